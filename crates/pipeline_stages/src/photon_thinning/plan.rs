use super::PhotonThinning;
use bevy_ecs::prelude::*;
use glam::{Vec2, Vec3};
use pipeline_core::RenderClock;
use pipeline_data::vocabulary::{Findings, SceneReport, stage_settings};
use pipeline_data::{CameraFrame, PrimIndex, RenderSettings};
use transport::Camera;

/// How photons are thinned. Written by `plan_thinning`; present where they are.
#[derive(Resource, Clone, Copy, Debug)]
pub(super) struct ThinningPlan {
    /// Photons that are enough in the square of a pixel.
    pub(super) density: f32,
    /// Where the camera is in the middle of the exposure.
    pub(super) eye: Vec3,
    /// Side of the square that a pixel covers at a distance of one metre, metres.
    pub(super) pixel: f32,
}

impl ThinningPlan {
    pub(super) fn new(density: f32, camera: &Camera, resolution: Vec2) -> Self {
        let [ray, next] = [Vec2::ZERO, Vec2::Y].map(|step| camera.ray(0.5 * resolution + step, 0.5));
        Self {
            density,
            eye: ray.origin,
            pixel: ray.direction.distance(next.direction),
        }
    }

    /// Photons per m² that are enough at a position.
    pub(super) fn most_density(&self, position: Vec3) -> f32 {
        self.density / (self.pixel * self.pixel * position.distance_squared(self.eye))
    }
}

/// Takes up the settings.
pub(super) fn plan_thinning(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    camera: Option<Res<CameraFrame>>,
    prims: Query<(&PrimIndex, &PhotonThinning)>,
    clock: Res<RenderClock>,
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<ThinningPlan>();
    let (Some(settings), Some(camera), Some(mut report)) = (settings, camera, report) else {
        return;
    };
    let mut findings = Findings::default();
    let unused = (clock.photons_pending == 0).then_some("nothing reads photons");
    let written = ("PhotonThinning", &prims);
    let chosen = stage_settings(written, settings.render_prim, unused, report.scene(), &mut findings);
    // A file of photons for this scene holds them thinned; once more, and they would be others.
    if let (Some(chosen), None) = (chosen, &report.request().photons) {
        let resolution = settings.resolution.as_vec2();
        commands.insert_resource(ThinningPlan::new(chosen.density, &camera.0, resolution));
    }
    report.file(findings);
}

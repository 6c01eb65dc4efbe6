//! Depth of field: rays start on a lens instead of in a point, and meet where the camera is focused.
//!
//! Scene: `DepthOfField` on the prim with the camera that `Render.camera` names. Without it, or with a lens without a
//! size, no system of this stage runs.
//! Sets: `PrepareStages` (`fit_lens`), `PerturbLens` (`sample_lens` moves the origin and direction of every camera ray).
//!
//! The lens is thin: what lies at `focus_distance` along the view is sharp, a point at another distance z becomes a disc.
//! On the plane of focus its diameter is 2 r |z − f| / z for a lens of radius r focused at f.
//!
//! Source: Potmesil and Chakravarty, SIGGRAPH 1981; sampled as in Cook, Porter and Carpenter, SIGGRAPH 1984.

mod fit;
mod lens;
mod sample;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use lens::ThinLens;
use pipeline_core::{PerturbSystems, Prepare, PrepareSystems, RenderPass};
use radiometry::StageKey;
use scene_format::{Exclusive, Range, Required, Unit};

/// Key of the random numbers of the place on the lens.
const LENS_STAGE: StageKey = StageKey::new("depth_of_field");

/// The lens of a camera. On the prim with the `Camera`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct DepthOfField {
    /// Radius of the lens: larger blurs more what is out of focus. 0 is a pinhole.
    #[reflect(@Range::at_least(0.0), @Unit("m"), @Exclusive::group("aperture"))]
    pub lens_radius: f32,
    /// The aperture as photographers say it, in place of `lens_radius`: the diameter of the lens is `focal_length` divided
    /// by it. 1.4 blurs much, 16 little.
    #[reflect(@Range::above(0.0), @Exclusive::group("aperture"))]
    pub fstop: Option<f32>,
    /// With `fstop`, the focal length that it divides. It does not change the angle of view, `Camera.fov` does.
    #[reflect(@Range::above(0.0), @Unit("mm"))]
    pub focal_length: f32,
    /// Distance of the plane that is sharp, along the view.
    #[reflect(@Required, @Range::above(0.0), @Unit("m"))]
    pub focus_distance: f32,
    /// Corners of the aperture, which the blur of small lights shows; 0 is round.
    #[reflect(@Range::closed(0.0, 64.0))]
    pub blades: u32,
}

impl Default for DepthOfField {
    fn default() -> Self {
        Self {
            lens_radius: 0.0,
            fstop: None,
            focal_length: 50.0,
            focus_distance: 1.0,
            blades: 0,
        }
    }
}

impl DepthOfField {
    /// Radius of the lens in metres, as one of the two fields says.
    fn radius(&self) -> f32 {
        const METRES_PER_MM: f32 = 0.001;
        match self.fstop {
            Some(fstop) => 0.5 * METRES_PER_MM * self.focal_length / fstop,
            None => self.lens_radius,
        }
    }
}

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct DepthOfFieldSystems;

/// Adds depth of field.
pub struct DepthOfFieldPlugin;

impl Plugin for DepthOfFieldPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<DepthOfField>()
            .add_systems(
                Prepare,
                fit::fit_lens
                    .in_set(PrepareSystems::PrepareStages)
                    .in_set(DepthOfFieldSystems),
            )
            .add_systems(
                RenderPass,
                sample::sample_lens
                    .in_set(PerturbSystems::PerturbLens)
                    .in_set(DepthOfFieldSystems)
                    .run_if(resource_exists::<ThinLens>),
            );
    }
}

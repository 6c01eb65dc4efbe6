use super::DepthOfField;
use super::lens::ThinLens;
use bevy_ecs::prelude::*;
use pipeline_data::vocabulary::{Camera, Findings, SceneReport, component_place, field_place};
use pipeline_data::{PrimIndex, RenderSettings};
use scene_format::Diagnostic;

/// Gives the camera of the render its lens.
pub(super) fn fit_lens(
    mut commands: Commands,
    settings: Option<Res<RenderSettings>>,
    lenses: Query<(&PrimIndex, &DepthOfField, Has<Camera>)>,
    report: Option<SceneReport<'_>>,
) {
    commands.remove_resource::<ThinLens>();
    let Some(mut report) = report else { return };
    let scene = report.scene();
    let mut findings = Findings::default();
    for (index, lens, is_camera) in &lenses {
        let path = &scene.prims[index.0 as usize].path;
        if !is_camera {
            let message = format!("`DepthOfField` of `{path}` has no effect: the prim has no `Camera`");
            let place = component_place(scene, index.0, "DepthOfField");
            findings.push_at(place, Diagnostic::warning("without-effect", message));
            continue;
        }
        if lens.blades == 1 || lens.blades == 2 {
            let message = format!("an aperture cannot have {} corners", lens.blades);
            let finding =
                Diagnostic::error("out-of-range", message).note("`blades` is 0 for a round one, or at least 3");
            findings.push_at(field_place(scene, index.0, "DepthOfField", &["blades"]), finding);
            continue;
        }
        let radius = lens.radius();
        let looked_through = settings
            .as_ref()
            .is_some_and(|settings| settings.camera_prim == index.0);
        if looked_through && radius > 0.0 {
            commands.insert_resource(ThinLens {
                radius,
                focus_distance: lens.focus_distance,
                blades: lens.blades,
            });
        }
    }
    report.file(findings);
}

use super::MotionBlur;
use bevy_ecs::prelude::*;
use pipeline_data::vocabulary::{Camera, Findings, Render, SceneReport, component_place, field_place};
use pipeline_data::{PrimIndex, ShutterInterval};
use scene_format::Diagnostic;

/// Opens the shutter for as long as the camera of the render says.
pub(super) fn open_shutter(
    mut commands: Commands,
    mut check: SceneReport,
    renders: Query<(&PrimIndex, &Render)>,
    blurs: Query<(&PrimIndex, &MotionBlur, Has<Camera>)>,
) {
    commands.remove_resource::<ShutterInterval>();
    let scene = check.scene();
    let mut findings = Findings::default();
    // Which of several renders counts is not for this stage to say: they are refused later.
    let looked_through = renders.iter().min_by_key(|(index, _)| **index);
    let camera = looked_through.map(|(_, render)| render.camera.0.as_str());
    for (index, blur, is_camera) in &blurs {
        let path = scene.prims[index.0 as usize].path.as_str();
        if !is_camera {
            let message = format!("`MotionBlur` of `{path}` has no effect: the prim has no `Camera`");
            let place = component_place(scene, index.0, "MotionBlur");
            findings.push_at(place, Diagnostic::warning("without-effect", message));
        } else if blur.shutter.y < blur.shutter.x {
            let message = format!("the shutter of `{path}` closes before it opens");
            let finding = Diagnostic::error("out-of-range", message)
                .note("`shutter` is (opening, closing) in frames, counted from the frame that is rendered");
            findings.push_at(field_place(scene, index.0, "MotionBlur", &["shutter"]), finding);
        } else if camera == Some(path) && blur.shutter.y > blur.shutter.x {
            commands.insert_resource(ShutterInterval {
                open: scene.frame + blur.shutter.x,
                close: scene.frame + blur.shutter.y,
            });
        }
    }
    check.file(findings);
}

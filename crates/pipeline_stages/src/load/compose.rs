use bevy_ecs::prelude::*;
use bevy_ecs::reflect::AppTypeRegistry;
use pipeline_core::Report;
use pipeline_data::vocabulary::{Findings, is_scene_component};
use pipeline_data::{ComposedScene, RenderRequest};
use scene_format::Schema;

/// Composes the scene file that the request names.
pub(super) fn compose_scene(
    mut commands: Commands,
    request: Res<RenderRequest>,
    registry: Res<AppTypeRegistry>,
    mut report: ResMut<Report>,
) {
    commands.remove_resource::<ComposedScene>();
    let registry = registry.read();
    let schema = match Schema::new(&registry, is_scene_component) {
        Ok(schema) => schema,
        Err(error) => return report.fail(format!("error[bad-schema]: {error}\n")),
    };
    match scene_format::load(&request.scene, &schema, &request.options) {
        Ok(scene) => {
            for warning in &scene.warnings {
                report.warn(scene.report(warning, request.colour));
            }
            commands.insert_resource(ComposedScene(scene));
        }
        Err(refusal) => Findings::file_refusal(&refusal, &request, &mut report),
    }
}

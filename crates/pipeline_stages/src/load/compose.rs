use bevy_ecs::prelude::*;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_reflect::TypeRegistration;
use bevy_reflect::std_traits::ReflectDefault;
use pipeline_core::Report;
use pipeline_data::vocabulary::Findings;
use pipeline_data::{ComposedScene, RenderRequest};
use scene_format::Schema;

/// Tells whether scenes may use a registered type: a component that has a default, of the program or of a plug-in.
///
/// The components of `bevy_ecs` itself are not for scenes. Whoever builds a [`Schema`] asks this, so that `run`, `check`
/// and `schema` agree.
#[must_use]
pub fn is_scene_component(found: &TypeRegistration) -> bool {
    found.contains::<ReflectComponent>()
        && found.contains::<ReflectDefault>()
        && !found.type_info().type_path().starts_with("bevy_")
}

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

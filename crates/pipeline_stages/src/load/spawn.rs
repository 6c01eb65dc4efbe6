use bevy_ecs::prelude::*;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use pipeline_core::{Counters, Report, record_items};
use pipeline_data::vocabulary::is_scene_component;
use pipeline_data::{ComposedScene, PrimIndex};
use scene_format::Schema;

/// Spawns an entity for every rendered prim, with its components as they are at the scene's frame.
///
/// Entities of an earlier load are replaced. They are spawned in the order of the prims, but nothing may depend on it:
/// whoever needs an order sorts by [`PrimIndex`].
pub(super) fn spawn_prims(world: &mut World) {
    let old: Vec<Entity> = world.query_filtered::<Entity, With<PrimIndex>>().iter(world).collect();
    for entity in old {
        world.despawn(entity);
    }
    let registry = world.resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let schema = match Schema::new(&registry, is_scene_component) {
        Ok(schema) => schema,
        Err(error) => {
            return world
                .resource_mut::<Report>()
                .fail(format!("error[bad-schema]: {error}\n"));
        }
    };
    let count = world.resource_scope(|world, composed: Mut<ComposedScene>| {
        let scene = &composed.0;
        for (index, prim) in scene.rendered() {
            let mut entity = world.spawn(PrimIndex(index as u32));
            for component in &prim.components {
                let built = component.build(&schema, scene.frame);
                if let Some(inserter) = registry.get_type_data::<ReflectComponent>(component.type_id) {
                    inserter.insert(&mut entity, built.as_partial_reflect(), &registry);
                }
            }
        }
        scene.rendered().count()
    });
    record_items(count);
    world.resource_mut::<Counters>().counter("load/prims").add(count as u64);
}

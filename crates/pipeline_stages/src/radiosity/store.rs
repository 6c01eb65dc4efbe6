use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{RadiosityPatch, SolvedPatches};

/// Makes the solved patches entities, in place of those of an earlier solution.
pub(super) fn store_patches(
    mut commands: Commands,
    solved: Option<Res<SolvedPatches>>,
    old: Query<Entity, With<RadiosityPatch>>,
) {
    for entity in &old {
        commands.entity(entity).despawn();
    }
    let Some(solved) = solved else { return };
    let patches: Vec<RadiosityPatch> = solved.0.patches().iter().map(|patch| RadiosityPatch(*patch)).collect();
    record_items(patches.len());
    commands.spawn_batch(patches);
}

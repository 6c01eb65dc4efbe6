use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{HitStream, PathStream, RayStream, TransportScene};
use rayon::prelude::*;

/// The counter of rays, asked for once.
pub(super) struct RayCounter(Counter);

impl FromWorld for RayCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("path_tracing/rays"))
    }
}

/// Traces every live path's ray to what it meets.
pub(super) fn intersect_rays(
    mut batches: Query<(&RayStream, &mut PathStream, &mut HitStream)>,
    scene: Res<TransportScene>,
    counter: Local<RayCounter>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let rays = batches
        .par_iter_mut()
        .map(|(rays, paths, hits)| {
            let traced = rays
                .0
                .iter()
                .zip(&mut paths.0)
                .map(|(ray, path)| transport::arrive(&scene.0, path, ray));
            hits.0.clear();
            hits.0.extend(traced);
            rays.0.len()
        })
        .sum();
    counter.0.add(rays as u64);
    record_items(rays);
}

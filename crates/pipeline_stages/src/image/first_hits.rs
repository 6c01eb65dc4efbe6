use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{FirstHit, FirstHits, HitStream, PathStream, RayStream, TransportScene};
use radiometry::Frame;
use rayon::prelude::*;

/// Notes what camera rays meet first, for the albedo, normal, depth and alpha channels.
pub(super) fn record_first_hits(
    mut batches: Query<(&RayStream, &PathStream, &HitStream, &mut FirstHits)>,
    scene: Res<TransportScene>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let paths = batches
        .par_iter_mut()
        .map(|(rays, paths, hits, first)| {
            first.0.clear();
            first.0.extend(rays.0.iter().zip(&hits.0).map(|(ray, hit)| {
                hit.as_ref().map_or(FirstHit::default(), |point| {
                    let (bsdf, normal) = scene.0.material(point).at(&scene.0.rays, point);
                    let wo = Frame::from_normal(normal).local_from_world(-ray.direction);
                    FirstHit {
                        alpha: 1.0,
                        albedo: bsdf.albedo(wo),
                        normal,
                        depth: point.p.distance(ray.origin),
                    }
                })
            }));
            paths.0.len()
        })
        .sum();
    record_items(paths);
}

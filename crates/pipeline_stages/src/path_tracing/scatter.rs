use bevy_ecs::prelude::*;
use pipeline_core::{RenderClock, record_items};
use pipeline_data::{GuideStream, HitStream, PathStream, RayStream, RenderSettings, TransportScene};
use rayon::prelude::*;
use transport::Vertex;

/// Sends every path on in a new direction and closes the ranks over those that ended.
pub(super) fn scatter_paths(
    mut batches: Query<(&mut RayStream, &mut PathStream, &HitStream, &GuideStream)>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
    mut clock: ResMut<RenderClock>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    record_items(clock.live_paths as usize);
    let live: usize = batches
        .par_iter_mut()
        .map(|(rays, paths, hits, guides)| {
            let (rays, paths) = (&mut rays.0, &mut paths.0);
            let mut kept = 0;
            for row in 0..paths.len() {
                let Some(hit) = &hits.0[row] else { continue };
                let mut path = paths[row];
                let arriving = rays[row];
                let vertex = Vertex::new(&scene.0, hit, -arriving.direction, &path.medium).guided(guides.0.get(row));
                let next = transport::scatter_at(&scene.0, &settings.methods, &mut path, arriving.time, &vertex);
                if let Some(ray) = next {
                    rays[kept] = ray;
                    paths[kept] = path;
                    kept += 1;
                }
            }
            rays.truncate(kept);
            paths.truncate(kept);
            kept
        })
        .sum();
    clock.live_paths = live as u64;
}

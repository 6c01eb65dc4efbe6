use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{
    Contribution, ContributionLog, GuideStream, HitStream, PathStream, RayStream, RenderSettings, TransportScene,
};
use rayon::prelude::*;
use transport::Vertex;

/// Light that was found by sampling the lights. Written by `sample_lights`.
#[derive(Component, Clone, Debug, Default)]
pub struct DirectLightContribution(ContributionLog);

impl AsMut<ContributionLog> for DirectLightContribution {
    fn as_mut(&mut self) -> &mut ContributionLog {
        &mut self.0
    }
}

impl Contribution for DirectLightContribution {
    const NAME: &'static str = "path_tracing/direct_light";
}

/// Samples one light at every hit.
pub(super) fn sample_lights(
    mut batches: Query<(
        &RayStream,
        &PathStream,
        &HitStream,
        &GuideStream,
        &mut DirectLightContribution,
    )>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let paths = batches
        .par_iter_mut()
        .map(|(rays, paths, hits, guides, log)| {
            for (row, ((ray, path), hit)) in rays.0.iter().zip(&paths.0).zip(&hits.0).enumerate() {
                let Some(hit) = hit else { continue };
                let vertex = Vertex::new(&scene.0, hit, -ray.direction, &path.medium).guided(guides.0.get(row));
                transport::sample_direct_light_at(
                    &scene.0,
                    &settings.methods,
                    path,
                    ray.time,
                    &vertex,
                    |layer, radiance| {
                        log.0.add(path.slot, layer, radiance);
                    },
                );
            }
            paths.0.len()
        })
        .sum();
    record_items(paths);
}

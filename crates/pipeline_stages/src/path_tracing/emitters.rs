use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{Contribution, ContributionLog, HitStream, PathStream, RayStream, RenderSettings, TransportScene};
use rayon::prelude::*;

/// Light that paths met by themselves. Written by `shade_emitters`.
#[derive(Component, Clone, Debug, Default)]
pub struct EmissionContribution(ContributionLog);

impl AsMut<ContributionLog> for EmissionContribution {
    fn as_mut(&mut self) -> &mut ContributionLog {
        &mut self.0
    }
}

impl Contribution for EmissionContribution {
    const NAME: &'static str = "path_tracing/emission";
}

/// Adds the light of emitters and of the environment that rays have met.
pub(super) fn shade_emitters(
    mut batches: Query<(&RayStream, &PathStream, &HitStream, &mut EmissionContribution)>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let paths = batches
        .par_iter_mut()
        .map(|(rays, paths, hits, log)| {
            for ((ray, path), hit) in rays.0.iter().zip(&paths.0).zip(&hits.0) {
                if let Some((layer, radiance)) =
                    transport::emitted_light(&scene.0, &settings.methods, path, ray, hit.as_ref())
                {
                    log.0.add(path.slot, layer, radiance);
                }
            }
            paths.0.len()
        })
        .sum();
    record_items(paths);
}

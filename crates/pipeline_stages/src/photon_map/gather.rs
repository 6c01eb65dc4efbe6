use super::CausticMap;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{Contribution, ContributionLog, HitStream, PathStream, RayStream, RenderSettings, TransportScene};
use rayon::prelude::*;
use transport::{DensityScratch, Vertex};

/// Caustics that were read from the photon map. Written by `gather_caustics`.
#[derive(Component, Clone, Debug, Default)]
pub struct CausticContribution(ContributionLog);

impl AsMut<ContributionLog> for CausticContribution {
    fn as_mut(&mut self) -> &mut ContributionLog {
        &mut self.0
    }
}

impl Contribution for CausticContribution {
    const NAME: &'static str = "photon_map/caustic";
}

/// The counter of this system, asked for once.
pub(super) struct LookupCounter(Counter);

impl FromWorld for LookupCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("photon_map/lookups"))
    }
}

/// Reads the caustic photon map wherever a path has reached a diffuse lobe.
pub(super) fn gather_caustics(
    mut batches: Query<(&RayStream, &PathStream, &HitStream, &mut CausticContribution)>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
    caustics: Res<CausticMap>,
    counter: Local<LookupCounter>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let lookups = batches
        .par_iter_mut()
        .map_init(DensityScratch::default, |scratch, (rays, paths, hits, log)| {
            let mut lookups = 0;
            for ((ray, path), hit) in rays.0.iter().zip(&paths.0).zip(&hits.0) {
                let Some(hit) = hit else { continue };
                let Some(layer) = settings.methods.caustic_map_layer(path.class) else {
                    continue;
                };
                let vertex = Vertex::new(&scene.0, hit, -ray.direction, &path.medium);
                if path.depth >= settings.methods.max_depth || !vertex.bsdf.has_diffuse() {
                    continue;
                }
                lookups += 1;
                let radiance = caustics.map.estimate_radiance(&vertex, &caustics.density, scratch);
                if !radiance.is_black() {
                    log.0.add(path.slot, layer, path.throughput * radiance);
                }
            }
            lookups
        })
        .sum();
    counter.0.add(lookups as u64);
    record_items(lookups);
}

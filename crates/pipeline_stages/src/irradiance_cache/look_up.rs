use super::density::RecordDensity;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, RenderClock, record_items};
use pipeline_data::{
    BuiltIrradianceCache, Contribution, ContributionLog, HitStream, PathStream, RayStream, RenderSettings,
    TransportScene,
};
use rayon::prelude::*;
use transport::{CacheAnswer, GatherMethods, GatherScratch, Incoming, Vertex};

/// Rays that are traced where no record holds: many, since that is rare and would show as specks among what is smooth.
const RAYS_WHERE_MISSING: u32 = 64;
/// Rays that are traced where the cache cannot be asked.
const RAYS_WHERE_UNSUITED: u32 = 4;

/// Indirect light from the irradiance cache. Written by `look_up_irradiance`.
#[derive(Component, Clone, Debug, Default)]
pub struct IrradianceContribution(ContributionLog);

impl AsMut<ContributionLog> for IrradianceContribution {
    fn as_mut(&mut self) -> &mut ContributionLog {
        &mut self.0
    }
}

impl Contribution for IrradianceContribution {
    const NAME: &'static str = "irradiance_cache/indirect";
}

/// The counters of this system, asked for once.
pub(super) struct LookupCounters {
    lookups: Counter,
    missing: Counter,
    unsuited: Counter,
}

impl FromWorld for LookupCounters {
    fn from_world(world: &mut World) -> Self {
        let mut counters = world.resource_mut::<Counters>();
        Self {
            lookups: counters.counter("irradiance_cache/lookups"),
            missing: counters.counter("irradiance_cache/missing"),
            unsuited: counters.counter("irradiance_cache/unsuited"),
        }
    }
}

type LookupStreams<'a> = (
    &'a RayStream,
    &'a PathStream,
    &'a HitStream,
    &'a mut IrradianceContribution,
    &'a mut RecordDensity,
);

/// Reads the cache wherever a path has reached its first diffuse lobe; traces where it has no answer, without bias.
pub(super) fn look_up_irradiance(
    mut batches: Query<LookupStreams<'_>>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
    cache: Res<BuiltIrradianceCache>,
    clock: Res<RenderClock>,
    counters: Local<LookupCounters>,
) {
    let is_first = clock.bounce == 0;
    let methods = &settings.methods;
    let traced = GatherMethods::new(methods, false);
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let counts = batches
        .par_iter_mut()
        .map_init(GatherScratch::default, |scratch, (rays, paths, hits, log, density)| {
            if is_first {
                density.reset(paths.0.len());
            }
            let [mut lookups, mut missing, mut unsuited] = [0_u64; 3];
            for ((ray, path), hit) in rays.0.iter().zip(&paths.0).zip(&hits.0) {
                let Some(hit) = hit else { continue };
                let Some(layer) = methods.gather_layer(path.class) else {
                    continue;
                };
                let vertex = Vertex::new(&scene.0, hit, -ray.direction, &path.medium);
                if path.depth >= methods.max_depth || !vertex.bsdf.has_diffuse() {
                    continue;
                }
                lookups += 1;
                let answer = transport::reflect_irradiance(&scene.0, cache.seen(), path, ray.time, &vertex);
                let mut trace = |rays| {
                    transport::gather_indirect(
                        &scene.0,
                        &traced,
                        Incoming::Paths,
                        path,
                        ray.time,
                        &vertex,
                        rays,
                        scratch,
                    )
                };
                let light = match answer {
                    CacheAnswer::Light {
                        radiance,
                        record_density,
                        ..
                    } => {
                        if is_first {
                            density.set(path.slot, record_density);
                        }
                        radiance
                    }
                    CacheAnswer::Missing => {
                        missing += 1;
                        trace(RAYS_WHERE_MISSING)
                    }
                    CacheAnswer::Unsuited => {
                        unsuited += 1;
                        trace(RAYS_WHERE_UNSUITED)
                    }
                };
                if !light.is_black() {
                    log.0.add(path.slot, layer, light);
                }
            }
            [lookups, missing, unsuited]
        })
        .reduce(|| [0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
    let [lookups, missing, unsuited] = counts;
    counters.lookups.add(lookups);
    counters.missing.add(missing);
    counters.unsuited.add(unsuited);
    record_items(lookups as usize);
}

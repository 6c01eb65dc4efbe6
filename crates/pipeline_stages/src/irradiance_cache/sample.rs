use super::fill::CacheFill;
use super::plan::CachePlan;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{BuiltIrradianceCache, BuiltPhotonMaps, RenderSettings, TransportScene};
use rayon::prelude::*;
use transport::{GatherScratch, HemisphereSample, IrradianceRecord, PhotonMaps, RecordRays, Site, summarize};

/// The counter of this system, asked for once.
pub(super) struct RayCounter(Counter);

impl FromWorld for RayCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("irradiance_cache/rays"))
    }
}

/// Sends rays over the hemisphere of each chosen place and makes records of what they saw.
pub(super) fn sample_records(
    mut fill: ResMut<CacheFill>,
    plan: Res<CachePlan>,
    settings: Res<RenderSettings>,
    scene: Res<TransportScene>,
    cache: Res<BuiltIrradianceCache>,
    built: Option<Res<BuiltPhotonMaps>>,
    counter: Local<RayCounter>,
) {
    let chosen = std::mem::take(&mut fill.chosen);
    if chosen.is_empty() {
        return;
    }
    // Without any photon there is nothing to read, and nothing is reflected.
    let empty = PhotonMaps::default();
    let hemisphere = plan.hemisphere;
    let filled = &cache.0[fill.depth];
    let rays = RecordRays {
        seed: settings.seed,
        methods: plan.methods[fill.depth],
        maps: plan
            .reads_photons
            .then(|| built.as_ref().map_or(&empty, |built| &built.0)),
        cache: cache.0.get(fill.depth + 1),
    };
    let next = u64::from(fill.next_stream[fill.depth]);
    let first = next | u64::from(fill.generation) << 32 | (fill.depth as u64) << 62;
    let record = |(i, site): (usize, &Site)| -> Option<IrradianceRecord> {
        let samples: Vec<HemisphereSample> = (0..hemisphere.rings())
            .into_par_iter()
            .map_init(GatherScratch::default, |scratch, ring| {
                hemisphere.sample_ring(&scene.0, &rays, site, first + i as u64, ring, scratch)
            })
            .flatten_iter()
            .collect();
        let record = summarize(
            &hemisphere,
            &samples,
            site,
            &plan.settings[fill.depth],
            &plan.spacing[fill.depth],
        )?;
        filled.accepts(&record).ok().map(|()| record)
    };
    let sampled: Vec<Option<IrradianceRecord>> = chosen.par_iter().enumerate().map(record).collect();
    let count = chosen.len() * hemisphere.rays() as usize;
    record_items(count);
    counter.0.add(count as u64);
    let depth = fill.depth;
    fill.next_stream[depth] += chosen.len() as u32;
    fill.sampled = sampled.into_iter().flatten().collect();
}

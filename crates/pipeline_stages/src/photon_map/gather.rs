use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{
    BuiltPhotonMaps, CausticPhoton, Contribution, ContributionLog, DirectPhoton, HitStream, IndirectPhoton, PathStream,
    PhotonMarker, RayStream, RenderSettings, TransportScene,
};
use rayon::prelude::*;
use std::marker::PhantomData;
use transport::{DensityScratch, Vertex};

/// Light that was read from one photon map. Written by `gather_photons`.
#[derive(Component, Clone, Debug)]
pub struct PhotonContribution<M: PhotonMarker> {
    log: ContributionLog,
    map: PhantomData<M>,
}

impl<M: PhotonMarker> Default for PhotonContribution<M> {
    fn default() -> Self {
        Self {
            log: ContributionLog::default(),
            map: PhantomData,
        }
    }
}

impl<M: PhotonMarker> AsMut<ContributionLog> for PhotonContribution<M> {
    fn as_mut(&mut self) -> &mut ContributionLog {
        &mut self.log
    }
}

impl Contribution for PhotonContribution<DirectPhoton> {
    const NAME: &'static str = "photon_map/direct";
}

impl Contribution for PhotonContribution<CausticPhoton> {
    const NAME: &'static str = "photon_map/caustic";
}

impl Contribution for PhotonContribution<IndirectPhoton> {
    const NAME: &'static str = "photon_map/indirect";
}

/// The counter of these systems, asked for once.
pub(super) struct LookupCounter(Counter);

impl FromWorld for LookupCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("photon_map/lookups"))
    }
}

/// True when a map is there and the methods read it where the eye looks.
pub(super) fn is_read<M: PhotonMarker>(
    built: Option<Res<BuiltPhotonMaps>>,
    settings: Option<Res<RenderSettings>>,
) -> bool {
    built.is_some_and(|built| built.0.get(M::KIND).is_some())
        && settings.is_some_and(|settings| settings.methods.reads_map(M::KIND))
}

/// Reads one photon map wherever a path has reached a diffuse lobe and the methods say so.
pub(super) fn gather_photons<M: PhotonMarker>(
    mut batches: Query<(&RayStream, &PathStream, &HitStream, &mut PhotonContribution<M>)>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
    built: Res<BuiltPhotonMaps>,
    counter: Local<LookupCounter>,
) {
    let Some(map) = built.0.get(M::KIND) else { return };
    let methods = &settings.methods;
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let lookups = batches
        .par_iter_mut()
        .map_init(DensityScratch::default, |scratch, (rays, paths, hits, term)| {
            let mut lookups = 0;
            for ((ray, path), hit) in rays.0.iter().zip(&paths.0).zip(&hits.0) {
                let Some(hit) = hit else { continue };
                let Some(layer) = methods.map_layer(M::KIND, path.class) else {
                    continue;
                };
                let vertex = Vertex::new(&scene.0, hit, -ray.direction, &path.medium);
                if path.depth >= methods.max_depth || !vertex.bsdf.has_diffuse() {
                    continue;
                }
                lookups += 1;
                let radiance = map.estimate_radiance(&scene.0, &vertex, scratch).value;
                if !radiance.is_black() {
                    term.log.add(path.slot, layer, path.throughput * radiance);
                }
            }
            lookups
        })
        .sum();
    counter.0.add(lookups as u64);
    record_items(lookups);
}

use super::GatherSource;
use super::plan::GatherPlan;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{
    BuiltPhotonMaps, Contribution, ContributionLog, HitStream, PathStream, RayStream, RenderSettings, SolvedPatches,
    TransportScene,
};
use rayon::prelude::*;
use transport::{GatherScratch, Incoming, Vertex};

/// Indirect light that was gathered. Written by `gather_indirect`.
#[derive(Component, Clone, Debug, Default)]
pub struct GatherContribution(ContributionLog);

impl AsMut<ContributionLog> for GatherContribution {
    fn as_mut(&mut self) -> &mut ContributionLog {
        &mut self.0
    }
}

impl Contribution for GatherContribution {
    const NAME: &'static str = "final_gather/indirect";
}

/// The counter of this system, asked for once.
pub(super) struct RayCounter(Counter);

impl FromWorld for RayCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("final_gather/rays"))
    }
}

/// Gathers indirect light wherever a path has reached its first diffuse lobe.
pub(super) fn gather_indirect(
    mut batches: Query<(&RayStream, &PathStream, &HitStream, &mut GatherContribution)>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
    plan: Res<GatherPlan>,
    built: Option<Res<BuiltPhotonMaps>>,
    patches: Option<Res<SolvedPatches>>,
    counter: Local<RayCounter>,
) {
    // Without any photon there is nothing to read, and nothing is reflected.
    let empty = transport::PhotonMaps::default();
    let incoming = match plan.incoming {
        GatherSource::Path => Incoming::Paths,
        GatherSource::Photons => Incoming::Photons(built.as_ref().map_or(&empty, |built| &built.0)),
        GatherSource::Radiosity => patches
            .as_ref()
            .map_or(Incoming::Paths, |patches| Incoming::Patches(&patches.0)),
    };
    let methods = &settings.methods;
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let points: usize = batches
        .par_iter_mut()
        .map_init(GatherScratch::default, |scratch, (rays, paths, hits, log)| {
            let mut points = 0;
            for ((ray, path), hit) in rays.0.iter().zip(&paths.0).zip(&hits.0) {
                let Some(hit) = hit else { continue };
                let Some(layer) = methods.gather_layer(path.class) else {
                    continue;
                };
                let vertex = Vertex::new(&scene.0, hit, -ray.direction, &path.medium);
                if path.depth >= methods.max_depth || !vertex.bsdf.has_diffuse() {
                    continue;
                }
                points += 1;
                let light = transport::gather_indirect(
                    &scene.0,
                    &plan.methods,
                    incoming,
                    path,
                    ray.time,
                    &vertex,
                    plan.rays,
                    scratch,
                );
                if !light.is_black() {
                    log.0.add(path.slot, layer, light);
                }
            }
            points
        })
        .sum();
    let rays = points * plan.rays as usize;
    counter.0.add(rays as u64);
    record_items(rays);
}

use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{
    Contribution, ContributionLog, HitStream, PathStream, RayStream, RenderSettings, SolvedPatches, TransportScene,
};
use radiometry::Rgb;
use rayon::prelude::*;
use transport::{GatherMethods, GatherScratch, Incoming, PatchScratch, Vertex};

/// Rays where there is no patch to read, as on moving surfaces.
const RAYS_WITHOUT_PATCH: u32 = 4;

/// Indirect light from the solution. Written by `look_up_radiosity`.
#[derive(Component, Clone, Debug, Default)]
pub struct RadiosityContribution(ContributionLog);

impl AsMut<ContributionLog> for RadiosityContribution {
    fn as_mut(&mut self) -> &mut ContributionLog {
        &mut self.0
    }
}

impl Contribution for RadiosityContribution {
    const NAME: &'static str = "radiosity/indirect";
}

/// The counter of this system, asked for once.
pub(super) struct MissCounter(Counter);

impl FromWorld for MissCounter {
    fn from_world(world: &mut World) -> Self {
        let mut counters = world.resource_mut::<Counters>();
        Self(counters.counter("radiosity/look-ups without a patch"))
    }
}

/// Reads the solution wherever a path has reached its first diffuse lobe.
pub(super) fn look_up_radiosity(
    mut batches: Query<(&RayStream, &PathStream, &HitStream, &mut RadiosityContribution)>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
    solved: Res<SolvedPatches>,
    misses: Local<MissCounter>,
) {
    let methods = &settings.methods;
    let gathering = GatherMethods::new(methods, false);
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let (points, missed): (usize, u64) = batches
        .par_iter_mut()
        .map_init(
            <(PatchScratch, GatherScratch)>::default,
            |scratch, (rays, paths, hits, log)| {
                let (mut points, mut missed) = (0, 0);
                for ((ray, path), hit) in rays.0.iter().zip(&paths.0).zip(&hits.0) {
                    let (Some(hit), Some(layer)) = (hit, methods.radiosity_layer(path.class)) else {
                        continue;
                    };
                    let vertex = Vertex::new(&scene.0, hit, -ray.direction, &path.medium);
                    if path.depth >= methods.max_depth || !vertex.bsdf.has_diffuse() {
                        continue;
                    }
                    points += 1;
                    let light: Rgb = match solved.0.indirect_irradiance(&scene.0, &vertex, &mut scratch.0) {
                        Some(irradiance) => path.throughput * vertex.diffuse_response() * irradiance,
                        None => {
                            missed += 1;
                            transport::gather_indirect(
                                &scene.0,
                                &gathering,
                                Incoming::Patches(&solved.0),
                                path,
                                ray.time,
                                &vertex,
                                RAYS_WITHOUT_PATCH,
                                &mut scratch.1,
                            )
                        }
                    };
                    if !light.is_black() {
                        log.0.add(path.slot, layer, light);
                    }
                }
                (points, missed)
            },
        )
        .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    misses.0.add(missed);
    record_items(points);
}

use super::plan::GuidePlan;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{BuiltPhotonMaps, GuideStream, HitStream, PathStream, RayStream, TransportScene};
use rayon::prelude::*;
use transport::{DensityScratch, Guide, MapKind, PhotonMap, Vertex};

/// The counter of this system, asked for once.
pub(super) struct GuideCounter(Counter);

impl FromWorld for GuideCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("path_guiding/guides"))
    }
}

/// Says at every hit where light comes from.
pub(super) fn guide_paths(
    mut batches: Query<(&RayStream, &PathStream, &HitStream, &mut GuideStream)>,
    scene: Res<TransportScene>,
    plan: Res<GuidePlan>,
    built: Option<Res<BuiltPhotonMaps>>,
    counter: Local<GuideCounter>,
) {
    let Some(built) = built else { return };
    let maps: Vec<&PhotonMap> = built
        .0
        .iter()
        .filter(|(kind, _)| plan.kinds.wants(*kind))
        .map(|(_, map)| map)
        .collect();
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let known: usize = batches
        .par_iter_mut()
        .map_init(
            || vec![DensityScratch::default(); MapKind::COUNT],
            |scratch, (rays, paths, hits, guides)| {
                let at = |((ray, path), hit): ((&spatial::Ray, &transport::Path), &Option<_>)| match hit {
                    Some(hit) => {
                        let vertex = Vertex::new(&scene.0, hit, -ray.direction, &path.medium);
                        Guide::at(&scene.0, &vertex, maps.iter().copied().zip(&mut *scratch), plan.mix)
                    }
                    None => Guide::NONE,
                };
                guides.0.clear();
                guides.0.extend(rays.0.iter().zip(&paths.0).zip(&hits.0).map(at));
                guides.0.iter().filter(|guide| guide.is_known()).count()
            },
        )
        .sum();
    counter.0.add(known as u64);
    record_items(known);
}

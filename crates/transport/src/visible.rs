use crate::emission::EmissionSampler;
use crate::path::{Path, arrive, scatter};
use crate::path_class::Methods;
use crate::projection::{TargetSphere, cluster_targets};
use crate::scene::Scene;
use radiometry::{SampleStream, StageKey};
use spatial::Ray;

/// Key of the random numbers of the paths and photons that ask what is visible.
const VISIBLE_STAGE: StageKey = StageKey::new("visible surfaces");

/// D vertices after which a path asks no further: one that is seen, and one that lights it.
const D_VERTICES: u32 = 2;

/// Photons that [`landing_share`] sends out.
const PROBES: u32 = 4096;

/// Spheres around the surfaces whose light the eye can see, directly, in mirrors, or over one more D vertex: where photons
/// matter.
///
/// - `rays`: camera rays spread over the film; each begins a path whose random numbers are those of its place in the order.
/// - returns at most [`MAX_TARGETS`](crate::MAX_TARGETS) spheres; none where no D vertex was met.
#[must_use]
pub fn visible_targets(scene: &Scene, seed: u64, rays: impl Iterator<Item = Ray>) -> Vec<TargetSphere> {
    let mut seen = Vec::new();
    for (number, mut ray) in rays.enumerate() {
        let mut path = Path::from_eye(0, SampleStream::new(seed, VISIBLE_STAGE, 0, number as u32));
        let mut vertices = 0;
        while let Some(hit) = arrive(scene, &mut path, &ray) {
            if scene.material(&hit).has_diffuse() {
                seen.push(TargetSphere {
                    centre: hit.p,
                    radius: 0.0,
                });
                vertices += 1;
            }
            if vertices == D_VERTICES {
                break;
            }
            match scatter(scene, &Methods::TRACED, &mut path, &ray, &hit) {
                Some(next) => ray = next,
                None => break,
            }
        }
    }
    cluster_targets(seen)
}

/// Share of the photons without aim whose first D vertex lies in one of the spheres, in [0, 1]: where it is high, aim would
/// only make photons unlike.
#[must_use]
pub fn landing_share(scene: &Scene, seed: u64, targets: &[TargetSphere]) -> f32 {
    let sampler = EmissionSampler::uniform(&scene.lights);
    let lands = |number: &u32| {
        let stream = SampleStream::new(seed, VISIBLE_STAGE, 1, *number);
        let Some(photon) = sampler.emit(&stream) else {
            return false;
        };
        let mut path = Path::from_eye(0, stream);
        let mut ray = photon.ray;
        while let Some(hit) = arrive(scene, &mut path, &ray) {
            if scene.material(&hit).has_diffuse() {
                let inside =
                    |target: &TargetSphere| hit.p.distance_squared(target.centre) <= target.radius * target.radius;
                return targets.iter().any(inside);
            }
            match scatter(scene, &Methods::TRACED, &mut path, &ray, &hit) {
                Some(next) => ray = next,
                None => return false,
            }
        }
        false
    };
    (0..PROBES).filter(lands).count() as f32 / PROBES as f32
}

use super::field::{Patch, PatchField, PatchScratch};
use crate::medium::{PathMedium, unblocked};
use crate::path::{Path, arrive, emitted_light, sample_direct_light_at, scatter_at};
use crate::path_class::{CausticMethod, DirectMethod, Event, IndirectMethod, Methods};
use crate::scene::Scene;
use crate::vertex::Vertex;
use radiometry::{Frame, Rgb, SampleStream, StageKey, warp};
use spatial::{Ray, SurfacePoint, spawn_origin};
use std::f32::consts::{FRAC_1_PI, PI};

/// Key of the rays of patches.
const CAST_STAGE: StageKey = StageKey::new("radiosity rays");
/// Key of the light samples of patches.
const DIRECT_STAGE: StageKey = StageKey::new("radiosity light");

/// What one patch sees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchRow {
    /// Row of a patch, and the form factor of this one with it, tinted by what is between; each patch once, by row.
    pub links: Vec<(u32, Rgb)>,
    /// Irradiance by lights that rays met, straight or over S surfaces, W·m⁻²; weighed against light sampling.
    pub met: Rgb,
}

/// The irradiance of a patch by light sampling: from all lights, those of points, surfaces and the surroundings.
///
/// `E = 1/N Σ w L(ω) |cosθ| V / p(ω)`, with `w` the power heuristic against the rays of [`cast_row`], which bring the rest:
/// next to a lamp light sampling alone has no bounded variance.
///
/// - `row`: of the patch, which its random numbers follow from.
#[must_use]
pub(super) fn direct_irradiance(scene: &Scene, patch: &Patch, row: u32, samples: u32, seed: u64) -> Rgb {
    let point = point_of(patch);
    let medium = PathMedium::at(scene, point.p + patch.normal * (4.0 * patch.error), 0.0);
    let mut sum = Rgb::BLACK;
    for number in 0..samples {
        let stream = SampleStream::new(seed, DIRECT_STAGE, u64::from(row), number);
        let light = scene
            .lights
            .sample(point.p, 0.0, stream.draw_2d(0, 0), stream.draw_2d(0, 1));
        let Some(light) = light else { continue };
        let cos = light.wi.dot(patch.normal);
        if cos <= 0.0 {
            continue;
        }
        if let Some(left) = unblocked(scene, medium, &light.shadow_ray(&point)) {
            let weight = if light.delta {
                1.0
            } else {
                warp::power_heuristic(light.pdf, cos * FRAC_1_PI)
            };
            sum += light.radiance * left * (weight * cos / light.pdf);
        }
    }
    sum * (1.0 / samples as f32)
}

/// Casts the rays of a patch over its hemisphere, by the cosine, and finds the patches that they end on.
///
/// `F_ij ≈ 1/N Σ [ray ends on j]`, so that the factors of a patch add up to the share of its rays that meet a diffuse
/// surface: to 1 in a closed room. Rays go on over S surfaces, and what they carry then is in the factor.
///
/// Cost: a ray and a look-up for each of `rays`, at least.
#[must_use]
pub fn cast_row(
    scene: &Scene,
    field: &PatchField,
    row: u32,
    rays: u32,
    seed: u64,
    scratch: &mut PatchScratch,
) -> PatchRow {
    let patch = &field.patches[row as usize];
    let frame = Frame::from_normal(patch.normal);
    let share = 1.0 / rays as f32;
    let mut found = PatchRow::default();
    for number in 0..rays {
        let stream = SampleStream::new(seed, CAST_STAGE, u64::from(row), number);
        let local = warp::sample_cosine_hemisphere(stream.draw_2d(u32::MAX, 0));
        let direction = frame.world_from_local(local).normalize();
        let mut path = Path::from_eye(0, stream);
        path.class = path.class.after(Event::Diffuse);
        path.pdf = local.z * FRAC_1_PI;
        let origin = spawn_origin(patch.position, patch.error, patch.normal, direction);
        follow(
            scene,
            field,
            path,
            Ray::new(origin, direction),
            share,
            &mut found,
            scratch,
        );
    }
    merge(&mut found.links);
    found
}

/// Follows a ray over S surfaces to what it ends on.
fn follow(
    scene: &Scene,
    field: &PatchField,
    mut path: Path,
    mut ray: Ray,
    share: f32,
    found: &mut PatchRow,
    scratch: &mut PatchScratch,
) {
    // Lights count here, straight or over S surfaces; patches know what is reflected.
    const METHODS: Methods = Methods {
        direct: DirectMethod::SampleLights,
        specular: true,
        caustic: CausticMethod::Trace,
        indirect: IndirectMethod::Radiosity,
        ..Methods::TRACED
    };
    loop {
        let hit = arrive(scene, &mut path, &ray);
        let mut add = |light: Rgb| found.met += light * (PI * share);
        if let Some((_, emitted)) = emitted_light(scene, &METHODS, &path, &ray, hit.as_ref()) {
            add(emitted);
        }
        let Some(hit) = hit else { return };
        let vertex = Vertex::new(scene, &hit, -ray.direction, &path.medium);
        if vertex.bsdf.has_diffuse() {
            let normal = vertex.facing_normal();
            if let Some(patch) = field.patch_at(scene, hit.instance, hit.p, normal, hit.error, scratch) {
                found.links.push((patch, path.throughput * share));
            }
        }
        if !vertex.bsdf.has_specular() {
            return;
        }
        sample_direct_light_at(scene, &METHODS, &path, 0.0, &vertex, |_, light| add(light));
        let Some(next) = scatter_at(scene, &METHODS, &mut path, 0.0, &vertex) else {
            return;
        };
        if !path.class.ends_as_specular() {
            return;
        }
        ray = next;
    }
}

/// Adds up links to the same patch, in the order of rays, and gives memory back.
fn merge(links: &mut Vec<(u32, Rgb)>) {
    links.sort_by_key(|(patch, _)| *patch);
    links.dedup_by(|later, first| {
        let is_same = later.0 == first.0;
        if is_same {
            first.1 += later.1;
        }
        is_same
    });
    // There may have been as many as rays.
    links.shrink_to_fit();
}

fn point_of(patch: &Patch) -> SurfacePoint {
    SurfacePoint {
        p: patch.position,
        error: patch.error,
        ng: patch.normal,
        ns: patch.normal,
        uv: glam::Vec2::ZERO,
        instance: patch.instance,
        primitive: 0,
        time: 0.0,
    }
}

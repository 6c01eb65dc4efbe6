use crate::medium::{PathMedium, follow, unblocked};
use crate::path_class::{Event, Layer, Methods, PathClass};
use crate::scene::Scene;
use crate::vertex::Vertex;
use radiometry::{Rgb, SampleStream, warp};
use scattering::Transport;
use spatial::{Ray, SurfacePoint, spawn_origin};

/// A path from the eye, between two bounces. 84 bytes.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// What light met now is weighted with, by the sampling so far.
    pub throughput: Rgb,
    /// Density per solid angle of the last direction; infinite after a delta lobe and for camera rays.
    pub pdf: f32,
    /// Product of the η² factors that refraction put into `throughput`.
    pub eta_scale: f32,
    /// Its random numbers.
    pub stream: SampleStream,
    /// What it travels in.
    pub medium: PathMedium,
    /// Where its contributions go, in its batch.
    pub slot: u32,
    /// Events so far.
    pub depth: u32,
    /// Its class so far.
    pub class: PathClass,
}

const _: () = assert!(size_of::<Path>() <= 88);

impl Path {
    /// A camera path that contributes to `slot`.
    #[must_use]
    pub fn from_eye(slot: u32, stream: SampleStream) -> Self {
        Self {
            throughput: Rgb::WHITE,
            pdf: f32::INFINITY,
            eta_scale: 1.0,
            stream,
            medium: PathMedium::VACUUM,
            slot,
            depth: 0,
            class: PathClass::EYE,
        }
    }
}

/// Dimensions of the random numbers of one bounce.
mod dimension {
    pub(super) const LIGHT_CHOICE: u32 = 0;
    pub(super) const LIGHT: u32 = 1;
    pub(super) const LOBE: u32 = 2;
    pub(super) const DIRECTION: u32 = 3;
    pub(super) const ROULETTE: u32 = 4;
    pub(super) const WAVELENGTH: u32 = 5;
    /// And all after it: one for each surface that is not whole, along a ray.
    pub(super) const CUTOUT: u32 = 6;
}

/// Events before Russian roulette begins.
pub(crate) const ROULETTE_DEPTH: u32 = 4;
/// Most that a path may survive with, so that roulette ends every path.
pub(crate) const ROULETTE_MAX: f32 = 0.95;

/// Follows a ray to what it meets, and lets the material that it travels in absorb on the way.
///
/// A path that begins with this ray finds out what it begins in.
#[inline]
#[must_use]
pub fn arrive(scene: &Scene, path: &mut Path, ray: &Ray) -> Option<SurfacePoint> {
    if path.depth == 0 {
        path.medium = PathMedium::at(scene, ray.origin, ray.time);
    }
    let u = |cutout| path.stream.draw_1d(path.depth, dimension::CUTOUT + cutout);
    let (point, left) = follow(scene, &mut path.medium, ray, u);
    path.throughput *= left;
    if let Some(point) = &point {
        let u = || path.stream.draw_1d(path.depth, dimension::WAVELENGTH);
        if let Some(weight) = path.medium.disperse(scene, point, u) {
            path.throughput *= weight;
        }
    }
    point
}

/// The light that a path meets at the end of its ray: on the surface `hit`, or the environment when there is none.
///
/// Weighted by multiple importance sampling (power heuristic) against [`sample_direct_light`] at the vertex before.
/// Returns the layer and the contribution; `None` when there is none or another estimator counts it.
#[inline]
#[must_use]
pub fn emitted_light(
    scene: &Scene,
    methods: &Methods,
    path: &Path,
    ray: &Ray,
    hit: Option<&SurfacePoint>,
) -> Option<(Layer, Rgb)> {
    if !methods.counts_traced_light(path.class) {
        return None;
    }
    let weigh = |radiance: Rgb, pdf: f32| radiance * warp::power_heuristic(path.pdf, pdf);
    let arriving = match hit {
        Some(point) => {
            let radiance = scene.lights.emitted(point, -ray.direction);
            if radiance.is_black() || path.pdf.is_infinite() {
                radiance
            } else {
                weigh(radiance, scene.lights.pdf_emitted(ray.origin, point))
            }
        }
        None => scene
            .lights
            .escaped(ray.direction, ray.time)
            .map(|(radiance, pdf)| weigh(radiance, pdf))
            .sum(),
    };
    (!arriving.is_black()).then(|| (path.class.layer(), path.throughput * arriving))
}

/// Light that arrives at `hit` straight from a sampled light, scattered towards the eye.
///
/// Next-event estimation over all non-delta lobes, S and D alike, each credited to the layer of its class and only where
/// `methods` lets traced light count. Weighted by multiple importance sampling (power heuristic) against hits.
///
/// - `contribute`: called for each layer that receives something.
#[inline]
pub fn sample_direct_light(
    scene: &Scene,
    methods: &Methods,
    path: &Path,
    ray: &Ray,
    hit: &SurfacePoint,
    mut contribute: impl FnMut(Layer, Rgb),
) {
    let vertex = Vertex::new(scene, hit, -ray.direction, &path.medium);
    sample_direct_light_at(scene, methods, path, ray.time, &vertex, &mut contribute);
}

/// [`sample_direct_light`] at a vertex that is known already.
///
/// - `time`: of the path, as that of its rays.
#[inline]
pub fn sample_direct_light_at(
    scene: &Scene,
    methods: &Methods,
    path: &Path,
    time: f32,
    vertex: &Vertex<'_>,
    mut contribute: impl FnMut(Layer, Rgb),
) {
    if path.depth >= methods.max_depth || !vertex.bsdf.needs_light_sampling() {
        return;
    }
    let hit = vertex.point;
    let specular = path.class.after(Event::Specular);
    let diffuse = path.class.after(Event::Diffuse);
    let counts_specular = methods.counts_traced_light(specular);
    let counts_diffuse = methods.counts_traced_light(diffuse);
    if !(counts_specular || counts_diffuse) {
        return;
    }
    let u_choice = path.stream.draw_2d(path.depth, dimension::LIGHT_CHOICE);
    let u = path.stream.draw_2d(path.depth, dimension::LIGHT);
    let Some(light) = scene.lights.sample(hit.p, time, u_choice, u) else {
        return;
    };
    let (mut values, pdf) = vertex.eval_and_pdf(light.wi);
    if !counts_specular {
        values.specular = Rgb::BLACK;
    }
    if !counts_diffuse {
        values.diffuse = Rgb::BLACK;
    }
    if values.specular.is_black() && values.diffuse.is_black() {
        return;
    }
    let mut medium = path.medium;
    if (light.wi.dot(hit.ng) > 0.0) != (vertex.wo.dot(hit.ng) > 0.0) {
        medium.pass(scene, hit, light.wi);
    }
    let Some(left) = unblocked(scene, medium, &light.shadow_ray(hit)) else {
        return;
    };
    let weight = if light.delta {
        1.0
    } else {
        warp::power_heuristic(light.pdf, pdf)
    };
    let arriving = path.throughput * light.radiance * left * (weight / light.pdf);
    if !values.specular.is_black() {
        contribute(specular.layer(), arriving * values.specular);
    }
    if !values.diffuse.is_black() {
        contribute(diffuse.layer(), arriving * values.diffuse);
    }
}

/// Sends a path on from `hit`: chooses a lobe and a direction, plays Russian roulette.
///
/// Returns the ray to follow, or `None` when the path ends: absorbed, at its depth, or of a class that cannot contribute
/// any more.
#[inline]
#[must_use]
pub fn scatter(scene: &Scene, methods: &Methods, path: &mut Path, ray: &Ray, hit: &SurfacePoint) -> Option<Ray> {
    let vertex = Vertex::new(scene, hit, -ray.direction, &path.medium);
    scatter_at(scene, methods, path, ray.time, &vertex)
}

/// [`scatter`] at a vertex that is known already.
///
/// - `time`: of the path, as that of its rays.
#[inline]
#[must_use]
pub fn scatter_at(scene: &Scene, methods: &Methods, path: &mut Path, time: f32, vertex: &Vertex<'_>) -> Option<Ray> {
    if path.depth >= methods.max_depth {
        return None;
    }
    let hit = vertex.point;
    let u_lobe = path.stream.draw_1d(path.depth, dimension::LOBE);
    let u = path.stream.draw_2d(path.depth, dimension::DIRECTION);
    let sample = vertex.sample(u_lobe, u, Transport::Radiance)?;
    path.class = path.class.after(sample.class.into());
    path.throughput *= sample.weight;
    path.eta_scale *= sample.eta_sq_scale;
    if path.throughput.is_black() || !methods.may_contribute(path.class) {
        return None;
    }
    path.pdf = sample.pdf;
    path.depth += 1;
    if path.depth > ROULETTE_DEPTH {
        let survival = (path.throughput.max_element() / path.eta_scale).min(ROULETTE_MAX);
        if path.stream.draw_1d(path.depth, dimension::ROULETTE) >= survival {
            return None;
        }
        path.throughput *= 1.0 / survival;
    }
    if sample.transmitted {
        path.medium.pass(scene, hit, sample.wi);
    }
    Some(Ray {
        time,
        ..Ray::new(spawn_origin(hit.p, hit.error, hit.ng, sample.wi), sample.wi)
    })
}

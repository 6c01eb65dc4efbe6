use crate::irradiance::{CacheAnswer, IrradianceCache, reflect_coarsely};
use crate::path::{Path, arrive, emitted_light, sample_direct_light_at, scatter_at};
use crate::path_class::{CausticMethod, DirectMethod, Event, IndirectMethod, Methods, PathClass};
use crate::photon::MapKind;
use crate::photon_maps::{PhotonMaps, PhotonMapsScratch};
use crate::scene::Scene;
use crate::vertex::Vertex;
use radiometry::{Rgb, StageKey};
use spatial::Ray;

/// Key of the random numbers of gather rays.
const GATHER_STAGE: StageKey = StageKey::new("final_gather");

/// What gather rays count, made once a render.
#[derive(Clone, Copy, Debug)]
pub struct GatherMethods {
    /// Up to the second D vertex.
    shallow: Methods,
    /// After it, where a ray was too short for the photons at its end.
    deep: Methods,
    /// After a D vertex whose indirect light a cache has told, as seen from there.
    told: Methods,
}

/// What says how much light is reflected where a gather ray ends.
#[derive(Clone, Copy)]
pub(crate) enum RayEnd<'a> {
    /// Nothing: rays go on as paths.
    Path,
    /// Photon maps tell all of it, where the ray is long enough.
    Photons(&'a PhotonMaps),
    /// Records of irradiance tell its indirect part, where some hold; the rest is traced.
    Records(&'a IrradianceCache),
}

impl GatherMethods {
    /// - `methods`: of the render.
    /// - `reads_photons`: whether photon maps say what is reflected at the ends of rays; else rays go on as paths.
    #[must_use]
    pub fn new(methods: &Methods, reads_photons: bool) -> Self {
        // Light that is met after one D vertex is direct or caustic, and none of the gather ray's business.
        let shallow = Methods {
            direct: DirectMethod::PhotonMap,
            specular: true,
            caustic: CausticMethod::PhotonMap,
            indirect: IndirectMethod::PathTrace,
            ..*methods
        };
        let caustic = if reads_photons {
            CausticMethod::PhotonMap
        } else {
            CausticMethod::Trace
        };
        Self {
            shallow,
            deep: Methods { caustic, ..shallow },
            told: Methods {
                direct: DirectMethod::SampleLights,
                caustic: CausticMethod::Trace,
                indirect: IndirectMethod::IrradianceCache,
                ..shallow
            },
        }
    }
}

/// Gathers the indirect light of a vertex: E S* D S* (D|V)(S|D|V)* L, seen from its first D.
///
/// `L_o(x, ω_o) ≈ 1/N Σ f_d(x, ω_i, ω_o) cosθ_i L_r(y_i, −ω_i) / p(ω_i)`, where `y_i` is the first D vertex in direction
/// `ω_i`, over S vertices or not, and `L_r` all that it reflects by its D lobes, as the photon maps tell.
///
/// Source: Jensen, "Realistic Image Synthesis Using Photon Mapping", 2001, section 9.2.
/// Differs: directions are drawn from the BSDF; a ray no longer than the radius of the estimate at its end does not use it
/// but goes on as a path, with light sampling, so that corners stay clean.
///
/// - `path`: as it arrived at the vertex.
/// - `maps`: without them every ray goes on as a path, which is unbiased.
/// - `rays`: N, at least 1.
/// - returns radiance in W·m⁻²·sr⁻¹, weighted with what the path carries.
#[must_use]
#[expect(
    clippy::too_many_arguments,
    reason = "the scene, the path where it stands, and how to gather"
)]
pub fn gather_indirect(
    scene: &Scene,
    methods: &GatherMethods,
    maps: Option<&PhotonMaps>,
    path: &Path,
    time: f32,
    vertex: &Vertex<'_>,
    rays: u32,
    scratch: &mut PhotonMapsScratch,
) -> Rgb {
    let end = maps.map_or(RayEnd::Path, RayEnd::Photons);
    let mut sum = Rgb::BLACK;
    for number in 0..rays {
        let mut path = Path {
            stream: path.stream.split(GATHER_STAGE, rays, number),
            ..*path
        };
        let Some(ray) = scatter_at(scene, &methods.shallow, &mut path, time, vertex) else {
            continue;
        };
        // What leaves by an S lobe is specular light, traced elsewhere.
        if !path.class.ends_as_specular() {
            sum += light_along(scene, methods, end, path, ray, scratch).radiance;
        }
    }
    sum * (1.0 / rays as f32)
}

/// What one ray sees that left a D vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenLight {
    /// Radiance in W·m⁻²·sr⁻¹, weighted with what the path carries: of E D S* (D|V)(S|D|V)* L alone.
    pub(crate) radiance: Rgb,
    /// To the first surface, S or not, in metres; infinite where there is none.
    pub(crate) distance: f32,
}

/// Follows one ray from a D vertex for the indirect light that it sees.
///
/// - `path`: as it left the vertex.
pub(crate) fn light_along(
    scene: &Scene,
    methods: &GatherMethods,
    end: RayEnd<'_>,
    mut path: Path,
    mut ray: Ray,
    scratch: &mut PhotonMapsScratch,
) -> SeenLight {
    let mut light = Rgb::BLACK;
    let mut distance = None;
    let seen = |radiance, distance: Option<f32>| SeenLight {
        radiance,
        distance: distance.unwrap_or(f32::INFINITY),
    };
    // Since the last D vertex, over any S.
    let mut length = 0.0;
    // Since a D vertex whose indirect light is known, all there is to find is its direct light and its caustics.
    let mut is_told = false;
    loop {
        let hit = arrive(scene, &mut path, &ray);
        let methods = if is_told {
            &methods.told
        } else if path.class.is_deep() {
            &methods.deep
        } else {
            &methods.shallow
        };
        if let Some((_, emitted)) = emitted_light(scene, methods, &path, &ray, hit.as_ref()) {
            light += emitted;
        }
        let Some(hit) = hit else {
            return seen(light, distance);
        };
        length += ray.origin.distance(hit.p);
        distance.get_or_insert(length);
        let vertex = Vertex::new(scene, &hit, -ray.direction, &path.medium);
        let mut is_read = false;
        let reflects = vertex.bsdf.has_diffuse() && path.depth < methods.max_depth;
        let known = match end {
            RayEnd::Records(cache) if reflects && !is_told => known_to(cache, scene, &path, ray.time, &vertex),
            _ => None,
        };
        light += known.unwrap_or(Rgb::BLACK);
        if let (RayEnd::Photons(maps), true) = (end, reflects) {
            let all = maps.estimate_all(&vertex, scratch);
            is_read = length > all.radius;
            let seen = if is_read {
                all
            } else {
                maps.estimate_radiance(MapKind::Caustic, &vertex, scratch)
            };
            light += path.throughput * seen.value;
        }
        if !is_read {
            sample_direct_light_at(scene, methods, &path, ray.time, &vertex, |_, direct| light += direct);
        } else if !vertex.bsdf.has_specular() {
            return seen(light, distance);
        }
        let Some(next) = scatter_at(scene, methods, &mut path, ray.time, &vertex) else {
            return seen(light, distance);
        };
        if !path.class.ends_as_specular() {
            if is_read {
                return seen(light, distance);
            }
            length = 0.0;
            if known.is_some() {
                is_told = true;
                path.class = PathClass::EYE.after(Event::Diffuse);
            }
        }
        ray = next;
    }
}

/// Indirect light that records say a vertex reflects, weighted with what the path carries; `None` where they do not tell.
fn known_to(cache: &IrradianceCache, scene: &Scene, path: &Path, time: f32, vertex: &Vertex<'_>) -> Option<Rgb> {
    match reflect_coarsely(scene, cache, path, time, vertex) {
        CacheAnswer::Light(light) => Some(light),
        CacheAnswer::Missing | CacheAnswer::Unsuited => None,
    }
}

use crate::irradiance::{CacheAnswer, IrradianceCache, reflect_irradiance};
use crate::path::{Path, arrive, emitted_light, sample_direct_light_at, scatter_at};
use crate::path_class::{CausticMethod, DirectMethod, Event, IndirectMethod, Methods, PathClass};
use crate::photon::MapKind;
use crate::photon_maps::{PhotonMaps, PhotonMapsScratch};
use crate::radiosity::{PatchField, PatchScratch};
use crate::scene::Scene;
use crate::vertex::Vertex;
use radiometry::{Rgb, StageKey};
use spatial::Ray;

/// Key of the random numbers of lights where several are sampled at the end of a ray.
const LIGHT_STAGE: StageKey = StageKey::new("final_gather/lights");
/// Key of the random numbers of gather rays.
const GATHER_STAGE: StageKey = StageKey::new("final_gather");

/// Who knows what is reflected at the ends of gather rays.
#[derive(Clone, Copy, Debug)]
pub enum Incoming<'a> {
    /// Nobody: every ray goes on as a path, which is unbiased.
    Paths,
    /// The photon maps.
    Photons(&'a PhotonMaps),
    /// The patches of radiosity.
    Patches(&'a PatchField),
    /// Records of irradiance, where some hold: the indirect part of it, and the rest is traced.
    Records(&'a IrradianceCache),
}

/// Memory that gather rays reuse; one a thread.
#[derive(Clone, Debug, Default)]
pub struct GatherScratch {
    photons: PhotonMapsScratch,
    patches: PatchScratch,
}

/// What gather rays count, made once a render.
#[derive(Clone, Copy, Debug)]
pub struct GatherMethods {
    /// Up to the second D vertex.
    shallow: Methods,
    /// After it, where a ray was too short for the photons at its end.
    deep: Methods,
    /// After a D vertex whose indirect light a cache has told, as seen from there.
    told: Methods,
    /// Lights that are sampled at the first D vertex of a ray.
    lights: u32,
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
            lights: 1,
        }
    }

    /// With paths that may have so many events fewer, for what is seen from after them.
    #[must_use]
    pub fn after(self, events: u32) -> Self {
        let less = |methods: Methods| Methods {
            max_depth: methods.max_depth.saturating_sub(events),
            ..methods
        };
        Self {
            shallow: less(self.shallow),
            deep: less(self.deep),
            told: less(self.told),
            ..self
        }
    }

    /// With so many lights sampled at the first D vertex of a ray, at least 1: a ray that is one of a stratum of its own has noise of
    /// which light was chosen, and little else.
    #[must_use]
    pub fn with_lights(self, lights: u32) -> Self {
        Self { lights, ..self }
    }
}

/// Gathers the indirect light of a vertex: E S* D S* (D|V)(S|D|V)* L, seen from its first D.
///
/// `L_o(x, ω_o) ≈ 1/N Σ f_d(x, ω_i, ω_o) cosθ_i L_r(y_i, −ω_i) / p(ω_i)`, where `y_i` is the first D vertex in direction
/// `ω_i`, over S vertices or not, and `L_r` all that it reflects by its D lobes, as `incoming` tells or paths find.
///
/// Source: Jensen, "Realistic Image Synthesis Using Photon Mapping", 2001, section 9.2.
/// Differs: directions are drawn from the BSDF; a ray no longer than what is told at its end is blurred over does not use it
/// but goes on as a path, with light sampling, so that corners stay clean.
///
/// - `path`: as it arrived at the vertex.
/// - `incoming`: who knows what is reflected at the ends of rays.
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
    incoming: Incoming<'_>,
    path: &Path,
    time: f32,
    vertex: &Vertex<'_>,
    rays: u32,
    scratch: &mut GatherScratch,
) -> Rgb {
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
            sum += light_along(scene, methods, incoming, path, ray, scratch).radiance;
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
    incoming: Incoming<'_>,
    mut path: Path,
    mut ray: Ray,
    scratch: &mut GatherScratch,
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
    // That of a ray's first D vertex, which is nearly all that it sees.
    let mut lights = methods.lights.max(1);
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
        let reflects = vertex.bsdf.has_diffuse() && path.depth < methods.max_depth;
        let known = if reflects && !is_told {
            let seen = what_is_reflected(scene, incoming, &path, ray.time, &vertex, length, scratch);
            light += seen.1;
            seen.0
        } else {
            Known::Nothing
        };
        let is_read = known == Known::All;
        if !is_read {
            let lights = if reflects { lights } else { 1 };
            for number in 0..lights {
                let path = Path {
                    throughput: path.throughput * (1.0 / lights as f32),
                    stream: if lights == 1 {
                        path.stream
                    } else {
                        path.stream.split(LIGHT_STAGE, lights, number)
                    },
                    ..path
                };
                sample_direct_light_at(scene, methods, &path, ray.time, &vertex, |_, direct| light += direct);
            }
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
            lights = 1;
            if known == Known::Indirect {
                is_told = true;
                path.class = PathClass::EYE.after(Event::Diffuse);
            }
        }
        ray = next;
    }
}

/// How much is known of what a vertex reflects by its D lobes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Known {
    /// No more than what was added already.
    Nothing,
    /// What is left is direct light and caustics.
    Indirect,
    All,
}

/// What a vertex reflects by its D lobes, as far as it is known; weighted with what the path carries.
///
/// - `length`: of the ray since the last D vertex, metres. Where it is short, what is blurred is not read.
fn what_is_reflected(
    scene: &Scene,
    incoming: Incoming<'_>,
    path: &Path,
    time: f32,
    vertex: &Vertex<'_>,
    length: f32,
    scratch: &mut GatherScratch,
) -> (Known, Rgb) {
    match incoming {
        Incoming::Paths => (Known::Nothing, Rgb::BLACK),
        Incoming::Photons(maps) => {
            let all = maps.estimate_all(scene, vertex, &mut scratch.photons);
            if length > all.radius {
                return (Known::All, path.throughput * all.value);
            }
            // Its caustics no path looks for.
            let caustic = maps.estimate_radiance(scene, MapKind::Caustic, vertex, &mut scratch.photons);
            (Known::Nothing, path.throughput * caustic.value)
        }
        Incoming::Patches(field) => match field.irradiance(scene, vertex, &mut scratch.patches) {
            Some(irradiance) if length > field.spacing() => {
                let all = vertex.diffuse_response() * (irradiance.direct + irradiance.indirect);
                (Known::All, path.throughput * all)
            }
            _ => (Known::Nothing, Rgb::BLACK),
        },
        Incoming::Records(cache) => match reflect_irradiance(scene, cache, path, time, vertex) {
            CacheAnswer::Light { radiance, blur, .. } if length > blur => (Known::Indirect, radiance),
            _ => (Known::Nothing, Rgb::BLACK),
        },
    }
}

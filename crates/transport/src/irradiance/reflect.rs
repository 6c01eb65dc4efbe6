use super::{IrradianceCache, IrradianceRecord, Site};
use crate::medium::PathMedium;
use crate::path::{Path, arrive, scatter_at};
use crate::path_class::Methods;
use crate::scene::Scene;
use crate::vertex::Vertex;
use glam::Vec3;
use radiometry::{Frame, Rgb, StageKey, warp};
use spatial::{Ray, spawn_origin};
use std::f32::consts::FRAC_1_PI;

/// Key of those of rays to deep places.
const DEEP_STAGE: StageKey = StageKey::new("irradiance_cache/deep");

/// D lobes with a smaller GGX width than this show what is around in too much detail for irradiance to tell; they are traced.
///
/// Metal in a small room, relMSE of the indirect light: by records 0.0040 at 0.4 and 0.0014 at 0.6, however many the samples;
/// traced 0.0061 at 0.2 and 0.0035 at 0.3, of 64 samples. Paint under such a coat: 0.0007 and 0.0006 by records.
const SHARPEST_ALPHA: f32 = 0.4;

/// Way over a surface on which a place and a record look at each other, in distances between the two.
const LIFT: f32 = 0.05;

/// What the cache knows of a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CacheAnswer {
    /// Some records do.
    Light {
        /// Reflected radiance of indirect light in W·m⁻²·sr⁻¹, weighted with what the path carries.
        radiance: Rgb,
        /// Records of each square metre around, as in [`Interpolated`](super::Interpolated).
        record_density: f32,
        /// What is smaller is blurred, metres, as in [`Interpolated`](super::Interpolated).
        blur: f32,
    },
    /// No record holds there.
    Missing,
    /// Irradiance does not tell what such a surface reflects.
    Unsuited,
}

/// True where irradiance tells what the D lobes reflect, and is the same whenever it is asked for.
///
/// Left out: D lobes that are glossy or pass light, normals from a normal map, which change from pixel to pixel, things that
/// move, and paths that carry one wavelength.
fn is_suited(scene: &Scene, vertex: &Vertex<'_>, medium: &PathMedium) -> bool {
    vertex.bsdf.sharpest_diffuse() >= SHARPEST_ALPHA
        && !vertex.has_turned_normal()
        && !scene.rays.instance_moves(vertex.point.instance)
        && !medium.has_wavelength()
}

/// Asks the cache for the indirect light that the D lobes of a vertex reflect: E S* (D S* (D|V)(S|D|V)* L).
///
/// `L_o(ω_o) ≈ ρ_hd(ω_o) E/π`, `ρ_hd = ∫ f_d cosθ_i dω_i`: exact for a Lambertian surface, and for any under even light.
///
/// - `path`: as it arrived at the vertex.
#[must_use]
pub fn reflect_irradiance(
    scene: &Scene,
    cache: &IrradianceCache,
    path: &Path,
    time: f32,
    vertex: &Vertex<'_>,
) -> CacheAnswer {
    if !is_suited(scene, vertex, &path.medium) {
        return CacheAnswer::Unsuited;
    }
    let (position, normal) = (vertex.point.p, vertex.facing_shading_normal());
    let sees = |record: &IrradianceRecord| sees(scene, position, normal, record, time);
    let Some(found) = cache.interpolate(position, normal, sees) else {
        return CacheAnswer::Missing;
    };
    CacheAnswer::Light {
        radiance: path.throughput
            * vertex.diffuse_reflectance(scene, &path.stream, path.depth)
            * found.irradiance
            * FRAC_1_PI,
        record_density: found.record_density,
        blur: found.blur,
    }
}

/// Follows a camera path to where the eye asks the cache, and one ray from each such place on to where it would ask in turn:
/// E S* D S* D. Such places are where rays of records end.
///
/// As [`find_sites`] otherwise.
pub fn find_deep_sites(scene: &Scene, methods: &Methods, path: Path, ray: Ray, pixel_size: f32, sites: &mut Vec<Site>) {
    let mut first = Vec::new();
    find_sites(scene, methods, path, ray, pixel_size, &mut first);
    for (number, site) in (0..).zip(&first) {
        let stream = path.stream.split(DEEP_STAGE, first.len() as u32, number);
        let local = warp::sample_cosine_hemisphere(stream.draw_2d(0, 0));
        let wi = Frame::from_normal(site.normal)
            .world_from_local(local)
            .normalize_or(site.normal);
        let next = Ray {
            time: ray.time,
            ..Ray::new(spawn_origin(site.position, site.error, site.geometric, wi), wi)
        };
        let path = Path {
            medium: site.medium,
            depth: 1,
            ..Path::from_eye(0, stream)
        };
        if site.geometric.dot(wi) > 0.0 {
            let length = site.pixel / pixel_size.max(f32::MIN_POSITIVE);
            find_sites_behind(scene, methods, (path, next), pixel_size, length, sites);
        }
    }
}

/// True when nothing stands between a place and a record, a little above the surface.
pub(super) fn sees(scene: &Scene, position: Vec3, normal: Vec3, record: &IrradianceRecord, time: f32) -> bool {
    let distance = position.distance(record.position);
    if distance == 0.0 {
        return true;
    }
    let (from, to) = (
        position + normal * (LIFT * distance),
        record.position + record.normal * (LIFT * distance),
    );
    let way = to - from;
    !scene.rays.occluded(&Ray {
        t_max: way.length(),
        time,
        ..Ray::new(from, way.normalize_or(normal))
    })
}

impl Site {
    /// True when the cache needs no record here.
    #[must_use]
    pub fn is_covered(&self, scene: &Scene, cache: &IrradianceCache) -> bool {
        let sees = |record: &IrradianceRecord| sees(scene, self.position, self.normal, record, 0.0);
        cache.covers(self.position, self.normal, sees)
    }
}

/// Follows a camera path along S lobes and finds where it will ask the cache: E S* D.
///
/// - `path`, `ray`: as they leave the camera.
/// - `pixel_size`: what a pixel spans at a distance of one metre, metres.
pub fn find_sites(scene: &Scene, methods: &Methods, path: Path, ray: Ray, pixel_size: f32, sites: &mut Vec<Site>) {
    find_sites_behind(scene, methods, (path, ray), pixel_size, 0.0, sites);
}

/// As [`find_sites`], where the ray begins some way from the eye.
///
/// - `length`: of that way, metres.
fn find_sites_behind(
    scene: &Scene,
    methods: &Methods,
    (mut path, mut ray): (Path, Ray),
    pixel_size: f32,
    mut length: f32,
    sites: &mut Vec<Site>,
) {
    while let Some(hit) = arrive(scene, &mut path, &ray) {
        length += ray.origin.distance(hit.p);
        let vertex = Vertex::new(scene, &hit, -ray.direction, &path.medium);
        let asks = methods.gather_layer(path.class).is_some() && path.depth < methods.max_depth;
        if asks && vertex.bsdf.has_diffuse() && is_suited(scene, &vertex, &path.medium) {
            sites.push(Site::of_vertex(&vertex, pixel_size * length, &path.medium));
        }
        if !vertex.bsdf.has_specular() {
            return;
        }
        match scatter_at(scene, methods, &mut path, ray.time, &vertex) {
            Some(next) if path.class.is_specular_only() => ray = next,
            _ => return,
        }
    }
}

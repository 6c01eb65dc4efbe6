use super::IrradianceCache;
use crate::gather::{GatherMethods, GatherScratch, Incoming, light_along};
use crate::medium::PathMedium;
use crate::path::Path;
use crate::path_class::{Event, PathClass};
use crate::photon_maps::PhotonMaps;
use crate::scene::Scene;
use crate::vertex::{Vertex, soften_terminator};
use glam::Vec3;
use radiometry::{Frame, Rgb, SampleStream, StageKey, math};
use spatial::{Ray, spawn_origin};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// Key of the random numbers of records.
const RECORD_STAGE: StageKey = StageKey::new("irradiance_cache/records");

/// Where irradiance is asked for, on the side of a surface that it is seen from.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// World space, metres.
    pub position: Vec3,
    /// Unit shading normal, on the side of the eye.
    pub normal: Vec3,
    /// Unit geometric normal, on the side of the eye.
    pub geometric: Vec3,
    /// Bound on the distance from the surface, metres.
    pub error: f32,
    /// What a pixel spans there, metres.
    pub pixel: f32,
    /// What is in front of it.
    pub medium: PathMedium,
}

impl Site {
    /// - `pixel`: what a pixel spans at the vertex, metres.
    /// - `medium`: of the path that arrived.
    #[must_use]
    pub fn of_vertex(vertex: &Vertex<'_>, pixel: f32, medium: &PathMedium) -> Self {
        Self {
            position: vertex.point.p,
            normal: vertex.facing_shading_normal(),
            geometric: vertex.facing_normal(),
            error: vertex.point.error,
            pixel,
            medium: *medium,
        }
    }
}

/// What one ray of a hemisphere saw.
#[derive(Clone, Copy, Debug, Default)]
pub struct HemisphereSample {
    /// Radiance of indirect light, W·m⁻²·sr⁻¹.
    pub radiance: Rgb,
    /// One over the distance to what the ray met, m⁻¹; 0 where it met nothing.
    pub inverse_distance: f32,
}

/// How the rays of records are followed.
#[derive(Clone, Copy)]
pub struct RecordRays<'a> {
    /// Of the render.
    pub seed: u64,
    /// What they count.
    pub methods: GatherMethods,
    /// Photon maps that tell what is reflected where rays end, as they do for [`gather_indirect`](crate::gather_indirect).
    pub maps: Option<&'a PhotonMaps>,
    /// Without photon maps, rays go on as paths with light sampling; where records of this cache hold, if there is one, they tell
    /// what is reflected of indirect light.
    pub cache: Option<&'a IrradianceCache>,
}

/// A stratified hemisphere: T rings of P cells, each with the same share of the cosine.
///
/// `θ_t = asin √((t − ξ)/T)`, `φ_p = 2π (p − ψ)/P`, hence `E ≈ π/(T P) Σ L(θ_t, φ_p)`, with P ≈ π T so that cells are about
/// square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hemisphere {
    rings: u32,
    cells: u32,
}

impl Hemisphere {
    /// A hemisphere of about so many rays, at least 6.
    #[must_use]
    pub fn of_rays(rays: u32) -> Self {
        let rings = (rays as f32 * FRAC_1_PI).sqrt().round().max(1.0);
        let cells = (rays as f32 / rings).round().max(6.0);
        Self {
            rings: rings as u32,
            cells: cells as u32,
        }
    }

    /// T.
    #[must_use]
    pub fn rings(&self) -> u32 {
        self.rings
    }

    /// P.
    #[must_use]
    pub fn cells(&self) -> u32 {
        self.cells
    }

    /// T P.
    #[must_use]
    pub fn rays(&self) -> u32 {
        self.rings * self.cells
    }

    /// A direction within a cell, in the frame of the normal.
    ///
    /// - `u`: in [0, 1)², places it.
    #[inline]
    #[must_use]
    pub fn direction(&self, ring: u32, cell: u32, u: glam::Vec2) -> Vec3 {
        let sin_sq = ((ring as f32 + u.x) / self.rings as f32).min(1.0);
        let (sin_phi, cos_phi) = math::sin_cos(TAU * (cell as f32 + u.y) / self.cells as f32);
        let sin = sin_sq.sqrt();
        Vec3::new(sin * cos_phi, sin * sin_phi, (1.0 - sin_sq).max(0.0).sqrt())
    }

    /// Sends out the rays of one ring of a record and returns what each of them saw.
    ///
    /// - `number`: of the record, which decides its random numbers.
    ///
    /// Cost: P paths. Deterministic whatever else is computed beside it.
    #[must_use]
    pub fn sample_ring(
        &self,
        scene: &Scene,
        rays: &RecordRays<'_>,
        site: &Site,
        number: u64,
        ring: u32,
        scratch: &mut GatherScratch,
    ) -> Vec<HemisphereSample> {
        let end = match (rays.maps, rays.cache) {
            (Some(maps), _) => Incoming::Photons(maps),
            (None, Some(cache)) => Incoming::Records(cache),
            (None, None) => Incoming::Paths,
        };
        let frame = Frame::from_normal(site.normal);
        let sample = |cell: u32| {
            let ray = ring * self.cells + cell;
            let stream = SampleStream::new(rays.seed, RECORD_STAGE, number, ray);
            let local = self.direction(ring, cell, stream.draw_2d(0, 0));
            let wi = frame.world_from_local(local).normalize();
            let cos_geometric = site.geometric.dot(wi);
            if cos_geometric <= 0.0 || local.z <= 0.0 {
                return HemisphereSample::default();
            }
            let path = Path {
                pdf: local.z * FRAC_1_PI,
                medium: site.medium,
                depth: 1,
                class: PathClass::EYE.after(Event::Diffuse),
                ..Path::from_eye(0, stream)
            };
            let ray = Ray {
                time: stream.draw_1d(0, 1),
                ..Ray::new(spawn_origin(site.position, site.error, site.geometric, wi), wi)
            };
            let seen = light_along(scene, &rays.methods, end, path, ray, scratch);
            let softened = soften_terminator(cos_geometric, local.z, site.normal.dot(site.geometric));
            HemisphereSample {
                radiance: seen.radiance * softened,
                inverse_distance: 1.0 / seen.distance.max(f32::MIN_POSITIVE),
            }
        };
        (0..self.cells).map(sample).collect()
    }

    /// What each sample's radiance counts in the irradiance: π/(T P).
    #[must_use]
    pub fn weight(&self) -> f32 {
        PI / self.rays() as f32
    }
}

use crate::scene::Scene;
use crate::vertex::Vertex;
use crate::wall::Walls;
use glam::Vec3;
use radiometry::{Rgb, math, unpack_direction};
use spatial::{Nearest, NearestScratch, Neighbour, PhotonTree};
use std::f32::consts::PI;

/// How photons are weighted over the disc that they are gathered in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DensityFilter {
    /// All alike.
    Disc,
    /// 1 − d/r: Jensen 1996, with `k_c` = 1.
    #[default]
    Cone,
    /// Jensen's Gaussian, β = 1.953, with the α that normalises it (García Hernández et al. 2014).
    Gaussian,
    /// 1 − d²/r²: Epanechnikov's kernel.
    Epanechnikov,
}

impl DensityFilter {
    /// Weight at squared distance `dist_sq` from the centre of a disc of squared radius `radius_sq`; its mean over the
    /// disc is 1, so that a weighted sum over π r² estimates density without bias on a uniform field.
    #[inline]
    #[must_use]
    pub fn weight(self, dist_sq: f32, radius_sq: f32) -> f32 {
        /// Jensen's steepness.
        const BETA: f32 = 1.953;
        /// 1 − e^(−β).
        const ONE_MINUS_EXP: f32 = 0.858_152_1;
        /// Normalisation over the disc; the often printed 0.918 is not one.
        const ALPHA: f32 = 1.728_3;
        let x = dist_sq / radius_sq;
        match self {
            Self::Disc => 1.0,
            Self::Cone => 3.0 * (1.0 - x.sqrt()),
            Self::Gaussian => ALPHA * (1.0 - (1.0 - math::exp(-0.5 * BETA * x)) / ONE_MINUS_EXP),
            Self::Epanechnikov => 2.0 * (1.0 - x),
        }
    }
}

/// How radiance is estimated from a photon map.
#[derive(Clone, Copy, Debug)]
pub struct DensitySettings {
    /// Photons that set the radius.
    pub nearest: usize,
    /// Largest radius in metres.
    pub max_radius: f32,
    /// Weight over the disc.
    pub filter: DensityFilter,
    /// Factor in (0, 1] for the radius that `nearest` and `max_radius` give; see [`progressive_shrink`].
    pub shrink: f32,
}

impl DensitySettings {
    /// The radius in metres within which `nearest` of `photons` lie when all are spread evenly over `area` m²:
    /// `π r² N / A = k`.
    #[must_use]
    pub fn even_radius(nearest: u32, photons: u32, area: f64) -> f32 {
        (f64::from(nearest) * area / (std::f64::consts::PI * f64::from(photons))).sqrt() as f32
    }
}

/// By how much the radius of pass `pass` (from 0) is smaller than that of pass 0: `r²ᵢ₊₁ = r²ᵢ (i+α)/(i+1)`, counted
/// from i = 1, with α = 2/3.
///
/// The mean of the passes then converges: bias and noise both fall, the root of the mean squared error as passes^(−1/3).
///
/// Source: Knaus and Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", ACM TOG 2011, eq. 15.
#[must_use]
pub fn progressive_shrink(pass: u32) -> f32 {
    const ALPHA: f64 = 2.0 / 3.0;
    let ratio_sq: f64 = (1..=pass).map(f64::from).map(|i| (i + ALPHA) / (i + 1.0)).product();
    ratio_sq.sqrt() as f32
}

/// What the inner loop reads of each photon, in the order of the tree.
#[derive(Clone, Debug, Default)]
pub struct PhotonColumns {
    /// Flux in W, divided by the number emitted.
    pub flux: Vec<Rgb>,
    /// Octahedral direction to where it came from.
    pub direction: Vec<u32>,
    /// Where it landed; not packed, since every candidate of a search is asked.
    pub surface: Vec<PhotonSurface>,
}

/// The surface around a photon. 28 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonSurface {
    /// Unit, on the side that the photon came from.
    pub normal: Vec3,
    /// What stands on it within the largest radius of an estimate.
    pub walls: Walls,
}

impl PhotonSurface {
    /// True when a wall stands between the photon and another place.
    ///
    /// - `position`: of the photon; `reach`: that its walls were looked for in, metres.
    #[inline]
    pub(crate) fn is_parted(&self, scene: &Scene, position: Vec3, reach: f32, place: Vec3) -> bool {
        let offset = place - position;
        self.walls
            .part(scene, (position, self.normal), reach, offset, offset.length_squared())
    }

    /// A surface that no wall stands on.
    #[must_use]
    pub fn open(normal: Vec3) -> Self {
        Self {
            normal,
            walls: Walls::NONE,
        }
    }
}

/// Photons ready for density estimation: a tree with the columns that the estimate reads.
#[derive(Clone, Debug)]
pub struct PhotonMap {
    /// Finds photons.
    pub tree: PhotonTree,
    /// What they carry, by slot of the tree.
    pub columns: PhotonColumns,
    /// How they are read.
    pub density: DensitySettings,
}

/// What a photon map tells of a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Radiance in W·m⁻²·sr⁻¹ that a vertex reflects, or irradiance in W·m⁻².
    pub value: Rgb,
    /// Radius in metres over which it is blurred.
    pub radius: f32,
}

/// Memory that estimates reuse, and what the last one found; one a thread.
///
/// The k-th photon is nowhere further than from a neighbouring point plus the way there, so each search begins with the
/// radius of the last one. That changes its cost and never its result.
#[derive(Clone, Debug, Default)]
pub struct DensityScratch {
    nearest: NearestScratch,
    /// Where the last estimate was, and its radius; only when the k-th photon was in reach.
    last: Option<(Vec3, f32)>,
}

/// Room for the rounding of a sum of two distances.
const ROUNDED_UP: f32 = 1.000_01;

/// Photons further off the plane of the hit than this share of their distance belong to another surface.
const MAX_ELEVATION: f32 = 0.3;
/// Photons whose surface normal has a smaller cosine to that of the hit belong to another surface.
pub(crate) const MIN_NORMAL_COSINE: f32 = 0.8;

/// Where an estimate is made, and which photons belong to the surface there.
struct Site<'a> {
    scene: &'a Scene,
    position: Vec3,
    /// Unit, on the side that is lit.
    normal: Vec3,
    /// Bound on the error of the position, metres.
    error: f32,
    /// A surface that transmits is lit from behind as well.
    both_sides: bool,
    /// A photon that made the site be chosen tells nothing of the density there.
    is_at_a_photon: bool,
}

impl<'a> Site<'a> {
    fn of(scene: &'a Scene, vertex: &Vertex<'_>) -> Self {
        Self {
            scene,
            position: vertex.point.p,
            normal: vertex.facing_normal(),
            error: vertex.point.error,
            both_sides: vertex.bsdf.transmits(),
            is_at_a_photon: false,
        }
    }
}

impl PhotonMap {
    /// Calls `f` with the slot of each photon that an estimate at a vertex would use.
    pub(crate) fn for_nearest(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        scratch: &mut DensityScratch,
        mut f: impl FnMut(usize),
    ) {
        let site = Site::of(scene, vertex);
        self.find(&site, scratch, |found, _| {
            let used = found.inside().filter(|photon| !self.is_walled_off(&site, photon));
            used.for_each(|photon| f(photon.slot as usize));
        });
    }

    /// Estimates the radiance that a vertex reflects of the photons around it.
    ///
    /// `L_o(x, ω_o) ≈ Σ_p w_p f_d(x, ω_p, ω_o) Φ_p / (π r²)`
    ///
    /// Source: Jensen, "Global Illumination using Photon Maps", EGWR 1996.
    /// Differs: the k-th photon only sets the radius (García Hernández et al. 2012), so that a uniform field is unbiased
    /// with every filter. Photons on other surfaces (normal, elevation over the plane, side of incidence) are neither
    /// used nor counted; those behind walls that stand on this one are counted and not used, so that a dark place next to
    /// a bright one is seen with a small disc. Only diffuse lobes reflect.
    ///
    /// When fewer than `nearest` are in reach, all of them count over π `max_radius`².
    /// Bias: blurs over r. Cost: O(k log N), no allocation once `scratch` has grown.
    #[must_use]
    pub fn estimate_radiance(&self, scene: &Scene, vertex: &Vertex<'_>, scratch: &mut DensityScratch) -> Estimate {
        let site = Site::of(scene, vertex);
        match vertex.lambertian() {
            // The same from every direction; the normals have made sure of the side.
            Some(value) => {
                let irradiance = self.estimate(&site, scratch, |_| Rgb::WHITE);
                Estimate {
                    value: irradiance.value * value,
                    ..irradiance
                }
            }
            None => self.estimate(&site, scratch, |slot| {
                vertex.eval_diffuse_flux(unpack_direction(self.columns.direction[slot]))
            }),
        }
    }

    /// Estimates the irradiance on one side of a surface where a photon landed; as [`PhotonMap::estimate_radiance`]
    /// otherwise. The photon itself does not count: that there is one is why the place was chosen, and with it uniform
    /// fields would seem brighter by 1/k and more.
    ///
    /// - `normal`: unit, on the side that is asked about.
    /// - `error`: bound on the error of `position`, metres.
    #[must_use]
    pub fn estimate_irradiance(
        &self,
        scene: &Scene,
        position: Vec3,
        normal: Vec3,
        error: f32,
        scratch: &mut DensityScratch,
    ) -> Estimate {
        let site = Site {
            scene,
            position,
            normal,
            error,
            both_sides: false,
            is_at_a_photon: true,
        };
        self.estimate(&site, scratch, |_| Rgb::WHITE)
    }

    /// Adds up `factor(slot) · w · Φ` over the photons of a site, divided by the area of their disc.
    #[inline]
    fn estimate(&self, site: &Site<'_>, scratch: &mut DensityScratch, factor: impl Fn(usize) -> Rgb) -> Estimate {
        let DensitySettings { filter, shrink, .. } = self.density;
        self.find(site, scratch, |found, radius_sq| {
            if radius_sq <= 0.0 {
                return Estimate::default();
            }
            let mut sum = Rgb::BLACK;
            for photon in found.inside() {
                if shrink < 1.0 && photon.dist_sq > radius_sq {
                    continue;
                }
                if self.is_walled_off(site, &photon) {
                    continue;
                }
                let slot = photon.slot as usize;
                sum += self.columns.flux[slot] * factor(slot) * filter.weight(photon.dist_sq, radius_sq);
            }
            Estimate {
                value: sum * (1.0 / (PI * radius_sq)),
                radius: radius_sq.sqrt(),
            }
        })
    }

    /// True when a wall stands between a site and a photon that was found around it.
    #[inline]
    fn is_walled_off(&self, site: &Site<'_>, photon: &Neighbour) -> bool {
        let surface = &self.columns.surface[photon.slot as usize];
        let reach = self.density.max_radius;
        surface.walls.may_part(reach, photon.dist_sq)
            && surface.is_parted(site.scene, self.tree.position(photon.slot), reach, site.position)
    }

    /// Finds the photons of a site, and gives them to `receive` with the squared radius of its disc.
    #[inline]
    fn find<R>(&self, site: &Site<'_>, scratch: &mut DensityScratch, receive: impl FnOnce(Nearest<'_>, f32) -> R) -> R {
        let DensitySettings {
            nearest: k,
            max_radius,
            shrink,
            ..
        } = self.density;
        let error_sq = site.error * site.error;
        let accept = |slot: u32, offset: Vec3, dist_sq: f32| {
            (!site.is_at_a_photon || dist_sq > 0.0) && is_on_surface(offset, site.normal, dist_sq, error_sq) && {
                let surface = &self.columns.surface[slot as usize];
                let cosine = surface.normal.dot(site.normal);
                (if site.both_sides { cosine.abs() } else { cosine }) >= MIN_NORMAL_COSINE
            }
        };
        let DensityScratch { nearest, last } = scratch;
        let bound = last.map_or(f32::INFINITY, |(place, radius)| {
            (radius + place.distance(site.position)) * ROUNDED_UP
        });
        let mut found = self
            .tree
            .nearest_where(site.position, k, bound.min(max_radius), accept, nearest);
        if found.kth().is_none() && bound < max_radius {
            // The last estimate was on another surface, with other photons.
            found = self.tree.nearest_where(site.position, k, max_radius, accept, nearest);
        }
        *last = found.kth().map(|kth| (site.position, kth.dist_sq.sqrt()));
        let radius_sq = found.kth().map_or(max_radius * max_radius, |kth| kth.dist_sq) * (shrink * shrink);
        receive(found, radius_sq)
    }

    /// Bytes that the map holds.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let c = &self.columns;
        self.tree.memory_bytes()
            + c.flux.capacity() * size_of::<Rgb>()
            + c.direction.capacity() * size_of::<u32>()
            + c.surface.capacity() * size_of::<PhotonSurface>()
    }
}

/// True when a point `offset` away lies on the same flat surface, as far as the disc of an estimate is flat.
#[inline]
pub(crate) fn is_on_surface(offset: Vec3, normal: Vec3, dist_sq: f32, error_sq: f32) -> bool {
    let height = offset.dot(normal);
    height * height <= MAX_ELEVATION * MAX_ELEVATION * dist_sq + 4.0 * error_sq
}

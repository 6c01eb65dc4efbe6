use crate::density::{DensityScratch, Estimate, MIN_NORMAL_COSINE, PhotonMap, PhotonSurface, is_on_surface};
use crate::photon::MapKind;
use crate::scene::Scene;
use crate::vertex::Vertex;
use glam::Vec3;
use radiometry::{Frame, SampleStream, StageKey, math};
use spatial::{NearestScratch, PhotonTree, PhotonTreeError, Ray};

/// The photon maps of a scene, those that there are.
#[derive(Clone, Debug, Default)]
pub struct PhotonMaps {
    /// By [`MapKind`].
    maps: [Option<PhotonMap>; MapKind::COUNT],
    /// Irradiance of all of them together, computed beforehand.
    pub irradiance: Option<IrradianceMap>,
}

/// Memory that estimates from several maps reuse; one a thread.
#[derive(Clone, Debug, Default)]
pub struct PhotonMapsScratch {
    maps: [DensityScratch; MapKind::COUNT],
    nearest: NearestScratch,
}

impl PhotonMaps {
    /// The map of a kind, if there is one.
    #[inline]
    #[must_use]
    pub fn get(&self, kind: MapKind) -> Option<&PhotonMap> {
        self.maps[kind as usize].as_ref()
    }

    /// The map of a kind, if there is one, to complete it.
    #[must_use]
    pub fn get_mut(&mut self, kind: MapKind) -> Option<&mut PhotonMap> {
        self.maps[kind as usize].as_mut()
    }

    /// Puts a map in the place of its kind. What was computed beforehand is out of date then, and dropped.
    pub fn insert(&mut self, kind: MapKind, map: PhotonMap) {
        self.maps[kind as usize] = Some(map);
        self.irradiance = None;
    }

    /// The maps that there are.
    pub fn iter(&self) -> impl Iterator<Item = (MapKind, &PhotonMap)> {
        MapKind::ALL
            .into_iter()
            .filter_map(|kind| Some((kind, self.get(kind)?)))
    }

    /// Estimates the radiance that a vertex reflects of the photons of one kind; black where there is no such map.
    #[inline]
    #[must_use]
    pub fn estimate_radiance(
        &self,
        scene: &Scene,
        kind: MapKind,
        vertex: &Vertex<'_>,
        scratch: &mut PhotonMapsScratch,
    ) -> Estimate {
        self.get(kind).map_or_else(Estimate::default, |map| {
            map.estimate_radiance(scene, vertex, &mut scratch.maps[kind as usize])
        })
    }

    /// Estimates all the radiance that a vertex reflects, from every map: what a gather ray sees at its end.
    ///
    /// Lambertian surfaces use irradiance that was computed beforehand, where there is some. The radius is the widest of
    /// all estimates.
    #[must_use]
    pub fn estimate_all(&self, scene: &Scene, vertex: &Vertex<'_>, scratch: &mut PhotonMapsScratch) -> Estimate {
        if let (Some(irradiance), Some(value)) = (&self.irradiance, vertex.diffuse_value()) {
            let normal = vertex.facing_normal();
            if let Some(found) =
                irradiance.nearest(scene, vertex.point.p, normal, vertex.point.error, &mut scratch.nearest)
            {
                return Estimate {
                    value: found.value * value,
                    ..found
                };
            }
        }
        self.sum(|map, scratch| map.estimate_radiance(scene, vertex, scratch), scratch)
    }

    /// Estimates the irradiance on one side of a surface, from every map; a photon exactly there does not count.
    ///
    /// - `normal`: unit, on the side that is asked about.
    #[must_use]
    pub fn estimate_irradiance(
        &self,
        scene: &Scene,
        position: Vec3,
        normal: Vec3,
        scratch: &mut PhotonMapsScratch,
    ) -> Estimate {
        let error = position_error(position);
        self.sum(
            |map, scratch| map.estimate_irradiance(scene, position, normal, error, scratch),
            scratch,
        )
    }

    fn sum(
        &self,
        estimate: impl Fn(&PhotonMap, &mut DensityScratch) -> Estimate,
        scratch: &mut PhotonMapsScratch,
    ) -> Estimate {
        let mut all = Estimate::default();
        for (map, scratch) in self.maps.iter().zip(&mut scratch.maps) {
            let Some(map) = map else { continue };
            let one = estimate(map, scratch);
            all.value += one.value;
            all.radius = all.radius.max(one.radius);
        }
        all
    }

    /// Photons beside which irradiance is worth computing beforehand: every `every`-th of each map, by slot.
    ///
    /// In query order, so that what is left is spread as all are.
    #[must_use]
    pub fn irradiance_seeds(&self, every: usize) -> Vec<(MapKind, u32)> {
        let seeds = self.iter().flat_map(|(kind, map)| {
            let slots = (0..map.tree.len() as u32).step_by(every.max(1));
            slots.map(move |slot| (kind, slot))
        });
        seeds.collect()
    }

    /// A site on the surface beside a photon: a third to a half of the radius of an estimate away, in a direction of chance.
    ///
    /// Photons are spread more evenly than by chance, so there are too few others beside each of them, and with itself too
    /// many. Some steps away that is forgotten. A photon at whose side no surface is stays the site itself.
    ///
    /// - returns position and unit normal, on the side that the photon came from.
    #[must_use]
    pub fn site_beside(
        &self,
        scene: &Scene,
        (kind, slot): (MapKind, u32),
        scratch: &mut PhotonMapsScratch,
    ) -> Option<(Vec3, Vec3)> {
        /// Key of the random numbers of the way there.
        const SITE_STAGE: StageKey = StageKey::new("irradiance sites");
        /// How far the site is, in radii.
        const STEP: [f32; 2] = [0.35, 0.5];
        /// The way leads over the surface at this share of its length.
        const LIFT: f32 = 0.1;
        let map = self.get(kind)?;
        let position = map.tree.position(slot);
        let normal = map.columns.surface[slot as usize].normal;
        let scratch = &mut scratch.maps[kind as usize];
        let radius = map
            .estimate_irradiance(scene, position, normal, position_error(position), scratch)
            .radius;
        let u = SampleStream::new(kind as u64, SITE_STAGE, 0, slot).draw_2d(0, 0);
        let length = radius * (STEP[0] + (STEP[1] - STEP[0]) * u.x);
        let (sin, cos) = math::sin_cos(std::f32::consts::TAU * u.y);
        let frame = Frame::from_normal(normal);
        let step = (frame.x * cos + frame.y * sin) * length;
        let lift = normal * (LIFT * length + 2.0 * position_error(position));
        let way = Ray {
            t_max: length,
            ..Ray::new(position + lift, step.normalize_or(frame.x))
        };
        let down = Ray {
            t_max: 2.0 * lift.length(),
            ..Ray::new(position + lift + step, -normal)
        };
        let beside = (!scene.rays.occluded(&way))
            .then(|| scene.rays.intersect(&down))
            .flatten();
        let site = beside.map(|hit| scene.rays.surface(&down, &hit)).map(|point| {
            let side = if point.ng.dot(normal) < 0.0 {
                -point.ng
            } else {
                point.ng
            };
            (point.p, side)
        });
        let is_same_surface = |(_, side): &(Vec3, Vec3)| side.dot(normal) >= MIN_NORMAL_COSINE;
        Some(site.filter(is_same_surface).unwrap_or((position, normal)))
    }

    /// The largest radius of any estimate, in metres.
    #[must_use]
    pub fn max_radius(&self) -> f32 {
        self.iter().map(|(_, map)| map.density.max_radius).fold(0.0, f32::max)
    }
}

/// Bound on the error of a position that was stored in single precision, metres.
pub(crate) fn position_error(position: Vec3) -> f32 {
    4.0 * f32::EPSILON * position.abs().max_element()
}

/// Irradiance beside some photons, computed beforehand, so that a gather ray asks for one neighbour instead of many.
///
/// Source: Christensen, "Faster Photon Map Global Illumination", Journal of Graphics Tools 4(3), 1999.
/// Differs: it holds the light of all maps together, and the radius of the estimate, by which gather rays judge whether
/// they are long enough.
#[derive(Clone, Debug)]
pub struct IrradianceMap {
    tree: PhotonTree,
    /// By slot of the tree.
    columns: Vec<(PhotonSurface, Estimate)>,
    /// Records further away than this tell nothing, metres.
    max_radius: f32,
}

impl IrradianceMap {
    /// Joins sites with the irradiance that was estimated there.
    ///
    /// - `estimates`: of each site.
    /// - `max_radius`: records further away than this from a hit tell nothing of it, metres.
    ///
    /// # Errors
    /// As [`PhotonTree::build`].
    pub fn new(
        sites: &[(Vec3, PhotonSurface)],
        estimates: &[Estimate],
        max_radius: f32,
    ) -> Result<Self, PhotonTreeError> {
        let tree = PhotonTree::from_fn(sites.len(), |row| sites[row].0)?;
        let column = |row: &u32| (sites[*row as usize].1, estimates[*row as usize]);
        Ok(Self {
            columns: tree.rows().iter().map(column).collect(),
            tree,
            max_radius,
        })
    }

    /// The irradiance at the nearest record on the same side of the same surface, no wall between.
    ///
    /// - `normal`: unit, on the side that is asked about; `error`: bound on the error of `position`, metres.
    #[must_use]
    pub fn nearest(
        &self,
        scene: &Scene,
        position: Vec3,
        normal: Vec3,
        error: f32,
        scratch: &mut NearestScratch,
    ) -> Option<Estimate> {
        let error_sq = error * error;
        let accept = |slot: u32, offset: Vec3, dist_sq: f32| {
            let surface = &self.columns[slot as usize].0;
            is_on_surface(offset, normal, dist_sq, error_sq)
                && surface.normal.dot(normal) >= MIN_NORMAL_COSINE
                && !surface.is_parted(scene, position + offset, self.max_radius, position)
        };
        let found = self.tree.nearest_where(position, 1, self.max_radius, accept, scratch);
        found.kth().map(|nearest| self.columns[nearest.slot as usize].1)
    }
}

use crate::density::{DensityScratch, Estimate, MIN_NORMAL_COSINE, PhotonMap, is_on_surface};
use crate::photon::MapKind;
use crate::vertex::Vertex;
use glam::Vec3;
use spatial::{NearestScratch, PhotonTree, PhotonTreeError};

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
    pub fn estimate_radiance(&self, kind: MapKind, vertex: &Vertex<'_>, scratch: &mut PhotonMapsScratch) -> Estimate {
        self.get(kind).map_or_else(Estimate::default, |map| {
            map.estimate_radiance(vertex, &mut scratch.maps[kind as usize])
        })
    }

    /// Estimates all the radiance that a vertex reflects, from every map: what a gather ray sees at its end.
    ///
    /// Lambertian surfaces use irradiance that was computed beforehand, where there is some. The radius is the widest of
    /// all estimates.
    #[must_use]
    pub fn estimate_all(&self, vertex: &Vertex<'_>, scratch: &mut PhotonMapsScratch) -> Estimate {
        if let (Some(irradiance), Some(value)) = (&self.irradiance, vertex.diffuse_value()) {
            let normal = vertex.facing_normal();
            if let Some(found) = irradiance.nearest(vertex.point.p, normal, vertex.point.error, &mut scratch.nearest) {
                return Estimate {
                    value: found.value * value,
                    ..found
                };
            }
        }
        self.sum(|map, scratch| map.estimate_radiance(vertex, scratch), scratch)
    }

    /// Estimates the irradiance on one side of a surface where a photon landed, from every map; the photon itself does not count.
    ///
    /// - `normal`: unit, on the side that is asked about.
    /// - `error`: bound on the error of `position`, metres.
    #[must_use]
    pub fn estimate_irradiance(
        &self,
        position: Vec3,
        normal: Vec3,
        error: f32,
        scratch: &mut PhotonMapsScratch,
    ) -> Estimate {
        self.sum(
            |map, scratch| map.estimate_irradiance(position, normal, error, scratch),
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

    /// Where irradiance is worth computing beforehand: position and unit normal of every `every`-th photon of each map.
    ///
    /// In query order, so that what is left is spread as all are.
    #[must_use]
    pub fn irradiance_sites(&self, every: usize) -> Vec<(Vec3, Vec3)> {
        let sites = self.iter().flat_map(|(_, map)| {
            let slots = (0..map.tree.len()).step_by(every.max(1));
            slots.map(|slot| (map.tree.position(slot as u32), map.columns.normal[slot]))
        });
        sites.collect()
    }

    /// The largest radius of any estimate, in metres.
    #[must_use]
    pub fn max_radius(&self) -> f32 {
        let radius = |(_, map): (MapKind, &PhotonMap)| map.density.max_radius * map.density.shrink;
        self.iter().map(radius).fold(0.0, f32::max)
    }
}

/// Irradiance at some photons, computed beforehand, so that a gather ray asks for one neighbour instead of many.
///
/// Source: Christensen, "Faster Photon Map Global Illumination", Journal of Graphics Tools 4(3), 1999.
/// Differs: it holds the light of all maps together, and the radius of the estimate, by which gather rays judge whether
/// they are long enough.
#[derive(Clone, Debug)]
pub struct IrradianceMap {
    tree: PhotonTree,
    /// By slot of the tree.
    columns: Vec<(Vec3, Estimate)>,
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
    pub fn new(sites: &[(Vec3, Vec3)], estimates: &[Estimate], max_radius: f32) -> Result<Self, PhotonTreeError> {
        let tree = PhotonTree::from_fn(sites.len(), |row| sites[row].0)?;
        let column = |row: &u32| (sites[*row as usize].1, estimates[*row as usize]);
        Ok(Self {
            columns: tree.rows().iter().map(column).collect(),
            tree,
            max_radius,
        })
    }

    /// The irradiance at the nearest record on the same side of the same surface.
    ///
    /// - `normal`: unit, on the side that is asked about; `error`: bound on the error of `position`, metres.
    #[must_use]
    pub fn nearest(&self, position: Vec3, normal: Vec3, error: f32, scratch: &mut NearestScratch) -> Option<Estimate> {
        let error_sq = error * error;
        let accept = |slot: u32, offset: Vec3, dist_sq: f32| {
            is_on_surface(offset, normal, dist_sq, error_sq)
                && self.columns[slot as usize].0.dot(normal) >= MIN_NORMAL_COSINE
        };
        let found = self.tree.nearest_where(position, 1, self.max_radius, accept, scratch);
        found.kth().map(|nearest| self.columns[nearest.slot as usize].1)
    }
}

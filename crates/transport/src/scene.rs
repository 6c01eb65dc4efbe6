use crate::light::{LightSource, LightTable};
use crate::projection::{TargetSphere, cluster_targets};
use glam::Vec3;
use radiometry::Rgb;
use scattering::{Bsdf, Dispersion, Interior};
use spatial::{RayScene, SurfacePoint};

/// What a surface is made of.
#[derive(Clone, Copy, Debug, Default)]
pub struct Material {
    /// How the surface scatters.
    pub bsdf: Bsdf,
    /// Absorption coefficient inside the closed geometry, in m⁻¹; zero where the surface has no inside.
    pub absorption: Rgb,
    /// Of the inside where it overlaps that of other geometry: the highest is there, of equal ones the innermost.
    pub priority: i8,
    /// How the index of refraction of the inside depends on the wavelength.
    pub dispersion: Option<Dispersion>,
}

/// Everything that light meets, in rows: geometry, materials and lights. Immutable once built.
pub struct Scene {
    /// Ray queries over all geometry.
    pub rays: RayScene,
    /// All lights.
    pub lights: LightTable,
    materials: Vec<Material>,
    material_of_instance: Vec<u32>,
    targets: Vec<TargetSphere>,
    diffuse_area: f64,
    /// Of each instance.
    passages: Vec<Passage>,
    may_hide_surfaces: bool,
}

/// What a surface may do to a ray beside stopping it; small, since every hit asks.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Passage {
    /// Light that passes is in another medium.
    pub(crate) has_inside: bool,
    /// Tells wavelengths apart.
    pub(crate) is_dispersive: bool,
}

impl Passage {
    fn of(material: &Material) -> Self {
        Self {
            has_inside: material.bsdf.has_inside(),
            is_dispersive: material.dispersion.is_some(),
        }
    }

    /// True when the surface stops every ray, and nothing else.
    #[inline]
    pub(crate) fn is_plain(self) -> bool {
        !(self.has_inside || self.is_dispersive)
    }
}

impl Scene {
    /// Joins geometry, materials and lights.
    ///
    /// - `material_of_instance`: row in `materials` for each instance of `rays`.
    /// - `lights`: area lights name instances of `rays`.
    ///
    /// # Panics
    /// When `material_of_instance` is shorter than the instances of `rays`, or names a row that does not exist.
    #[must_use]
    pub fn new(
        rays: RayScene,
        materials: Vec<Material>,
        material_of_instance: Vec<u32>,
        lights: Vec<LightSource>,
    ) -> Self {
        let instances = rays.instance_count();
        assert!(
            material_of_instance.len() >= instances
                && material_of_instance.iter().all(|m| (*m as usize) < materials.len()),
            "every instance has a material"
        );
        let lights = LightTable::new(&rays, lights);
        let material = |i: u32| &materials[material_of_instance[i as usize] as usize];
        let rows = 0..instances as u32;
        let passages: Vec<Passage> = rows.clone().map(|i| Passage::of(material(i))).collect();
        let targets = rows.clone().filter(|i| material(*i).bsdf.has_specular()).map(|i| {
            let bounds = rays.instance_bounds(i);
            TargetSphere {
                centre: bounds.center(),
                radius: 0.5 * bounds.diagonal(),
            }
        });
        let targets = cluster_targets(targets.collect());
        let diffuse_area = rows
            .filter(|i| material(*i).bsdf.has_diffuse())
            .map(|i| rays.instance_area(i))
            .sum();
        Self {
            rays,
            lights,
            materials,
            material_of_instance,
            targets,
            diffuse_area,
            may_hide_surfaces: passages.iter().filter(|passage| passage.has_inside).count() > 1,
            passages,
        }
    }

    /// The material of the surface that was hit.
    #[inline]
    #[must_use]
    pub fn material(&self, point: &SurfacePoint) -> &Material {
        self.material_by_row(self.material_row(point))
    }

    /// Row of the material of the surface that was hit.
    #[inline]
    #[must_use]
    pub fn material_row(&self, point: &SurfacePoint) -> u32 {
        self.material_of_instance[point.instance as usize]
    }

    /// The material in a row.
    #[inline]
    #[must_use]
    pub fn material_by_row(&self, row: u32) -> &Material {
        &self.materials[row as usize]
    }

    /// The medium behind the surface that was hit; `None` where it has no inside.
    #[inline]
    pub(crate) fn interior(&self, point: &SurfacePoint) -> Option<Interior> {
        self.passage(point).has_inside.then(|| {
            let medium = self.material_row(point);
            let priority = self.material_by_row(medium).priority;
            Interior { medium, priority }
        })
    }

    /// What the surface that was hit may do to a ray beside stopping it.
    #[inline]
    pub(crate) fn passage(&self, point: &SurfacePoint) -> Passage {
        self.passages[point.instance as usize]
    }

    /// True when a surface may lie hidden in the medium of another.
    #[inline]
    pub(crate) fn may_hide_surfaces(&self) -> bool {
        self.may_hide_surfaces
    }

    /// Spheres around all surfaces that own a specular lobe, at most [`MAX_TARGETS`](crate::MAX_TARGETS).
    #[must_use]
    pub fn specular_targets(&self) -> &[TargetSphere] {
        &self.targets
    }

    /// World area of all surfaces that own a diffuse lobe, in m²: where photons can be stored.
    #[must_use]
    pub fn diffuse_area(&self) -> f64 {
        self.diffuse_area
    }
}

pub(crate) fn bounding_sphere(rays: &RayScene) -> (Vec3, f32) {
    let bounds = rays.bounds();
    if bounds.is_empty() {
        (Vec3::ZERO, 0.0)
    } else {
        (bounds.center(), 0.5 * bounds.diagonal())
    }
}

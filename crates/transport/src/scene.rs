use crate::light::{LightSource, LightTable};
use crate::projection::{TargetSphere, cluster_targets};
use crate::reflectance::ReflectanceTable;
use crate::textures::{SurfaceInputs, TexturedSurface};
use glam::Vec3;
use radiometry::Rgb;
use scattering::{Bsdf, Dispersion, Interior};
use spatial::{Bounds, RayScene, SurfacePoint};
use std::sync::{Arc, OnceLock};

/// What a surface is made of.
#[derive(Clone, Debug, Default)]
pub struct Material {
    /// How the surface scatters; where that changes from point to point, how it does where it is clearest.
    pub bsdf: Bsdf,
    /// What changes from point to point, if anything does.
    pub textured: Option<Arc<TexturedSurface>>,
    /// Absorption coefficient inside the closed geometry, in m⁻¹; zero where the surface has no inside.
    pub absorption: Rgb,
    /// Of the inside where it overlaps that of other geometry: the highest is there, of equal ones the innermost.
    pub priority: i8,
    /// How the index of refraction of the inside depends on the wavelength.
    pub dispersion: Option<Dispersion>,
}

impl Material {
    /// A material by inputs. One that is the same everywhere costs nothing more than one without.
    ///
    /// Cost: a look at every texel, to know which lobes it has anywhere.
    #[must_use]
    pub fn from_inputs(inputs: SurfaceInputs) -> Self {
        let textured = TexturedSurface::new(inputs);
        let is_constant = textured.is_constant();
        Self {
            bsdf: textured.clearest(),
            textured: (!is_constant).then(|| Arc::new(textured)),
            ..Self::default()
        }
    }

    /// The scattering function and the shading normal at a point of the surface.
    #[inline]
    #[must_use]
    pub fn at(&self, rays: &RayScene, point: &SurfacePoint) -> (Bsdf, Vec3) {
        match &self.textured {
            None => (self.bsdf, point.ns),
            Some(textured) => textured.at(rays, point),
        }
    }

    /// How much of the surface is there at a point, in [0, 1].
    #[inline]
    #[must_use]
    pub fn alpha(&self, rays: &RayScene, point: &SurfacePoint) -> f32 {
        match &self.textured {
            None => 1.0,
            Some(textured) => textured.alpha(rays, point),
        }
    }

    /// True when the surface may be less than whole anywhere.
    #[must_use]
    pub fn has_alpha(&self) -> bool {
        self.textured.as_ref().is_some_and(|textured| textured.has_alpha())
    }

    /// True when a lobe counts as D anywhere on the surface.
    #[must_use]
    pub fn has_diffuse(&self) -> bool {
        self.anywhere(Bsdf::has_diffuse)
    }

    /// True when a lobe counts as S anywhere on the surface.
    #[must_use]
    pub fn has_specular(&self) -> bool {
        self.anywhere(Bsdf::has_specular)
    }

    /// True when a lobe is delta anywhere on the surface.
    #[must_use]
    pub fn has_delta(&self) -> bool {
        self.anywhere(Bsdf::has_delta)
    }

    /// True when a lobe passes light to the other side anywhere on the surface.
    #[must_use]
    pub fn transmits(&self) -> bool {
        self.anywhere(Bsdf::transmits)
    }

    /// True when light that passes is in another medium anywhere behind the surface.
    #[must_use]
    pub fn has_inside(&self) -> bool {
        self.anywhere(Bsdf::has_inside)
    }

    /// Asks all that the surface can be; may say yes where no point of it is so, never no where one is.
    fn anywhere(&self, is_so: impl Fn(&Bsdf) -> bool) -> bool {
        match &self.textured {
            None => is_so(&self.bsdf),
            Some(textured) => textured.anywhere(is_so),
        }
    }
}

/// Everything that light meets, in rows: geometry, materials and lights. Immutable once built.
pub struct Scene {
    /// Ray queries over all geometry.
    pub rays: RayScene,
    /// All lights.
    pub lights: LightTable,
    materials: Vec<Material>,
    material_of_instance: Vec<u32>,
    /// Of each material that was asked for it.
    reflectances: Vec<OnceLock<ReflectanceTable>>,
    targets: Vec<TargetSphere>,
    diffuse_area: f64,
    /// Of each instance.
    passages: Vec<Passage>,
    /// Boxes around all geometry with an inside.
    media: Vec<Bounds>,
    /// Around all of `media`.
    all_media: Bounds,
    may_hide_surfaces: bool,
    has_alpha: bool,
}

/// What a surface may do to a ray beside stopping it; small, since every hit asks.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Passage {
    /// Light that passes is in another medium.
    pub(crate) has_inside: bool,
    /// Tells wavelengths apart.
    pub(crate) is_dispersive: bool,
    /// Is less than whole somewhere.
    pub(crate) has_alpha: bool,
    /// Light gets to its other side somewhere.
    pub(crate) lets_through: bool,
}

impl Passage {
    fn of(material: &Material) -> Self {
        Self {
            has_inside: material.has_inside(),
            is_dispersive: material.dispersion.is_some(),
            has_alpha: material.has_alpha(),
            lets_through: material.transmits() || material.has_alpha(),
        }
    }

    /// True when the surface stops every ray, and nothing else.
    #[inline]
    pub(crate) fn is_plain(self) -> bool {
        !(self.has_inside || self.is_dispersive || self.has_alpha)
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
        let material = |i: u32| &materials[material_of_instance[i as usize] as usize];
        let lights = LightTable::new(&rays, lights, |i| {
            material(i).textured.clone().filter(|t| t.has_alpha())
        });
        let rows = 0..instances as u32;
        let passages: Vec<Passage> = rows.clone().map(|i| Passage::of(material(i))).collect();
        let has_inside = |i: &u32| passages[*i as usize].has_inside;
        let media: Vec<Bounds> = rows
            .clone()
            .filter(has_inside)
            .map(|i| rays.instance_bounds(i))
            .collect();
        let targets = rows.clone().filter(|i| material(*i).has_specular()).map(|i| {
            let bounds = rays.instance_bounds(i);
            TargetSphere {
                centre: bounds.center(),
                radius: 0.5 * bounds.diagonal(),
            }
        });
        let targets = cluster_targets(targets.collect());
        let diffuse_area = rows
            .filter(|i| material(*i).has_diffuse())
            .map(|i| rays.instance_area(i))
            .sum();
        Self {
            rays,
            lights,
            reflectances: materials.iter().map(|_| OnceLock::new()).collect(),
            materials,
            material_of_instance,
            targets,
            diffuse_area,
            may_hide_surfaces: media.len() > 1,
            all_media: media.iter().fold(Bounds::EMPTY, |all, one| all.union(one)),
            media,
            has_alpha: passages.iter().any(|passage| passage.has_alpha),
            passages,
        }
    }

    /// The material of the surface that was hit.
    #[inline]
    #[must_use]
    pub fn material(&self, point: &SurfacePoint) -> &Material {
        self.material_by_row(self.material_row(point))
    }

    /// The material of an instance.
    #[must_use]
    pub fn material_of(&self, instance: u32) -> &Material {
        self.material_by_row(self.material_of_instance[instance as usize])
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

    /// What the D lobes of a surface reflect of even light; `None` where that changes from point to point. Made when it is first
    /// asked for.
    #[inline]
    pub(crate) fn reflectance_table(&self, point: &SurfacePoint) -> Option<&ReflectanceTable> {
        let row = self.material_row(point);
        let material = self.material_by_row(row);
        let table = || self.reflectances[row as usize].get_or_init(|| ReflectanceTable::of(&material.bsdf));
        material.textured.is_none().then(table)
    }

    /// How much of the surface is there at a point that was hit, in [0, 1].
    #[inline]
    #[must_use]
    pub fn alpha(&self, point: &SurfacePoint) -> f32 {
        self.material(point).alpha(&self.rays, point)
    }

    /// True when a surface may be less than whole anywhere, so that [`Scene::alpha`] has to be asked.
    #[inline]
    #[must_use]
    pub fn has_alpha(&self) -> bool {
        self.has_alpha
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

    /// False where no medium can be around a place.
    #[inline]
    pub(crate) fn may_be_inside(&self, p: Vec3) -> bool {
        let holds = |bounds: &Bounds| p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
        holds(&self.all_media) && self.media.iter().any(holds)
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

use super::field::{Patch, PatchField, PatchScratch};
use crate::scene::Scene;
use crate::vertex::Vertex;
use glam::{DMat3, DVec3, Vec2, Vec3};
use radiometry::{Frame, Rgb, warp};

/// The irradiance of a place, in W·m⁻².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PatchIrradiance {
    /// By light that comes from the lights straight or over S surfaces.
    pub direct: Rgb,
    /// By light that other patches reflect.
    pub indirect: Rgb,
}

/// Patches that a smooth value is made of.
const NEIGHBOURS: usize = 12;

impl PatchField {
    /// The irradiance by light that patches reflect, smooth from patch to patch.
    ///
    /// A plane is fitted to the values around, weighted by `(1 − d²/r²)²` with `r` the distance of the furthest; so linear
    /// changes are met exactly, up to the borders of a surface. The result goes no further than half the range of the values
    /// beyond them.
    /// Patches behind something do not count.
    ///
    /// Source: moving least squares, Lancaster and Salkauskas, Mathematics of Computation 37, 1981.
    ///
    /// - returns nothing where there are no patches.
    #[must_use]
    pub fn indirect_irradiance(&self, scene: &Scene, vertex: &Vertex<'_>, scratch: &mut PatchScratch) -> Option<Rgb> {
        let (point, normal) = (vertex.point, vertex.facing_normal());
        self.find(scene, point.instance, point.p, normal, point.error, NEIGHBOURS, scratch);
        let furthest = scratch.found.last()?.1;
        let frame = Frame::from_normal(normal);
        let mut fit = Fit::default();
        for (row, distance_sq) in &scratch.found {
            let patch = &self.patches[*row as usize];
            // A little over the furthest, so that few patches make a value too.
            let weight = 1.0 - distance_sq / (1.05 * furthest).max(f32::MIN_POSITIVE);
            let offset = patch.position - point.p;
            let along = Vec2::new(offset.dot(frame.x), offset.dot(frame.y)) / self.spacing;
            fit.add(weight * weight, along, patch.indirect);
        }
        Some(fit.at_origin())
    }

    /// The irradiance of the patch that a place is part of.
    ///
    /// - returns nothing where there is no patch.
    #[must_use]
    pub fn irradiance(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        scratch: &mut PatchScratch,
    ) -> Option<PatchIrradiance> {
        let (point, normal) = (vertex.point, vertex.facing_normal());
        let row = self.patch_at(scene, point.instance, point.p, normal, point.error, scratch)?;
        let Patch { direct, indirect, .. } = self.patches[row as usize];
        Some(PatchIrradiance { direct, indirect })
    }
}

impl Vertex<'_> {
    /// What the D lobes send back to the eye of light that arrives evenly from all around on its side, over its irradiance:
    /// `1/π ∫ f_d cosθ dω`, in sr⁻¹; albedo/π of a Lambertian surface.
    #[must_use]
    pub fn diffuse_response(&self) -> Rgb {
        /// Directions, by the cosine, for lobes that are not Lambertian.
        const DIRECTIONS: u32 = 16;
        if let Some(value) = self.diffuse_value() {
            return value;
        }
        let frame = Frame::from_normal(self.facing_normal());
        let value = |i: u32| {
            let u = Vec2::new((i as f32 + 0.5) / DIRECTIONS as f32, (0.618_034 * i as f32).fract());
            self.eval_diffuse_flux(frame.world_from_local(warp::sample_cosine_hemisphere(u)))
        };
        (0..DIRECTIONS).map(value).sum::<Rgb>() * (1.0 / DIRECTIONS as f32)
    }
}

/// A weighted fit of a plane to values in the tangent plane.
#[derive(Clone, Copy, Debug)]
struct Fit {
    normal: DMat3,
    right: [DVec3; 3],
    least: Vec3,
    most: Vec3,
}

impl Default for Fit {
    fn default() -> Self {
        Self {
            normal: DMat3::ZERO,
            right: [DVec3::ZERO; 3],
            least: Vec3::INFINITY,
            most: Vec3::ZERO,
        }
    }
}

impl Fit {
    fn add(&mut self, weight: f32, along: Vec2, value: Rgb) {
        let basis = DVec3::new(1.0, along.x.into(), along.y.into());
        let weighted = basis * f64::from(weight);
        self.normal += DMat3::from_cols(weighted * basis.x, weighted * basis.y, weighted * basis.z);
        let value = Vec3::from_array(value.to_array());
        for (right, value) in self.right.iter_mut().zip(value.to_array()) {
            *right += weighted * f64::from(value);
        }
        self.least = self.least.min(value);
        self.most = self.most.max(value);
    }

    fn at_origin(&self) -> Rgb {
        /// Places in a line, or too few, tell no slope; the mean is taken then.
        const LEAST_DETERMINANT: f64 = 1e-3;
        let weights = self.normal.x_axis.x;
        let determinant = self.normal.determinant();
        let value = if determinant > LEAST_DETERMINANT * weights * weights * weights {
            let row = self.normal.inverse().x_axis;
            self.right.map(|right| row.dot(right))
        } else {
            self.right.map(|right| right.x / weights.max(f64::MIN_POSITIVE))
        };
        // In the corner of a surface all patches are on one side, so that the plane may leave their range a little.
        let leave = 0.5 * (self.most - self.least).max(Vec3::ZERO);
        let (least, most) = ((self.least - leave).max(Vec3::ZERO), self.most + leave);
        let value = Vec3::from_array(value.map(|v| v as f32)).clamp(least, most.max(least));
        Rgb::new(value.x, value.y, value.z)
    }
}

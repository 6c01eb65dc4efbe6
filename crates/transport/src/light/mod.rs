//! The lights of a scene: how one is chosen, how it is sampled from a point, and what hits of it weigh.

mod distant;
mod environment;
mod prepared;
mod sample;
mod source;
mod tree;

use crate::TexturedSurface;
use crate::scene::bounding_sphere;
use glam::{Vec2, Vec3};
use radiometry::{Distribution, Rgb};
use spatial::{RayScene, SurfacePoint};
use std::sync::Arc;
use tree::LightTree;

pub use environment::{Environment, EnvironmentMap};
pub(crate) use prepared::Light;
pub use sample::LightSample;
pub use source::{LightSource, SpotCone};

/// All lights.
///
/// Photons choose a light in proportion to its power. A point of the scene first chooses between the lights that are
/// infinitely far away and the others; among the former it chooses by power, among the latter by a tree over all of them,
/// each triangle of a mesh by itself.
pub struct LightTable {
    lights: Vec<Light>,
    choice: Distribution,
    infinite: Vec<u32>,
    /// Among `infinite`.
    infinite_choice: Distribution,
    /// Probability of choosing among them.
    infinite_share: f32,
    tree: LightTree,
    /// Light and piece of each leaf of the tree.
    leaves: Vec<(u32, u32)>,
    /// Row of the light on each instance, or `NONE`, and the leaf of its first piece.
    light_of_instance: Vec<(u32, u32)>,
    bounding_sphere: (Vec3, f32),
}

const NONE: u32 = u32::MAX;

impl LightTable {
    /// Builds the table. Lights without power (black, without area, or with nothing there) are left out.
    ///
    /// - `coverage`: of an instance that is not whole.
    #[must_use]
    pub(crate) fn new(
        rays: &RayScene,
        sources: Vec<LightSource>,
        coverage: impl Fn(u32) -> Option<Arc<TexturedSurface>>,
    ) -> Self {
        let mut table = Self {
            lights: Vec::new(),
            choice: Distribution::default(),
            infinite: Vec::new(),
            infinite_choice: Distribution::default(),
            infinite_share: 0.0,
            tree: LightTree::default(),
            leaves: Vec::new(),
            light_of_instance: vec![(NONE, NONE); rays.instance_count()],
            bounding_sphere: bounding_sphere(rays),
        };
        let mut powers = Vec::new();
        for source in sources {
            let instance = match &source {
                LightSource::Area { instance, .. } => Some(*instance),
                _ => None,
            };
            let Some(light) = Light::prepare(rays, source, &coverage) else {
                continue;
            };
            let power = light.power(table.radius());
            if power <= 0.0 || power.is_nan() {
                continue;
            }
            let row = table.lights.len() as u32;
            if let Some(instance) = instance {
                table.light_of_instance[instance as usize].0 = row;
            }
            table.lights.push(light);
            powers.push(power);
        }
        table.choice = Distribution::new(powers.iter().copied());
        table.plant_tree(&powers);
        table
    }

    /// Sorts lights into near and far, and builds the tree over the former.
    fn plant_tree(&mut self, powers: &[f64]) {
        let (mut bounds, mut near, mut far) = (Vec::new(), 0.0, Vec::new());
        let mut first_leaf = vec![NONE; self.lights.len()];
        for (row, light) in (0_u32..).zip(&self.lights) {
            if light.is_infinite() {
                self.infinite.push(row);
                far.push(powers[row as usize]);
                continue;
            }
            near += powers[row as usize];
            first_leaf[row as usize] = self.leaves.len() as u32;
            for piece in 0..light.piece_count() {
                self.leaves.push((row, piece));
                bounds.push(light.bounds(piece));
            }
        }
        for (row, leaf) in &mut self.light_of_instance {
            if *row != NONE {
                *leaf = first_leaf[*row as usize];
            }
        }
        self.tree = LightTree::build(&bounds);
        let all_far: f64 = far.iter().sum();
        self.infinite_choice = Distribution::new(far);
        // The power of what is infinitely far grows with the size of the scene, not so the light that it sends to a point
        // of it: over a wide floor, a lamp that lights what one looks at would hardly ever be chosen.
        let counted = if near > 0.0 { all_far.min(near) } else { all_far };
        self.infinite_share = if counted > 0.0 {
            (counted / (counted + near)) as f32
        } else {
            0.0
        };
    }

    /// True when nothing shines.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// The largest radiance, in any channel, that a ray may meet, W·m⁻²·sr⁻¹; infinite where light comes from points, which
    /// no ray meets.
    #[must_use]
    pub fn brightest(&self) -> f32 {
        self.lights.iter().map(Light::brightest).fold(0.0, f32::max)
    }

    /// Power of all lights together, in W (mean of the channels).
    #[must_use]
    pub fn power(&self) -> f64 {
        self.choice.total()
    }

    /// Chooses a light and a direction to it as seen from `from`.
    ///
    /// - `time`: in [0, 1] of the shutter.
    /// - `u_choice`, `u`: uniform in [0, 1)².
    ///
    /// `None` when there is no light, or the sampled point of it does not shine this way.
    #[inline]
    #[must_use]
    pub fn sample(&self, from: Vec3, time: f32, u_choice: Vec2, u: Vec2) -> Option<LightSample> {
        if u_choice.x < self.infinite_share {
            let (index, probability, _) = self.infinite_choice.sample(u_choice.x / self.infinite_share)?;
            let light = &self.lights[self.infinite[index] as usize];
            return Some(light.sample_infinite(u, time, self.infinite_share * probability));
        }
        // The second number carries on where the first has no more digits, deep in the tree.
        let u_tree = (u_choice.x - self.infinite_share) / (1.0 - self.infinite_share);
        let u_tree = f64::from(u_tree) + f64::from(u_choice.y) * (1.0 / 16_777_216.0);
        let (leaf, probability) = self.tree.sample(from, u_tree.min(LAST))?;
        let (row, piece) = self.leaves[leaf as usize];
        let probability = (1.0 - self.infinite_share) * probability;
        self.lights[row as usize].sample_near(from, piece, u, time, probability)
    }

    /// Radiance that leaves a hit surface towards `wo`; black where it does not shine.
    #[inline]
    #[must_use]
    pub fn emitted(&self, point: &SurfacePoint, wo: Vec3) -> Rgb {
        match self.light_of(point) {
            Some(Light::Area {
                sampler,
                shine,
                two_sided,
            }) if *two_sided || point.ng.dot(wo) > 0.0 => {
                shine.at(sampler, point.primitive, point.p, point.uv, point.time)
            }
            _ => Rgb::BLACK,
        }
    }

    /// Density per solid angle with which [`LightTable::sample`] from `from` would have found this surface point.
    #[inline]
    #[must_use]
    pub fn pdf_emitted(&self, from: Vec3, point: &SurfacePoint) -> f32 {
        match self.light_of(point) {
            Some(Light::Area { sampler, .. }) => {
                let first = self.light_of_instance[point.instance as usize].1;
                let leaf = first + sampler.piece_of(point.primitive);
                (1.0 - self.infinite_share) * self.tree.probability(from, leaf) * sampler.pdf_toward(from, point)
            }
            _ => 0.0,
        }
    }

    /// What arrives from a direction in which there is nothing: of each light that is infinitely far away the radiance,
    /// and the density with which [`LightTable::sample`] finds the direction.
    #[inline]
    pub fn escaped(&self, direction: Vec3, time: f32) -> impl Iterator<Item = (Rgb, f32)> {
        self.infinite.iter().enumerate().filter_map(move |(index, row)| {
            let (radiance, pdf) = match &self.lights[*row as usize] {
                Light::Environment(environment) => (environment.radiance_from(direction), environment.pdf(direction)),
                Light::Distant(disc) if disc.holds(direction, time) => (disc.radiance, disc.pdf()),
                _ => return None,
            };
            let probability = self.infinite_share * self.infinite_choice.probability(index);
            (!radiance.is_black()).then_some((radiance, probability * pdf))
        })
    }

    #[inline]
    fn light_of(&self, point: &SurfacePoint) -> Option<&Light> {
        match self.light_of_instance[point.instance as usize].0 {
            NONE => None,
            row => Some(&self.lights[row as usize]),
        }
    }

    /// Chooses a light in proportion to power.
    pub(crate) fn choice(&self) -> &Distribution {
        &self.choice
    }

    /// The light in a row.
    pub(crate) fn light(&self, row: usize) -> &Light {
        &self.lights[row]
    }

    /// All lights, by row.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter()
    }

    /// Centre and radius of the sphere around all geometry.
    pub(crate) fn bounding_sphere(&self) -> (Vec3, f32) {
        self.bounding_sphere
    }

    /// Radius of the sphere through which infinite lights shine; that of an empty scene is 1, so that they can be chosen.
    fn radius(&self) -> f64 {
        if self.bounding_sphere.1 > 0.0 {
            f64::from(self.bounding_sphere.1)
        } else {
            1.0
        }
    }
}

/// The largest number below 1.
const LAST: f64 = 1.0 - f64::EPSILON / 2.0;

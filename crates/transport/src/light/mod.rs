//! The lights of a scene: how one is chosen, how it is sampled from a point, and what hits of it weigh.

mod environment;
mod tree;

use crate::frame::MovingFrame;
use crate::scene::bounding_sphere;
use glam::{Vec2, Vec3};
use radiometry::{Distribution, Frame, Rgb, math, warp};
use spatial::{Ray, RayScene, SurfacePoint, SurfaceSampler};
use std::f64::consts::PI;
use std::sync::Arc;
use texture::Texture;
use tree::{Facing, LightBounds, LightTree};

pub use environment::{Environment, EnvironmentMap};

/// A light, as the tables are built from it.
#[derive(Clone, Debug)]
pub enum LightSource {
    /// A point that shines alike in all directions.
    Point {
        /// Where it is; its axes do not matter.
        frame: MovingFrame,
        /// W·sr⁻¹.
        intensity: Rgb,
    },
    /// A point that shines into a cone along −Z of its frame.
    Spot {
        /// Where it is and shines.
        frame: MovingFrame,
        /// W·sr⁻¹ on the axis.
        intensity: Rgb,
        /// Its edge.
        cone: SpotCone,
    },
    /// A surface that shines by Lambert's law.
    Area {
        /// Row of the instance whose surface shines.
        instance: u32,
        /// W·m⁻²·sr⁻¹.
        radiance: Rgb,
        /// Radiance from point to point, in place of `radiance`, which is then its mean, for the choice of lights.
        texture: Option<Arc<Texture>>,
        /// Shines on both sides; otherwise on that of the geometric normal.
        two_sided: bool,
    },
    /// A disc infinitely far away, whose light travels along −Z of its frame.
    Distant {
        /// Its rotation; where it is does not matter.
        frame: MovingFrame,
        /// W·m⁻² on a plane that faces it.
        irradiance: Rgb,
        /// Half the angle that it subtends, radians, in [0, π/2); 0 is a point that no ray meets by chance.
        half_angle: f32,
    },
    /// All directions in which there is nothing else.
    Environment(Environment),
}

/// How a spot light fades towards the edge of its cone: a smoothstep in the cosine of the angle to the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCone {
    /// Cosine of the half-angle within which it shines with full intensity.
    pub cos_inner: f32,
    /// Cosine of the half-angle beyond which it is dark, at most `cos_inner`.
    pub cos_outer: f32,
}

impl SpotCone {
    /// Share of the intensity on the axis that is sent at an angle, in [0, 1].
    #[inline]
    #[must_use]
    pub fn falloff(&self, cos: f32) -> f32 {
        if cos < self.cos_outer {
            return 0.0;
        }
        if cos >= self.cos_inner {
            return 1.0;
        }
        let t = (cos - self.cos_outer) / (self.cos_inner - self.cos_outer);
        t * t * (3.0 - 2.0 * t)
    }

    /// 1 − cos of the outer half-angle.
    pub(crate) fn one_minus_cos(&self) -> f32 {
        1.0 - self.cos_outer
    }
}

/// A light sampled from a point.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub wi: Vec3,
    /// Radiance that arrives when nothing is in the way; for a point light intensity over squared distance, for a
    /// distant point irradiance.
    pub radiance: Rgb,
    /// Density of this choice: per solid angle, or the probability of the light when `delta`.
    pub pdf: f32,
    /// True for a light that no ray can meet by chance.
    pub delta: bool,
    target: Target,
}

#[derive(Clone, Copy, Debug)]
enum Target {
    Point { p: Vec3, error: f32, ng: Vec3 },
    Infinity,
}

impl LightSample {
    /// The ray that must be free for the light to arrive at `point`.
    #[inline]
    #[must_use]
    pub fn shadow_ray(&self, point: &SurfacePoint) -> Ray {
        let ray = match self.target {
            Target::Point { p, error, ng } => spatial::connect(point.p, point.error, point.ng, p, error, ng),
            Target::Infinity => Ray::new(spatial::spawn_origin(point.p, point.error, point.ng, self.wi), self.wi),
        };
        Ray {
            time: point.time,
            ..ray
        }
    }
}

/// Radiance of a surface.
pub(crate) struct SurfaceRadiance {
    /// W·m⁻²·sr⁻¹; of a texture the mean.
    pub(crate) mean: Rgb,
    texture: Option<Arc<Texture>>,
}

impl SurfaceRadiance {
    /// Radiance of a point of the surface that `sampler` samples, W·m⁻²·sr⁻¹.
    ///
    /// - `primitive`, `p`, `uv`: of the point.
    #[inline]
    pub(crate) fn at(&self, sampler: &SurfaceSampler, primitive: u32, p: Vec3, uv: Vec2, time: f32) -> Rgb {
        match &self.texture {
            None => self.mean,
            Some(texture) => texture.rgb(sampler.uv_set(primitive, p, uv, time, texture.uv_set)),
        }
    }
}

pub(crate) enum Light {
    Point {
        frame: MovingFrame,
        intensity: Rgb,
    },
    Spot {
        frame: MovingFrame,
        intensity: Rgb,
        cone: SpotCone,
    },
    Area {
        sampler: Box<SurfaceSampler>,
        shine: SurfaceRadiance,
        two_sided: bool,
    },
    Distant(DistantDisc),
    Environment(Environment),
}

/// A disc infinitely far away.
pub(crate) struct DistantDisc {
    frame: MovingFrame,
    /// Radiance of the disc; irradiance of a point.
    pub(crate) radiance: Rgb,
    /// 1 − cos of its half-angle; 0 for a point.
    one_minus_cos: f32,
}

impl DistantDisc {
    fn new(frame: MovingFrame, irradiance: Rgb, half_angle: f32) -> Self {
        let (sin, cos) = math::sin_cos(half_angle);
        // E = ∫ L cosθ dω = π L sin² of the half-angle.
        let projected = std::f32::consts::PI * sin * sin;
        let one_minus_cos = sin * sin / (1.0 + cos);
        let is_point = projected < 1e-10;
        Self {
            frame,
            radiance: if is_point {
                irradiance
            } else {
                irradiance * (1.0 / projected)
            },
            one_minus_cos: if is_point { 0.0 } else { one_minus_cos },
        }
    }

    pub(crate) fn is_point(&self) -> bool {
        self.one_minus_cos == 0.0
    }

    /// A unit direction towards it and its density per solid angle; 1 for a point.
    #[inline]
    pub(crate) fn sample(&self, u: Vec2, time: f32) -> (Vec3, f32) {
        let axis = self.frame.back(time);
        if self.is_point() {
            return (axis, 1.0);
        }
        let local = warp::sample_uniform_cone(u, self.one_minus_cos);
        let direction = Frame::from_normal(axis).world_from_local(local).normalize();
        (direction, self.pdf())
    }

    fn pdf(&self) -> f32 {
        1.0 / (std::f32::consts::TAU * self.one_minus_cos)
    }

    /// True where a direction meets the disc; never for a point.
    #[inline]
    fn holds(&self, direction: Vec3, time: f32) -> bool {
        // 1 − cos of a small angle through its chord: |a − b|² = 2 (1 − cos).
        0.5 * (direction - self.frame.back(time)).length_squared() < self.one_minus_cos
    }
}

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
    /// Builds the table. Lights without power (black, or without area) are left out.
    #[must_use]
    pub fn new(rays: &RayScene, sources: Vec<LightSource>) -> Self {
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
            let Some(light) = prepare(rays, source) else { continue };
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

/// `None` for a surface without area.
fn prepare(rays: &RayScene, source: LightSource) -> Option<Light> {
    Some(match source {
        LightSource::Point { frame, intensity } => Light::Point { frame, intensity },
        LightSource::Spot { frame, intensity, cone } => Light::Spot { frame, intensity, cone },
        LightSource::Area {
            instance,
            radiance,
            texture,
            two_sided,
        } => Light::Area {
            sampler: Box::new(SurfaceSampler::new(rays, instance)?),
            shine: SurfaceRadiance {
                mean: radiance,
                texture,
            },
            two_sided,
        },
        LightSource::Distant {
            frame,
            irradiance,
            half_angle,
        } => Light::Distant(DistantDisc::new(frame, irradiance, half_angle)),
        LightSource::Environment(environment) => Light::Environment(environment),
    })
}

impl Light {
    fn is_infinite(&self) -> bool {
        matches!(self, Self::Distant(_) | Self::Environment(_))
    }

    /// Flux in W, mean of the channels; of infinite lights what goes through a sphere of `radius`.
    fn power(&self, radius: f64) -> f64 {
        let disc = PI * radius * radius;
        match self {
            Self::Point { intensity, .. } => 4.0 * PI * f64::from(intensity.mean()),
            Self::Spot { intensity, cone, .. } => {
                PI * f64::from(intensity.mean() * (2.0 - cone.cos_inner - cone.cos_outer))
            }
            Self::Area { sampler, .. } => (0..self.piece_count())
                .map(|piece| self.power_of_area(sampler.piece(piece).area))
                .sum(),
            Self::Distant(light) if light.is_point() => disc * f64::from(light.radiance.mean()),
            Self::Distant(light) => disc * f64::from(light.radiance.mean() / light.pdf()),
            Self::Environment(environment) => disc * f64::from(environment.fluence().mean()),
        }
    }

    /// What `area` m² of a surface emit, W.
    fn power_of_area(&self, area: f64) -> f64 {
        match self {
            Self::Area { shine, two_sided, .. } => {
                PI * area * if *two_sided { 2.0 } else { 1.0 } * f64::from(shine.mean.mean())
            }
            _ => 0.0,
        }
    }

    /// Leaves of the tree that stand for the light.
    fn piece_count(&self) -> u32 {
        match self {
            Self::Area { sampler, .. } => sampler.piece_count(),
            _ => 1,
        }
    }

    fn bounds(&self, piece: u32) -> LightBounds {
        match self {
            Self::Area { sampler, two_sided, .. } => {
                let part = sampler.piece(piece);
                LightBounds {
                    bounds: part.bounds,
                    power: self.power_of_area(part.area) as f32,
                    facing: Facing {
                        axis: part.axis,
                        cos_spread: part.cos_spread,
                        cos_emission: 0.0,
                        two_sided: *two_sided,
                    },
                }
            }
            Self::Point { frame, .. } => LightBounds {
                bounds: frame.bounds(),
                power: self.power(0.0) as f32,
                facing: Facing::ANYWHERE,
            },
            Self::Spot { frame, cone, .. } => LightBounds {
                bounds: frame.bounds(),
                power: self.power(0.0) as f32,
                facing: if frame.moves() {
                    Facing::ANYWHERE
                } else {
                    Facing {
                        axis: -frame.back(0.0),
                        cos_spread: 1.0,
                        cos_emission: cone.cos_outer,
                        two_sided: false,
                    }
                },
            },
            Self::Distant(_) | Self::Environment(_) => unreachable!("infinite lights are not in the tree"),
        }
    }

    /// - `probability`: of this light.
    #[inline]
    fn sample_infinite(&self, u: Vec2, time: f32, probability: f32) -> LightSample {
        let (wi, radiance, pdf, delta) = match self {
            Self::Environment(environment) => {
                let (wi, pdf) = environment.sample(u);
                (wi, environment.radiance_from(wi), pdf, false)
            }
            Self::Distant(disc) => {
                let (wi, pdf) = disc.sample(u, time);
                (wi, disc.radiance, pdf, disc.is_point())
            }
            _ => unreachable!("only these are infinitely far away"),
        };
        LightSample {
            wi,
            radiance,
            pdf: probability * pdf,
            delta,
            target: Target::Infinity,
        }
    }

    /// - `probability`: of this piece.
    #[inline]
    fn sample_near(&self, from: Vec3, piece: u32, u: Vec2, time: f32, probability: f32) -> Option<LightSample> {
        match self {
            Self::Point { frame, intensity } => sample_point(from, frame.position(time), probability, |_| *intensity),
            Self::Spot { frame, intensity, cone } => {
                let axis = frame.back(time);
                sample_point(from, frame.position(time), probability, |wi| {
                    *intensity * cone.falloff(wi.dot(axis))
                })
            }
            Self::Area {
                sampler,
                shine,
                two_sided,
            } => {
                let sampled = sampler.sample_toward(from, piece, u, time)?;
                let on = &sampled.sample;
                let shines = *two_sided || sampled.sample.ng.dot(sampled.wi) < 0.0;
                let finite = sampled.pdf > 0.0 && sampled.pdf.is_finite();
                (shines && finite).then_some(LightSample {
                    wi: sampled.wi,
                    radiance: shine.at(sampler, on.primitive, on.p, on.uv, time),
                    pdf: probability * sampled.pdf,
                    delta: false,
                    target: Target::Point {
                        p: sampled.sample.p,
                        error: sampled.sample.error,
                        ng: sampled.sample.ng,
                    },
                })
            }
            Self::Distant(_) | Self::Environment(_) => None,
        }
    }
}

/// - `intensity`: as seen along the direction towards the light.
#[inline]
fn sample_point(
    from: Vec3,
    position: Vec3,
    probability: f32,
    intensity: impl FnOnce(Vec3) -> Rgb,
) -> Option<LightSample> {
    let offset = position - from;
    let distance_sq = offset.length_squared();
    if distance_sq <= 0.0 {
        return None;
    }
    let wi = offset / distance_sq.sqrt();
    let intensity = intensity(wi);
    (!intensity.is_black()).then_some(LightSample {
        wi,
        radiance: intensity * (1.0 / distance_sq),
        pdf: probability,
        delta: true,
        target: Target::Point {
            p: position,
            error: 0.0,
            ng: Vec3::ZERO,
        },
    })
}

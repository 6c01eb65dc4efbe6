use crate::light::{Light, LightTable};
use crate::projection::TargetSphere;
use glam::{Vec2, Vec3};
use radiometry::{Distribution, Frame, Rgb, SampleStream, StageKey, warp};
use spatial::{Ray, spawn_origin};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// A photon that has just left its light.
#[derive(Clone, Copy, Debug)]
pub struct EmittedPhoton {
    /// Where it flies.
    pub ray: Ray,
    /// Its flux in W, not yet divided by the number of photons emitted.
    pub flux: Rgb,
}

/// Emits photons from all lights, in proportion to power, aimed at target spheres.
///
/// A share of the photons leaves as the light shines (uniform emission); the rest is aimed at the cones that the targets
/// subtend from the sampled point of the light, in proportion to solid angle. The flux is divided by the density of the
/// mixture, so that a photon that lands in a cone by chance weighs the same as one that was aimed (one-sample balance
/// heuristic), and nothing is missed whatever the targets are.
///
/// Source of the idea: projection maps, Jensen, "Realistic Image Synthesis Using Photon Mapping", 2001, section 5.
/// Differs: spheres instead of a raster, and a defensive share, which keeps the estimate unbiased.
///
/// Aimed photons choose their light by the flux that it sends to the targets, not by its power: a sky of a hundred watts
/// of which a milliwatt meets the ring does not drown the lamp beside it.
pub struct EmissionSampler<'a> {
    lights: &'a LightTable,
    targets: &'a [TargetSphere],
    uniform_share: f32,
    /// Chooses the light of an aimed photon.
    aimed_choice: Distribution,
}

mod dimension {
    /// Choice of aim, light and target, and the direction: all from one pair, nested, so that the photons of each light
    /// and target are stratified over their directions. Where the way to the surface is smooth, so is their density.
    pub(super) const DIRECTION: u32 = 0;
    pub(super) const POSITION: u32 = 1;
    pub(super) const SIDE: u32 = 2;
    pub(super) const TIME: u32 = 3;
}

impl<'a> EmissionSampler<'a> {
    /// Emits as the lights shine, aiming at nothing.
    #[must_use]
    pub fn uniform(lights: &'a LightTable) -> Self {
        Self {
            lights,
            targets: &[],
            uniform_share: 1.0,
            aimed_choice: Distribution::default(),
        }
    }

    /// Aims at `targets`, but for the share `uniform_share` in (0, 1]; without targets everything is uniform.
    #[must_use]
    pub fn aimed(lights: &'a LightTable, targets: &'a [TargetSphere], uniform_share: f32) -> Self {
        let aimed_choice = Distribution::new(lights.iter().map(|light| flux_to_targets(light, targets)));
        let uniform_share = if aimed_choice.is_empty() {
            1.0
        } else {
            uniform_share.clamp(1e-3, 1.0)
        };
        Self {
            lights,
            targets,
            uniform_share,
            aimed_choice,
        }
    }

    /// Emits one photon; its numbers are those of bounce 0 of `stream`.
    ///
    /// `None` when this draw carries no flux; it counts as emitted all the same.
    #[must_use]
    pub fn emit(&self, stream: &SampleStream) -> Option<EmittedPhoton> {
        let u = stream.draw_2d(0, dimension::DIRECTION);
        let aims = u.x >= self.uniform_share;
        let (choice, u_choice) = if aims {
            (
                &self.aimed_choice,
                (u.x - self.uniform_share) / (1.0 - self.uniform_share),
            )
        } else {
            (self.lights.choice(), u.x / self.uniform_share)
        };
        let (row, _, rest) = choice.sample(u_choice)?;
        // Densities with which the light is chosen to shine as it does, and to aim.
        let uniform = self.uniform_share * self.lights.choice().probability(row);
        let aimed = (1.0 - self.uniform_share) * self.aimed_choice.probability(row);
        let draw = Draw {
            uniform,
            aimed,
            aims,
            u: Vec2::new(rest, u.y),
        };
        let time = stream.draw_1d(0, dimension::TIME);
        let (ray, flux) = match self.lights.light(row) {
            Light::Point { frame, intensity } => {
                let position = frame.position(time);
                let cones = Cones::seen_from(self.targets, position, None);
                let (direction, pdf) = draw.direction(&cones, Shine::Everywhere)?;
                (Ray::new(position, direction), *intensity * (1.0 / pdf))
            }
            Light::Spot { frame, intensity, cone } => {
                let (position, axis) = (frame.position(time), -frame.back(time));
                let cones = Cones::seen_from(self.targets, position, None);
                let shine = Shine::Cone {
                    axis,
                    one_minus_cos: cone.one_minus_cos(),
                };
                let (direction, pdf) = draw.direction(&cones, shine)?;
                let falloff = cone.falloff(direction, axis);
                (Ray::new(position, direction), *intensity * (falloff / pdf))
            }
            Light::Area {
                sampler,
                shine,
                two_sided,
            } => {
                let surface = sampler.sample_area(stream.draw_2d(0, dimension::POSITION), time);
                let (side, sides) = match (*two_sided, stream.draw_1d(0, dimension::SIDE) < 0.5) {
                    (false, _) => (1.0, 1.0),
                    (true, front) => (if front { 1.0 } else { -1.0 }, 2.0),
                };
                let normal = surface.ng * side;
                let cones = Cones::seen_from(self.targets, surface.p, Some(normal));
                let (direction, pdf) = draw.direction(&cones, Shine::Lambert(normal))?;
                let cos = direction.dot(normal);
                if cos <= 0.0 || surface.pdf_area <= 0.0 {
                    return None;
                }
                let origin = spawn_origin(surface.p, surface.error, surface.ng, direction);
                let radiance = shine.sent_at(sampler, surface.primitive, surface.p, surface.uv, time);
                let flux = radiance * (cos * sides / (surface.pdf_area * pdf));
                (Ray::new(origin, direction), flux)
            }
            Light::Distant(disc) => {
                let (from, pdf) = disc.sample(stream.draw_2d(0, dimension::POSITION), time);
                self.photon_from_afar(-from, disc.radiance * (1.0 / pdf), &draw)?
            }
            Light::Environment(environment) => {
                let (from, pdf) = environment.sample(stream.draw_2d(0, dimension::POSITION));
                self.photon_from_afar(-from, environment.radiance_from(from) * (1.0 / pdf), &draw)?
            }
        };
        let photon = EmittedPhoton {
            ray: Ray { time, ..ray },
            flux,
        };
        if flux.is_black() {
            return None;
        }
        photon.flux.is_finite().then_some(photon)
    }

    /// A photon of `irradiance` W·m⁻² across `direction`, and its flux.
    fn photon_from_afar(&self, direction: Vec3, irradiance: Rgb, draw: &Draw) -> Option<(Ray, Rgb)> {
        let (origin, pdf) = self.origin_at_infinity(direction, draw)?;
        Some((Ray::new(origin, direction), irradiance * (1.0 / pdf)))
    }

    /// A point outside the scene from where `direction` leads through it, and the density of light and point, per area
    /// across.
    fn origin_at_infinity(&self, direction: Vec3, draw: &Draw) -> Option<(Vec3, f32)> {
        let (centre, radius) = self.lights.bounding_sphere();
        if radius <= 0.0 {
            return None;
        }
        let frame = Frame::from_normal(direction);
        let across = |from: Vec3, r: f32, u: Vec2| {
            let disc = warp::sample_unit_disc(u);
            from + frame.x * (disc.x * r) + frame.y * (disc.y * r)
        };
        let discs: f32 = self.targets.iter().map(|t| t.radius * t.radius).sum();
        let through = if draw.aims {
            let (target, rest) = choose(self.targets, |t| t.radius * t.radius / discs, draw.u.x)?;
            across(target.centre, target.radius, Vec2::new(rest, draw.u.y))
        } else {
            across(centre, radius, draw.u)
        };
        let distance_sq_across = |c: Vec3| (through - c).reject_from_normalized(direction).length_squared();
        let in_scene = distance_sq_across(centre) <= radius * radius;
        let covering = self
            .targets
            .iter()
            .filter(|t| distance_sq_across(t.centre) <= t.radius * t.radius)
            .count();
        let uniform_pdf = if in_scene { FRAC_1_PI / (radius * radius) } else { 0.0 };
        let aimed_pdf = if discs > 0.0 {
            covering as f32 / (PI * discs)
        } else {
            0.0
        };
        let pdf = draw.uniform * uniform_pdf + draw.aimed * aimed_pdf;
        // Back along the ray to well outside the sphere around everything.
        let back = (through - centre).dot(direction) + 2.0 * radius;
        (pdf > 0.0).then_some((through - direction * back, pdf))
    }
}

/// One choice of a light, and of whether to aim.
struct Draw {
    /// Probability of this light without aim.
    uniform: f32,
    /// Probability of this light with aim.
    aimed: f32,
    aims: bool,
    /// What is left of the numbers after these choices; uniform in [0, 1).
    u: Vec2,
}

impl Draw {
    /// A direction, and the density of light and direction, per solid angle. `None` when it was to be aimed and no target
    /// is in view from here.
    fn direction(&self, cones: &Cones, shine: Shine) -> Option<(Vec3, f32)> {
        let direction = if self.aims {
            cones.sample(self.u)?
        } else {
            shine.sample(self.u)
        };
        let pdf = self.uniform * shine.pdf(direction) + self.aimed * cones.pdf(direction);
        (pdf > 0.0).then_some((direction, pdf))
    }
}

/// How light leaves a point when nothing aims it.
#[derive(Clone, Copy)]
enum Shine {
    Everywhere,
    /// In proportion to the cosine to a unit normal.
    Lambert(Vec3),
    /// Evenly into a cone around a unit axis.
    Cone {
        axis: Vec3,
        one_minus_cos: f32,
    },
}

impl Shine {
    fn sample(self, u: Vec2) -> Vec3 {
        match self {
            Self::Everywhere => warp::sample_uniform_sphere(u),
            Self::Lambert(n) => Frame::from_normal(n).world_from_local(warp::sample_cosine_hemisphere(u)),
            Self::Cone { axis, one_minus_cos } => Frame::from_normal(axis)
                .world_from_local(warp::sample_uniform_cone(u, one_minus_cos))
                .normalize(),
        }
    }

    fn pdf(self, direction: Vec3) -> f32 {
        match self {
            Self::Everywhere => warp::PDF_UNIFORM_SPHERE,
            Self::Lambert(n) => warp::pdf_cosine_hemisphere(n.dot(direction)),
            // Rounding may carry a sample out of the cone, where next to no light is.
            Self::Cone { axis, one_minus_cos } if 0.5 * (direction - axis).length_squared() <= one_minus_cos => {
                1.0 / (TAU * one_minus_cos)
            }
            Self::Cone { .. } => 0.0,
        }
    }
}

/// Chooses one of a few items by probabilities that add up to 1; also returns `u` stretched back over [0, 1).
fn choose<T>(items: &[T], probability: impl Fn(&T) -> f32, u: f32) -> Option<(&T, f32)> {
    let mut below = 0.0;
    for (i, item) in items.iter().enumerate() {
        let p = probability(item);
        if u < below + p || i + 1 == items.len() {
            return Some((item, ((u - below) / p).clamp(0.0, 1.0 - f32::EPSILON)));
        }
        below += p;
    }
    None
}

/// Roughly the flux that a light sends to the targets, in W. Zero where no probe sees one: then uniform emission has to do.
fn flux_to_targets(light: &Light, targets: &[TargetSphere]) -> f64 {
    /// Points of an area light that are asked.
    const PROBES: u32 = 16;
    /// When moving lights are asked.
    const TIME: f32 = 0.5;
    let discs = || PI * targets.iter().map(|t| t.radius * t.radius).sum::<f32>();
    let flux = match light {
        Light::Point { frame, intensity } => {
            intensity.mean() * Cones::seen_from(targets, frame.position(TIME), None).solid_angle
        }
        Light::Spot { frame, intensity, cone } => {
            let cones = Cones::seen_from(targets, frame.position(TIME), None);
            let axis = -frame.back(TIME);
            intensity.mean() * cones.weighted(|direction| cone.falloff(direction, axis))
        }
        Light::Area {
            sampler,
            shine,
            two_sided,
        } => {
            let key = StageKey::new("flux to targets");
            let probe = |i: u32| {
                let surface = sampler.sample_area(SampleStream::new(0, key, 0, i).draw_2d(0, 0), TIME);
                let cones = |n: Vec3| Cones::seen_from(targets, surface.p, Some(n)).weighted(|d| d.dot(n));
                cones(surface.ng) + if *two_sided { cones(-surface.ng) } else { 0.0 }
            };
            let mean = (0..PROBES).map(probe).sum::<f32>() / PROBES as f32;
            shine.mean_sent().mean() * sampler.area() as f32 * mean
        }
        Light::Distant(disc) => {
            let (_, pdf) = disc.sample(Vec2::splat(0.5), TIME);
            disc.radiance.mean() / pdf * discs()
        }
        Light::Environment(environment) => environment.fluence().mean() * discs(),
    };
    f64::from(flux)
}

/// The cones that targets subtend from one point, all that are not wholly behind its surface.
struct Cones {
    cones: [(Vec3, f32); crate::MAX_TARGETS],
    count: usize,
    solid_angle: f32,
}

impl Cones {
    fn seen_from(targets: &[TargetSphere], from: Vec3, normal: Option<Vec3>) -> Self {
        let mut out = Self {
            cones: [(Vec3::Z, 0.0); crate::MAX_TARGETS],
            count: 0,
            solid_angle: 0.0,
        };
        for target in targets {
            let offset = target.centre - from;
            if normal.is_some_and(|n| offset.dot(n) <= -target.radius) {
                continue;
            }
            let distance = offset.length();
            let one_minus_cos = warp::one_minus_cos_of_sphere(target.radius, distance);
            if one_minus_cos > 0.0 && out.count < out.cones.len() {
                let axis = if distance > 0.0 { offset / distance } else { Vec3::Z };
                out.cones[out.count] = (axis, one_minus_cos);
                out.count += 1;
                out.solid_angle += TAU * one_minus_cos;
            }
        }
        out
    }

    fn all(&self) -> &[(Vec3, f32)] {
        &self.cones[..self.count]
    }

    fn sample(&self, u: Vec2) -> Option<Vec3> {
        let share = |(_, one_minus_cos): &(Vec3, f32)| TAU * one_minus_cos / self.solid_angle;
        let ((axis, one_minus_cos), rest) = choose(self.all(), share, u.x)?;
        let local = warp::sample_uniform_cone(Vec2::new(rest, u.y), *one_minus_cos);
        Some(Frame::from_normal(*axis).world_from_local(local).normalize())
    }

    /// Solid angles weighted by a function of their axes, but never with less than a twentieth: a cone whose axis is below
    /// the horizon can still reach above it.
    fn weighted(&self, weight: impl Fn(Vec3) -> f32) -> f32 {
        self.all()
            .iter()
            .map(|(axis, one_minus_cos)| TAU * one_minus_cos * weight(*axis).max(0.05))
            .sum()
    }

    /// Density of [`Cones::sample`]: cones that hold the direction, over the solid angle of all of them.
    fn pdf(&self, direction: Vec3) -> f32 {
        let covering = self.all().iter().filter(|(axis, one_minus_cos)| {
            // 1 − cos of a small angle through its chord: |a − b|² = 2 (1 − cos).
            0.5 * (direction - *axis).length_squared() <= *one_minus_cos
        });
        if self.count == 0 {
            0.0
        } else {
            covering.count() as f32 / self.solid_angle
        }
    }
}

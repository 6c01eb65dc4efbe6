use crate::scene::bounding_sphere;
use glam::{Vec2, Vec3};
use radiometry::{Distribution, Rgb, warp};
use spatial::{Ray, RayScene, SurfacePoint, SurfaceSampler};
use std::f64::consts::PI;

/// A light, as the tables are built from it.
#[derive(Clone, Copy, Debug)]
pub enum LightSource {
    /// A point that shines alike in all directions.
    Point {
        /// World space, metres.
        position: Vec3,
        /// W·sr⁻¹.
        intensity: Rgb,
    },
    /// A surface that shines by Lambert's law.
    Area {
        /// Row of the instance whose surface shines.
        instance: u32,
        /// W·m⁻²·sr⁻¹.
        radiance: Rgb,
        /// Shines on both sides; otherwise on that of the geometric normal.
        two_sided: bool,
    },
    /// All directions in which there is nothing else.
    Environment {
        /// W·m⁻²·sr⁻¹.
        radiance: Rgb,
    },
}

/// A light sampled from a point.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub wi: Vec3,
    /// Radiance that arrives when nothing is in the way; for a point light intensity over squared distance.
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
        match self.target {
            Target::Point { p, error, ng } => spatial::connect(point.p, point.error, point.ng, p, error, ng),
            Target::Infinity => Ray::new(spatial::spawn_origin(point.p, point.error, point.ng, self.wi), self.wi),
        }
    }
}

pub(crate) enum Light {
    Point {
        position: Vec3,
        intensity: Rgb,
    },
    Area {
        sampler: Box<SurfaceSampler>,
        radiance: Rgb,
        two_sided: bool,
    },
    Environment {
        radiance: Rgb,
    },
}

/// All lights, chosen in proportion to their power.
pub struct LightTable {
    lights: Vec<Light>,
    choice: Distribution,
    /// How lights are chosen as seen from a point.
    sampled_choice: Distribution,
    /// Row of the light on each instance, or `NONE`.
    light_of_instance: Vec<u32>,
    environment: Option<u32>,
    bounding_sphere: (Vec3, f32),
}

const NONE: u32 = u32::MAX;

impl LightTable {
    /// Builds the table. Lights without power (black, or without area) are left out.
    #[must_use]
    pub fn new(rays: &RayScene, sources: Vec<LightSource>) -> Self {
        let bounding_sphere = bounding_sphere(rays);
        let mut table = Self {
            lights: Vec::new(),
            choice: Distribution::default(),
            sampled_choice: Distribution::default(),
            light_of_instance: vec![NONE; rays.instance_count()],
            environment: None,
            bounding_sphere,
        };
        let mut powers = Vec::new();
        for source in sources {
            let row = table.lights.len() as u32;
            let (light, power) = match source {
                LightSource::Point { position, intensity } => (
                    Light::Point { position, intensity },
                    4.0 * PI * f64::from(intensity.mean()),
                ),
                LightSource::Area {
                    instance,
                    radiance,
                    two_sided,
                } => {
                    let Some(sampler) = SurfaceSampler::new(rays, instance).map(Box::new) else {
                        continue;
                    };
                    let sides = if two_sided { 2.0 } else { 1.0 };
                    let power = PI * sampler.area() * sides * f64::from(radiance.mean());
                    (
                        Light::Area {
                            sampler,
                            radiance,
                            two_sided,
                        },
                        power,
                    )
                }
                LightSource::Environment { radiance } => {
                    // What a uniform environment sends through the sphere around the scene; a scene without geometry
                    // gets a unit sphere, so that the light can still be chosen.
                    let radius = if bounding_sphere.1 > 0.0 {
                        f64::from(bounding_sphere.1)
                    } else {
                        1.0
                    };
                    (
                        Light::Environment { radiance },
                        4.0 * PI * PI * radius * radius * f64::from(radiance.mean()),
                    )
                }
            };
            if power <= 0.0 {
                continue;
            }
            match source {
                LightSource::Area { instance, .. } => table.light_of_instance[instance as usize] = row,
                LightSource::Environment { .. } => table.environment = Some(row),
                LightSource::Point { .. } => {}
            }
            table.lights.push(light);
            powers.push(power);
        }
        table.choice = Distribution::new(powers.iter().copied());
        table.sampled_choice = Distribution::new(sampling_weights(powers, table.environment));
        table
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
    /// - `u_choice`, `u`: uniform in [0, 1).
    ///
    /// `None` when there is no light, or the sampled point of it does not shine this way.
    #[must_use]
    pub fn sample(&self, from: Vec3, u_choice: f32, u: Vec2) -> Option<LightSample> {
        let (row, probability, _) = self.sampled_choice.sample(u_choice)?;
        match &self.lights[row] {
            Light::Point { position, intensity } => {
                let offset = *position - from;
                let distance_sq = offset.length_squared();
                if distance_sq <= 0.0 {
                    return None;
                }
                Some(LightSample {
                    wi: offset / distance_sq.sqrt(),
                    radiance: *intensity * (1.0 / distance_sq),
                    pdf: probability,
                    delta: true,
                    target: Target::Point {
                        p: *position,
                        error: 0.0,
                        ng: Vec3::ZERO,
                    },
                })
            }
            Light::Area {
                sampler,
                radiance,
                two_sided,
            } => {
                let sampled = sampler.sample_toward(from, u)?;
                let shines = *two_sided || sampled.sample.ng.dot(sampled.wi) < 0.0;
                let finite = sampled.pdf > 0.0 && sampled.pdf.is_finite();
                (shines && finite).then_some(LightSample {
                    wi: sampled.wi,
                    radiance: *radiance,
                    pdf: probability * sampled.pdf,
                    delta: false,
                    target: Target::Point {
                        p: sampled.sample.p,
                        error: sampled.sample.error,
                        ng: sampled.sample.ng,
                    },
                })
            }
            Light::Environment { radiance } => Some(LightSample {
                wi: warp::sample_uniform_sphere(u),
                radiance: *radiance,
                pdf: probability * warp::PDF_UNIFORM_SPHERE,
                delta: false,
                target: Target::Infinity,
            }),
        }
    }

    /// Radiance that leaves a hit surface towards `wo`; black where it does not shine.
    #[inline]
    #[must_use]
    pub fn emitted(&self, point: &SurfacePoint, wo: Vec3) -> Rgb {
        match self.light_of(point) {
            Some(Light::Area {
                radiance, two_sided, ..
            }) if *two_sided || point.ng.dot(wo) > 0.0 => *radiance,
            _ => Rgb::BLACK,
        }
    }

    /// Density per solid angle with which [`LightTable::sample`] from `from` would have found this surface point.
    #[inline]
    #[must_use]
    pub fn pdf_emitted(&self, from: Vec3, point: &SurfacePoint) -> f32 {
        match self.light_of(point) {
            Some(Light::Area { sampler, .. }) => {
                let row = self.light_of_instance[point.instance as usize] as usize;
                self.sampled_choice.probability(row) * sampler.pdf_toward(from, point)
            }
            _ => 0.0,
        }
    }

    /// Radiance of the environment, and the density with which [`LightTable::sample`] finds a direction of it.
    #[inline]
    #[must_use]
    pub fn environment(&self) -> Option<(Rgb, f32)> {
        let row = self.environment? as usize;
        match &self.lights[row] {
            Light::Environment { radiance } => {
                Some((*radiance, self.sampled_choice.probability(row) * warp::PDF_UNIFORM_SPHERE))
            }
            _ => None,
        }
    }

    #[inline]
    fn light_of(&self, point: &SurfacePoint) -> Option<&Light> {
        match self.light_of_instance[point.instance as usize] {
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
}

/// Weights by which a point chooses a light: power, but an environment at most as much as all other lights together.
///
/// The power of an environment grows with the size of the scene, not so the light that it sends to a point of it: over a
/// wide floor, a lamp that lights what one looks at would hardly ever be chosen.
fn sampling_weights(mut powers: Vec<f64>, environment: Option<u32>) -> Vec<f64> {
    if let Some(row) = environment {
        let others = powers.iter().sum::<f64>() - powers[row as usize];
        if others > 0.0 {
            powers[row as usize] = powers[row as usize].min(others);
        }
    }
    powers
}

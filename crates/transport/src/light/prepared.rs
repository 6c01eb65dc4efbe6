use super::distant::DistantDisc;
use super::sample::{LightSample, Target};
use super::tree::{Facing, LightBounds};
use super::{Environment, LightSource, SpotCone};
use crate::TexturedSurface;
use crate::frame::MovingFrame;
use glam::{Vec2, Vec3};
use radiometry::{Rgb, SampleStream, StageKey};
use spatial::{RayScene, SurfaceSampler};
use std::f64::consts::PI;
use std::sync::Arc;
use texture::Texture;

/// Radiance of a surface.
pub(crate) struct SurfaceRadiance {
    /// W·m⁻²·sr⁻¹; of a texture the mean.
    pub(crate) mean: Rgb,
    texture: Option<Arc<Texture>>,
    /// A surface that is not whole, of which only what is there shines. Rays that meet it are thinned already, so only
    /// points that are sampled ask.
    coverage: Option<Arc<TexturedSurface>>,
    /// How much of the surface is there on average, in [0, 1].
    mean_coverage: f32,
}

impl SurfaceRadiance {
    /// Points that are asked how much of the surface is there.
    const PROBES: u32 = 256;

    fn new(
        sampler: &SurfaceSampler,
        mean: Rgb,
        texture: Option<Arc<Texture>>,
        coverage: Option<Arc<TexturedSurface>>,
    ) -> Self {
        let mut shine = Self {
            mean,
            texture,
            coverage,
            mean_coverage: 1.0,
        };
        let Some(coverage) = &shine.coverage else { return shine };
        shine.mean_coverage = if coverage.is_nowhere() {
            0.0
        } else {
            let probe = |i: u32| {
                let u = SampleStream::new(0, StageKey::new("coverage"), 0, i).draw_2d(0, 0);
                let on = sampler.sample_area(u, 0.0);
                shine.coverage_at(sampler, on.primitive, on.p, on.uv, 0.0)
            };
            let mean = (0..Self::PROBES).map(probe).sum::<f32>() / Self::PROBES as f32;
            // What no probe met may be there all the same.
            mean.max(1.0 / Self::PROBES as f32)
        };
        shine
    }

    /// Mean radiance of the whole surface, holes included, W·m⁻²·sr⁻¹.
    pub(crate) fn mean_sent(&self) -> Rgb {
        self.mean * self.mean_coverage
    }

    /// Bounds the radiance of every point, channel by channel.
    fn brightest(&self) -> Rgb {
        self.texture.as_ref().map_or(self.mean, |texture| texture.max_rgb())
    }

    /// How much of the surface is there at a point, in [0, 1].
    #[inline]
    fn coverage_at(&self, sampler: &SurfaceSampler, primitive: u32, p: Vec3, uv: Vec2, time: f32) -> f32 {
        self.coverage.as_ref().map_or(1.0, |surface| {
            let vertex_alpha = || sampler.vertex_colour(primitive, p, time).w;
            surface.alpha_at(|set| sampler.uv_set(primitive, p, uv, time, set), vertex_alpha)
        })
    }

    /// [`SurfaceRadiance::at`] a point that was sampled: what is not there sends nothing.
    #[inline]
    pub(crate) fn sent_at(&self, sampler: &SurfaceSampler, primitive: u32, p: Vec3, uv: Vec2, time: f32) -> Rgb {
        self.at(sampler, primitive, p, uv, time) * self.coverage_at(sampler, primitive, p, uv, time)
    }

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

/// A light with what it takes to sample it.
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

impl Light {
    /// `None` for a surface without area.
    ///
    /// - `coverage`: of an instance that is not whole.
    pub(super) fn prepare(
        rays: &RayScene,
        source: LightSource,
        coverage: impl Fn(u32) -> Option<Arc<TexturedSurface>>,
    ) -> Option<Self> {
        Some(match source {
            LightSource::Point { frame, intensity } => Self::Point { frame, intensity },
            LightSource::Spot { frame, intensity, cone } => Self::Spot { frame, intensity, cone },
            LightSource::Area {
                instance,
                radiance,
                texture,
                two_sided,
            } => {
                let sampler = Box::new(SurfaceSampler::new(rays, instance)?);
                Self::Area {
                    shine: SurfaceRadiance::new(&sampler, radiance, texture, coverage(instance)),
                    sampler,
                    two_sided,
                }
            }
            LightSource::Distant {
                frame,
                irradiance,
                half_angle,
            } => Self::Distant(DistantDisc::new(frame, irradiance, half_angle)),
            LightSource::Environment(environment) => Self::Environment(environment),
        })
    }

    pub(super) fn is_infinite(&self) -> bool {
        matches!(self, Self::Distant(_) | Self::Environment(_))
    }

    /// Flux in W, mean of the channels; of infinite lights what goes through a sphere of `radius`.
    pub(super) fn power(&self, radius: f64) -> f64 {
        let disc = PI * radius * radius;
        match self {
            Self::Point { intensity, .. } => 4.0 * PI * f64::from(intensity.mean()),
            Self::Spot { intensity, cone, .. } => f64::from(intensity.mean() * cone.solid_angle()),
            Self::Area { sampler, .. } => self.power_of_area(sampler.area()),
            Self::Distant(light) if light.is_point() => disc * f64::from(light.radiance.mean()),
            Self::Distant(light) => disc * f64::from(light.radiance.mean() / light.pdf()),
            Self::Environment(environment) => disc * f64::from(environment.fluence().mean()),
        }
    }

    /// The largest radiance, in any channel, that a ray may meet; infinite where none meets the light.
    pub(super) fn brightest(&self) -> f32 {
        match self {
            Self::Point { .. } | Self::Spot { .. } => f32::INFINITY,
            Self::Area { shine, .. } => shine.brightest().max_element(),
            Self::Distant(light) if light.is_point() => f32::INFINITY,
            Self::Distant(light) => light.radiance.max_element(),
            Self::Environment(environment) => environment.brightest(),
        }
    }

    /// What `area` m² of a surface emit, W.
    fn power_of_area(&self, area: f64) -> f64 {
        match self {
            Self::Area { shine, two_sided, .. } => {
                PI * area * if *two_sided { 2.0 } else { 1.0 } * f64::from(shine.mean_sent().mean())
            }
            _ => 0.0,
        }
    }

    /// Leaves of the tree that stand for the light.
    pub(super) fn piece_count(&self) -> u32 {
        match self {
            Self::Area { sampler, .. } => sampler.piece_count(),
            _ => 1,
        }
    }

    pub(super) fn bounds(&self, piece: u32) -> LightBounds {
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
                        // Rounding must not hide the light from where a narrow cone reaches.
                        cos_emission: 1.0 - cone.one_minus_cos() - 1e-6,
                        two_sided: false,
                    }
                },
            },
            Self::Distant(_) | Self::Environment(_) => unreachable!("infinite lights are not in the tree"),
        }
    }

    /// - `probability`: of this light.
    #[inline]
    pub(super) fn sample_infinite(&self, u: Vec2, time: f32, probability: f32) -> LightSample {
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
    pub(super) fn sample_near(
        &self,
        from: Vec3,
        piece: u32,
        u: Vec2,
        time: f32,
        probability: f32,
    ) -> Option<LightSample> {
        match self {
            Self::Point { frame, intensity } => {
                LightSample::of_point(from, frame.position(time), probability, |_| *intensity)
            }
            Self::Spot { frame, intensity, cone } => {
                let axis = frame.back(time);
                LightSample::of_point(from, frame.position(time), probability, |wi| {
                    *intensity * cone.falloff(wi, axis)
                })
            }
            Self::Area {
                sampler,
                shine,
                two_sided,
            } => {
                let sampled = sampler.sample_toward(from, piece, u, time)?;
                let on = &sampled.sample;
                let shines = *two_sided || on.ng.dot(sampled.wi) < 0.0;
                let finite = sampled.pdf > 0.0 && sampled.pdf.is_finite();
                (shines && finite).then_some(LightSample {
                    wi: sampled.wi,
                    radiance: shine.sent_at(sampler, on.primitive, on.p, on.uv, time),
                    pdf: probability * sampled.pdf,
                    delta: false,
                    target: Target::Point {
                        p: on.p,
                        error: on.error,
                        ng: on.ng,
                    },
                })
            }
            Self::Distant(_) | Self::Environment(_) => None,
        }
    }
}

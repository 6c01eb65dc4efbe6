//! Irradiance: sampled over the hemisphere of a surface point, kept in records, and interpolated between them.
//!
//! Indirect light changes slowly over matt surfaces. So it is computed at few places, well, and every other place takes a
//! mean of the records near it. A record holds the irradiance E of *indirect* light alone: light that came over at least one
//! other D vertex. What comes from lamps, straight or over S vertices, adds nothing to it.
//!
//! - [`Hemisphere`] sends rays over a stratified hemisphere; [`Site`] is where they start.
//! - [`summarize`] makes a record of what they saw: E, how it changes when the normal turns and when the place moves, and
//!   how far the record holds.
//! - [`IrradianceCache`] keeps records and interpolates between those that hold at a place.
//! - [`reflect_irradiance`] is what the eye sees of them.
//!
//! Source: Ward, Rubinstein and Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988; Ward and
//! Heckbert, "Irradiance Gradients", EGWR 1992; Křivánek, Bouatouch, Pattanaik and Žára, "Making Radiance and Irradiance
//! Caching Practical", EGSR 2006.

mod cache;
mod clamp;
mod gradient;
mod hemisphere;
mod hessian;
mod interpolate;
mod reflect;
mod strata;
mod summary;
#[cfg(test)]
mod tests;

use glam::Vec3;
use radiometry::Rgb;
use std::array;

pub use cache::{CacheSettings, IrradianceCache};
pub use hemisphere::{Hemisphere, HemisphereSample, RecordRays, Site};
pub use interpolate::Interpolated;
pub use reflect::{CacheAnswer, find_deep_sites, find_sites, reflect_irradiance};
pub use summary::{Spacing, summarize};

/// How the distance is found within which a record holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorMetric {
    /// By how fast the gradient of the light changes.
    OcclusionHessian,
    /// By how far what the rays met is away.
    HarmonicMean,
}

impl ErrorMetric {
    /// How much faster than the distance a range may grow from record to record, and how many ranges make the distance over which a
    /// linear change doubles or ends the light: ranges by the harmonic mean are distances of things; those by the Hessian reach half
    /// as far as the nearest thing, at 1/a = 10, and no further.
    pub(super) fn ranges_per_distance(self) -> f32 {
        match self {
            Self::OcclusionHessian => 5.0,
            Self::HarmonicMean => 1.0,
        }
    }
}

/// A gradient of irradiance, channel by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct RgbGradient(pub [Vec3; 3]);

impl RgbGradient {
    /// The change along a step, linear.
    #[inline]
    #[must_use]
    pub fn along(&self, step: Vec3) -> Rgb {
        let [r, g, b] = self.0.map(|channel| channel.dot(step));
        Rgb::new(r, g, b)
    }

    /// Adds `step` times the value of each channel.
    #[inline]
    pub(crate) fn add(&mut self, step: Vec3, value: Rgb) {
        for (gradient, value) in self.0.iter_mut().zip(value.to_array()) {
            *gradient += step * value;
        }
    }

    /// Of the mean of the channels.
    #[inline]
    pub(crate) fn mean(&self) -> Vec3 {
        (self.0[0] + self.0[1] + self.0[2]) * (1.0 / 3.0)
    }

    /// Turned from a local frame into the world.
    pub(crate) fn map(self, turn: impl Fn(Vec3) -> Vec3) -> Self {
        Self(array::from_fn(|channel| turn(self.0[channel])))
    }
}

/// Irradiance of indirect light at a place of a surface, and how far it holds. 120 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct IrradianceRecord {
    /// World space, metres.
    pub position: Vec3,
    /// Unit shading normal, on the side that light comes from.
    pub normal: Vec3,
    /// E, W·m⁻².
    pub irradiance: Rgb,
    /// How E changes as the normal turns by a vector angle: W·m⁻² per radian.
    pub rotation: RgbGradient,
    /// How E changes as the place moves: W·m⁻² per metre.
    pub translation: RgbGradient,
    /// r, metres: 1/a times the radius within which the record holds. By the harmonic mean, about the distance at which E has
    /// changed by itself. Neighbours may lower it.
    pub range: f32,
    /// The range counts as no less than this, so that corners do not fill up with records, metres.
    pub least_range: f32,
    /// Distance of the nearest thing that a ray has met, metres; infinite where none has. What is much nearer to the record has
    /// nothing in between.
    pub nearest: f32,
}

impl IrradianceRecord {
    /// The range that counts, metres.
    #[inline]
    #[must_use]
    pub fn effective_range(&self) -> f32 {
        self.range.max(self.least_range)
    }
}

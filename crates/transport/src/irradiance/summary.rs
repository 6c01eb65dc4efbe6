use super::gradient::{rotational, translational};
use super::{Hemisphere, HemisphereSample, IrradianceRecord, RgbGradient, Site};
use radiometry::{Frame, Rgb};

/// How near and how far apart records may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// Least radius within which a record holds, in pixels as they are seen.
    pub min_pixels: f32,
    /// Largest such radius, in pixels, at least the least.
    pub max_pixels: f32,
    /// A record holds within 1/`min_weight` of its range.
    pub min_weight: f32,
    /// No range is more than this: the extent of the scene, metres.
    pub most: f32,
}

/// Makes a record of what the rays of a hemisphere saw.
///
/// `E = π/(T P) Σ L`; `r = T P/Σ 1/d`, the harmonic mean of the distances, an escaped ray with 1/d = 0; no more than
/// `E/|∇_t E|`, where a linear change would have doubled or ended the light.
///
/// Source: Ward, Rubinstein and Clear 1988; the limit by the gradient as in Ward's Radiance.
///
/// - `samples`: ring by ring.
/// - `gradients`: whether to compute them; else they are zero.
/// - returns `None` where a ray saw what is no number, or the samples are not those of the hemisphere.
#[must_use]
pub fn summarize(
    hemisphere: &Hemisphere,
    samples: &[HemisphereSample],
    site: &Site,
    spacing: &Spacing,
    gradients: bool,
) -> Option<IrradianceRecord> {
    let light: Rgb = samples.iter().map(|sample| sample.radiance).sum();
    let irradiance = light * hemisphere.weight();
    let near: f32 = samples.iter().map(|sample| sample.inverse_distance).sum();
    if !irradiance.is_finite() || near.is_nan() || samples.len() != hemisphere.rays() as usize {
        return None;
    }
    let mut range = (samples.len() as f32 / near.max(f32::MIN_POSITIVE)).min(spacing.most);
    let (mut rotation, mut translation) = <(RgbGradient, RgbGradient)>::default();
    if gradients {
        let frame = Frame::from_normal(site.normal);
        rotation = rotational(hemisphere, samples).map(|v| frame.world_from_local(v));
        translation = translational(hemisphere, samples).map(|v| frame.world_from_local(v));
        let steepness = translation.mean().length();
        if steepness > 0.0 {
            range = range.min(irradiance.mean() / steepness);
        }
    }
    let least_range = (spacing.min_pixels * site.pixel * spacing.min_weight).min(spacing.most);
    let most_range = (spacing.max_pixels * site.pixel * spacing.min_weight).max(least_range);
    let nearest = samples.iter().map(|sample| sample.inverse_distance).fold(0.0, f32::max);
    let is_finite = [rotation, translation]
        .iter()
        .all(|g| g.0.iter().all(|v| v.is_finite()));
    is_finite.then_some(IrradianceRecord {
        position: site.position,
        normal: site.normal,
        irradiance,
        rotation,
        translation,
        range: range.min(most_range).max(f32::MIN_POSITIVE),
        least_range,
        nearest: 1.0 / nearest,
    })
}

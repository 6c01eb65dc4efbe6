//! Reconstruction filters, sampled in proportion to their value.
//!
//! A sample that is thrown with the filter's density and added with weight 1 touches one pixel only,
//! which is what lets the film be cut into independent spans. Source: Ernst, Stamminger, Greiner,
//! "Filter Importance Sampling", IEEE Symposium on Interactive Ray Tracing 2006.

use glam::Vec2;

/// The shape of a reconstruction filter. All are non-negative, symmetric and separable.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FilterKind {
    /// Constant. Sharp and prone to aliasing; radius 0.5 is the plain pixel area.
    Box,
    /// Falls linearly to zero at the radius.
    Triangle,
    /// exp(−x²/2σ²) with σ = radius/3, lowered so that it ends at zero.
    Gaussian,
    /// Four-term Blackman–Harris window; sharp with next to no ringing or aliasing.
    /// Source: Harris, "On the Use of Windows for Harmonic Analysis with the DFT", Proc. IEEE 1978.
    #[default]
    BlackmanHarris,
}

/// Cells of the table over half the support. The density is taken as linear within a cell, which at
/// this number is within 10⁻⁵ of the peak.
const CELLS: usize = 512;

/// Draws offsets from a pixel centre with the density of a filter.
///
/// Box and triangle invert their distribution in closed form, the others through a table of the
/// cumulative distribution over half the (symmetric) support. Made once a render; 8 KB.
#[derive(Clone, Debug)]
pub struct FilterSampler {
    kind: FilterKind,
    radius: f64,
    /// Normalised density at the cell borders, over t = |x| / radius, integrating to 1 over 0 ..= 1.
    density: Vec<f64>,
    /// Integral of `density` from 0 to each cell border; ends with 1.
    cumulative: Vec<f64>,
    /// What the raw shape integrates to over 0 ..= 1.
    mass: f64,
}

impl FilterSampler {
    /// Tabulates a filter.
    ///
    /// - `radius`: half the width of the support, pixels, finite and above 0; with a wider one the image
    ///   is smoother and edges are softer.
    ///
    /// # Panics
    ///
    /// If the radius is out of range.
    #[must_use]
    pub fn new(kind: FilterKind, radius: f32) -> Self {
        assert!(
            radius > 0.0 && radius.is_finite(),
            "filter radius {radius} is out of range"
        );
        let width = 1.0 / CELLS as f64;
        let mut density: Vec<f64> = (0..=CELLS).map(|border| shape(kind, border as f64 * width)).collect();
        let mut cumulative = Vec::with_capacity(CELLS + 1);
        let mut mass = 0.0;
        cumulative.push(mass);
        for pair in density.windows(2) {
            mass += 0.5 * (pair[0] + pair[1]) * width;
            cumulative.push(mass);
        }
        density
            .iter_mut()
            .chain(&mut cumulative)
            .for_each(|value| *value /= mass);
        Self {
            kind,
            radius: f64::from(radius),
            density,
            cumulative,
            mass,
        }
    }

    /// Returns the shape.
    #[must_use]
    pub fn kind(&self) -> FilterKind {
        self.kind
    }

    /// Returns the radius in pixels.
    #[must_use]
    pub fn radius(&self) -> f32 {
        self.radius as f32
    }

    /// Maps two uniform numbers to an offset from the pixel centre.
    ///
    /// - `u`: each in 0 .. 1; a stratified set stays stratified.
    /// - returns an offset in pixels, each component within ± radius, with the density
    ///   [`FilterSampler::eval`]; the sample's weight is 1.
    ///
    /// Deterministic: additions, products and square roots in `f64` only. Cost: a binary search of nine
    /// steps an axis for the tabulated shapes.
    #[must_use]
    pub fn sample(&self, u: Vec2) -> Vec2 {
        Vec2::new(self.sample_axis(u.x), self.sample_axis(u.y))
    }

    /// Returns the filter's value, normalised to integrate to 1 over the plane.
    ///
    /// - `offset`: from the pixel centre, in pixels.
    /// - returns pixel⁻²; 0 outside the support.
    #[must_use]
    pub fn eval(&self, offset: Vec2) -> f32 {
        (self.eval_axis(offset.x) * self.eval_axis(offset.y)) as f32
    }

    fn eval_axis(&self, x: f32) -> f64 {
        let t = f64::from(x).abs() / self.radius;
        if t > 1.0 {
            0.0
        } else {
            shape(self.kind, t) / (2.0 * self.mass * self.radius)
        }
    }

    fn sample_axis(&self, u: f32) -> f32 {
        // The lower half of the numbers mirrors the upper half, so the offsets are symmetric exactly.
        let signed = 2.0 * f64::from(u) - 1.0;
        let below = signed.abs().min(1.0);
        let t = match self.kind {
            FilterKind::Box => below,
            FilterKind::Triangle => 1.0 - (1.0 - below).sqrt(),
            FilterKind::Gaussian | FilterKind::BlackmanHarris => self.invert(below),
        };
        (t.clamp(0.0, 1.0) * self.radius).copysign(signed) as f32
    }

    /// Finds t with cumulative(t) = `below`.
    fn invert(&self, below: f64) -> f64 {
        let cell = self.cumulative.partition_point(|&c| c <= below).clamp(1, CELLS) - 1;
        let width = 1.0 / CELLS as f64;
        let (start, end) = (self.density[cell], self.density[cell + 1]);
        // start·s + (end − start)/(2 width)·s² = area, in the form that does not cancel.
        let area = below - self.cumulative[cell];
        let root = (start * start + 2.0 * (end - start) / width * area).max(0.0).sqrt();
        let denominator = start + root;
        let step = if denominator > 0.0 {
            2.0 * area / denominator
        } else {
            width
        };
        cell as f64 * width + step.clamp(0.0, width)
    }
}

/// The unnormalised shape at t = |x| / radius in 0 ..= 1.
fn shape(kind: FilterKind, t: f64) -> f64 {
    match kind {
        FilterKind::Box => 1.0,
        FilterKind::Triangle => 1.0 - t,
        // (t · 3σ)² / 2σ² = 4.5 t².
        FilterKind::Gaussian => (libm::exp(-4.5 * t * t) - libm::exp(-4.5)).max(0.0),
        FilterKind::BlackmanHarris => {
            // The window runs over 0 ..= 1 with its peak at one half; here t = 0 is the peak.
            let phase = std::f64::consts::PI * (t + 1.0);
            let term = |n: f64| libm::cos(n * phase);
            (0.35875 - 0.48829 * term(1.0) + 0.14128 * term(2.0) - 0.01168 * term(3.0)).max(0.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [FilterKind; 4] = [
        FilterKind::Box,
        FilterKind::Triangle,
        FilterKind::Gaussian,
        FilterKind::BlackmanHarris,
    ];

    fn uniform(index: u64) -> f32 {
        let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }

    /// Mean of `eval` over a cell, by the midpoint rule.
    fn cell_probability(sampler: &FilterSampler, min: Vec2, size: f32) -> f64 {
        const STEPS: usize = 16;
        let step = size / STEPS as f32;
        let at = |i: usize| (i as f32 + 0.5) * step;
        let values = (0..STEPS * STEPS).map(|i| f64::from(sampler.eval(min + Vec2::new(at(i % STEPS), at(i / STEPS)))));
        values.sum::<f64>() * f64::from(step) * f64::from(step)
    }

    #[test]
    fn histogram_follows_the_filter() {
        const BINS: usize = 16;
        const COUNT: u64 = 400_000;
        for kind in KINDS {
            let sampler = FilterSampler::new(kind, 1.5);
            let size = 3.0 / BINS as f32;
            let mut histogram = [0_u32; BINS * BINS];
            for i in 0..COUNT {
                let offset = sampler.sample(Vec2::new(uniform(2 * i), uniform(2 * i + 1)));
                let bin = ((offset + 1.5) / size)
                    .as_uvec2()
                    .min(glam::UVec2::splat(BINS as u32 - 1));
                histogram[bin.y as usize * BINS + bin.x as usize] += 1;
            }
            let (mut chi_square, mut cells, mut rare) = (0.0, 0.0, (0.0, 0.0));
            for (index, &count) in histogram.iter().enumerate() {
                let corner = Vec2::new((index % BINS) as f32, (index / BINS) as f32) * size - 1.5;
                let expected = cell_probability(&sampler, corner, size) * COUNT as f64;
                if expected < 8.0 {
                    rare = (rare.0 + expected, rare.1 + f64::from(count));
                } else {
                    chi_square += (f64::from(count) - expected).powi(2) / expected;
                    cells += 1.0;
                }
            }
            if rare.0 > 0.0 {
                chi_square += (rare.1 - rare.0) * (rare.1 - rare.0) / rare.0;
            }
            // Five standard deviations of a chi-square with this many cells: a false alarm in 10⁶.
            let limit = cells + 5.0 * (2.0_f64 * cells).sqrt();
            assert!(chi_square < limit, "{kind:?}: {chi_square} of {limit}");
        }
    }

    #[test]
    fn tails_follow_the_filter() {
        // Evenly spaced numbers must put the right share of samples beyond any distance.
        const COUNT: u32 = 1 << 16;
        for kind in KINDS {
            let sampler = FilterSampler::new(kind, 2.0);
            let offsets: Vec<f32> = (0..COUNT)
                .map(|i| sampler.sample_axis((i as f32 + 0.5) / COUNT as f32).abs())
                .collect();
            for border in [0.1_f32, 0.5, 1.0, 1.5, 1.8] {
                let inside = offsets.iter().filter(|&&x| x < border).count();
                const STEPS: usize = 1 << 12;
                let step = border / STEPS as f32;
                let expected: f64 = (0..STEPS)
                    .map(|i| 2.0 * sampler.eval_axis((i as f32 + 0.5) * step) * f64::from(step))
                    .sum();
                let share = inside as f64 / f64::from(COUNT);
                assert!((share - expected).abs() < 5e-5, "{kind:?} {border}: {share} {expected}");
            }
        }
    }

    #[test]
    fn samples_are_symmetric_monotonic_and_inside() {
        for kind in KINDS {
            let sampler = FilterSampler::new(kind, 1.25);
            let mut previous = f32::NEG_INFINITY;
            for i in 0..=4096 {
                let u = i as f32 / 4096.0;
                let x = sampler.sample(Vec2::splat(u)).x;
                assert!(x.abs() <= 1.25, "{kind:?}: {x}");
                assert!(x >= previous, "{kind:?}: {x} after {previous}");
                assert_eq!(x, -sampler.sample_axis(1.0 - u), "{kind:?}");
                previous = x;
            }
            assert_eq!(sampler.sample(Vec2::splat(0.5)), Vec2::ZERO);
            assert_eq!(sampler.eval(Vec2::new(1.26, 0.0)), 0.0);
            assert_eq!(sampler.eval(Vec2::new(0.3, -0.4)), sampler.eval(Vec2::new(-0.3, 0.4)));
        }
    }

    #[test]
    fn the_filter_integrates_to_one() {
        for kind in KINDS {
            let sampler = FilterSampler::new(kind, 0.75);
            let total = cell_probability(&sampler, Vec2::splat(-0.75), 1.5);
            assert!((total - 1.0).abs() < 3e-3, "{kind:?}: {total}");
        }
    }
}

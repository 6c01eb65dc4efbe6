use crate::density::{DensityScratch, PhotonMap};
use crate::scene::Scene;
use crate::vertex::Vertex;
use glam::{Vec2, Vec3};
use radiometry::{math, unpack_direction};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Rings of a guide, equal steps of sin²θ.
const RINGS: usize = 8;
/// Sectors of each ring, equal steps of azimuth.
const SECTORS: usize = 16;
const BINS: usize = RINGS * SECTORS;

/// Where light comes from at a point, as far as nearby photons tell: a histogram over the hemisphere, to draw directions
/// from. 136 bytes.
///
/// Bins are equal in projected solid angle, so that equal weights are what a Lambertian surface draws by itself. Directions
/// are drawn from the histogram with probability `mix`, else from the scattering function, and weighed with the density of
/// both together: without bias whatever the histogram holds.
///
/// Source: Jensen, "Importance Driven Path Tracing using the Photon Map", Rendering Techniques 1995.
#[derive(Clone, Copy, Debug)]
pub struct Guide {
    weights: [u8; BINS],
    /// Of all weights; 0 where no photon tells anything.
    sum: u32,
    mix: f32,
}

impl Guide {
    /// A guide that knows nothing.
    pub const NONE: Self = Self {
        weights: [0; BINS],
        sum: 0,
        mix: 0.0,
    };

    /// The guide at a vertex, from the photons of some maps that lie around it, weighed by flux.
    ///
    /// Knows nothing where the vertex does not scatter by one Lambertian lobe.
    ///
    /// - `mix`: share of directions in [0, 1) that the guide is to choose.
    /// - `scratch`: one for each map.
    #[must_use]
    pub fn at<'m>(
        scene: &Scene,
        vertex: &Vertex<'_>,
        maps: impl IntoIterator<Item = (&'m PhotonMap, &'m mut DensityScratch)>,
        mix: f32,
    ) -> Self {
        if vertex.diffuse_value().is_none() {
            return Self::NONE;
        }
        let mut flux = [0.0_f32; BINS];
        for (map, scratch) in maps {
            map.for_nearest(scene, vertex, scratch, |slot| {
                let from = vertex.to_local(unpack_direction(map.columns.direction[slot]));
                flux[bin_of(from)] += map.columns.flux[slot].mean();
            });
        }
        let most = flux.iter().copied().fold(0.0, f32::max);
        if most <= 0.0 {
            return Self::NONE;
        }
        let weights = flux.map(|flux| (flux / most * 255.0).round() as u8);
        Self {
            weights,
            sum: weights.iter().map(|weight| u32::from(*weight)).sum(),
            mix,
        }
    }

    /// True when there is anything to draw from.
    #[inline]
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.sum > 0
    }

    /// Draws a local direction on the side of +z; `None` where the scattering function is to draw it.
    ///
    /// - `u_choice`: in [0, 1), chooses between the two and the bin; `u`: in [0, 1)², the place in the bin.
    #[inline]
    pub(crate) fn sample(&self, u_choice: f32, u: Vec2) -> Option<Vec3> {
        if u_choice >= self.mix {
            return None;
        }
        let mut left = (u_choice / self.mix * self.sum as f32) as u32;
        let mut bin = 0;
        for (i, weight) in self.weights.iter().enumerate() {
            let weight = u32::from(*weight);
            if weight > 0 {
                bin = i;
                if left < weight {
                    break;
                }
                left -= weight;
            }
        }
        let sin_sq = ((bin / SECTORS) as f32 + u.x) / RINGS as f32;
        let (sin_phi, cos_phi) = math::sin_cos(TAU * ((bin % SECTORS) as f32 + u.y) / SECTORS as f32);
        let sin = sin_sq.sqrt();
        Some(Vec3::new(sin * cos_phi, sin * sin_phi, (1.0 - sin_sq).max(0.0).sqrt()))
    }

    /// Density per solid angle of a local direction on the side of +z, drawn as [`Guide::sample`] says.
    ///
    /// - `pdf`: that of the scattering function.
    #[inline]
    pub(crate) fn mixed_pdf(&self, wi: Vec3, pdf: f32) -> f32 {
        let share = f32::from(self.weights[bin_of(wi)]) * BINS as f32 / self.sum as f32;
        self.mix * share * wi.z.max(0.0) * FRAC_1_PI + (1.0 - self.mix) * pdf
    }
}

/// The bin of a unit direction; of its mirror image where it lies below.
#[inline]
fn bin_of(direction: Vec3) -> usize {
    let sin_sq = direction.x * direction.x + direction.y * direction.y;
    let ring = ((sin_sq * RINGS as f32) as usize).min(RINGS - 1);
    let turn = math::atan2(direction.y, direction.x) / TAU;
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    let sector = ((turn * SECTORS as f32) as usize).min(SECTORS - 1);
    ring * SECTORS + sector
}

#[cfg(test)]
mod tests {
    use super::*;
    use radiometry::{SampleStream, StageKey};

    fn guide() -> Guide {
        let mut weights = [0; BINS];
        for (i, weight) in weights.iter_mut().enumerate().filter(|(i, _)| i % 3 != 0) {
            *weight = (i * 2) as u8;
        }
        Guide {
            weights,
            sum: weights.iter().map(|weight| u32::from(*weight)).sum(),
            mix: 0.6,
        }
    }

    #[test]
    fn directions_are_drawn_with_the_density_that_is_told() {
        let (guide, n) = (guide(), 1 << 18);
        let mut counts = [0_u32; BINS];
        for i in 0..n {
            let stream = SampleStream::new(1, StageKey::new("guide"), 0, i);
            let direction = guide
                .sample(stream.draw_1d(0, 0), stream.draw_2d(0, 1))
                .unwrap_or_else(|| radiometry::warp::sample_cosine_hemisphere(stream.draw_2d(0, 2)));
            counts[bin_of(direction)] += 1;
        }
        for (bin, count) in counts.into_iter().enumerate() {
            // The density over the cosine is the same all over a bin.
            let sin_sq = ((bin / SECTORS) as f32 + 0.5) / RINGS as f32;
            let (sin_phi, cos_phi) = math::sin_cos(TAU * ((bin % SECTORS) as f32 + 0.5) / SECTORS as f32);
            let cos = (1.0 - sin_sq).sqrt();
            let centre = Vec3::new(sin_sq.sqrt() * cos_phi, sin_sq.sqrt() * sin_phi, cos);
            let density = guide.mixed_pdf(centre, cos * FRAC_1_PI) / cos;
            let expected = f64::from(density) * std::f64::consts::PI / BINS as f64 * f64::from(n);
            let deviation = (f64::from(count) - expected) / expected.sqrt();
            assert!(deviation.abs() < 4.5, "bin {bin}: {count} of {expected}");
        }
    }
}

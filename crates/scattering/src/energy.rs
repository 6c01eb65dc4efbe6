//! What single scattering loses: the tables behind energy compensation.
//!
//! A GGX lobe accounts for light that meets one microfacet. The rest, 1 − E(ω), is what these tables hold: an average
//! over the normals visible from ω, by a fixed quadrature, so they are the same on every machine. Off the nodes the
//! tables are within 0.3 % of all light, most of it where total reflection begins; 0.03 % is usual.

use crate::fresnel::fresnel_dielectric;
use crate::ggx::Ggx;
use crate::loss_table::{LossTable, SideLoss, cell};
use glam::{Vec2, Vec3};
use radiometry::math;
use std::f32::consts::TAU;
use std::sync::LazyLock;

/// Light that a perfectly reflecting GGX surface loses in single scattering.
#[inline]
pub(crate) fn reflection_loss(alpha: f32) -> SideLoss<1> {
    REFLECTION.of_alpha(alpha)
}

/// Light that a GGX interface between two dielectrics loses in single scattering, reflected and refracted together.
///
/// - `eta`: `n_transmitted / n_incident` as seen from the side in question; clamped to [¼, 4].
#[inline]
pub(crate) fn refraction_loss(alpha: f32, eta: f32) -> SideLoss<2> {
    REFRACTION.of_slab_and_alpha(locate_eta(eta), alpha)
}

/// Slabs of the refraction table: equal steps of ±|s|^¼, s = (η − 1)/(η + 1), which are dense about η = 1: there losses at
/// μ change over |η − 1| ≈ μ²/2.
const ETA_STEPS: usize = 128;
/// s for η = 4; its negative is η = ¼.
const LARGEST_S: f32 = 0.6;

#[inline]
fn locate_eta(eta: f32) -> (usize, f32) {
    let s = (eta - 1.0) / (eta + 1.0) / LARGEST_S;
    cell(0.5 + 0.5 * s.abs().sqrt().sqrt().copysign(s), ETA_STEPS)
}

fn eta_of_slab(slab: usize) -> f32 {
    let root = 2.0 * slab as f32 / ETA_STEPS as f32 - 1.0;
    let s = LARGEST_S * (root * root * root * root).copysign(root);
    (1.0 + s) / (1.0 - s)
}

static REFLECTION: LazyLock<LossTable> = LazyLock::new(build_reflection);
static REFRACTION: LazyLock<LossTable> = LazyLock::new(build_refraction);

fn build_reflection() -> LossTable {
    let quadrature = Quadrature::new((610, 377));
    LossTable::new(1, 96, 64, move |_, alpha, mu| quadrature.reflection(alpha, mu))
}

fn build_refraction() -> LossTable {
    let quadrature = Quadrature::new((987, 610));
    LossTable::new(ETA_STEPS + 1, 64, 48, move |slab, alpha, mu| {
        quadrature.refraction(alpha, mu, eta_of_slab(slab))
    })
}

/// A lattice over the two numbers that choose a visible normal, each number midpoints by itself.
///
/// Losses have a kink where total reflection begins, which at normal incidence is a circle of normals: rings of points
/// would all meet it at the same place.
pub(crate) struct Quadrature {
    azimuths: Vec<Vec2>,
    /// With a weight each, one on average.
    heights: Vec<(f32, f32)>,
}

impl Quadrature {
    /// - `fibonacci`: a Fibonacci number of points, and the one before it.
    pub(crate) fn new((points, step): (usize, usize)) -> Self {
        let on_circle = |phi: f32| Vec2::new(math::cos(phi), math::sin(phi));
        let graded = |i: usize| {
            let rest = 1.0 - (i as f32 + 0.5) / points as f32;
            (1.0 - rest * rest, 2.0 * rest)
        };
        Self {
            azimuths: (0..points)
                .map(|i| on_circle(TAU * (i * step % points) as f32 / points as f32))
                .collect(),
            heights: (0..points).map(graded).collect(),
        }
    }

    /// Mean of `loss(ω_o, h)` over the normals visible from an angle.
    pub(crate) fn mean(&self, ggx: Ggx, mu: f32, loss: impl Fn(Vec3, Vec3) -> f32) -> f32 {
        let wo = Vec3::new(((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt(), 0.0, mu);
        let mut sum = 0.0_f64;
        for (azimuth, (height, weight)) in self.azimuths.iter().zip(&self.heights) {
            sum += f64::from(weight * loss(wo, ggx.visible_normal(wo, *azimuth, *height)));
        }
        (sum / self.heights.len() as f64) as f32
    }

    /// Mean of 1 − G₂/G₁.
    fn reflection(&self, alpha: f32, mu: f32) -> f32 {
        let ggx = Ggx::new(alpha);
        self.mean(ggx, mu, |wo, h| loss_of_reflection(ggx, wo, h)).max(0.0)
    }

    /// Mean of `F (1 − G₂/G₁) + (1 − F)(1 − G₁(ω_i))`.
    fn refraction(&self, alpha: f32, mu: f32, eta: f32) -> f32 {
        let ggx = Ggx::new(alpha);
        self.mean(ggx, mu, |wo, h| {
            let c = wo.dot(h).max(0.0);
            let (f, cos_t) = fresnel_dielectric(c, eta);
            let below = wo.z / eta - (c / eta - cos_t) * h.z;
            let refracted = if below > 0.0 { 1.0 - ggx.masking(below) } else { 1.0 };
            f * loss_of_reflection(ggx, wo, h) + (1.0 - f) * refracted
        })
        .max(0.0)
    }
}

/// `1 − G₂(ω_o, ω_i)/G₁(ω_o)` of the reflection at `h`; all of it where that lies below the surface.
pub(crate) fn loss_of_reflection(ggx: Ggx, wo: Vec3, h: Vec3) -> f32 {
    let cos_i = 2.0 * wo.dot(h) * h.z - wo.z;
    if cos_i <= 0.0 {
        return 1.0;
    }
    let (s_o, s_i) = (ggx.spread(wo.z), ggx.spread(cos_i));
    1.0 - cos_i * (wo.z + s_o) / (wo.z * s_i + cos_i * s_o)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_as_rough_as_can_be_has_a_closed_form() {
        // α = 1, normal incidence: h² is uniform, G₂/G₁ = 2c/(1 + c) with c = 2h² − 1, so E = 1 − ln 2.
        let loss = reflection_loss(1.0).at(1.0);
        assert!((loss - std::f32::consts::LN_2).abs() < 5e-4, "{loss}");
    }

    #[test]
    fn interpolated_losses_are_those_of_a_finer_quadrature() {
        /// Half of what a furnace may be off by.
        const TOLERANCE: f32 = 2.5e-3;
        let fine = Quadrature::new((4181, 2584));
        for alpha in [0.0017, 0.0091, 0.043, 0.13, 0.37, 0.66, 0.91] {
            for mu in [0.004, 0.017, 0.071, 0.23, 0.39, 0.64, 0.87, 1.0] {
                let (found, exact) = (reflection_loss(alpha).at(mu), fine.reflection(alpha, mu));
                assert!((found - exact).abs() < TOLERANCE, "α {alpha} at {mu}: {found} {exact}");
                for eta in [0.29, 0.53, 0.67, 0.88, 0.97, 1.03, 1.13, 1.47, 2.3, 3.7] {
                    let (found, exact) = (refraction_loss(alpha, eta).at(mu), fine.refraction(alpha, mu, eta));
                    assert!(
                        (found - exact).abs() < TOLERANCE,
                        "α {alpha}, η {eta} at {mu}: {found} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn averages_are_those_of_the_interpolated_losses() {
        /// Relative: what the sum here and rounding are off by.
        const TOLERANCE: f32 = 2e-3;
        let steps = 20_000;
        let mean = |f: &dyn Fn(f32) -> f32| -> f32 {
            let term = |i: i32| {
                let mu = (f64::from(i) + 0.5) / f64::from(steps);
                2.0 * mu * f64::from(f(mu as f32)) / f64::from(steps)
            };
            (0..steps).map(term).sum::<f64>() as f32
        };
        for alpha in [0.002, 0.011, 0.07, 0.3, 0.77] {
            let metal = reflection_loss(alpha);
            let glass = refraction_loss(alpha, 1.5);
            let (m, g) = (mean(&|mu| metal.at(mu)), mean(&|mu| glass.at(mu)));
            assert!(
                (metal.average() - m).abs() < TOLERANCE * m,
                "{alpha}: {} {m}",
                metal.average()
            );
            assert!(
                (glass.average() - g).abs() < TOLERANCE * g,
                "{alpha}: {} {g}",
                glass.average()
            );
        }
    }
}

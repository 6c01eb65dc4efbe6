//! What a GGX lobe with a Fresnel term reflects, by the angle: the tables behind layers that lose nothing.
//!
//! What lies under a rough coat gets the light that the coat does not reflect, 1 − R(ω). R is tabulated as what single
//! scattering takes away from the reflectance of a smooth surface, which vanishes with α; so it tends to the smooth
//! formula exactly, and keeps its precision at grazing angles. Computed at first use, like the tables of `energy`.

use crate::energy::{Quadrature, loss_of_reflection, reflection_loss};
use crate::fresnel::{average_fresnel_dielectric, fresnel_dielectric};
use crate::ggx::Ggx;
use crate::loss_table::{LossTable, SideLoss, cell};
use std::ops::{Add, Mul};
use std::sync::LazyLock;

/// Directional reflectance of a GGX lobe with Schlick's Fresnel term, without multiple scattering.
///
/// `R(ω) = f₀ A(ω) + f₉₀ B(ω)`, since the term is linear in both. A + B is what a perfect reflector scatters once.
#[derive(Clone, Copy)]
pub(crate) struct SchlickReflectance {
    /// 1 − A − B, and (1 − μ)⁵ − B; `None` for a smooth surface, which loses nothing.
    losses: Option<(SideLoss<1>, SideLoss<1>)>,
}

/// The coefficients of f₀ and f₉₀ in a reflectance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SchlickShares {
    pub(crate) f0: f32,
    pub(crate) f90: f32,
}

impl SchlickShares {
    /// f₀ A + f₉₀ B.
    #[inline]
    pub(crate) fn of<T: Mul<f32, Output = T> + Add<Output = T>>(self, f0: T, f90: T) -> T {
        f0 * self.f0 + f90 * self.f90
    }

    /// What a perfect reflector loses in single scattering: 1 − A − B.
    #[inline]
    pub(crate) fn loss(self) -> f32 {
        (1.0 - self.f0 - self.f90).max(0.0)
    }
}

impl SchlickReflectance {
    /// - `alpha`: GGX width; 0 for a smooth surface.
    #[inline]
    pub(crate) fn new(alpha: f32) -> Self {
        Self {
            losses: (alpha > 0.0).then(|| (reflection_loss(alpha), GRAZING.of_alpha(alpha))),
        }
    }

    /// A and B at an angle.
    #[inline]
    pub(crate) fn at(&self, cos_theta: f32) -> SchlickShares {
        let m = 1.0 - cos_theta.min(1.0);
        let m2 = m * m;
        let losses = self
            .losses
            .as_ref()
            .map(|(all, grazing)| (all.at(cos_theta), grazing.at(cos_theta)));
        Self::shares(m2 * m2 * m, losses)
    }

    /// A and B of diffuse light: 2 ∫ A(μ) μ dμ and 2 ∫ B(μ) μ dμ.
    #[inline]
    pub(crate) fn average(&self) -> SchlickShares {
        let losses = self
            .losses
            .as_ref()
            .map(|(all, grazing)| (all.average(), grazing.average()));
        Self::shares(1.0 / 21.0, losses)
    }

    #[inline]
    fn shares(smooth_f90: f32, losses: Option<(f32, f32)>) -> SchlickShares {
        let (all, grazing) = losses.unwrap_or((0.0, 0.0));
        let f90 = (smooth_f90 - grazing).max(0.0);
        SchlickShares {
            f0: (1.0 - all - f90).max(0.0),
            f90,
        }
    }
}

/// Directional reflectance of a GGX lobe with the Fresnel term of a dielectric, without multiple scattering.
#[derive(Clone, Copy)]
pub(crate) struct DielectricReflectance {
    ior: f32,
    /// F(μ) − R(μ); `None` for a smooth surface.
    loss: Option<SideLoss<2>>,
}

/// Slabs of the table: equal steps of √s, s = (η − 1)/(η + 1), up to η = 4.
const IOR_STEPS: usize = 18;
const LARGEST_S: f32 = 0.6;

impl DielectricReflectance {
    /// - `ior`: index of the coat over that outside, in [1, 4].
    /// - `alpha`: GGX width; 0 for a smooth surface.
    pub(crate) fn new(ior: f32, alpha: f32) -> Self {
        let s = (ior - 1.0) / (ior + 1.0) / LARGEST_S;
        let slab = cell(s.max(0.0).sqrt(), IOR_STEPS);
        Self {
            ior,
            loss: (alpha > 0.0).then(|| DIELECTRIC.of_slab_and_alpha(slab, alpha)),
        }
    }

    /// R at an angle.
    #[inline]
    pub(crate) fn at(&self, cos_theta: f32) -> f32 {
        let (smooth, _) = fresnel_dielectric(cos_theta, self.ior);
        let loss = self.loss.as_ref().map_or(0.0, |loss| loss.at(cos_theta));
        (smooth - loss).clamp(0.0, 1.0)
    }

    /// R of diffuse light: 2 ∫ R(μ) μ dμ.
    pub(crate) fn average(&self) -> f32 {
        let loss = self.loss.as_ref().map_or(0.0, SideLoss::average);
        (average_fresnel_dielectric(self.ior) - loss).clamp(0.0, 1.0)
    }
}

static GRAZING: LazyLock<LossTable> = LazyLock::new(build_grazing);
static DIELECTRIC: LazyLock<LossTable> = LazyLock::new(build_dielectric);

fn fifth(x: f32) -> f32 {
    let squared = x * x;
    squared * squared * x
}

fn build_grazing() -> LossTable {
    let quadrature = Quadrature::new((610, 377));
    LossTable::new(1, 96, 64, move |_, alpha, mu| {
        let ggx = Ggx::new(alpha);
        let reflected = quadrature.mean(ggx, mu, |wo, h| {
            fifth(1.0 - wo.dot(h).clamp(0.0, 1.0)) * (1.0 - loss_of_reflection(ggx, wo, h))
        });
        fifth(1.0 - mu) - reflected
    })
}

fn build_dielectric() -> LossTable {
    let quadrature = Quadrature::new((610, 377));
    LossTable::new(IOR_STEPS + 1, 64, 48, move |slab, alpha, mu| {
        let root = slab as f32 / IOR_STEPS as f32;
        let s = LARGEST_S * root * root;
        let (ggx, ior) = (Ggx::new(alpha), (1.0 + s) / (1.0 - s));
        let reflected = quadrature.mean(ggx, mu, |wo, h| {
            fresnel_dielectric(wo.dot(h), ior).0 * (1.0 - loss_of_reflection(ggx, wo, h))
        });
        fresnel_dielectric(mu, ior).0 - reflected
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_surface_has_its_fresnel_term() {
        let schlick = SchlickReflectance::new(0.0);
        assert_eq!(schlick.at(1.0).of(0.04, 1.0), 0.04);
        assert_eq!(schlick.at(0.0).of(0.04, 1.0), 1.0);
        assert!((schlick.average().of(0.04, 1.0) - (0.04 + 0.96 / 21.0)).abs() < 1e-6);
        let coat = DielectricReflectance::new(1.5, 0.0);
        assert_eq!(coat.at(0.3), fresnel_dielectric(0.3, 1.5).0);
        assert_eq!(coat.average(), average_fresnel_dielectric(1.5));
    }

    #[test]
    fn a_nearly_smooth_surface_tends_to_a_smooth_one() {
        for mu in [1.0, 0.5, 0.1] {
            let (rough, smooth) = (
                SchlickReflectance::new(1e-3).at(mu),
                SchlickReflectance::new(0.0).at(mu),
            );
            assert!((rough.f0 - smooth.f0).abs() < 1e-3 && (rough.f90 - smooth.f90).abs() < 1e-3);
            let (rough, smooth) = (
                DielectricReflectance::new(1.5, 1e-3),
                DielectricReflectance::new(1.5, 0.0),
            );
            assert!((rough.at(mu) - smooth.at(mu)).abs() < 1e-3);
        }
    }

    #[test]
    fn averages_are_those_of_the_interpolated_reflectances() {
        /// The base under a coat divides by 1 − R̄: this much of all light may be lost or gained.
        const TOLERANCE: f32 = 2e-4;
        let mean = |f: &dyn Fn(f32) -> f32| -> f32 {
            let mids = (0..20_000).map(|i| (i as f32 + 0.5) / 20_000.0);
            mids.map(|mu| f64::from(1e-4 * mu * f(mu))).sum::<f64>() as f32
        };
        for alpha in [0.002, 0.011, 0.07, 0.3, 0.77, 1.0] {
            let schlick = SchlickReflectance::new(alpha);
            let average = schlick.average().of(0.04, 1.0);
            let integral = mean(&|mu| schlick.at(mu).of(0.04, 1.0));
            assert!((average - integral).abs() < TOLERANCE, "{alpha}: {average} {integral}");
            for ior in [1.0, 1.07, 1.5, 2.9] {
                let coat = DielectricReflectance::new(ior, alpha);
                let (average, integral) = (coat.average(), mean(&|mu| coat.at(mu)));
                assert!(
                    (average - integral).abs() < TOLERANCE,
                    "{alpha}, {ior}: {average} {integral}"
                );
            }
        }
    }
}

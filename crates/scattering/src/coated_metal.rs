//! What a coated metal does not scatter once: the table behind a clear coat over metal.
//!
//! The coat reflects `R_c(ω)` and lets `T(ω) = 1 − R_c(ω)` through. The lobe of the metal is attenuated by
//! `min(T(ω_o), T(ω_i))`, which is symmetric, exact for a mirror, and never returns more than `T(ω_o)` in all. What then
//! is missing, `r(ω_o) = T(ω_o) − ∫ min(T(ω_o), T(ω_i)) f cosθ_i dω_i` for a perfect reflector, holds light that met several
//! microfacets and light that went to and fro between coat and metal.

use crate::SMOOTH_ALPHA;
use crate::energy::{Quadrature, loss_of_reflection};
use crate::ggx::Ggx;
use crate::loss_table::{LossTable, SideLoss, alpha_of_row, cell, eighth_root};
use crate::principled::COAT_F0;
use crate::reflectance::SchlickReflectance;
use std::sync::LazyLock;

/// Steps of the width of a rough coat; a smooth coat has a slab before them.
const COAT_STEPS: usize = 8;

/// What is missing of a perfect reflector of width `alpha` under a coat of width `coat_alpha`.
///
/// - `alpha`: not smooth; a mirror misses nothing.
/// - `coat_alpha`: 0 for a smooth coat.
#[inline]
pub(crate) fn coated_loss(alpha: f32, coat_alpha: f32) -> SideLoss<2> {
    let slab = if coat_alpha > 0.0 {
        let low = eighth_root(SMOOTH_ALPHA);
        let (i, f) = cell((eighth_root(coat_alpha) - low) / (1.0 - low), COAT_STEPS);
        (i + 1, f)
    } else {
        (0, 0.0)
    };
    COATED.of_slab_and_alpha(slab, alpha)
}

static COATED: LazyLock<LossTable> = LazyLock::new(build);

fn build() -> LossTable {
    let quadrature = Quadrature::new((610, 377));
    LossTable::new(COAT_STEPS + 2, 64, 48, move |slab, alpha, mu| {
        let coat_alpha = match slab {
            0 => 0.0,
            _ => alpha_of_row((slab - 1) as f32 / COAT_STEPS as f32),
        };
        let coat = SchlickReflectance::new(coat_alpha);
        let passed = |mu: f32| 1.0 - coat.at(mu).of(COAT_F0, 1.0);
        let (ggx, passed_o) = (Ggx::new(alpha), passed(mu));
        quadrature.mean(ggx, mu, |wo, h| {
            let cos_i = 2.0 * wo.dot(h) * h.z - wo.z;
            passed_o - passed_o.min(passed(cos_i.max(0.0))) * (1.0 - loss_of_reflection(ggx, wo, h))
        })
    })
}

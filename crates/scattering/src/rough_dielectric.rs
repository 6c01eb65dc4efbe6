//! Reflection and refraction by a GGX interface, with the light that scatters more than once.
//!
//! With `η = n_t/n_i` as seen from `ω_o`, h the normal of the microfacet, per solid angle and for flux:
//!
//! - reflection: `F D(h) G₂(ω_o, ω_i)/(4 cosθ_o cosθ_i)`, `h ∝ ω_o + ω_i`;
//! - refraction: `(1 − F) D(h) G₁(ω_o) G₁(ω_i) |ω_o·h| |ω_i·h| η²/(cosθ_o cosθ_i |ω_o + η ω_i|²)`,
//!   `h ∝ −(ω_o + η ω_i)`.
//!
//! Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007. The masking of a
//! refracted direction is Walter's product; correlated heights would need a Beta function.
//!
//! Multiple scattering is a diffuse reflection and a diffuse transmission, shaped like Kulla and Conty's: from side a to
//! side b, `K(ω_o → ω_i) = S_ab (1 − E_a(ω_o))(1 − E_b(ω_i))/(π (1 − Ē_b))`, with `S_aa + S_ab = 1` for a white furnace.
//! The shares are chosen so that K obeys the same reciprocity as single refraction, `K_ab/n_b² = K_ba/n_a²`; of the two
//! sides, the one that loses less transmits its diffuse Fresnel transmittance, the other less in proportion.
//!
//! How that light is split between the sides, and that it leaves diffusely, is a model, not a simulation. It is poorest
//! for rough surfaces of little contrast (η near 1), which in truth let grazing light pass almost unbent.

use crate::energy::refraction_loss;
use crate::fresnel::fresnel_dielectric;
use crate::ggx::Ggx;
use crate::{BsdfSample, DielectricBsdf, Transport};
use glam::{Vec2, Vec3};
use radiometry::Rgb;
use std::f32::consts::FRAC_1_PI;

/// Constants of multiple scattering, for the outside (0) and the inside (1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RoughInterface {
    /// 1/(1 − Ē) of each side; zero when nothing is compensated.
    inverse_loss: [f32; 2],
    /// Share of multiply scattered light that crosses, coming from each side.
    crossing: [f32; 2],
}

impl RoughInterface {
    /// - `losses`: 1 − Ē of each side.
    /// - `fresnel`: diffuse Fresnel reflectance F̄ of each side.
    pub(crate) fn new(losses: [f32; 2], fresnel: [f32; 2]) -> Self {
        let largest = losses[0].max(losses[1]);
        if losses[0] <= 0.0 || losses[1] <= 0.0 {
            return Self::default();
        }
        Self {
            inverse_loss: [1.0 / losses[0], 1.0 / losses[1]],
            crossing: [
                (1.0 - fresnel[0]) * losses[1] / largest,
                (1.0 - fresnel[1]) * losses[0] / largest,
            ],
        }
    }

    pub(crate) fn is_compensated(&self) -> bool {
        self.inverse_loss[0] > 0.0
    }
}

impl DielectricBsdf {
    /// `f·|cosθ_i|` and the density of sampling it.
    pub(crate) fn rough_eval_and_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        let reflected = wo.z * wi.z > 0.0;
        let eta = self.eta_from(wo);
        let (mut value, mut pdf) = if reflected {
            self.single_reflection(wo, wi, eta)
        } else {
            self.single_refraction(wo, wi, eta)
        };
        if self.surface.has_energy_compensation() {
            let alpha = self.surface.alpha();
            let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
            let from = usize::from(wo.z < 0.0);
            let to = usize::from(wi.z < 0.0);
            let loss_o = refraction_loss(alpha, eta).at(cos_o);
            let (loss_i, pdf_i) = refraction_loss(alpha, self.eta_from(wi)).at_and_pdf(cos_i);
            let crossing = self.interface.crossing[from];
            let share = loss_o * if reflected { 1.0 - crossing } else { crossing };
            value += share * loss_i * self.interface.inverse_loss[to] * cos_i * FRAC_1_PI;
            pdf = pdf * (1.0 - loss_o) + share * pdf_i;
        }
        if reflected {
            (Rgb::splat(value), pdf)
        } else {
            (self.tint * (value * transport.refraction_scale(eta)), pdf)
        }
    }

    #[inline]
    fn single_reflection(&self, wo: Vec3, wi: Vec3, eta: f32) -> (f32, f32) {
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let ggx = Ggx::new(self.surface.alpha());
        let h = (wo + wi).normalize();
        let (f, _) = fresnel_dielectric(wo.dot(h), eta);
        let density = f * ggx.density(h);
        (
            density * ggx.visibility(cos_o, cos_i) * cos_i,
            0.25 * density * ggx.masking_over_cos(cos_o),
        )
    }

    #[inline]
    fn single_refraction(&self, wo: Vec3, wi: Vec3, eta: f32) -> (f32, f32) {
        let sum = wo + eta * wi;
        let sum_sq = sum.length_squared();
        if sum_sq <= 0.0 {
            return (0.0, 0.0);
        }
        // Towards the side of wo, where visible normals are.
        let h = sum * (wo.z.signum() * sum.z.signum() / sum_sq.sqrt());
        let (dot_o, dot_i) = (wo.dot(h), wi.dot(h));
        if dot_o <= 0.0 || dot_i >= 0.0 {
            return (0.0, 0.0);
        }
        let (f, _) = fresnel_dielectric(dot_o, eta);
        let ggx = Ggx::new(self.surface.alpha());
        let jacobian = eta * eta * -dot_i / sum_sq;
        let pdf = (1.0 - f) * ggx.density(h) * dot_o * ggx.masking_over_cos(wo.z.abs()) * jacobian;
        (pdf * ggx.masking(wi.z.abs()), pdf)
    }

    pub(crate) fn sample_rough(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        let eta = self.eta_from(wo);
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        let alpha = self.surface.alpha();
        let loss = if self.surface.has_energy_compensation() {
            refraction_loss(alpha, eta).at(up.z)
        } else {
            0.0
        };
        let (mut wi, transmitted) = if u_lobe < loss {
            let transmitted = u_lobe < loss * self.interface.crossing[usize::from(wo.z < 0.0)];
            let eta_from_wi = if transmitted { 1.0 / eta } else { eta };
            let mut wi = refraction_loss(alpha, eta_from_wi).sample(u);
            if transmitted {
                wi.z = -wi.z;
            }
            (wi, transmitted)
        } else {
            let u_fresnel = (u_lobe - loss) / (1.0 - loss);
            let h = Ggx::new(alpha).sample_visible_normal(up, u);
            let dot = up.dot(h).max(0.0);
            let (f, cos_t) = fresnel_dielectric(dot, eta);
            if u_fresnel < f {
                (2.0 * dot * h - up, false)
            } else {
                ((dot / eta - cos_t) * h - up / eta, true)
            }
        };
        if wi.z == 0.0 || (wi.z < 0.0) != transmitted {
            return None;
        }
        wi = wi.normalize();
        wi.z *= wo.z.signum();
        let (value, pdf) = self.rough_eval_and_pdf(wo, wi, transport);
        let mut sample = BsdfSample::from_value(wi, value, pdf, self.surface.class())?;
        if transmitted {
            sample.transmitted = true;
            sample.eta_sq_scale = transport.refraction_scale(eta);
        }
        Some(sample)
    }
}

use crate::ggx::Ggx;
use crate::reflectance::DielectricReflectance;
use crate::{BsdfSample, LobeClass, LobeValues, Microsurface, fresnel_dielectric};
use glam::{Vec2, Vec3};
use radiometry::{Rgb, warp};
use std::f32::consts::{FRAC_1_PI, PI};

/// A Lambertian base under a clear dielectric coat: plastic, lacquer, glazed tiles.
///
/// `f = F(ω_o·h) D(h) G₂(ω_o, ω_i)/(4 cosθ_o cosθ_i) + (1 − R(ω_o))(1 − R(ω_i)) albedo/(π η² (1 − albedo R_int))`,
/// `R_int = 1 − (1 − R̄)/η²`
///
/// R(ω) is what the first term, the coat, reflects of light from ω, and R̄ = 2 ∫ R(μ) μ dμ; over a smooth coat they are F
/// and its average, and `R_int` is the internal diffuse reflectance. Light that passes the coat reaches the base, and
/// what the base returns is reflected down again by `R_int` until it leaves.
///
/// Source: Wolff, "Diffuse-Reflectance Model for Smooth Dielectric Surfaces", JOSA A 11(11), 1994, with the internal
/// reflections summed (Saunderson 1942), as in Mitsuba's `plastic`. Differs for a rough coat: R in place of F makes it lossless at every roughness
/// and keeps it reciprocal; `R_int` follows from R̄ by reciprocity of the interface, not from the rough interface seen
/// from inside. Light that meets several microfacets of the coat counts as passing it.
///
/// Seen from either side, the coat is in front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticBsdf {
    ior: f32,
    surface: Microsurface,
    /// `albedo/(π η² (1 − albedo R_int))`.
    base: Rgb,
    /// `π (1 − R̄) base`: share of the light behind the coat that comes back out.
    returned: Rgb,
}

impl PlasticBsdf {
    /// Builds plastic.
    ///
    /// - `albedo`: of the base as if bare, in [0, 1]. The interreflection saturates it: what is seen is darker.
    /// - `ior`: index of the coat relative to the outside, clamped to [1, 4].
    /// - `surface`: of the coat. Its energy compensation is without effect, since the base takes all that is left.
    #[must_use]
    pub fn new(albedo: Rgb, ior: f32, surface: Microsurface) -> Self {
        let ior = if ior.is_nan() { 1.0 } else { ior.clamp(1.0, 4.0) };
        let passed = 1.0 - DielectricReflectance::new(ior, surface.alpha()).average();
        let eta_sq = ior * ior;
        let internal = 1.0 - passed / eta_sq;
        let base = albedo.map(|a| FRAC_1_PI * a / (eta_sq * (1.0 - a * internal)));
        Self {
            ior,
            surface,
            base,
            returned: base * (PI * passed),
        }
    }

    /// The surface of the coat.
    #[inline]
    #[must_use]
    pub fn surface(&self) -> Microsurface {
        self.surface
    }

    /// `R(ω_o)`, and the probability with which the coat is sampled.
    #[inline]
    fn choice(&self, reflectance: &DielectricReflectance, cos_o: f32) -> (f32, f32) {
        let r = reflectance.at(cos_o);
        let diffuse = (1.0 - r) * self.returned.mean();
        let sum = r + diffuse;
        (r, if sum > 0.0 { r / sum } else { 0.0 })
    }

    #[inline]
    pub(crate) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3) -> (LobeValues, f32) {
        if wo.z * wi.z <= 0.0 {
            return (LobeValues::default(), 0.0);
        }
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let reflectance = DielectricReflectance::new(self.ior, self.surface.alpha());
        let (r, coat_probability) = self.choice(&reflectance, cos_o);
        let diffuse = self.base * ((1.0 - r) * (1.0 - reflectance.at(cos_i)) * cos_i);
        let diffuse = LobeValues::of_class(LobeClass::Diffuse, diffuse);
        let diffuse_pdf = (1.0 - coat_probability) * cos_i * FRAC_1_PI;
        if self.surface.is_smooth() {
            return (diffuse, diffuse_pdf);
        }
        let h = (wo + wi).normalize();
        let ggx = Ggx::new(self.surface.alpha());
        let density = ggx.density(h);
        let (f, _) = fresnel_dielectric(wo.dot(h), self.ior);
        let coat = Rgb::splat(f * density * ggx.visibility(cos_o, cos_i) * cos_i);
        let coat_pdf = 0.25 * density * ggx.masking_over_cos(cos_o);
        (
            LobeValues::of_class(self.surface.class(), coat) + diffuse,
            coat_probability * coat_pdf + diffuse_pdf,
        )
    }

    #[inline]
    pub(crate) fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        let reflectance = DielectricReflectance::new(self.ior, self.surface.alpha());
        let (r, coat_probability) = self.choice(&reflectance, up.z);
        let mut wi = if u_lobe >= coat_probability {
            warp::sample_cosine_hemisphere(u)
        } else if self.surface.is_smooth() {
            return Some(BsdfSample::delta_reflection(wo, Rgb::splat(r / coat_probability)));
        } else {
            let h = Ggx::new(self.surface.alpha()).sample_visible_normal(up, u);
            (2.0 * up.dot(h) * h - up).normalize()
        };
        if wi.z <= 0.0 {
            return None;
        }
        wi.z = wi.z.copysign(wo.z);
        let (values, pdf) = self.eval_and_pdf(wo, wi);
        BsdfSample::from_lobes(wi, values, pdf, BsdfSample::class_number(u_lobe))
    }

    /// Directional albedo: exact but for the interpolation of R.
    pub(crate) fn albedo(&self, wo: Vec3) -> Rgb {
        let r = DielectricReflectance::new(self.ior, self.surface.alpha()).at(wo.z.abs());
        Rgb::splat(r) + self.returned * (1.0 - r)
    }
}

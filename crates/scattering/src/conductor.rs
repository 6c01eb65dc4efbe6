use crate::energy::reflection_loss;
use crate::fresnel::{average_fresnel_conductor, fresnel_conductor, schlick};
use crate::normals::Normals;
use crate::{BsdfSample, Metal, Microsurface, NormalDistribution};
use glam::{Vec2, Vec3};
use radiometry::Rgb;
use std::f32::consts::{FRAC_1_PI, PI};

/// How the reflectance of a conductor depends on the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConductorFresnel {
    /// The same reflectance, in [0, 1], at every angle. *Non-physical*, but handy for mirrors and furnaces.
    Constant(Rgb),
    /// Schlick's approximation from the reflectance at normal incidence, in [0, 1].
    Schlick(Rgb),
    /// The exact equations for a complex index of refraction η + ik, relative to the outside.
    Complex {
        /// Real part, ≥ 0.
        eta: Rgb,
        /// Imaginary part, ≥ 0.
        k: Rgb,
    },
}

impl From<Metal> for ConductorFresnel {
    fn from(metal: Metal) -> Self {
        Self::Complex {
            eta: metal.eta,
            k: metal.k,
        }
    }
}

impl ConductorFresnel {
    /// Reflectance at an angle of incidence, in [0, 1].
    #[inline]
    #[must_use]
    pub fn reflectance(&self, cos_i: f32) -> Rgb {
        match *self {
            Self::Constant(reflectance) => reflectance,
            Self::Schlick(f0) => schlick(cos_i, f0),
            Self::Complex { eta, k } => fresnel_conductor(cos_i, eta, k),
        }
    }

    /// Reflectance of diffuse light: F̄ = 2 ∫ F(μ) μ dμ.
    #[must_use]
    pub fn average(&self) -> Rgb {
        match *self {
            Self::Constant(reflectance) => reflectance,
            Self::Schlick(f0) => f0 + (Rgb::WHITE - f0) * (1.0 / 21.0),
            Self::Complex { eta, k } => average_fresnel_conductor(eta, k),
        }
    }
}

/// A metal: a mirror, or a GGX reflection with the light that bounces between microfacets added, or a Beckmann reflection
/// without it.
///
/// `f = F(ω_o·h) D(h) G₂(ω_o, ω_i)/(4 cosθ_o cosθ_i) + F_ms (1 − E(ω_o))(1 − E(ω_i))/(π (1 − Ē))`,
/// `F_ms = F̄² Ē/(1 − F̄ (1 − Ē))`
///
/// Source: Walter et al. 2007 with Smith's height-correlated masking (Heitz 2014); multiple scattering by Kulla and
/// Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH course 2017, with the F̄² of S. Hill, "A
/// Multi-Faceted Exploration", 2018. The second term keeps the lobe reciprocal, so paths from the eye and from the
/// light agree, and a white surface reflects all light at every roughness. What Beckmann's surfaces lose is not tabulated, so
/// they have no second term.
///
/// Seen from either side. Normals are sampled among the visible ones; the second term is sampled by its own shape, with
/// probability `1 − E(ω_o)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConductorBsdf {
    fresnel: ConductorFresnel,
    /// `F_ms/(π (1 − Ē))`: the second term without its two factors; zero when nothing is compensated.
    multiple: Rgb,
    /// Factor for all that it reflects.
    tint: Rgb,
    surface: Microsurface,
    distribution: NormalDistribution,
}

impl ConductorBsdf {
    /// Builds a metal from its Fresnel term and its surface, of GGX.
    #[must_use]
    pub fn new(fresnel: ConductorFresnel, surface: Microsurface) -> Self {
        let loss = if surface.has_energy_compensation() {
            reflection_loss(surface.alpha()).average()
        } else {
            0.0
        };
        let multiple = if loss > 0.0 {
            let scale = FRAC_1_PI / loss;
            fresnel
                .average()
                .map(|f| scale * f * f * (1.0 - loss) / (1.0 - f * loss))
        } else {
            Rgb::BLACK
        };
        Self {
            fresnel,
            multiple,
            tint: Rgb::WHITE,
            surface: surface.with_energy_compensation(loss > 0.0),
            distribution: NormalDistribution::Ggx,
        }
    }

    /// The same metal with another distribution of the same α. Beckmann's takes the energy compensation away.
    #[must_use]
    pub fn with_distribution(self, distribution: NormalDistribution) -> Self {
        match distribution {
            NormalDistribution::Ggx => Self { distribution, ..self },
            NormalDistribution::Beckmann => Self {
                multiple: Rgb::BLACK,
                surface: self.surface.with_energy_compensation(false),
                distribution,
                ..self
            },
        }
    }

    /// The same metal with a factor for all that it reflects, ≥ 0. *Non-physical*: other renderers have it.
    #[must_use]
    pub fn with_tint(self, tint: Rgb) -> Self {
        Self {
            multiple: self.multiple * tint,
            tint,
            ..self
        }
    }

    /// The surface that the metal was built with.
    #[inline]
    #[must_use]
    pub fn surface(&self) -> Microsurface {
        self.surface
    }

    #[inline]
    fn normals(&self) -> Normals {
        Normals::new(self.distribution, self.surface.alpha())
    }

    /// Reflectance of a microfacet, tinted.
    #[inline]
    fn reflectance(&self, cos_i: f32) -> Rgb {
        self.fresnel.reflectance(cos_i) * self.tint
    }

    /// `f·|cosθ_i|` and the density of [`Self::sample`]; zero for a smooth metal.
    #[inline]
    pub(crate) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        if self.surface.is_smooth() || wo.z * wi.z <= 0.0 {
            return (Rgb::BLACK, 0.0);
        }
        let h = (wo + wi).normalize();
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let normals = self.normals();
        let density = normals.density(h);
        let value = self.reflectance(wo.dot(h)) * (density * normals.visibility(cos_o, cos_i) * cos_i);
        let pdf = 0.25 * density * normals.masking_over_cos(cos_o);
        if !self.surface.has_energy_compensation() {
            return (value, pdf);
        }
        let loss = reflection_loss(self.surface.alpha());
        let loss_o = loss.at(cos_o);
        let (loss_i, pdf_i) = loss.at_and_pdf(cos_i);
        (
            value + self.multiple * (loss_o * loss_i * cos_i),
            pdf * (1.0 - loss_o) + loss_o * pdf_i,
        )
    }

    #[inline]
    pub(crate) fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let class = self.surface.class();
        if self.surface.is_smooth() {
            let weight = self.reflectance(wo.z);
            return Some(BsdfSample::delta_reflection(wo, weight));
        }
        let up = Vec3::new(wo.x, wo.y, wo.z.abs());
        let multiple = self.surface.has_energy_compensation().then(|| {
            let loss = reflection_loss(self.surface.alpha());
            (loss.at(up.z), loss)
        });
        let mut wi = match multiple {
            Some((share, loss)) if u_lobe < share => loss.sample(u),
            _ => {
                let h = self.normals().sample_visible_normal(up, u);
                (2.0 * up.dot(h) * h - up).normalize()
            }
        };
        if wi.z <= 0.0 {
            return None;
        }
        wi.z = wi.z.copysign(wo.z);
        let (value, pdf) = self.eval_and_pdf(wo, wi);
        BsdfSample::from_value(wi, value, pdf, class)
    }

    /// Directional albedo, with the Fresnel term taken at the macroscopic normal, and without what a Beckmann surface loses.
    pub(crate) fn albedo(&self, wo: Vec3) -> Rgb {
        let f = self.reflectance(wo.z);
        if self.surface.is_smooth() || self.distribution == NormalDistribution::Beckmann {
            return f;
        }
        let loss = reflection_loss(self.surface.alpha());
        let lost = loss.at(wo.z.abs());
        f * (1.0 - lost) + self.multiple * (PI * lost * loss.average())
    }
}

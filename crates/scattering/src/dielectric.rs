use crate::energy::refraction_loss;
use crate::fresnel::{average_fresnel_dielectric, fresnel_dielectric};
use crate::rough_dielectric::RoughInterface;
use crate::{BsdfSample, LobeClass, Microsurface, Transport};
use glam::{Vec2, Vec3};
use radiometry::Rgb;

/// Glass, water, air bubbles: an interface between two transparent media, or a thin pane.
///
/// The side of the normal (`wo.z > 0`) is the outside. `tint` multiplies light each time it crosses an interface, and
/// leaves reflected light alone. Absorption inside is not here: transport applies it along the segments.
///
/// Radiance that crosses into a medium of another index is squeezed into another solid angle: with `η = n_t/n_i` as seen
/// from `wo`, refraction multiplies radiance by 1/η² under [`Transport::Radiance`] (the light comes from the side of
/// `wi`), and nothing under [`Transport::Flux`]. Entering and leaving cancel, so a glass ball in uniform radiance shows
/// that radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DielectricBsdf {
    pub(crate) ior: f32,
    pub(crate) tint: Rgb,
    pub(crate) surface: Microsurface,
    /// What was asked for; `surface` is smooth where this index hardly spreads light, and another one may.
    asked: Microsurface,
    pub(crate) interface: RoughInterface,
    thin: bool,
}

/// A rough interface spreads refracted light over about α |ior − 1|; when that is less, it counts as smooth.
///
/// Below it, single precision can't tell the half-vector from the two directions that it lies between.
pub const SMOOTH_SPREAD: f32 = 5e-5;

impl DielectricBsdf {
    /// Builds a closed surface.
    ///
    /// - `ior`: index of the inside relative to the outside, > 0. Energy compensation is exact for [¼, 4].
    /// - `tint`: factor for each crossing, in [0, 1].
    /// - `surface`: smooth or GGX. α |ior − 1| below [`SMOOTH_SPREAD`] becomes smooth.
    #[must_use]
    pub fn new(ior: f32, tint: Rgb, surface: Microsurface) -> Self {
        let averages = if surface.has_energy_compensation() {
            Self::fresnel_averages(ior)
        } else {
            [0.0; 2]
        };
        Self::with_fresnel_averages(ior, tint, surface, averages)
    }

    /// Diffuse Fresnel reflectance of the outside and of the inside.
    pub(crate) fn fresnel_averages(ior: f32) -> [f32; 2] {
        [average_fresnel_dielectric(ior), average_fresnel_dielectric(1.0 / ior)]
    }

    /// As [`Self::new`], with the two averages at hand: cheap enough to be built when it is evaluated.
    pub(crate) fn with_fresnel_averages(ior: f32, tint: Rgb, surface: Microsurface, averages: [f32; 2]) -> Self {
        let asked = surface;
        let smooth = surface.alpha() * (ior - 1.0).abs() < SMOOTH_SPREAD;
        let surface = if smooth { Microsurface::SMOOTH } else { surface };
        let mut interface = RoughInterface::default();
        if surface.has_energy_compensation() {
            let alpha = surface.alpha();
            let outside = refraction_loss(alpha, ior).average();
            let inside = refraction_loss(alpha, 1.0 / ior).average();
            interface = RoughInterface::new([outside, inside], averages);
        }
        let compensated = surface.has_energy_compensation() && interface.is_compensated();
        Self {
            ior,
            tint,
            surface: surface.with_energy_compensation(compensated),
            asked,
            interface,
            thin: false,
        }
    }

    /// Builds a pane: two smooth parallel interfaces, too close together to bend light or to have an inside.
    ///
    /// All reflections between the two are summed: with R the Fresnel reflectance of one and t the tint,
    /// R′ = R + t² R (1 − R)/(1 + R), which is 2R/(1 + R) for t = 1; T′ = t² (1 − R)/(1 + R). Transmitted light goes
    /// straight on. There is no rough pane: the caller refuses roughness together with `thin`.
    #[must_use]
    pub fn thin(ior: f32, tint: Rgb) -> Self {
        Self {
            ior,
            tint,
            surface: Microsurface::SMOOTH,
            asked: Microsurface::SMOOTH,
            interface: RoughInterface::default(),
            thin: true,
        }
    }

    /// The same closed surface with another index.
    pub(crate) fn with_ior(&self, ior: f32) -> Self {
        Self::new(ior, self.tint, self.asked)
    }

    /// The surface that the interface has; smooth for a pane, and where it hardly bends light.
    #[inline]
    #[must_use]
    pub fn surface(&self) -> Microsurface {
        self.surface
    }

    /// True for a pane, which has no inside.
    #[inline]
    #[must_use]
    pub fn is_thin(&self) -> bool {
        self.thin
    }

    /// `n_transmitted / n_incident` as seen from `wo`.
    #[inline]
    pub(crate) fn eta_from(&self, wo: Vec3) -> f32 {
        if wo.z > 0.0 { self.ior } else { 1.0 / self.ior }
    }

    #[inline]
    pub(crate) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        if self.surface.is_smooth() || wo.z == 0.0 || wi.z == 0.0 {
            return (Rgb::BLACK, 0.0);
        }
        self.rough_eval_and_pdf(wo, wi, transport)
    }

    #[inline]
    pub(crate) fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        if self.thin {
            return Some(self.sample_pane(wo, u_lobe));
        }
        if self.surface.is_smooth() {
            return Some(self.sample_smooth(wo, u_lobe, transport));
        }
        self.sample_rough(wo, u_lobe, u, transport)
    }

    fn sample_smooth(&self, wo: Vec3, u_lobe: f32, transport: Transport) -> BsdfSample {
        let eta = self.eta_from(wo);
        let (f, cos_t) = fresnel_dielectric(wo.z, eta);
        if u_lobe < f {
            return BsdfSample::delta_reflection(wo, Rgb::WHITE);
        }
        let scale = transport.refraction_scale(eta);
        BsdfSample {
            wi: Vec3::new(-wo.x / eta, -wo.y / eta, (-cos_t).copysign(-wo.z)).normalize(),
            weight: self.tint * scale,
            pdf: f32::INFINITY,
            class: LobeClass::Specular,
            transmitted: true,
            eta_sq_scale: scale,
        }
    }

    fn sample_pane(&self, wo: Vec3, u_lobe: f32) -> BsdfSample {
        let (r, _) = fresnel_dielectric(wo.z, self.ior);
        let t_sq = self.tint * self.tint;
        if u_lobe < 2.0 * r / (1.0 + r) {
            let weight = (Rgb::splat(1.0 + r) + t_sq * (1.0 - r)) * 0.5;
            return BsdfSample::delta_reflection(wo, weight);
        }
        BsdfSample {
            wi: -wo,
            weight: t_sq,
            pdf: f32::INFINITY,
            class: LobeClass::Specular,
            transmitted: true,
            eta_sq_scale: 1.0,
        }
    }

    /// Reflected plus transmitted share of light, without the η² of radiance; Fresnel at the macroscopic normal.
    pub(crate) fn albedo(&self, wo: Vec3) -> Rgb {
        let (f, _) = fresnel_dielectric(wo.z, self.eta_from(wo));
        if self.thin {
            let (r, _) = fresnel_dielectric(wo.z, self.ior);
            let crossed = self.tint * self.tint * ((1.0 - r) / (1.0 + r));
            return Rgb::splat(r) + crossed * r + crossed;
        }
        let once = Rgb::splat(f) + self.tint * (1.0 - f);
        if self.surface.is_smooth() || self.surface.has_energy_compensation() {
            return once;
        }
        once * (1.0 - refraction_loss(self.surface.alpha(), self.eta_from(wo)).at(wo.z.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bsdf;

    #[test]
    fn a_frosted_bubble_is_frosted_again_in_glass() {
        let frosted = Microsurface::from_roughness(0.5, 0.05);
        let bubble = Bsdf::Dielectric(DielectricBsdf::new(1.0, Rgb::WHITE, frosted));
        assert!(!bubble.needs_light_sampling());
        let in_glass = bubble.with_relative_ior(1.0 / 1.5);
        assert_eq!(
            in_glass,
            Bsdf::Dielectric(DielectricBsdf::new(1.0 / 1.5, Rgb::WHITE, frosted))
        );
        assert!(in_glass.needs_light_sampling() && in_glass.has_diffuse());
    }
}

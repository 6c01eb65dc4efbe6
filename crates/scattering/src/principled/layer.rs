use super::{COAT_F0, PrincipledBsdf};
use crate::energy::reflection_loss;
use crate::reflectance::{SchlickReflectance, SchlickShares};
use crate::{DielectricBsdf, Microsurface};
use radiometry::Rgb;

/// A Fresnel term by its two ends, mixed and weighted: `f0 + (f90 − f0)(1 − cosθ)⁵`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Schlick {
    pub(super) f0: Rgb,
    pub(super) f90: Rgb,
}

impl Schlick {
    #[inline]
    pub(super) fn at(&self, cos: f32) -> Rgb {
        let m = 1.0 - cos.abs().min(1.0);
        let m2 = m * m;
        self.f0 + (self.f90 - self.f0) * (m2 * m2 * m)
    }

    #[inline]
    pub(super) fn albedo(&self, shares: SchlickShares) -> Rgb {
        shares.of(self.f0, self.f90)
    }
}

/// All that lies on one microsurface, the bare one or the coat: its shares of the mixture are in its factors.
#[derive(Clone, Copy)]
pub(super) struct Layer {
    pub(super) surface: Microsurface,
    pub(super) reflectance: SchlickReflectance,
    /// 1 − Ē; zero for a smooth surface.
    pub(super) average_loss: f32,
    /// Reflected by microfacets.
    pub(super) reflected: Schlick,
    /// Passed through them straight, of a thin wall.
    pub(super) passed: Schlick,
    /// What multiple scattering sends up and down, by share of what was lost.
    pub(super) multiple: [Rgb; 2],
    /// The Fresnel term over the matt base.
    pub(super) cover: Schlick,
    /// `base_color` by the share of the matt base.
    pub(super) matt: Rgb,
    /// `matt/(1 − R̄)`.
    pub(super) base: Rgb,
    /// Share of the clear solid.
    pub(super) solid: f32,
}

/// Share of multiply scattered light that a metal keeps: F̄² (1 − ℓ)/(1 − F̄ ℓ), where ℓ is lost on the way each time.
fn kept_by_metal(base_color: Rgb, loss: f32) -> Rgb {
    let average = base_color + (Rgb::WHITE - base_color) * (1.0 / 21.0);
    average.map(|f| f * f * (1.0 - loss) / (1.0 - f * loss))
}

impl PrincipledBsdf {
    pub(super) fn bare_layer(&self) -> Layer {
        let cover = Schlick {
            f0: self.f0,
            f90: Rgb::splat(self.f90),
        };
        self.layer(self.surface, cover, 1.0 - self.coated, true)
    }

    pub(super) fn coat_layer(&self) -> Layer {
        let cover = Schlick {
            f0: Rgb::splat(COAT_F0),
            f90: Rgb::WHITE,
        };
        self.layer(self.coat, cover, self.coated, false)
    }

    /// - `weight`: share of the surface.
    /// - `bare`: whether its metal shows; under a coat the metal has a lobe of its own.
    fn layer(&self, surface: Microsurface, cover: Schlick, weight: f32, bare: bool) -> Layer {
        let reflectance = SchlickReflectance::new(surface.alpha());
        let average_loss = if surface.is_smooth() {
            0.0
        } else {
            reflection_loss(surface.alpha()).average()
        };
        let thin = if self.solid { 0.0 } else { weight * self.clear };
        let (metal, opaque) = (weight * self.metal, weight * self.opaque);
        let dielectric = opaque + thin;
        let metal_term = if bare {
            Schlick {
                f0: self.base_color,
                f90: Rgb::WHITE,
            }
        } else {
            cover
        };
        let mixed = |of_metal: Rgb, of_cover: Rgb| of_metal * metal + of_cover * dielectric;
        let clear = self.base_color * thin;
        let matt = self.base_color * opaque;
        let average = cover.f0 + (cover.f90 - cover.f0) * (1.0 / 21.0);
        let metal_multiple = if bare {
            kept_by_metal(self.base_color, average_loss) * metal
        } else {
            Rgb::BLACK
        };
        let under = cover.albedo(reflectance.average());
        Layer {
            surface,
            reflectance,
            average_loss,
            reflected: Schlick {
                f0: mixed(metal_term.f0, cover.f0),
                f90: mixed(metal_term.f90, cover.f90),
            },
            passed: Schlick {
                f0: clear * (Rgb::WHITE - cover.f0),
                f90: clear * (Rgb::WHITE - cover.f90),
            },
            multiple: [metal_multiple + average * thin, clear * (Rgb::WHITE - average)],
            cover,
            matt,
            base: matt / (Rgb::WHITE - under).map(|x| x.max(1e-6)),
            solid: if self.solid { weight * self.clear } else { 0.0 },
        }
    }

    /// The clear solid with the roughness of a layer.
    pub(super) fn solid_of(&self, layer: &Layer) -> DielectricBsdf {
        DielectricBsdf::with_fresnel_averages(self.ior, self.base_color, layer.surface, self.fresnel_averages)
    }

    /// The metal under the coat, by its weight.
    pub(super) fn coated_metal(&self) -> f32 {
        self.coated * self.metal
    }

    /// The share of what a coated metal misses that it scatters after all.
    pub(super) fn kept_under_coat(&self, average_loss: f32) -> Rgb {
        kept_by_metal(self.base_color, average_loss) * self.coated_metal()
    }
}

//! The layered model of glTF 2.0, as a mixture of parts that each lose nothing.
//!
//! A surface is the mixture, by `metallic`, `transmission` and `clearcoat`, of six parts: metal, opaque dielectric and
//! transmissive dielectric, each bare or coated. Weights don't depend on direction, so the mixture is reciprocal and
//! lossless as its parts are. With F Schlick's term from `f₀ = ((ior − 1)/(ior + 1))² specular_color · specular` to
//! `f₉₀ = specular`, and R(ω) what a GGX lobe of that term reflects:
//!
//! - bare metal: GGX with F from `base_color` to 1, and what it scatters more than once ([`ConductorBsdf`]'s formula);
//! - bare dielectric: GGX with F, over `base_color (1 − R(ω_o))(1 − R(ω_i))/(π (1 − R̄))`;
//! - bare transmissive, thin: GGX with F, and `base_color (1 − F)` of the same lobe turned to the other side;
//! - bare transmissive, solid: [`DielectricBsdf`] of `ior`, tinted by `base_color`; its Fresnel term is exact and
//!   `specular` doesn't touch it;
//! - coated metal: GGX of the coat, F from 0.04 to 1; the metal's lobe, less by `min(T(ω_o), T(ω_i))` with T = 1 − R of
//!   the coat; and what the two scatter to and fro, `F_ms r(ω_o) r(ω_i)/(π r̄)`;
//! - coated dielectrics: a coat of about their own index fills their roughness, so they are the bare ones with the
//!   roughness of the coat and F from 0.04 to 1.
//!
//! Above them lies `sheen`, which takes what the formula of `KHR_materials_sheen` says: all else is scaled by
//! `min(1 − max(sheen) E(ω_o), 1 − max(sheen) E(ω_i))`. It is reciprocal, and loses a little: with sheen, one is only an
//! upper bound of a white furnace.
//!
//! Source: glTF 2.0, appendix B, and `KHR_materials_{ior, specular, transmission, volume, clearcoat, sheen}`. Differs:
//! the reciprocal form of the diffuse part and all that scatters more than once, so that white is white; the coat of
//! dielectrics, where glTF keeps a second highlight that an index of 1.5 under one of 1.5 does not have.
//!
//! [`ConductorBsdf`]: crate::ConductorBsdf
//! [`DielectricBsdf`]: crate::DielectricBsdf

mod layer;
mod mixture;
mod sample;

use crate::{DielectricBsdf, LobeClass, Microsurface};
use radiometry::Rgb;

/// Reflectance of a coat at normal incidence: index 1.5.
pub(crate) const COAT_F0: f32 = 0.04;

/// The parameters of a [`PrincipledBsdf`] at a point: what textures and factors came to.
///
/// Values out of range are clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipledParameters {
    /// Reflectance of the metal, or of the base of the dielectric, or its transmittance; in [0, 1].
    pub base_color: Rgb,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// In [0, 1]; α is its square.
    pub roughness: f32,
    /// Index of refraction of the dielectric, in [1, 4].
    pub ior: f32,
    /// Strength of the dielectric's reflection, in [0, 1]; 1 is what `ior` says.
    pub specular: f32,
    /// Colour of the dielectric's reflection at normal incidence, ≥ 0.
    pub specular_color: Rgb,
    /// Share of the dielectric that is clear instead of matt, in [0, 1].
    pub transmission: f32,
    /// True where the geometry has an inside, which light is refracted into; else it is a wall without thickness.
    pub solid: bool,
    /// Share of the surface under a clear coat, in [0, 1].
    pub clearcoat: f32,
    /// In [0, 1]; α is its square.
    pub clearcoat_roughness: f32,
    /// Colour of the sheen, in [0, 1]; black for none.
    pub sheen: Rgb,
    /// In [0, 1]; α is its square, at least 0.01.
    pub sheen_roughness: f32,
}

impl Default for PrincipledParameters {
    fn default() -> Self {
        Self {
            base_color: Rgb::WHITE,
            metallic: 0.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 1.0,
            specular_color: Rgb::WHITE,
            transmission: 0.0,
            solid: false,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            sheen: Rgb::BLACK,
            sheen_roughness: 0.0,
        }
    }
}

/// The layered surface of glTF: metal, plastic, glass, lacquer and cloth in one.
///
/// Cheap to build, so that its parameters may differ from point to point. 88 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipledBsdf {
    base_color: Rgb,
    f0: Rgb,
    f90: f32,
    /// Shares of metal, of the opaque and of the clear dielectric; their sum is 1.
    metal: f32,
    opaque: f32,
    clear: f32,
    coated: f32,
    surface: Microsurface,
    coat: Microsurface,
    sheen: Rgb,
    sheen_roughness: f32,
    ior: f32,
    /// Diffuse Fresnel reflectance of the outside and inside of a clear solid.
    fresnel_averages: [f32; 2],
    solid: bool,
}

const _: () = assert!(size_of::<PrincipledBsdf>() <= 92);

/// Clamps to [low, high]; NaN becomes `low`.
fn within(x: f32, low: f32, high: f32) -> f32 {
    x.max(low).min(high)
}

impl PrincipledBsdf {
    /// Builds the surface at a point.
    ///
    /// - `specular_alpha`: the threshold of [`lobe_class`](crate::lobe_class).
    #[must_use]
    pub fn new(parameters: &PrincipledParameters, specular_alpha: f32) -> Self {
        let p = parameters;
        let share = |x: f32| within(x, 0.0, 1.0);
        let (metal, transmission) = (share(p.metallic), share(p.transmission));
        let ior = within(p.ior, 1.0, 4.0);
        let (specular, root) = (share(p.specular), (ior - 1.0) / (ior + 1.0));
        let clear = (1.0 - metal) * transmission;
        let solid = p.solid && clear > 0.0;
        let coated = share(p.clearcoat);
        Self {
            base_color: p.base_color.map(share),
            f0: p.specular_color.map(|c| specular * share(c * root * root)),
            f90: specular,
            metal,
            opaque: (1.0 - metal) * (1.0 - transmission),
            clear,
            coated,
            surface: Microsurface::from_roughness(p.roughness, specular_alpha),
            coat: Microsurface::from_roughness(p.clearcoat_roughness, specular_alpha),
            sheen: p.sheen.map(share),
            sheen_roughness: p.sheen_roughness,
            ior,
            fresnel_averages: if solid {
                DielectricBsdf::fresnel_averages(ior)
            } else {
                [0.0; 2]
            },
            solid,
        }
    }

    /// Index of refraction of the inside, of a solid.
    #[must_use]
    pub fn ior(&self) -> f32 {
        self.ior
    }

    /// The same surface, its clear solid with another index relative to the outside; its other lobes stay as they are.
    pub(crate) fn with_solid_ior(&self, ior: f32) -> Self {
        Self {
            ior,
            fresnel_averages: DielectricBsdf::fresnel_averages(ior),
            ..*self
        }
    }

    pub(crate) fn transmits(&self) -> bool {
        self.clear > 0.0
    }

    pub(crate) fn has_inside(&self) -> bool {
        self.solid
    }

    /// The surfaces of all lobes but the matt ones.
    fn surfaces(&self) -> impl Iterator<Item = Microsurface> {
        let layered = self.metal > 0.0 || self.opaque > 0.0 || (self.clear > 0.0 && !self.solid);
        let bare = layered && (self.coated < 1.0 || self.metal > 0.0);
        let solid = |surface| DielectricBsdf::new(self.ior, Rgb::WHITE, surface).surface();
        [
            bare.then_some(self.surface),
            (layered && self.coated > 0.0).then_some(self.coat),
            (self.solid && self.coated < 1.0).then(|| solid(self.surface)),
            (self.solid && self.coated > 0.0).then(|| solid(self.coat)),
        ]
        .into_iter()
        .flatten()
    }

    /// True when a Lambertian base or a sheen is there.
    fn has_matt(&self) -> bool {
        self.opaque > 0.0 || !self.sheen.is_black()
    }

    pub(crate) fn has_class(&self, class: LobeClass) -> bool {
        (self.has_matt() && class == LobeClass::Diffuse) || self.surfaces().any(|surface| surface.class() == class)
    }

    /// Smallest GGX width of its D lobes; 0 where one of them passes light.
    pub(crate) fn sharpest_diffuse(&self) -> f32 {
        let diffuse = self.surfaces().filter(|surface| surface.class() == LobeClass::Diffuse);
        let least = diffuse.map(Microsurface::alpha).fold(1.0, f32::min);
        if self.transmits() && least < 1.0 { 0.0 } else { least }
    }

    pub(crate) fn has_delta(&self) -> bool {
        self.surfaces().any(Microsurface::is_smooth)
    }

    pub(crate) fn needs_light_sampling(&self) -> bool {
        self.has_matt() || self.surfaces().any(|surface| !surface.is_smooth())
    }
}

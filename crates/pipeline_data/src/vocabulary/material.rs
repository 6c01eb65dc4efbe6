use super::TextureMap;
use bevy_ecs::component::Component;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use glam::Vec3;
use scene_format::{Exclusive, Range, Unit};

/// A matt surface: it scatters light equally in all directions (Lambert). Two-sided.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Diffuse {
    /// Share of light that it reflects. Above about 0.9 light bounces for long, and the render takes longer.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub albedo: Vec3,
    /// A picture in place of `albedo`.
    pub albedo_texture: Option<TextureMap>,
}

impl Default for Diffuse {
    fn default() -> Self {
        Self {
            albedo: Vec3::splat(0.5),
            albedo_texture: None,
        }
    }
}

impl Diffuse {
    /// Name and value of each texture that is there.
    pub fn textures(&self) -> impl Iterator<Item = (&'static str, &TextureMap)> {
        self.albedo_texture.iter().map(|map| ("albedo_texture", map))
    }
}

/// A metal or a mirror. Two-sided.
///
/// Its colour is one of four: a named `metal`, a complex index of refraction `eta` with `k`, a colour `f0`, or a
/// constant `reflectance`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Conductor {
    /// A measured metal: "aluminium", "beryllium", "chrome", "copper", "gold", "iridium", "mercury", "silver",
    /// "tungsten" or "vanadium".
    #[reflect(@Exclusive::group("spectrum"))]
    pub metal: Option<String>,
    /// Real part of the index of refraction; needs `k`.
    #[reflect(@Range::at_least(0.0), @Exclusive::side("spectrum", "eta_k"))]
    pub eta: Option<Vec3>,
    /// Imaginary part of the index of refraction; needs `eta`.
    #[reflect(@Range::at_least(0.0), @Exclusive::side("spectrum", "eta_k"))]
    pub k: Option<Vec3>,
    /// Reflectance seen head-on; it rises towards grazing angles (Schlick).
    #[reflect(@Range::closed(0.0, 1.0), @Exclusive::group("spectrum"))]
    pub f0: Option<Vec3>,
    /// The same reflectance at every angle; non-physical, but exact in a mirror box. Counts when nothing else is written.
    #[reflect(@Range::closed(0.0, 1.0), @Exclusive::group("spectrum"))]
    pub reflectance: Vec3,
    /// 0 is a mirror, 1 nearly matt; the width α of the distribution is its square.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub roughness: f32,
    /// How the normals of its microfacets are distributed.
    pub distribution: NormalDistribution,
    /// Adds the light that bounces more than once between the microfacets. Off, rough metal is too dark; non-physical.
    /// Beckmann has none: what it loses is not tabulated.
    pub energy_compensation: bool,
    /// Factor for all that it reflects; non-physical, for scenes of renderers that have it.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub tint: Vec3,
}

impl Default for Conductor {
    fn default() -> Self {
        Self {
            metal: None,
            eta: None,
            k: None,
            f0: None,
            reflectance: Vec3::ONE,
            roughness: 0.0,
            distribution: NormalDistribution::default(),
            energy_compensation: true,
            tint: Vec3::ONE,
        }
    }
}

/// Distribution of the normals of microfacets.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalDistribution {
    /// Highlights with a long tail, as of most real surfaces (Trowbridge and Reitz).
    #[default]
    Ggx,
    /// Highlights that end.
    Beckmann,
}

impl From<NormalDistribution> for scattering::NormalDistribution {
    fn from(distribution: NormalDistribution) -> Self {
        match distribution {
            NormalDistribution::Ggx => Self::Ggx,
            NormalDistribution::Beckmann => Self::Beckmann,
        }
    }
}

/// Glass, water, an air bubble: clear, with an inside.
///
/// The side of the normal is its outside, so the geometry must be closed; a sheet without thickness takes `thin`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Dielectric {
    /// Index of refraction of the inside: water 1.33, glass 1.5, diamond 2.42, an air bubble in any of them 1. What lies
    /// outside has the index of the medium there, 1 in the open.
    #[reflect(@Range::closed(0.25, 4.0))]
    pub ior: f32,
    /// 0 is polished, 1 frosted; the GGX width is its square.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub roughness: f32,
    /// Adds the light that bounces more than once between the microfacets. Off, rough glass is too dark; non-physical.
    pub energy_compensation: bool,
    /// Factor for light each time it goes through the surface; non-physical where `absorption` would do.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub tint: Vec3,
    /// Light lost on the way through the inside: exp(−absorption · distance). Colours thick parts more than thin ones.
    #[reflect(@Range::at_least(0.0), @Unit("m⁻¹"))]
    pub absorption: Vec3,
    /// Abbe number, how little the index depends on the colour: crown glass 59, flint 36, diamond 55, water 56. Low spreads
    /// colours more. Light keeps a single wavelength from the first such surface on, so the picture takes more samples.
    #[reflect(@Range::closed(5.0, 200.0))]
    pub dispersion: Option<f32>,
    /// A pane: both of its surfaces in one, too close together to bend light. Smooth only.
    pub thin: bool,
    /// Which material is there where the insides of two overlap: the one with the higher priority; of equal ones the one
    /// that was entered last. Let a drink reach a little into its glass, and give the glass the higher one.
    #[reflect(@Range::closed(-128.0, 127.0))]
    pub priority: i8,
}

impl Default for Dielectric {
    fn default() -> Self {
        Self {
            ior: 1.5,
            roughness: 0.0,
            energy_compensation: true,
            tint: Vec3::ONE,
            absorption: Vec3::ZERO,
            dispersion: None,
            thin: false,
            priority: 0,
        }
    }
}

/// Plastic, lacquer, glazed tiles: a matt base under a clear coat. Two-sided.
///
/// Light passes the coat, is scattered by the base, and is reflected down again by the coat from inside before it leaves;
/// so it looks darker and more saturated than its `albedo`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Plastic {
    /// Share of light that the base would reflect without its coat.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub albedo: Vec3,
    /// Index of refraction of the coat relative to the outside; higher ones reflect more. 1 is no coat.
    #[reflect(@Range::closed(1.0, 4.0))]
    pub ior: f32,
    /// Of the coat: 0 is polished, 1 nearly matt; the GGX width is its square.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub roughness: f32,
}

impl Default for Plastic {
    fn default() -> Self {
        Self {
            albedo: Vec3::splat(0.5),
            ior: 1.5,
            roughness: 0.1,
        }
    }
}

use super::TextureMap;
use bevy_ecs::component::Component;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use glam::Vec3;
use scene_format::{Range, Unit};

/// The material of glTF: metal, plastic, glass, lacquer and cloth in one, mixed by its weights. Two-sided.
///
/// The metallic-roughness model with the extensions ior, specular, transmission, volume, clearcoat and sheen. White
/// mixtures without sheen lose no light.
///
/// A field that ends in `_texture` takes the place of the field before it.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Principled {
    /// Reflectance of a metal, of the matt base of anything else, or what clear material lets through.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub base_color: Vec3,
    /// A picture in place of `base_color`.
    pub base_color_texture: Option<TextureMap>,
    /// 0 is plastic or glass, 1 metal.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub metallic: f32,
    /// A picture in place of `metallic`.
    pub metallic_texture: Option<TextureMap>,
    /// 0 is polished, 1 nearly matt; the GGX width is its square.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub roughness: f32,
    /// A picture in place of `roughness`.
    pub roughness_texture: Option<TextureMap>,
    /// Index of refraction of what is not metal; it sets the strength of the reflection, and how a solid bends light.
    #[reflect(@Range::closed(1.0, 4.0))]
    pub ior: f32,
    /// Strength of the reflection of what is not metal; 1 is what `ior` says, less is non-physical. Does not change how
    /// a clear solid reflects.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub specular: f32,
    /// A picture in place of `specular`.
    pub specular_texture: Option<TextureMap>,
    /// Colour of that reflection seen head-on; non-physical. At grazing angles it is white.
    #[reflect(@Range::at_least(0.0))]
    pub specular_color: Vec3,
    /// A picture in place of `specular_color`.
    pub specular_color_texture: Option<TextureMap>,
    /// Share that is clear instead of matt: 1 is glass.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub transmission: f32,
    /// A picture in place of `transmission`.
    pub transmission_texture: Option<TextureMap>,
    /// 0 is a wall without thickness, which light passes straight. Above 0 clear material is solid: the geometry must be
    /// closed, and light bends and is absorbed by the way it really takes, so how much above is all the same.
    #[reflect(@Range::at_least(0.0), @Unit("m"))]
    pub thickness: f32,
    /// What is left of white light after `attenuation_distance` in a clear solid; at least a millionth.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub attenuation_color: Vec3,
    /// How far light goes in a clear solid until `attenuation_color` is left; without it nothing is absorbed.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub attenuation_distance: Option<f32>,
    /// Of a clear solid: which material is there where the insides of two overlap, the one with the higher priority.
    #[reflect(@Range::closed(-128.0, 127.0))]
    pub priority: i8,
    /// Share of the surface under a clear coat of index 1.5.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub clearcoat: f32,
    /// A picture in place of `clearcoat`.
    pub clearcoat_texture: Option<TextureMap>,
    /// Of the coat; the GGX width is its square.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub clearcoat_roughness: f32,
    /// A picture in place of `clearcoat_roughness`.
    pub clearcoat_roughness_texture: Option<TextureMap>,
    /// Colour of the soft shine of cloth towards its edges; black is none.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub sheen: Vec3,
    /// A picture in place of `sheen`.
    pub sheen_texture: Option<TextureMap>,
    /// How far the shine reaches in from the edges; its square is the width, 0.01 at least.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub sheen_roughness: f32,
    /// A picture in place of `sheen_roughness`.
    pub sheen_roughness_texture: Option<TextureMap>,
    /// Radiance that every geometry of this material emits, on the side of its normal. An `Emission` on the geometry
    /// itself counts instead.
    #[reflect(@Range::at_least(0.0), @Unit("W·m⁻²·sr⁻¹"))]
    pub emission: Vec3,
    /// A picture in place of `emission`.
    pub emission_texture: Option<TextureMap>,
    /// Coverage: 0 is not there, 1 hides what is behind.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub alpha: f32,
    /// A picture in place of `alpha`; often the channel `A` of the one of `base_color_texture`.
    pub alpha_texture: Option<TextureMap>,
    /// Alpha below this is 0, and all other 1: cut out instead of half there.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub alpha_cutoff: Option<f32>,
    /// A picture of normals in the frame of the texture coordinates: red to the right, green up, blue outward, 0.5 for 0.
    pub normal_texture: Option<TextureMap>,
    /// How far the normals of `normal_texture` lean; 0 is not at all, and below 0 they lean the other way: dents
    /// become bumps.
    pub normal_scale: f32,
}

impl Default for Principled {
    fn default() -> Self {
        Self {
            base_color: Vec3::splat(0.5),
            base_color_texture: None,
            metallic: 0.0,
            metallic_texture: None,
            roughness: 0.5,
            roughness_texture: None,
            ior: 1.5,
            specular: 1.0,
            specular_texture: None,
            specular_color: Vec3::ONE,
            specular_color_texture: None,
            transmission: 0.0,
            transmission_texture: None,
            thickness: 0.0,
            attenuation_color: Vec3::ONE,
            attenuation_distance: None,
            priority: 0,
            clearcoat: 0.0,
            clearcoat_texture: None,
            clearcoat_roughness: 0.0,
            clearcoat_roughness_texture: None,
            sheen: Vec3::ZERO,
            sheen_texture: None,
            sheen_roughness: 0.0,
            sheen_roughness_texture: None,
            emission: Vec3::ZERO,
            emission_texture: None,
            alpha: 1.0,
            alpha_texture: None,
            alpha_cutoff: None,
            normal_texture: None,
            normal_scale: 1.0,
        }
    }
}

impl Principled {
    /// Name and value of each texture that is there.
    pub fn textures(&self) -> impl Iterator<Item = (&'static str, &TextureMap)> {
        let all = [
            ("base_color_texture", &self.base_color_texture),
            ("metallic_texture", &self.metallic_texture),
            ("roughness_texture", &self.roughness_texture),
            ("specular_texture", &self.specular_texture),
            ("specular_color_texture", &self.specular_color_texture),
            ("transmission_texture", &self.transmission_texture),
            ("clearcoat_texture", &self.clearcoat_texture),
            ("clearcoat_roughness_texture", &self.clearcoat_roughness_texture),
            ("sheen_texture", &self.sheen_texture),
            ("sheen_roughness_texture", &self.sheen_roughness_texture),
            ("emission_texture", &self.emission_texture),
            ("alpha_texture", &self.alpha_texture),
            ("normal_texture", &self.normal_texture),
        ];
        all.into_iter().filter_map(|(name, map)| Some((name, map.as_ref()?)))
    }
}

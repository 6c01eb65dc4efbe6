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
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Principled {
    /// Reflectance of a metal, of the matt base of anything else, or what clear material lets through.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub base_color: Vec3,
    /// 0 is plastic or glass, 1 metal.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub metallic: f32,
    /// 0 is polished, 1 nearly matt; the GGX width is its square.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub roughness: f32,
    /// Index of refraction of what is not metal; it sets the strength of the reflection, and how a solid bends light.
    #[reflect(@Range::closed(1.0, 4.0))]
    pub ior: f32,
    /// Strength of the reflection of what is not metal; 1 is what `ior` says, less is non-physical. Does not change how
    /// a clear solid reflects.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub specular: f32,
    /// Colour of that reflection seen head-on; non-physical. At grazing angles it is white.
    #[reflect(@Range::at_least(0.0))]
    pub specular_color: Vec3,
    /// Share that is clear instead of matt: 1 is glass.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub transmission: f32,
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
    /// Of the coat; the GGX width is its square.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub clearcoat_roughness: f32,
    /// Colour of the soft shine of cloth towards its edges; black is none.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub sheen: Vec3,
    /// How far the shine reaches in from the edges; its square is the width, 0.01 at least.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub sheen_roughness: f32,
    /// Radiance that every geometry of this material emits, on the side of its normal. An `Emission` on the geometry
    /// itself counts instead.
    #[reflect(@Range::at_least(0.0), @Unit("W·m⁻²·sr⁻¹"))]
    pub emission: Vec3,
    /// Coverage: 0 is not there. Below 1 it is not supported yet.
    #[reflect(@Range::closed(0.0, 1.0))]
    pub alpha: f32,
}

impl Default for Principled {
    fn default() -> Self {
        Self {
            base_color: Vec3::splat(0.5),
            metallic: 0.0,
            roughness: 0.5,
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            thickness: 0.0,
            attenuation_color: Vec3::ONE,
            attenuation_distance: None,
            priority: 0,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            sheen: Vec3::ZERO,
            sheen_roughness: 0.0,
            emission: Vec3::ZERO,
            alpha: 1.0,
        }
    }
}

use bevy_ecs::component::Component;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use glam::Vec3;
use scene_format::{AssetPath, Exclusive, Range, Unit};

/// Makes the geometry of its prim shine, on the side of the geometric normal. Without a material it reflects nothing.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Emission {
    /// Radiance, the same in every direction: how bright the surface looks, whatever its size.
    #[reflect(@Range::at_least(0.0), @Unit("W·m⁻²·sr⁻¹"), @Exclusive::group("strength"))]
    pub radiance: Vec3,
    /// All the light of one instance in place of `radiance`: a larger lamp then looks dimmer. With `two_sided` both sides
    /// share it.
    #[reflect(@Range::at_least(0.0), @Unit("W"), @Exclusive::group("strength"))]
    pub power: Option<Vec3>,
    /// Whether the back shines too.
    pub two_sided: bool,
}

impl Default for Emission {
    fn default() -> Self {
        Self {
            radiance: Vec3::ONE,
            power: None,
            two_sided: false,
        }
    }
}

/// A point that shines equally in all directions. Its shadows are sharp, and cameras and mirrors do not see it.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct PointLight {
    /// All of its light: 4π times the intensity.
    #[reflect(@Range::at_least(0.0), @Unit("W"), @Exclusive::group("strength"))]
    pub power: Vec3,
    /// Light per solid angle in place of `power`.
    #[reflect(@Range::at_least(0.0), @Unit("W·sr⁻¹"), @Exclusive::group("strength"))]
    pub intensity: Option<Vec3>,
}

impl Default for PointLight {
    fn default() -> Self {
        Self {
            power: Vec3::ONE,
            intensity: None,
        }
    }
}

/// Light from all around, from infinitely far away. A scene has at most one.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct EnvironmentLight {
    /// A picture of the surroundings. Not supported yet.
    #[reflect(@Exclusive::group("source"))]
    pub file: Option<AssetPath>,
    /// The same radiance from everywhere.
    #[reflect(@Range::at_least(0.0), @Unit("W·m⁻²·sr⁻¹"), @Exclusive::group("source"))]
    pub radiance: Vec3,
    /// Factor for all of it.
    #[reflect(@Range::at_least(0.0))]
    pub scale: f32,
}

impl Default for EnvironmentLight {
    fn default() -> Self {
        Self {
            file: None,
            radiance: Vec3::ONE,
            scale: 1.0,
        }
    }
}

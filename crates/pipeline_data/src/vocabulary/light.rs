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

/// A point that shines into a cone along −Z. Its shadows are sharp, and cameras and mirrors do not see it.
///
/// Between the two angles light fades by a smoothstep in the cosine. All of its light is
/// π · intensity · (2 − cos `inner_angle` − cos `outer_angle`).
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct SpotLight {
    /// All of its light; a narrower cone is then brighter.
    #[reflect(@Range::at_least(0.0), @Unit("W"), @Exclusive::group("strength"))]
    pub power: Vec3,
    /// Light per solid angle in the middle of the cone, in place of `power`.
    #[reflect(@Range::at_least(0.0), @Unit("W·sr⁻¹"), @Exclusive::group("strength"))]
    pub intensity: Option<Vec3>,
    /// Half-angle within which it shines with full strength.
    #[reflect(@Range::closed(0.0, 180.0), @Unit("degrees"))]
    pub inner_angle: f32,
    /// Half-angle beyond which it is dark, at least `inner_angle`.
    #[reflect(@Range::half_open(0.01, 180.0), @Unit("degrees"))]
    pub outer_angle: f32,
}

impl Default for SpotLight {
    fn default() -> Self {
        Self {
            power: Vec3::ONE,
            intensity: None,
            inner_angle: 20.0,
            outer_angle: 30.0,
        }
    }
}

/// A sun: a disc infinitely far away, whose light travels along −Z. Cameras and mirrors see the disc.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct DistantLight {
    /// What arrives on a plane that faces it.
    #[reflect(@Range::at_least(0.0), @Unit("W·m⁻²"))]
    pub irradiance: Vec3,
    /// The full angle of the disc: wider makes softer shadows. 0 is a point, which nobody sees.
    #[reflect(@Range::closed(0.0, 170.0), @Unit("degrees"))]
    pub angle: f32,
}

impl Default for DistantLight {
    fn default() -> Self {
        Self {
            irradiance: Vec3::ONE,
            angle: 0.53,
        }
    }
}

/// Light from all around, from infinitely far away. A scene has at most one.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct EnvironmentLight {
    /// A picture of the surroundings by latitude and longitude, `.exr` or `.hdr` (or any other picture): its middle lies
    /// towards +Z, its left edge towards −Z, its upper edge is the zenith. A rotation of the prim turns it.
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

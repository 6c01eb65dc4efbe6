use bevy_ecs::component::Component;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use glam::{DMat4, DQuat, DVec3};
use scene_format::{Exclusive, Required, Target, Unit};

/// Places a prim in the space of its parent: first scaled, then rotated, then moved.
///
/// Normals stay perpendicular to their surface, and outside stays outside under a negative scale. A scale of 0 is an
/// error: it leaves no volume to trace.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Transform {
    /// Where the prim's origin lies.
    #[reflect(@Unit("m"))]
    pub translate: DVec3,
    /// Angles about X, Y and Z, applied in this order, counter-clockwise seen against the axis.
    #[reflect(@Unit("degrees"), @Exclusive::group("rotation"))]
    pub rotate: DVec3,
    /// Factor along each axis; negative mirrors.
    pub scale: DVec3,
    /// The rotation as (x, y, z, w) in place of `rotate`; any length but 0. For imported files.
    #[reflect(@Exclusive::group("rotation"))]
    pub quaternion: Option<DQuat>,
    /// All of it in place of the other fields: 16 numbers, column after column, the last row (0, 0, 0, 1). For imported
    /// files.
    pub matrix: Option<DMat4>,
}

impl Default for Transform {
    fn default() -> Self {
        Self {
            translate: DVec3::ZERO,
            rotate: DVec3::ZERO,
            scale: DVec3::ONE,
            quaternion: None,
            matrix: None,
        }
    }
}

/// Turns a prim so that its −Z axis looks at a point of the world.
///
/// It sets the orientation in the world: parents move the prim's origin and nothing else, and `Transform.rotate` does
/// not count. `Transform.scale` still does.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct LookAt {
    /// The point to look at, in world space, other than the prim's own place.
    #[reflect(@Required, @Unit("m"))]
    pub target: DVec3,
    /// The direction of the world that points up in the picture; not along the view.
    pub up: DVec3,
}

impl Default for LookAt {
    fn default() -> Self {
        Self {
            target: DVec3::ZERO,
            up: DVec3::Y,
        }
    }
}

/// Gives a prim and all below it the material of another prim.
///
/// The nearest binding counts; a material component on the geometry prim itself wins over any.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
pub struct MaterialBinding {
    /// The prim that carries the material component.
    #[reflect(@Required)]
    pub target: Target,
}

use bevy_ecs::component::Component;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use scene_format::{Range, Unit};

/// A pinhole camera that looks along −Z, Y up. A scale on it or above it moves it and changes nothing else.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Camera {
    /// Vertical angle of view; wider shows more and stretches the edges.
    #[reflect(@Range::closed(0.01, 179.0), @Unit("degrees"))]
    pub fov: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self { fov: 40.0 }
    }
}

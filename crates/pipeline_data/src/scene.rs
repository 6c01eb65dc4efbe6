use bevy_ecs::component::Component;
use bevy_ecs::resource::Resource;
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The composed scene file: every value with its opinions and places. Written by `load`, read by whoever raises errors.
#[derive(Resource)]
pub struct ComposedScene(pub scene_format::Scene);

/// Row of an entity's prim in [`ComposedScene`]. Written by `load`; on every entity that came from the scene.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PrimIndex(pub u32);

/// Places a prim in the world, in the scene file's own coordinates. Written by `geometry`.
#[derive(Component, Clone, Copy, Debug)]
pub struct WorldTransform(pub DAffine3);

/// Where a prim goes while the shutter is open: its world transforms at evenly spaced times from opening to closing, in
/// straight lines between. Written by `geometry`, on prims that move.
#[derive(Component, Clone, Debug)]
pub struct WorldMotion(pub Arc<[DAffine3]>);

/// The time that the picture covers, in frames. Written by whatever opens the shutter for longer than a moment; without
/// it everything stands as at the frame.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct ShutterInterval {
    /// When it opens.
    pub open: f64,
    /// When it closes, not before.
    pub close: f64,
}

/// The point of the scene file's world that is the origin of everything rendered, so that a room ten kilometres away
/// keeps its precision in `f32`. Written by `geometry`.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct SceneOrigin(pub DVec3);

/// Prim of each instance of the ray scene, by instance row. Written by `geometry`.
#[derive(Resource, Clone, Debug, Default)]
pub struct InstancePrims(pub Vec<u32>);

/// The ray scene on its way from `geometry` to `tables`, which takes it.
#[derive(Resource, Default)]
pub struct Acceleration(pub Option<spatial::RayScene>);

/// Geometry, materials and lights as light transport reads them. Written by `tables`, read by every stage that traces.
#[derive(Resource)]
pub struct TransportScene(pub transport::Scene);

/// The pictures of surroundings that the scene names, by the prim with the `EnvironmentLight`. Written by `load`.
#[derive(Resource, Clone, Debug, Default)]
pub struct EnvironmentMaps(pub BTreeMap<PrimIndex, Arc<transport::EnvironmentMap>>);

/// The camera that the render looks through. Written by `tables`.
#[derive(Resource, Clone, Debug)]
pub struct CameraFrame(pub transport::Camera);

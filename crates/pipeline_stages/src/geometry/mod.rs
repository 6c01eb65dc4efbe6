//! Geometry: where everything is, and what rays meet.
//!
//! Scene: `Transform`, `LookAt`, and one of `Sphere`, `Quad`, `Disc`, `Cuboid`, `Cylinder`, `Torus`, `Band`, `Mesh`.
//! Sets: `resolve_transforms` in [`PrepareSystems::ResolveTransforms`] places every prim in the world
//! ([`WorldTransform`](pipeline_data::WorldTransform)), at the frame and, where the
//! [`ShutterInterval`](pipeline_data::ShutterInterval) is longer than a moment, over its time
//! ([`WorldMotion`](pipeline_data::WorldMotion)), and finds the middle of all geometry
//! ([`SceneOrigin`]); `build_acceleration` in [`PrepareSystems::BuildAcceleration`] moves the
//! geometry there, in `f64`, and builds the ray scene ([`Acceleration`]), whose instances
//! are listed by prim in [`InstancePrims`], in the order of the scene.
//!
//! Counters: `geometry/instances`.
//!
//! Limits: meshes move as a whole, they do not deform. Each mesh file is stored once however many prims name it; shapes are one each, since
//! they are as small as a reference to one.

mod build;
mod motion;
mod placement;
#[cfg(test)]
mod tests;
mod transforms;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use pipeline_core::{Prepare, PrepareSystems};
use pipeline_data::{Acceleration, ComposedScene, InstancePrims, MeshStore, SceneOrigin};

/// Places prims and builds the ray scene.
pub struct GeometryPlugin;

impl Plugin for GeometryPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<MeshStore>()
            .init_resource::<SceneOrigin>()
            .init_resource::<Acceleration>()
            .init_resource::<InstancePrims>()
            .add_systems(
                Prepare,
                (
                    transforms::resolve_transforms.in_set(PrepareSystems::ResolveTransforms),
                    build::build_acceleration.in_set(PrepareSystems::BuildAcceleration),
                )
                    .run_if(resource_exists::<ComposedScene>),
            );
    }
}

//! Motion blur: the shutter stays open for a while, and each ray is shot at a time of its own.
//!
//! Scene: `MotionBlur` on the prim with the camera that `Render.camera` names. Without it, or with an interval without
//! length, no system of this stage runs and everything stands as at the frame.
//! Sets: `OpenShutter` (`open_shutter` writes the [`ShutterInterval`], which makes `geometry` keep where prims go),
//! `PerturbTime` (`sample_shutter` gives each camera ray its time, and the place of a moving camera at that time).
//!
//! Transforms, cameras, lights and emitters move, by samples over time of `Transform` and `LookAt`. Everything that a path
//! meets is met at the time of its camera ray; photons have times of their own.
//!
//! Limits: other fields than those of `Transform` and `LookAt` stay as at the frame, and so does an `EnvironmentLight`
//! (with a warning where it turns). A photon map does not know times: on
//! a surface that moves, it is blurred as over one that stands still.

mod open;
mod sample;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use glam::DVec2;
use pipeline_core::{PerturbSystems, Prepare, PrepareSystems, RenderPass};
use pipeline_data::{ComposedScene, ShutterInterval};
use radiometry::StageKey;
use scene_format::Unit;

/// Key of the random numbers of the time in the shutter interval.
const SHUTTER_STAGE: StageKey = StageKey::new("motion_blur");

/// How long the shutter of a camera is open. On the prim with the `Camera`.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct MotionBlur {
    /// When it opens and closes, counted from the frame. Half a frame is what a film camera has; longer smears more.
    #[reflect(@Unit("frames"))]
    pub shutter: DVec2,
}

impl Default for MotionBlur {
    fn default() -> Self {
        Self {
            shutter: DVec2::new(0.0, 0.5),
        }
    }
}

/// Where this stage works.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct MotionBlurSystems;

/// Adds motion blur.
pub struct MotionBlurPlugin;

impl Plugin for MotionBlurPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<MotionBlur>()
            .add_systems(
                Prepare,
                open::open_shutter
                    .in_set(PrepareSystems::OpenShutter)
                    .in_set(MotionBlurSystems)
                    .run_if(resource_exists::<ComposedScene>),
            )
            .add_systems(
                RenderPass,
                sample::sample_shutter
                    .in_set(PerturbSystems::PerturbTime)
                    .in_set(MotionBlurSystems)
                    .run_if(resource_exists::<ShutterInterval>),
            );
    }
}

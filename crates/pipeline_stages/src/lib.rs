//! The stages of the renderer, a directory each, and [`DefaultStages`], the list of them.
//!
//! A stage is a plugin: its settings are components that a scene file can carry, its systems sit in the sets of
//! `pipeline_core`, and what it shares with others stands in `pipeline_data`. Stages never import each other; adding one
//! means a directory here and a line in [`DefaultStages`].
//!
//! | stage | does |
//! |---|---|
//! | [`load`] | scene file to entities and meshes |
//! | [`geometry`] | world transforms and acceleration structures |
//! | [`tables`] | materials, lights, camera and settings, checked |
//! | [`camera`] | camera rays through the reconstruction filter |
//! | [`motion_blur`] | the time of each camera ray, and a camera that moves |
//! | [`depth_of_field`] | camera rays through a lens |
//! | [`photon_map`] | photons: emitted, stored as entities in three maps, gathered |
//! | [`photon_thinning`] | fewer photons where a picture has no use for more, with all their flux |
//! | [`final_gather`] | indirect light by rays that read the photon maps |
//! | [`radiosity`] | indirect light that matt surfaces exchange, solved for patches |
//! | [`irradiance_cache`] | indirect light at few places, as entities, and interpolated between them |
//! | [`path_guiding`] | directions of paths, drawn to where photons come from |
//! | [`path_tracing`] | intersection, emission, direct light, scattering |
//! | [`image`] | film, auxiliary channels, image files and checkpoints |
//!
//! ```
//! use bevy_app::App;
//! let mut app = App::empty();
//! app.add_plugins((pipeline_core::CorePlugin, pipeline_stages::DefaultStages));
//! let schedules = pipeline_core::describe_schedules(&mut app).expect("no ambiguities");
//! assert!(schedules.iter().any(|s| s.name == "Bounce"));
//! ```

use bevy_app::{App, Plugin};
use bevy_ecs::schedule::IntoScheduleConfigs;
use pipeline_core::Prepare;

pub mod camera;
pub mod depth_of_field;
pub mod final_gather;
pub mod geometry;
pub mod image;
pub mod irradiance_cache;
pub mod load;
pub mod motion_blur;
pub mod path_guiding;
pub mod path_tracing;
pub mod photon_map;
pub mod photon_thinning;
pub mod radiosity;
pub mod tables;

/// All stages of the renderer.
pub struct DefaultStages;

impl Plugin for DefaultStages {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            load::LoadPlugin,
            geometry::GeometryPlugin,
            tables::TablesPlugin,
            camera::CameraPlugin,
            motion_blur::MotionBlurPlugin,
            depth_of_field::DepthOfFieldPlugin,
            photon_map::PhotonMapPlugin,
            photon_thinning::PhotonThinningPlugin,
            final_gather::FinalGatherPlugin,
            radiosity::RadiosityPlugin,
            irradiance_cache::IrradianceCachePlugin,
            path_guiding::PathGuidingPlugin,
            path_tracing::PathTracingPlugin,
            image::ImagePlugin,
        ));
        // These report trouble and set the clock when they prepare. Photons are planned after whoever asks for them, records are
        // taken from a file before a film is from a checkpoint, which has to know them, radiosity takes its time when no other trouble
        // is left, and then the camera cuts the samples that the film lacks into passes.
        app.configure_sets(
            Prepare,
            (
                path_guiding::PathGuidingSystems,
                final_gather::FinalGatherSystems,
                irradiance_cache::IrradianceCacheSystems,
                photon_map::PhotonMapSystems,
                photon_thinning::PhotonThinningSystems,
                irradiance_cache::RecordFileSystems,
                image::ImageSystems,
                radiosity::RadiositySystems,
                camera::CameraSystems,
                depth_of_field::DepthOfFieldSystems,
            )
                .chain(),
        );
    }
}

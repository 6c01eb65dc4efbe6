use crate::PixelChoice;
use bevy_ecs::resource::Resource;
use glam::UVec2;
use std::path::PathBuf;
use transport::MapKinds;

/// What the caller asks of this render, beside what the scene says. Written by the command line, read by stages.
#[derive(Resource, Clone, Debug)]
pub struct RenderRequest {
    /// The scene file.
    pub scene: PathBuf,
    /// How to compose it: `--set`, `--variant`, frame, limits.
    pub options: scene_format::Options,
    /// Samples a pixel, in place of the scene's.
    pub samples: Option<u32>,
    /// Stop once the estimated relative error of the image is below this; samples are without a bound then, but for
    /// `samples`.
    pub until: Option<f64>,
    /// Seed, in place of the scene's.
    pub seed: Option<u64>,
    /// Resolution in pixels, in place of the scene's.
    pub resolution: Option<UVec2>,
    /// Part of the film to render: x0, y0, x1, y1 in pixels, the latter two exclusive.
    pub crop: Option<[u32; 4]>,
    /// Side of a film tile in pixels. Changes no bit of the picture.
    pub tile_size: u32,
    /// Files to write, each `.exr` or `.png`.
    pub outputs: Vec<PathBuf>,
    /// A file of photons to take up instead of tracing them.
    pub photons: Option<PathBuf>,
    /// A file of irradiance records to begin with.
    pub records: Option<PathBuf>,
    /// Irradiance records will be kept in a file: refuse those that change during a render.
    pub saves_records: bool,
    /// Photon maps to make beside those that the scene's methods read.
    pub photon_maps: MapKinds,
    /// Go on from the checkpoint that an interrupted render left beside its first output.
    pub resume: bool,
    /// Render these pixels alone, and keep the variance of every layer.
    pub pixels: Option<PixelChoice>,
    /// Trace everything, whatever the scene's methods, but for what they switch off: the same image without bias.
    pub traced: bool,
    /// Treat warnings as errors.
    pub strict: bool,
    /// Use colour in messages.
    pub colour: bool,
}

impl Default for RenderRequest {
    fn default() -> Self {
        Self {
            scene: PathBuf::new(),
            options: scene_format::Options::default(),
            samples: None,
            until: None,
            seed: None,
            resolution: None,
            crop: None,
            tile_size: 32,
            outputs: Vec::new(),
            photons: None,
            records: None,
            saves_records: false,
            photon_maps: MapKinds::default(),
            resume: false,
            pixels: None,
            traced: false,
            strict: false,
            colour: false,
        }
    }
}

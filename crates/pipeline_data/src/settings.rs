use bevy_ecs::resource::Resource;
use glam::UVec2;

/// The settings of this render, checked: what scene and command line together say. Written by `tables`.
#[derive(Resource, Clone, Debug)]
pub struct RenderSettings {
    /// Estimator of each term.
    pub methods: transport::Methods,
    /// Samples a pixel.
    pub samples: u32,
    /// Passes that progressive methods make of the samples; none: one a sample.
    pub passes: Option<u32>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Pixels of the whole film.
    pub resolution: UVec2,
    /// First pixel of the crop.
    pub crop_min: UVec2,
    /// One beyond the last pixel of the crop.
    pub crop_max: UVec2,
    /// Reconstruction filter.
    pub filter: film::FilterKind,
    /// Its radius in pixels.
    pub filter_radius: f32,
    /// Whether samples come in batches, for the variance of each pixel.
    pub variance: bool,
    /// Exposure of the 8-bit output, in stops.
    pub exposure: f32,
    /// Tone curve of the 8-bit output.
    pub tone_map: film::ToneMap,
    /// Row of the prim that carries `Render`, in the composed scene.
    pub render_prim: u32,
    /// Row of the prim whose `Camera` it looks through.
    pub camera_prim: u32,
}

use bevy_ecs::resource::Resource;
use glam::UVec2;
use scene_format::Scene;

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

impl RenderSettings {
    /// What a file of a render has to agree with to be taken up again: the program, the composed scene at its frame, the seed
    /// and the film. The number of samples may differ.
    ///
    /// - `purpose`: of the file, so that no kind of file passes for another.
    #[must_use]
    pub fn key(&self, scene: &Scene, purpose: &str) -> [u8; 32] {
        let mut key = scene.hash;
        scene_format::mix_hash(&mut key, purpose, env!("CARGO_PKG_VERSION").as_bytes());
        scene_format::mix_hash(&mut key, "seed", &self.seed.to_le_bytes());
        for (label, value) in [
            ("resolution", self.resolution),
            ("crop min", self.crop_min),
            ("crop max", self.crop_max),
        ] {
            scene_format::mix_hash(&mut key, label, &value.x.to_le_bytes());
            scene_format::mix_hash(&mut key, label, &value.y.to_le_bytes());
        }
        key
    }
}

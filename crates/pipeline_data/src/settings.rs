use bevy_ecs::resource::Resource;
use glam::UVec2;
use scene_format::{ComponentValue, FieldValue, Prim, Scene};

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
    /// Debug layers that the film has beside the light, by name.
    pub debug_layers: Vec<&'static str>,
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

    /// What light that was computed at places of the scene has to agree with to be taken up again: as [`RenderSettings::key`],
    /// without what decides the view alone. Camera, lens and film may differ, and the frame where nothing else changes.
    #[must_use]
    pub fn light_key(&self, scene: &Scene, purpose: &str) -> [u8; 32] {
        let only_places_views = views(scene);
        let counts = |prim: usize, component: &ComponentValue, field: Option<&FieldValue>| {
            let is_of_view = OF_VIEW.contains(&component.name)
                || PLACEMENTS.contains(&component.name) && only_places_views[prim]
                || component.name == "Render" && field.is_some_and(|field| OF_VIEW_IN_RENDER.contains(&field.name));
            !is_of_view
        };
        let is_still = |component: &ComponentValue| component.fields.iter().all(|field| field.samples().is_none());
        let mut parts = scene
            .rendered()
            .flat_map(|(i, prim)| prim.components.iter().map(move |c| (i, c)));
        let stands_still = parts.all(|(prim, component)| !counts(prim, component, None) || is_still(component));
        // Where nothing moves, it does not matter for how long the shutter is open.
        let mut key = scene.hash_of_part(|prim, component, field| {
            counts(prim, component, field) && !(stands_still && component.name == "MotionBlur")
        });
        scene_format::mix_hash(&mut key, purpose, env!("CARGO_PKG_VERSION").as_bytes());
        scene_format::mix_hash(&mut key, "seed", &self.seed.to_le_bytes());
        key
    }
}

/// Components that decide what is seen of light, and no light.
const OF_VIEW: [&str; 3] = ["Camera", "DepthOfField", "Film"];

/// Fields of `Render` that do so too; the seed is told by the settings, which the command line may have changed.
const OF_VIEW_IN_RENDER: [&str; 4] = ["camera", "samples", "seed", "passes"];

/// Components that place a prim and all below it.
const PLACEMENTS: [&str; 2] = ["Transform", "LookAt"];

/// Of each prim, whether nothing is placed by it but cameras.
fn views(scene: &Scene) -> Vec<bool> {
    let names_views = |prim: &Prim| {
        let mut names = prim.components.iter().map(|component| component.name);
        names.all(|name| OF_VIEW.contains(&name) || PLACEMENTS.contains(&name) || name == "MotionBlur")
    };
    let mut views: Vec<bool> = scene.prims.iter().map(names_views).collect();
    // Children come after their parents.
    for (i, prim) in scene.prims.iter().enumerate().rev() {
        if let (Some(parent), false) = (prim.parent, views[i] || !prim.rendered) {
            views[parent] = false;
        }
    }
    views
}

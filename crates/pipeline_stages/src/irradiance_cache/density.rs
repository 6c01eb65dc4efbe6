use bevy_ecs::prelude::*;
use pipeline_data::{DebugLayer, RenderSettings};
use transport::IndirectMethod;

/// More records on a square metre than this show as so many, which the film can hold.
const MOST_DENSITY: f32 = 1e12;

/// Records of each square metre around what a camera ray meets first, m⁻²; 0 where the cache is not asked there, or has no
/// answer. Written by `look_up_irradiance`.
#[derive(Component, Clone, Debug, Default)]
pub struct RecordDensity(Vec<f32>);

impl RecordDensity {
    /// Forgets everything.
    ///
    /// - `slots`: of the batch.
    pub(super) fn reset(&mut self, slots: usize) {
        self.0.clear();
        self.0.resize(slots, 0.0);
    }

    /// Notes the density at what the camera ray of a slot met.
    pub(super) fn set(&mut self, slot: u32, density: f32) {
        if let Some(place) = self.0.get_mut(slot as usize) {
            *place = density.min(MOST_DENSITY);
        }
    }
}

impl AsRef<[f32]> for RecordDensity {
    fn as_ref(&self) -> &[f32] {
        &self.0
    }
}

impl DebugLayer for RecordDensity {
    const NAME: &'static str = "record_density";

    fn is_shown(settings: &RenderSettings) -> bool {
        settings.methods.indirect == IndirectMethod::IrradianceCache
    }
}

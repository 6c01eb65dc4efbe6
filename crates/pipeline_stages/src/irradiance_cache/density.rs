use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{BuiltIrradianceCache, DebugLayer, HitStream, RayStream, RenderSettings};
use rayon::prelude::*;
use spatial::SurfacePoint;
use transport::IndirectMethod;

/// More records on a square metre than this show as so many, which the film can hold.
const MOST_DENSITY: f32 = 1e12;

/// Records of each square metre around what a camera ray meets first, m⁻². Written by `measure_record_density`.
#[derive(Component, Clone, Debug, Default)]
pub struct RecordDensity(Vec<f32>);

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

/// Estimates how densely records lie around what camera rays meet first.
pub(super) fn measure_record_density(
    mut batches: Query<(&RayStream, &HitStream, &mut RecordDensity)>,
    cache: Res<BuiltIrradianceCache>,
) {
    let mut batches: Vec<_> = batches.iter_mut().collect();
    let rays = batches
        .par_iter_mut()
        .map(|(rays, hits, density)| {
            let at = |point: &SurfacePoint, to_eye: glam::Vec3| {
                let facing = if point.ns.dot(to_eye) < 0.0 {
                    -point.ns
                } else {
                    point.ns
                };
                cache.0.record_density(point.p, facing).min(MOST_DENSITY)
            };
            density.0.clear();
            let first = rays.0.iter().zip(&hits.0);
            density
                .0
                .extend(first.map(|(ray, hit)| hit.as_ref().map_or(0.0, |point| at(point, -ray.direction))));
            rays.0.len()
        })
        .sum();
    record_items(rays);
}

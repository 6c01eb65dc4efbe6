use super::fill::CacheFill;
use super::plan::CachePlan;
use bevy_ecs::prelude::*;
use pipeline_core::record_items;
use pipeline_data::{BuiltIrradianceCache, CameraFrame, RenderSettings, TransportScene};
use radiometry::hash_u64;
use rayon::prelude::*;
use spatial::{Bounds, RecordOctree};
use transport::Site;

/// Camera rays that one task follows.
const TASK_RAYS: usize = 256;

/// Rays of a round at most, so that somebody who wants to stop need not wait.
const MOST_RAYS: u32 = 1 << 20;

/// Records of a cell of the octree that thins.
const CELL_RECORDS: usize = 8;

/// Places whose normals are closer than this cosine may do with one record.
pub(super) const SAME_NORMAL: f32 = 0.9;

/// Follows the camera rays of the wave to where the eye asks for indirect light.
pub(super) fn find_sites(
    mut fill: ResMut<CacheFill>,
    scene: Res<TransportScene>,
    settings: Res<RenderSettings>,
    camera: Res<CameraFrame>,
) {
    let rays = std::mem::take(&mut fill.rays);
    if rays.is_empty() {
        return;
    }
    let pixel_size = camera.0.pixel_size();
    let find = if fill.depth == 0 {
        transport::find_sites
    } else {
        transport::find_deep_sites
    };
    let found: Vec<Site> = rays
        .par_chunks(TASK_RAYS)
        .flat_map_iter(|rays| {
            let mut sites = Vec::new();
            for (path, ray) in rays {
                find(&scene.0, &settings.methods, *path, *ray, pixel_size, &mut sites);
            }
            sites
        })
        .collect();
    record_items(rays.len());
    fill.missing = found;
}

/// Drops the places that records tell of, and chooses among the others those that get a record now: in an order of chance that
/// is always the same, none nearer to another than camera rays are, or than records may be.
pub(super) fn choose_sites(
    mut fill: ResMut<CacheFill>,
    plan: Res<CachePlan>,
    cache: Res<BuiltIrradianceCache>,
    scene: Res<TransportScene>,
) {
    if fill.missing.is_empty() {
        return;
    }
    record_items(fill.missing.len());
    let filled = &cache.0[fill.depth];
    let missing = std::mem::take(&mut fill.missing);
    let most = (MOST_RAYS / plan.hemisphere.rays()).max(1) as usize;
    let spacing = plan.spacing[fill.depth].min_pixels.max(fill.step as f32);
    let bounds = scene.0.rays.bounds();
    // A place that no octree takes is left to paths: there would be no end to asking for it.
    let octree = RecordOctree::new(&bounds, CELL_RECORDS);
    let can_have = |site: &Site| octree.accepts(site.position, spacing * site.pixel).is_ok();
    let mut missing: Vec<Site> = missing
        .into_par_iter()
        .filter(|site| can_have(site) && !site.is_covered(&scene.0, filled))
        .collect();
    let is_chosen = thin(&missing, spacing, most, &bounds);
    let mut number = 0;
    fill.chosen.clear();
    missing.retain(|site| {
        let takes = is_chosen[number];
        number += 1;
        if takes {
            fill.chosen.push(*site);
        }
        !takes
    });
    fill.missing = missing;
}

/// Which of the places get a record: greedily, at least `spacing` pixels apart, and at most `most`.
pub(super) fn thin(sites: &[Site], spacing: f32, most: usize, bounds: &Bounds) -> Vec<bool> {
    let mut order: Vec<u32> = (0..sites.len() as u32).collect();
    order.sort_unstable_by_key(|row| (hash_u64(u64::from(*row)), *row));
    let mut is_chosen = vec![false; sites.len()];
    let mut taken: Vec<u32> = Vec::new();
    let mut octree = RecordOctree::new(bounds, CELL_RECORDS);
    for row in order {
        if taken.len() >= most {
            break;
        }
        let site = &sites[row as usize];
        let does_for_both = |i: u32| sites[taken[i as usize] as usize].normal.dot(site.normal) > SAME_NORMAL;
        if octree.containing(site.position).any(does_for_both) {
            continue;
        }
        if octree.insert(site.position, spacing * site.pixel).is_ok() {
            taken.push(row);
            is_chosen[row as usize] = true;
        }
    }
    is_chosen
}

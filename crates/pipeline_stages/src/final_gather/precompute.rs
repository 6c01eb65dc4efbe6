use bevy_ecs::prelude::*;
use glam::Vec3;
use pipeline_core::{Counters, Report, record_items};
use pipeline_data::{BuiltPhotonMaps, TransportScene};
use rayon::prelude::*;
use transport::{Estimate, IrradianceMap, PhotonMapsScratch, PhotonSurface, Walls};

/// Irradiance is computed at one photon of so many.
const EVERY: usize = 4;
/// Sites that one task takes: neighbours, so that each search begins with the radius of the last.
const TASK_SITES: usize = 256;

/// Computes irradiance beside a part of the photons, for gather rays to read.
pub(super) fn precompute_irradiance(
    mut maps: ResMut<BuiltPhotonMaps>,
    scene: Res<TransportScene>,
    mut counters: ResMut<Counters>,
    mut report: ResMut<Report>,
) {
    let seeds = maps.0.irradiance_seeds(EVERY);
    let reach = maps.0.max_radius();
    let records: Vec<((Vec3, PhotonSurface), Estimate)> = seeds
        .par_chunks(TASK_SITES)
        .flat_map_iter(|seeds| {
            let mut scratch = PhotonMapsScratch::default();
            let (maps, scene) = (&maps.0, &scene.0);
            seeds.iter().filter_map(move |seed| {
                let (position, normal) = maps.site_beside(scene, *seed, &mut scratch)?;
                let estimate = maps.estimate_irradiance(scene, position, normal, &mut scratch);
                let walls = Walls::around(scene, position, normal, reach);
                Some(((position, PhotonSurface { normal, walls }), estimate))
            })
        })
        .collect();
    record_items(records.len());
    counters
        .counter("final_gather/irradiance records")
        .add(records.len() as u64);
    let (sites, estimates): (Vec<_>, Vec<_>) = records.into_iter().unzip();
    match IrradianceMap::new(&sites, &estimates, reach) {
        Ok(irradiance) => maps.0.irradiance = Some(irradiance),
        Err(error) => report.warn(format!(
            "warning[final-gather]: irradiance is not computed beforehand: {error}"
        )),
    }
}

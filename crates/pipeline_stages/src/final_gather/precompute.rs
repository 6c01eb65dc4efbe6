use bevy_ecs::prelude::*;
use pipeline_core::{Counters, Report, record_items};
use pipeline_data::BuiltPhotonMaps;
use rayon::prelude::*;
use transport::{Estimate, IrradianceMap, PhotonMapsScratch};

/// Irradiance is computed at one photon of so many.
const EVERY: usize = 4;
/// Sites that one task takes: neighbours, so that each search begins with the radius of the last.
const TASK_SITES: usize = 256;
/// Bound on the error of a stored position, relative to its coordinates.
const POSITION_ERROR: f32 = 4.0 * f32::EPSILON;

/// Computes irradiance at a part of the photons, for gather rays to read.
pub(super) fn precompute_irradiance(
    mut maps: ResMut<BuiltPhotonMaps>,
    mut counters: ResMut<Counters>,
    mut report: ResMut<Report>,
) {
    let sites = maps.0.irradiance_sites(EVERY);
    let estimates: Vec<Estimate> = sites
        .par_chunks(TASK_SITES)
        .flat_map_iter(|sites| {
            let mut scratch = PhotonMapsScratch::default();
            let maps = &maps.0;
            sites.iter().map(move |(position, normal)| {
                let error = position.abs().max_element() * POSITION_ERROR;
                maps.estimate_irradiance(*position, *normal, error, &mut scratch)
            })
        })
        .collect();
    record_items(sites.len());
    counters
        .counter("final_gather/irradiance records")
        .add(sites.len() as u64);
    match IrradianceMap::new(&sites, &estimates, maps.0.max_radius()) {
        Ok(irradiance) => maps.0.irradiance = Some(irradiance),
        Err(error) => report.warn(format!(
            "warning[final-gather]: irradiance is not computed beforehand: {error}"
        )),
    }
}

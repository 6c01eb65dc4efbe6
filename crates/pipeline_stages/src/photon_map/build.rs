use super::run::PhotonRun;
use bevy_ecs::prelude::*;
use glam::Vec3;
use pipeline_core::{RenderClock, Report, record_items};
use pipeline_data::{BuiltPhotonMaps, Photon, PhotonMarker, TransportScene};
use radiometry::{Rgb, unpack_direction};
use rayon::prelude::*;
use spatial::{PhotonTree, PhotonTreeError};
use transport::{DensitySettings, PhotonColumns, PhotonMap, PhotonSurface, Walls};

/// Photons whose columns one task copies.
const TASK_PHOTONS: usize = 4096;

/// Builds the tree over the photon entities of one map and copies what the estimate reads into its order.
pub(super) fn build_photon_map<M: PhotonMarker>(
    run: Res<PhotonRun>,
    photons: Query<&Photon, With<M>>,
    mut built: ResMut<BuiltPhotonMaps>,
    mut report: ResMut<Report>,
) {
    let Some(map) = run.landed.iter().find(|map| map.plan.kind == M::KIND) else {
        return;
    };
    // All photons of one map are of one archetype, hence in one column, unless a plug-in has marked some of them.
    let columns: Vec<&[Photon]> = photons.contiguous_iter().map(Iterator::collect).unwrap_or_default();
    let joined;
    let photons: &[Photon] = match columns.as_slice() {
        [one] => one,
        many => {
            joined = many.concat();
            &joined
        }
    };
    record_items(photons.len());
    match photon_map(photons, map.density()) {
        Ok(map) => built.0.insert(M::KIND, map),
        Err(error) => {
            let kind = M::KIND.name();
            report.warn(format!("warning[photon-map]: there is no {kind} photon map: {error}"));
        }
    }
}

/// Looks for the walls around each photon, so that estimates need not.
pub(super) fn probe_walls<M: PhotonMarker>(
    run: Res<PhotonRun>,
    scene: Res<TransportScene>,
    mut built: ResMut<BuiltPhotonMaps>,
) {
    let has_landed = run.landed.iter().any(|map| map.plan.kind == M::KIND);
    let Some(map) = built.0.get_mut(M::KIND).filter(|_| has_landed) else {
        return;
    };
    look_for_walls(map, &scene.0);
    record_items(map.tree.len());
}

/// Makes the place that maps are put in. Until they are there, nothing may read it.
pub(super) fn make_room_for_maps(mut commands: Commands) {
    commands.init_resource::<BuiltPhotonMaps>();
}

/// Ends the photons of a pass.
pub(super) fn finish_photons(mut commands: Commands, mut clock: ResMut<RenderClock>) {
    commands.remove_resource::<PhotonRun>();
    clock.photons_pending -= 1;
}

/// Builds the tree over photons and copies what an estimate reads into its order.
///
/// # Errors
/// A photon whose position is not finite, or more photons than a tree can hold.
pub fn photon_map(photons: &[Photon], density: DensitySettings) -> Result<PhotonMap, PhotonTreeError> {
    let tree = PhotonTree::from_fn(photons.len(), |row| Vec3::from_array(photons[row].position))?;
    let mut columns = PhotonColumns {
        flux: vec![Rgb::BLACK; photons.len()],
        direction: vec![0; photons.len()],
        surface: vec![PhotonSurface::open(Vec3::ZERO); photons.len()],
    };
    // Photons lie in memory as they were traced, so each is a cache miss: once for all columns, and on all threads.
    (
        tree.rows().par_chunks(TASK_PHOTONS),
        columns.flux.par_chunks_mut(TASK_PHOTONS),
        columns.direction.par_chunks_mut(TASK_PHOTONS),
        columns.surface.par_chunks_mut(TASK_PHOTONS),
    )
        .into_par_iter()
        .for_each(|(rows, flux, direction, surface)| {
            for (slot, row) in rows.iter().enumerate() {
                let photon = &photons[*row as usize];
                flux[slot] = photon.flux;
                direction[slot] = photon.direction;
                surface[slot] = PhotonSurface::open(unpack_direction(photon.normal));
            }
        });
    Ok(PhotonMap { tree, columns, density })
}

/// Looks for the walls around each photon, as far as estimates reach.
pub fn look_for_walls(map: &mut PhotonMap, scene: &transport::Scene) {
    let PhotonMap { tree, columns, density } = map;
    columns.surface.par_iter_mut().enumerate().for_each(|(slot, surface)| {
        let position = tree.position(slot as u32);
        surface.walls = Walls::around(scene, position, surface.normal, density.max_radius);
    });
}

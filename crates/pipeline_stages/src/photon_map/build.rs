use super::PhotonRun;
use bevy_ecs::prelude::*;
use glam::Vec3;
use pipeline_core::{Report, record_items};
use pipeline_data::{CausticPhoton, Photon};
use radiometry::unpack_direction;
use spatial::{PhotonTree, PhotonTreeError};
use transport::{DensitySettings, PhotonColumns, PhotonMap};

/// The caustic photon map, ready to be read. Written by `build_photon_map`, read by `gather_caustics`.
#[derive(Resource)]
pub struct CausticMap {
    /// The photons.
    pub map: PhotonMap,
    /// How they are gathered.
    pub density: DensitySettings,
}

/// Builds the tree over the photon entities and copies what the estimate reads into its order.
pub(super) fn build_photon_map(
    mut commands: Commands,
    run: Res<PhotonRun>,
    photons: Query<&Photon, With<CausticPhoton>>,
    mut report: ResMut<Report>,
) {
    // All photons of one map are of one archetype, hence in one column.
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
    match caustic_map(photons) {
        Ok(map) => {
            let density = run.density;
            commands.insert_resource(CausticMap { map, density });
        }
        Err(error) => report.warn(format!("warning[photon-map]: there is no caustic photon map: {error}")),
    }
    commands.remove_resource::<PhotonRun>();
}

/// Builds the tree over photons and copies what an estimate reads into its order.
///
/// # Errors
/// A photon whose position is not finite, or more photons than a tree can hold.
pub fn caustic_map(photons: &[Photon]) -> Result<PhotonMap, PhotonTreeError> {
    let tree = PhotonTree::from_fn(photons.len(), |row| Vec3::from_array(photons[row].position))?;
    let rows = || tree.rows().iter().map(|row| &photons[*row as usize]);
    let columns = PhotonColumns {
        flux: rows().map(|p| p.flux).collect(),
        direction: rows().map(|p| p.direction).collect(),
        normal: rows().map(|p| unpack_direction(p.normal)).collect(),
    };
    Ok(PhotonMap { tree, columns })
}

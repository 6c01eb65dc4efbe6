use super::plan::ThinningPlan;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, Report, record_items};
use pipeline_data::{Photon, PhotonMarker};
use radiometry::unpack_direction;
use transport::PhotonRows;

/// The counter of these systems, asked for once.
pub(super) struct RemovedCounter(Counter);

impl FromWorld for RemovedCounter {
    fn from_world(world: &mut World) -> Self {
        Self(
            world
                .resource_mut::<Counters>()
                .counter("photon_thinning/photons removed"),
        )
    }
}

/// Thins the photons of one map when they have been stored anew.
///
/// Change detection tells: other runs of the pass, and passes that leave this map as it is, must not thin it again.
pub(super) fn thin_photons<M: PhotonMarker>(
    mut commands: Commands,
    plan: Res<ThinningPlan>,
    mut photons: Query<(Entity, Mut<Photon>), With<M>>,
    removed: Local<RemovedCounter>,
    mut report: ResMut<Report>,
) {
    if !photons.iter().any(|(_, photon)| photon.is_changed()) {
        return;
    }
    let stored = || photons.iter().map(|(_, photon)| photon);
    let position: Vec<_> = stored().map(|photon| photon.position.into()).collect();
    let normal: Vec<_> = stored().map(|photon| unpack_direction(photon.normal)).collect();
    let flux: Vec<_> = stored().map(|photon| photon.flux).collect();
    record_items(position.len());
    let rows = PhotonRows {
        position: &position,
        normal: &normal,
        flux: &flux,
    };
    let thinned = match transport::thin_photons(rows, |position| plan.most_density(position)) {
        Ok(thinned) => thinned,
        Err(error) => {
            let kind = M::KIND.name();
            report.warn(format!(
                "warning[photon-thinning]: {kind} photons are not thinned: {error}"
            ));
            return;
        }
    };
    let mut count = 0;
    for ((entity, mut photon), flux) in photons.iter_mut().zip(thinned) {
        match flux {
            Some(flux) if flux != photon.flux => photon.flux = flux,
            Some(_) => {}
            None => {
                commands.entity(entity).despawn();
                count += 1;
            }
        }
    }
    removed.0.add(count);
}

use super::run::PhotonRun;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, record_items};
use pipeline_data::{Photon, PhotonMarker};

/// The query that [`store_in_pool`] overwrites.
pub type PhotonPool<'w, 's, M> = Query<'w, 's, &'static mut Photon, With<M>>;

/// The counter of these systems, asked for once.
pub(super) struct StoredCounter(Counter);

impl FromWorld for StoredCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("photon_map/photons stored"))
    }
}

/// Makes the photons that landed for one map entities, their flux divided by the number emitted.
pub(super) fn store_photons<M: PhotonMarker>(
    mut commands: Commands,
    mut run: ResMut<PhotonRun>,
    mut pool: PhotonPool<'_, '_, M>,
    entities: Query<Entity, (With<Photon>, With<M>)>,
    stored: Local<StoredCounter>,
) {
    let Some(map) = run.landed.iter_mut().find(|map| map.plan.kind == M::KIND) else {
        return;
    };
    let mut photons = std::mem::take(&mut map.photons);
    let scale = 1.0 / map.emitted.unwrap_or(1).max(1) as f32;
    for photon in &mut photons {
        photon.flux *= scale;
    }
    stored.0.add(photons.len() as u64);
    record_items(photons.len());
    let overwritten = store_in_pool(&photons, &mut pool);
    if overwritten < photons.len() {
        let new: Vec<_> = photons[overwritten..]
            .iter()
            .map(|photon| (*photon, M::default()))
            .collect();
        commands.spawn_batch(new);
    }
    // Counting costs nothing, walking a million entities to find none too many does.
    if entities.iter().len() > photons.len() {
        for entity in entities.iter().skip(photons.len()) {
            commands.entity(entity).despawn();
        }
    }
}

/// Overwrites the photon entities that there are, column by column; returns how many photons found a place.
pub fn store_in_pool<M: PhotonMarker>(photons: &[Photon], pool: &mut PhotonPool<'_, '_, M>) -> usize {
    let mut done = 0;
    if let Ok(columns) = pool.contiguous_iter_mut() {
        for mut column in columns {
            let n = column.len().min(photons.len() - done);
            column[..n].copy_from_slice(&photons[done..done + n]);
            done += n;
        }
    }
    done
}

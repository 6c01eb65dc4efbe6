use super::fill::CacheFill;
use bevy_ecs::prelude::*;
use pipeline_core::{Counter, Counters, RenderClock, Report, record_items};
use pipeline_data::{BuiltIrradianceCache, IrradianceRecord, TransportScene};

/// The counter of this system, asked for once.
pub(super) struct RecordCounter(Counter);

impl FromWorld for RecordCounter {
    fn from_world(world: &mut World) -> Self {
        Self(world.resource_mut::<Counters>().counter("irradiance_cache/records"))
    }
}

/// Makes the records of the round entities, numbered in the order in which their places were found.
pub(super) fn insert_records(mut commands: Commands, mut fill: ResMut<CacheFill>, counter: Local<RecordCounter>) {
    let sampled = std::mem::take(&mut fill.sampled);
    record_items(sampled.len());
    counter.0.add(sampled.len() as u64);
    let first = fill.next_number;
    fill.next_number += sampled.len() as u32;
    let numbered: Vec<IrradianceRecord> = (first..)
        .zip(sampled)
        .map(|(number, record)| IrradianceRecord { number, record })
        .collect();
    commands.spawn_batch(numbered);
}

/// Takes new record entities into the cache by number, and writes ranges that neighbours have lowered back to all of them.
/// Ends the pass once nothing is missing.
pub(super) fn maintain_octree(
    mut commands: Commands,
    fill: Res<CacheFill>,
    mut cache: ResMut<BuiltIrradianceCache>,
    mut entities: Query<&mut IrradianceRecord>,
    scene: Res<TransportScene>,
    mut clock: ResMut<RenderClock>,
    mut report: ResMut<Report>,
) {
    let known = cache.0.records().len();
    let mut new: Vec<IrradianceRecord> = entities
        .iter()
        .filter(|entity| entity.number as usize >= known)
        .copied()
        .collect();
    record_items(new.len());
    let mut result = Ok(());
    if !new.is_empty() {
        new.sort_unstable_by_key(|entity| entity.number);
        let records: Vec<_> = new.iter().map(|entity| entity.record).collect();
        result = cache.0.insert(&records);
        for mut entity in &mut entities {
            let range = cache.0.records().get(entity.number as usize).map(|record| record.range);
            if let Some(range) = range.filter(|range| *range != entity.record.range) {
                entity.record.range = range;
            }
        }
    }
    if fill.is_over() {
        // Records of a file alone are in an octree of their last ranges already.
        if fill.next_number > fill.first_number {
            result = result.and_then(|()| cache.0.rebuild(&scene.0.rays.bounds()));
        }
        commands.remove_resource::<CacheFill>();
        clock.records_pending -= 1;
    }
    if let Err(error) = result {
        report.warn(format!("warning[irradiance-cache]: a record is not used: {error}"));
    }
}

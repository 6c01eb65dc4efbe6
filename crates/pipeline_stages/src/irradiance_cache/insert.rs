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
    let depth = fill.depth;
    let first = fill.next_number[depth];
    fill.next_number[depth] += sampled.len() as u32;
    let numbered: Vec<IrradianceRecord> = (first..)
        .zip(sampled)
        .map(|(number, record)| IrradianceRecord {
            number,
            depth: depth as u32,
            record,
        })
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
    let is_filled = |entity: &IrradianceRecord| entity.depth as usize == fill.depth;
    let filled = &mut cache.0[fill.depth];
    let known = filled.records().len();
    let mut new: Vec<IrradianceRecord> = entities
        .iter()
        .filter(|entity| is_filled(entity) && entity.number as usize >= known)
        .copied()
        .collect();
    record_items(new.len());
    let mut result = Ok(());
    if !new.is_empty() {
        new.sort_unstable_by_key(|entity| entity.number);
        let records: Vec<_> = new.iter().map(|entity| entity.record).collect();
        result = filled.insert(&records);
        for mut entity in entities.iter_mut().filter(|entity| is_filled(entity)) {
            let range = filled.records().get(entity.number as usize).map(|record| record.range);
            if let Some(range) = range.filter(|range| *range != entity.record.range) {
                entity.record.range = range;
            }
        }
    }
    if fill.is_over() {
        for (depth, filled) in cache.0.iter_mut().enumerate() {
            // Records of a file alone are in an octree of their last ranges already.
            if fill.next_number[depth] > fill.first_number[depth] {
                result = result.and_then(|()| filled.rebuild(&scene.0.rays.bounds()));
            }
        }
        commands.remove_resource::<CacheFill>();
        clock.records_pending -= 1;
    }
    if let Err(error) = result {
        report.warn(format!("warning[irradiance-cache]: a record is not used: {error}"));
    }
}

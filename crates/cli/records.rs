//! `pipeline records`: draws the irradiance records of a scene, or writes them down.

use crate::args::RecordsArgs;
use crate::cache_session::CacheSession;
use crate::exit::Failure;
use crate::parse::CacheFormat;
use crate::point_picture::{self, Point};
use crate::record_colour::Colours;
use crate::record_ply;
use crate::summary;
use bevy_app::App;
use bevy_ecs::world::World;
use film::{WriteError, atomic_write};
use pipeline_core::RenderClock;
use pipeline_data::{BorrowedRecords, IrradianceRecord, RecordKeys, RecordsByDepth, SceneOrigin, write_records};
use std::io;
use std::path::Path;

/// Extension of files that a render takes up again.
const OWN: &str = "records";

pub(crate) fn execute(options: &RecordsArgs) -> Result<(), Failure> {
    let session = CacheSession {
        scene: &options.scene,
        draw: &options.draw,
        output: &options.output,
        clock: RenderClock {
            records_only: true,
            ..RenderClock::default()
        },
    };
    let mut app = session.make(|request| {
        request.records = options.records.clone();
        request.saves_records = options.output.iter().any(|path| is_own(path));
    })?;
    let records = made(&mut app);
    // Deep records are in files alone: the eye does not read them.
    let (seen, deep) = records.split_at(records.partition_point(|entity| entity.depth == 0));
    let colours = Colours::new(options.colour, seen);
    let mut found = vec![format!("{} records, and {} deeper ones", seen.len(), deep.len())];
    found.extend(summary::reused_records(&app));
    let world = app.world();
    session.write(&found, |path| match CacheFormat::of(path, OWN) {
        Some(CacheFormat::Own) => write_own(world, path, &records),
        Some(CacheFormat::Ply) => {
            let origin = world.resource::<SceneOrigin>().0;
            atomic_write(path, |file| record_ply::write(file, seen, origin, &colours))
        }
        Some(CacheFormat::Png) | None => {
            let points: Vec<Point> = seen.iter().map(|entity| colours.point(entity)).collect();
            point_picture::write(path, world, &points)
        }
    })
}

fn is_own(path: &Path) -> bool {
    CacheFormat::of(path, OWN) == Some(CacheFormat::Own)
}

/// The record entities, by depth and number.
fn made(app: &mut App) -> Vec<IrradianceRecord> {
    let mut records = app.world_mut().query::<&IrradianceRecord>();
    let mut records: Vec<IrradianceRecord> = records.iter(app.world()).copied().collect();
    records.sort_unstable_by_key(|entity| (entity.depth, entity.number));
    records
}

/// Writes the records of all depths for a render to take up.
fn write_own(world: &World, path: &Path, records: &[IrradianceRecord]) -> Result<(), WriteError> {
    let of_depth = |depth: usize| records.iter().filter(move |entity| entity.depth as usize == depth);
    let by_depth: RecordsByDepth = std::array::from_fn(|depth| of_depth(depth).map(|entity| entity.record).collect());
    let origin = *world.resource::<SceneOrigin>();
    let borrowed = world.get_resource::<BorrowedRecords>().copied();
    atomic_write(path, |file| match world.get_resource::<RecordKeys>() {
        Some(keys) => write_records(file, keys, borrowed, origin, &by_depth),
        // To keep these was refused before any was made.
        None => Err(io::Error::other("records that change during a render cannot be kept")),
    })
}

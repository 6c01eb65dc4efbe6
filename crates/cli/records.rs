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
use pipeline_data::{IrradianceRecord, RecordKeys, SceneOrigin, write_records};
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
    let colours = Colours::new(options.colour, &records);
    let mut found = vec![format!("{} records", records.len())];
    found.extend(summary::reused_records(&app));
    session.write(&found, |path| write(app.world(), path, &records, &colours))
}

fn is_own(path: &Path) -> bool {
    CacheFormat::of(path, OWN) == Some(CacheFormat::Own)
}

/// The record entities, by number.
fn made(app: &mut App) -> Vec<IrradianceRecord> {
    let mut records = app.world_mut().query::<&IrradianceRecord>();
    let mut records: Vec<IrradianceRecord> = records.iter(app.world()).copied().collect();
    records.sort_unstable_by_key(|entity| entity.number);
    records
}

fn write(world: &World, path: &Path, records: &[IrradianceRecord], colours: &Colours) -> Result<(), WriteError> {
    let origin = *world.resource::<SceneOrigin>();
    match (CacheFormat::of(path, OWN), world.get_resource::<RecordKeys>()) {
        (Some(CacheFormat::Ply), _) => atomic_write(path, |file| record_ply::write(file, records, origin.0, colours)),
        (Some(CacheFormat::Own), Some(keys)) => {
            let records: Vec<_> = records.iter().map(|entity| entity.record).collect();
            atomic_write(path, |file| write_records(file, keys, origin, &records))
        }
        // Without keys records change during a render; to keep them was refused before any was made.
        (Some(CacheFormat::Png | CacheFormat::Own) | None, _) => {
            let points: Vec<Point> = records.iter().map(|entity| colours.point(entity)).collect();
            point_picture::write(path, world, &points)
        }
    }
}

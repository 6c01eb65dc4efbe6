//! `pipeline photons`: draws the photons of a scene, or writes them down.

use crate::args::{PhotonColour, PhotonMapName, PhotonsArgs};
use crate::exit::Failure;
use crate::interrupt;
use crate::outputs;
use crate::parse::PhotonFormat;
use crate::photon_picture;
use crate::photon_ply;
use crate::progress::{Display, Watcher};
use crate::session;
use crate::terminal::say;
use bevy_app::App;
use bevy_ecs::query::With;
use film::atomic_write;
use pipeline_core::{Cancellation, Outcome, Progress, RenderClock};
use pipeline_data::{
    CausticPhoton, ComposedScene, DirectPhoton, IndirectPhoton, Photon, PhotonMarker, PhotonsOfKind, RenderRequest,
    RenderSettings, SceneOrigin, write_photons,
};
use pipeline_stages::photon_map::photon_key;
use std::path::Path;
use transport::{MapKind, MapKinds};

pub(crate) fn execute(options: &PhotonsArgs) -> Result<(), Failure> {
    outputs::check_writable(&options.output)?;
    session::use_threads(options.threads)?;
    let kinds = wanted_kinds(&options.map);
    let mut app = session::new_app();
    app.insert_resource(RenderRequest {
        seed: options.seed,
        resolution: options.resolution.map(Into::into),
        crop: options.crop,
        photon_maps: kinds,
        ..session::scene_request(&options.scene)
    })
    .insert_resource(RenderClock {
        photons_only: true,
        ..RenderClock::default()
    });
    let display = Display::new(options.quiet);
    interrupt::listen(app.world().resource::<Cancellation>(), &display)?;
    let progress = app.world().resource::<Progress>().clone();
    let watcher = Watcher::start(progress, display, None);
    let outcome = pipeline_core::render(&mut app);
    drop(watcher);
    session::tell_warnings(&app);
    match outcome {
        Outcome::BadScene => return Err(session::bad_scene(&app)),
        Outcome::Interrupted => return Err(Failure::interrupted()),
        Outcome::Finished | Outcome::WriteFailed => {}
    }
    let maps = landed(&mut app, kinds);
    if !options.quiet {
        for (kind, photons) in &maps {
            say(&format!("{} {} photons", photons.len(), kind.name()));
        }
    }
    for path in &options.output {
        write(&app, path, &maps, options.colour)?;
        if !options.quiet {
            say(&format!("wrote {}", path.display()));
        }
    }
    Ok(())
}

/// The maps that were asked for; all where none was named.
fn wanted_kinds(names: &[PhotonMapName]) -> MapKinds {
    let all = MapKind::ALL.into_iter();
    let named = |kind: &MapKind| names.is_empty() || names.iter().any(|name| MapKind::from(*name) == *kind);
    all.filter(named).fold(MapKinds::default(), MapKinds::with)
}

/// The photon entities of the maps that are wanted and hold any, in the order in which they were stored.
fn landed(app: &mut App, kinds: MapKinds) -> Vec<PhotonsOfKind> {
    fn of<M: PhotonMarker>(app: &mut App) -> PhotonsOfKind {
        let mut photons = app.world_mut().query_filtered::<&Photon, With<M>>();
        (M::KIND, photons.iter(app.world()).copied().collect())
    }
    let all = [
        of::<DirectPhoton>(app),
        of::<CausticPhoton>(app),
        of::<IndirectPhoton>(app),
    ];
    let wanted = all
        .into_iter()
        .filter(|(kind, photons)| kinds.wants(*kind) && !photons.is_empty());
    wanted.collect()
}

fn write(app: &App, path: &Path, maps: &[PhotonsOfKind], colour: PhotonColour) -> Result<(), Failure> {
    let world = app.world();
    let origin = *world.resource::<SceneOrigin>();
    let written = match PhotonFormat::of(path) {
        Some(PhotonFormat::Ply) => atomic_write(path, |file| photon_ply::write(file, maps, origin.0, colour)),
        Some(PhotonFormat::Photons) => {
            let key = photon_key(&world.resource::<ComposedScene>().0, world.resource::<RenderSettings>());
            atomic_write(path, |file| write_photons(file, &key, origin, maps))
        }
        Some(PhotonFormat::Png) | None => photon_picture::write(path, world, maps, colour),
    };
    written.map_err(|error| Failure::failed(error.to_string()))
}

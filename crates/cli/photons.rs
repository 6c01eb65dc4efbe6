//! `pipeline photons`: draws the photons of a scene, or writes them down.

use crate::args::{PhotonMapName, PhotonsArgs};
use crate::cache_session::CacheSession;
use crate::exit::Failure;
use crate::parse::CacheFormat;
use crate::photon_colour::Colours;
use crate::photon_ply;
use crate::point_picture::{self, Point};
use bevy_app::App;
use bevy_ecs::query::With;
use bevy_ecs::world::World;
use film::{WriteError, atomic_write};
use pipeline_core::RenderClock;
use pipeline_data::{
    CausticPhoton, ComposedScene, DirectPhoton, IndirectPhoton, Photon, PhotonMarker, PhotonsOfKind, RenderSettings,
    SceneOrigin, write_photons,
};
use pipeline_stages::photon_map::photon_key;
use std::path::Path;
use transport::{MapKind, MapKinds};

pub(crate) fn execute(options: &PhotonsArgs) -> Result<(), Failure> {
    let session = CacheSession {
        scene: &options.scene,
        draw: &options.draw,
        output: &options.output,
        clock: RenderClock {
            photons_only: true,
            ..RenderClock::default()
        },
    };
    let kinds = wanted_kinds(&options.map);
    let mut app = session.make(|request| request.photon_maps = kinds)?;
    let maps = landed(&mut app, kinds);
    let colours = Colours::new(options.colour, &maps);
    let found: Vec<String> = maps
        .iter()
        .map(|(kind, photons)| format!("{} {} photons", photons.len(), kind.name()))
        .collect();
    session.write(&found, |path| write(app.world(), path, &maps, &colours))
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

fn write(world: &World, path: &Path, maps: &[PhotonsOfKind], colours: &Colours) -> Result<(), WriteError> {
    let origin = *world.resource::<SceneOrigin>();
    match CacheFormat::of(path, "photons") {
        Some(CacheFormat::Ply) => atomic_write(path, |file| photon_ply::write(file, maps, origin.0, colours)),
        Some(CacheFormat::Own) => {
            let key = photon_key(&world.resource::<ComposedScene>().0, world.resource::<RenderSettings>());
            atomic_write(path, |file| write_photons(file, &key, origin, maps))
        }
        Some(CacheFormat::Png) | None => {
            let of_map = |(kind, photons): &PhotonsOfKind| -> Vec<Point> {
                photons.iter().map(|photon| colours.point(*kind, photon)).collect()
            };
            let points: Vec<Point> = maps.iter().flat_map(of_map).collect();
            point_picture::write(path, world, &points)
        }
    }
}

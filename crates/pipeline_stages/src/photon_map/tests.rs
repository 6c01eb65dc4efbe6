use super::run::{MapPlan, MapRun, PhotonRun};
use super::store::store_photons;
use bevy_ecs::prelude::*;
use bevy_ecs::system::RunSystemOnce;
use pipeline_core::Counters;
use pipeline_data::{CausticPhoton, Photon};
use radiometry::Rgb;
use transport::{DensityFilter, DensitySettings, MapKind};

fn photon(path: u32) -> Photon {
    Photon {
        position: [path as f32, 0.0, 0.0],
        flux: Rgb::splat(8.0),
        direction: 0,
        normal: 0,
        path,
        bounce: 1,
    }
}

/// Stores this many photons of 16 emitted, as a pass does.
fn store(world: &mut World, count: u32) {
    let density = DensitySettings {
        nearest: 50,
        max_radius: 1.0,
        filter: DensityFilter::Cone,
        shrink: 1.0,
    };
    let mut map = MapRun::new(
        MapPlan {
            kind: MapKind::Caustic,
            wanted: u64::from(count),
            density,
            batches: None,
        },
        0,
    );
    map.emitted = Some(16);
    map.photons = (0..count).map(photon).collect();
    let run = PhotonRun {
        emissions: Default::default(),
        landed: vec![map],
    };
    world.insert_resource(run);
    world.run_system_once(store_photons::<CausticPhoton>).unwrap();
}

/// The stored photons: entity, path and flux.
fn stored(world: &mut World) -> Vec<(Entity, u32, f32)> {
    let mut query = world.query_filtered::<(Entity, &Photon), With<CausticPhoton>>();
    query.iter(world).map(|(e, p)| (e, p.path, p.flux.g)).collect()
}

#[test]
fn a_pass_overwrites_the_photons_of_the_last_and_keeps_only_its_own() {
    let mut world = World::new();
    world.init_resource::<Counters>();
    let mut before = Vec::new();
    for count in [3, 7, 2, 0, 4, 4] {
        store(&mut world, count);
        let after = stored(&mut world);
        let photons: Vec<_> = after.iter().map(|(_, path, flux)| (*path, *flux)).collect();
        let expected: Vec<_> = (0..count).map(|path| (path, 0.5)).collect();
        assert_eq!(
            photons, expected,
            "in order, each a sixteenth of the flux it landed with"
        );
        let kept = before.len().min(after.len());
        assert_eq!(
            before[..kept],
            after[..kept],
            "no entity is made anew that could be overwritten"
        );
        before = after;
    }
    assert_eq!(world.resource::<Counters>().get("photon_map/photons stored"), 20);
}

use super::plan::ThinningPlan;
use super::thin::thin_photons;
use bevy_ecs::prelude::*;
use glam::{Vec2, Vec3};
use pipeline_core::{Counters, Report};
use pipeline_data::{CausticPhoton, DirectPhoton, Photon};
use radiometry::{Rgb, pack_direction};
use transport::{Camera, MovingFrame};

/// A lattice of photons, one a square centimetre.
const SIDE: u32 = 40;

fn photon(path: u32) -> Photon {
    Photon {
        position: [(path % SIDE) as f32 * 0.01, 0.0, (path / SIDE) as f32 * 0.01],
        flux: Rgb::splat(0.5),
        direction: 0,
        normal: pack_direction(Vec3::Y),
        path,
        bounce: 1,
    }
}

/// A world in which a quarter of the photons is enough, as seen from an eye at this height.
fn world(height: f32) -> World {
    let mut world = World::new();
    world.init_resource::<Counters>();
    world.init_resource::<Report>();
    let pixel = 0.02 / height;
    world.insert_resource(ThinningPlan {
        density: 1.0,
        eye: Vec3::new(0.2, height, 0.2),
        pixel,
    });
    world.spawn_batch((0..SIDE * SIDE).map(|path| (photon(path), CausticPhoton)));
    world.spawn_batch((0..9).map(|path| (photon(path), DirectPhoton)));
    world
}

fn of<M: Component>(world: &mut World) -> (usize, f32) {
    let mut photons = world.query_filtered::<&Photon, With<M>>();
    let flux = photons.iter(world).map(|photon| photon.flux.g);
    (flux.clone().count(), flux.sum())
}

#[test]
fn photons_are_thinned_once_after_they_were_stored_and_keep_their_flux() {
    let mut world = world(10.0);
    let thin = world.register_system(thin_photons::<CausticPhoton>);
    world.run_system(thin).unwrap();
    let all = (SIDE * SIDE) as usize;
    let (count, flux) = of::<CausticPhoton>(&mut world);
    assert!(count > all / 5 && count < all / 2, "{count} of {all}");
    assert_eq!(flux, 0.5 * all as f32);
    assert_eq!(of::<DirectPhoton>(&mut world), (9, 4.5), "of another map");
    let removed = world.resource::<Counters>().get("photon_thinning/photons removed");
    assert_eq!(removed as usize, all - count);

    // Nothing was stored since.
    world.resource_mut::<ThinningPlan>().density = 0.1;
    world.run_system(thin).unwrap();
    assert_eq!(of::<CausticPhoton>(&mut world).0, count);

    // The next pass overwrites one, and so all.
    let mut photons = world.query_filtered::<&mut Photon, With<CausticPhoton>>();
    photons.iter_mut(&mut world).next().unwrap().path = 7;
    world.run_system(thin).unwrap();
    let (again, flux) = of::<CausticPhoton>(&mut world);
    assert!(again < count / 2, "{again} of {count}");
    assert_eq!(flux, 0.5 * all as f32);
}

#[test]
fn what_is_enough_follows_from_the_pixels() {
    let frame = MovingFrame::fixed(glam::Affine3A::from_translation(Vec3::new(0.0, 0.0, 2.0)));
    let camera = Camera::new(frame, 90_f32.to_radians(), Vec2::new(200.0, 100.0));
    let plan = ThinningPlan::new(3.0, &camera, Vec2::new(200.0, 100.0));
    // At one metre, 100 pixels are two metres.
    let pixel = 0.02;
    for distance in [0.5, 1.0, 8.0_f32] {
        let expected = 3.0 / (pixel * distance).powi(2);
        let density = plan.most_density(Vec3::new(0.0, 0.0, 2.0 - distance));
        assert!(
            (density / expected - 1.0).abs() < 1e-3,
            "{density} instead of {expected}"
        );
    }
    assert_eq!(plan.most_density(Vec3::new(0.0, 0.0, 2.0)), f32::INFINITY);
}

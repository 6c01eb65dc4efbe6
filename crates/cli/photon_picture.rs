//! Photons as points over a dim picture of the scene.

use crate::args::PhotonColour;
use crate::photon_colour::Colours;
use bevy_ecs::world::World;
use film::{WriteError, write_rgb8_png};
use glam::{Vec2, Vec3};
use pipeline_data::{CameraFrame, PhotonsOfKind, RenderSettings, TransportScene};
use rayon::prelude::*;
use spatial::Ray;
use std::path::Path;
use transport::{Camera, Scene};

/// Brightness of a white surface that faces the camera, under the photons.
const SURFACES: f32 = 0.22;
/// When things that move are drawn, in the shutter interval.
const TIME: f32 = 0.5;
/// Photons are hidden by what is nearer to the eye than this share of their distance.
const NEARER: f32 = 0.999;

/// Draws each photon that the camera sees, in the middle of the shutter interval, as one pixel.
pub(crate) fn write(
    path: &Path,
    world: &World,
    maps: &[PhotonsOfKind],
    colour: PhotonColour,
) -> Result<(), WriteError> {
    let settings = world.resource::<RenderSettings>();
    let (scene, camera) = (
        &world.resource::<TransportScene>().0,
        &world.resource::<CameraFrame>().0,
    );
    let size = settings.crop_max - settings.crop_min;
    let low = settings.crop_min.as_vec2();
    let mut pixels: Vec<[f32; 3]> = (0..size.x as usize * size.y as usize)
        .into_par_iter()
        .map(|i| {
            let pixel = Vec2::new((i % size.x as usize) as f32, (i / size.x as usize) as f32);
            surface(scene, &camera.ray(low + pixel + 0.5, TIME))
        })
        .collect();
    let colours = Colours::new(colour, maps);
    for (kind, photons) in maps {
        // Which pixel each photon is seen in, found in parallel and drawn in order.
        let places: Vec<Option<usize>> = photons
            .par_iter()
            .map(|photon| {
                let film = seen_at(scene, camera, Vec3::from_array(photon.position))? - low;
                let inside = film.cmpge(Vec2::ZERO).all() && film.cmplt(size.as_vec2()).all();
                inside.then(|| film.y as usize * size.x as usize + film.x as usize)
            })
            .collect();
        for (photon, place) in photons.iter().zip(places) {
            let Some(pixel) = place.and_then(|place| pixels.get_mut(place)) else {
                continue;
            };
            for (value, point) in pixel.iter_mut().zip(colours.of(*kind, photon)) {
                // The brightest of a pixel, so that crowds keep their colour.
                *value = value.max(point);
            }
        }
    }
    let bytes: Vec<u8> = pixels
        .as_flattened()
        .iter()
        .map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8)
        .collect();
    write_rgb8_png(path, size.x, size.y, &bytes)
}

/// How a surface is shaded that a camera ray meets.
fn surface(scene: &Scene, ray: &Ray) -> [f32; 3] {
    let Some(hit) = scene.rays.intersect(ray) else {
        return [0.0; 3];
    };
    let point = scene.rays.surface(ray, &hit);
    [SURFACES * point.ns.dot(ray.direction).abs(); 3]
}

/// The place on the film where a point is seen; `None` behind the camera or behind something.
fn seen_at(scene: &Scene, camera: &Camera, point: Vec3) -> Option<Vec2> {
    let film = camera.film_position(point, TIME)?;
    let ray = camera.ray(film, TIME);
    let sight = Ray {
        t_max: ray.origin.distance(point) * NEARER,
        ..ray
    };
    (!scene.rays.occluded(&sight)).then_some(film)
}

//! Points, photons or records, over a dim picture of the scene.

use crate::point_colour::to_bytes;
use bevy_ecs::world::World;
use film::{WriteError, write_rgb8_png};
use glam::{Vec2, Vec3};
use pipeline_data::{CameraFrame, RenderSettings, TransportScene};
use rayon::prelude::*;
use spatial::Ray;
use std::path::Path;
use transport::{Camera, Scene};

/// Brightness of a white surface that faces the camera, under the points.
const SURFACES: f32 = 0.22;
/// When things that move are drawn, in the shutter interval.
const TIME: f32 = 0.5;
/// Points are hidden by what is nearer to the eye than this share of their distance.
const NEARER: f32 = 0.999;

/// A point to draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    /// World space, metres.
    pub(crate) place: Vec3,
    /// sRGB in [0, 1].
    pub(crate) colour: [f32; 3],
}

/// Draws each point that the camera sees, in the middle of the shutter interval, as one pixel.
pub(crate) fn write(path: &Path, world: &World, points: &[Point]) -> Result<(), WriteError> {
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
    // Which pixel each point is seen in, found in parallel and drawn in order.
    let places: Vec<Option<usize>> = points
        .par_iter()
        .map(|point| {
            let film = seen_at(scene, camera, point.place)? - low;
            let inside = film.cmpge(Vec2::ZERO).all() && film.cmplt(size.as_vec2()).all();
            inside.then(|| film.y as usize * size.x as usize + film.x as usize)
        })
        .collect();
    for (point, place) in points.iter().zip(places) {
        let Some(pixel) = place.and_then(|place| pixels.get_mut(place)) else {
            continue;
        };
        for (value, point) in pixel.iter_mut().zip(point.colour) {
            // The brightest of a pixel, so that crowds keep their colour.
            *value = value.max(point);
        }
    }
    let bytes: Vec<[u8; 3]> = pixels.iter().map(|pixel| to_bytes(*pixel)).collect();
    write_rgb8_png(path, size.x, size.y, bytes.as_flattened())
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

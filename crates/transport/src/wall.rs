use crate::density::MIN_NORMAL_COSINE;
use crate::scene::Scene;
use glam::Vec3;
use radiometry::{Frame, SampleStream, StageKey, math};
use spatial::{Ray, spawn_origin};
use std::f32::consts::TAU;

/// Key of the random numbers that turn probes.
const PROBE_STAGE: StageKey = StageKey::new("clearance");
/// Rays from a place, evenly around.
const PROBES: u32 = 12;
/// Of the distance that a probe found: a straight wall may be nearer than that by cos(2π / 12), even where it begins in a
/// corner next to the place.
const BETWEEN_PROBES: f32 = 0.86;
/// Rays run over the surface at this share of their reach.
const LIFT: f32 = 0.01;
/// Where a place is in doubt, with all that stands there; more are not looked through.
const MOST_SURFACES: u32 = 8;
/// Walls that move are looked for where they are at half the time of the shutter, since photons have no time.
const TIME: f32 = 0.5;

/// How far a place of a surface is from the next wall: the distance in metres within which nothing stands between it and
/// the rest of its surface, at most `reach`.
///
/// Twelve rays along the surface find it. What is seen under less than 30° from here may be missed, and is too small to part
/// much of a disc from the rest.
///
/// - `normal`: unit, on the side that is asked about.
/// - `reach`: metres; `number`: of the place, for the directions of its rays.
#[must_use]
pub fn clearance(scene: &Scene, position: Vec3, normal: Vec3, reach: f32, number: u32) -> f32 {
    let frame = Frame::from_normal(normal);
    let turn = SampleStream::new(0, PROBE_STAGE, 0, number).draw_1d(0, 0);
    let origin = position + normal * lift(position, reach);
    let probe = |i: u32| {
        let (sin, cos) = math::sin_cos(TAU * (i as f32 + turn) / PROBES as f32);
        let direction = (frame.x * cos + frame.y * sin).normalize();
        distance_to_wall(scene, origin, direction, reach / BETWEEN_PROBES, normal)
    };
    (0..PROBES)
        .filter_map(probe)
        .map(|distance| distance * BETWEEN_PROBES)
        .fold(reach, f32::min)
}

/// True when a wall stands on a surface between two places of it.
///
/// - `normal`: unit, on the side that is asked about.
/// - `height`: of one place above the plane of the other, metres; the surface may bulge by as much in between.
#[must_use]
pub(crate) fn is_walled_off(scene: &Scene, from: Vec3, to: Vec3, normal: Vec3, height: f32) -> bool {
    let way = to - from;
    let length = way.length();
    let lift = lift(from, length) + 0.5 * height.abs();
    length > 0.0 && distance_to_wall(scene, from + normal * lift, way / length, length, normal).is_some()
}

/// How high over a surface a ray along it starts, so that it does not meet what it started from.
fn lift(position: Vec3, reach: f32) -> f32 {
    LIFT * reach + 16.0 * f32::EPSILON * position.abs().max_element()
}

/// Distance to the first thing that stands on a surface and lets no light through. What lies on it, or is the surface
/// itself, is no wall, nor is glass.
fn distance_to_wall(scene: &Scene, origin: Vec3, direction: Vec3, reach: f32, normal: Vec3) -> Option<f32> {
    let mut ray = Ray {
        t_max: reach,
        time: TIME,
        ..Ray::new(origin, direction)
    };
    if !scene.rays.occluded(&ray) {
        return None;
    }
    for _ in 0..MOST_SURFACES {
        let hit = scene.rays.intersect(&ray)?;
        let point = scene.rays.surface(&ray, &hit);
        let distance = point.p.distance(origin);
        if point.ng.dot(normal).abs() < MIN_NORMAL_COSINE && !scene.passage(&point).lets_through {
            return Some(distance);
        }
        ray.origin = spawn_origin(point.p, point.error, point.ng, direction);
        ray.t_max = reach - distance;
        if ray.t_max <= 0.0 {
            return None;
        }
    }
    None
}

use crate::density::MIN_NORMAL_COSINE;
use crate::scene::Scene;
use glam::Vec3;
use radiometry::{Frame, math};
use spatial::{Ray, spawn_origin};
use std::f32::consts::TAU;

/// Rays from a place, evenly around.
const PROBES: usize = 12;
/// Of the distance that a probe found: a straight wall may be nearer than that by cos(2π / 12), even where it begins in a
/// corner next to the place.
const BETWEEN_PROBES: f32 = 0.86;
/// Rays run over the surface at this share of their reach.
const LIFT: f32 = 0.01;
/// Things that are no walls, of which a ray looks behind so many.
const MOST_SURFACES: u32 = 8;
/// Walls that move are looked for where they are at half the time of the shutter, since photons have no time.
const TIME: f32 = 0.5;
/// What is nearer than this share of the way to where a wall would be if it were straight is in front of it.
const IN_FRONT: f32 = 0.9;
/// And what is further away than this is behind it.
const BEHIND: f32 = 1.08;
/// Steps that distances are kept in.
const STEPS: f32 = 255.0;

/// The walls around a place of a surface: what stands on it and lets no light through, in twelve directions along it. 16 bytes.
///
/// Estimates that spread over a disc ask it which photons are on this side of them. What is seen under less than 30° from
/// the place may be missed, and is too small to part much of a disc from the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walls {
    /// Distance to the wall in each direction, in shares of the reach; `u8::MAX` where there is none.
    distance: [u8; PROBES],
    /// The least of them.
    nearest: u8,
    /// A bit for each direction: the wall there goes on to the next one.
    goes_on: u16,
}

const _: () = assert!(size_of::<Walls>() <= 16);

impl Walls {
    /// Nothing stands on the surface.
    pub const NONE: Self = Self {
        distance: [u8::MAX; PROBES],
        nearest: u8::MAX,
        goes_on: 0,
    };

    /// Looks for the walls around a place.
    ///
    /// - `normal`: unit, on the side that is asked about.
    /// - `reach`: metres; what is further away does not matter.
    #[must_use]
    pub fn around(scene: &Scene, position: Vec3, normal: Vec3, reach: f32) -> Self {
        let frame = Frame::from_normal(normal);
        let origin = position + normal * lift(position, reach);
        let found: [_; PROBES] = std::array::from_fn(|i| {
            let (sin, cos) = math::sin_cos(TAU * i as f32 / PROBES as f32);
            let direction = (frame.x * cos + frame.y * sin).normalize();
            first_wall(scene, origin, direction, reach / BETWEEN_PROBES, normal)
        });
        let steps = |wall: Option<Wall>| match wall {
            Some(wall) => (wall.distance * BETWEEN_PROBES / reach * STEPS) as u8,
            None => u8::MAX,
        };
        let goes_on = |i: &usize| match (found[*i], found[(i + 1) % PROBES]) {
            (Some(one), Some(next)) => one.instance == next.instance,
            _ => false,
        };
        let distance = found.map(steps);
        Self {
            distance,
            nearest: distance.into_iter().fold(u8::MAX, u8::min),
            goes_on: (0..PROBES).filter(goes_on).fold(0, |bits, i| bits | 1 << i),
        }
    }

    /// False when nothing stands on the surface within a distance, which is at most `reach`.
    #[inline]
    pub(crate) fn may_part(&self, reach: f32, dist_sq: f32) -> bool {
        let nearest = f32::from(self.nearest) * reach;
        self.nearest != u8::MAX && dist_sq * (STEPS * STEPS) > nearest * nearest
    }

    /// True when a wall stands between the place and another of its surface. Where the directions that were looked in leave it
    /// open, a ray decides.
    ///
    /// - `position`, `normal`, `reach`: of [`Walls::around`].
    /// - `offset`: to the other place, at most `reach`; `dist_sq`: its squared length.
    #[inline]
    pub(crate) fn part(
        &self,
        scene: &Scene,
        (position, normal): (Vec3, Vec3),
        reach: f32,
        offset: Vec3,
        dist_sq: f32,
    ) -> bool {
        if !self.may_part(reach, dist_sq) {
            return false;
        }
        let distance = dist_sq.sqrt();
        self.part_distant(normal, offset, distance / reach * STEPS)
            .unwrap_or_else(|| {
                // The surface may bulge in between by half of what it rises from here to there.
                let lift = lift(position, distance) + 0.5 * offset.dot(normal).abs();
                first_wall(scene, position + normal * lift, offset / distance, distance, normal).is_some()
            })
    }

    /// The same beyond the nearest wall, as far as the directions that were looked in tell.
    fn part_distant(&self, normal: Vec3, offset: Vec3, steps: f32) -> Option<bool> {
        let along = Frame::from_normal(normal).local_from_world(offset);
        let turn = math::atan2(along.y, along.x) / TAU * PROBES as f32;
        let turn = if turn < 0.0 { turn + PROBES as f32 } else { turn };
        let probe = turn as usize % PROBES;
        let beside = [self.distance[probe], self.distance[(probe + 1) % PROBES]];
        if beside
            .into_iter()
            .all(|wall| wall == u8::MAX || steps <= f32::from(wall))
        {
            return Some(false);
        }
        if self.goes_on >> probe & 1 == 0 {
            return None;
        }
        let straight = straight_wall(beside.map(f32::from), turn.fract()) / BETWEEN_PROBES;
        if steps <= IN_FRONT * straight {
            return Some(false);
        }
        (steps > BEHIND * straight + 1.0).then_some(true)
    }
}

/// A wall, as one ray found it.
#[derive(Clone, Copy)]
struct Wall {
    distance: f32,
    instance: u32,
}

/// Distance to the straight wall through two others, in between: `sinα / d = sin(α − φ) / d₁ + sinφ / d₂`.
///
/// - `beside`: distances in one direction and the next; `share`: φ/α, in [0, 1], of the angle between them.
fn straight_wall([one, next]: [f32; 2], share: f32) -> f32 {
    const ALPHA: f32 = TAU / PROBES as f32;
    let (to_next, from_one) = (math::sin((1.0 - share) * ALPHA), math::sin(share * ALPHA));
    math::sin(ALPHA) / (to_next / one + from_one / next)
}

/// How high over a surface a ray along it starts, so that it does not meet what it started from.
fn lift(position: Vec3, reach: f32) -> f32 {
    LIFT * reach + 16.0 * f32::EPSILON * position.abs().max_element()
}

/// The first thing along a ray that stands on a surface and lets no light through. What lies on it, or is the surface itself,
/// is no wall, nor is glass.
fn first_wall(scene: &Scene, origin: Vec3, direction: Vec3, reach: f32, normal: Vec3) -> Option<Wall> {
    let mut ray = Ray {
        t_max: reach,
        time: TIME,
        ..Ray::new(origin, direction)
    };
    for _ in 0..MOST_SURFACES {
        let hit = scene.rays.intersect(&ray)?;
        let point = scene.rays.surface(&ray, &hit);
        let distance = point.p.distance(origin);
        if point.ng.dot(normal).abs() < MIN_NORMAL_COSINE && !scene.passage(&point).lets_through {
            let instance = hit.instance;
            return Some(Wall { distance, instance });
        }
        ray.origin = spawn_origin(point.p, point.error, point.ng, direction);
        ray.t_max = reach - distance;
        if ray.t_max <= 0.0 {
            return None;
        }
    }
    None
}

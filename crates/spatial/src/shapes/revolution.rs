//! Surfaces of revolution around Y whose profile is a polyline: cylinders, discs, annuli and cone frusta.
//!
//! Cylinder and Band are such surfaces. The profile runs with the outside on its right hand.

use super::{LocalPoint, ShapeHit, Spread, share_of_turn, turn};
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::PI;

/// A polyline in the half-plane (radius, y), turned around Y.
#[derive(Debug)]
pub(crate) struct Profile {
    segments: Vec<Segment>,
    radius: f64,
    half_height: f64,
}

/// One straight piece, in coordinates (radius, y).
#[derive(Clone, Copy, Debug)]
struct Segment {
    from: DVec2,
    along: DVec2,
    length: f64,
    /// Outward, unit length.
    normal: DVec2,
}

/// How far, relative to its length, a segment is prolonged at both ends when it is hit, so that no line slips between
/// two of them. Far below what single precision resolves.
const OVERLAP: f64 = 1e-10;

impl Profile {
    /// Cylinder of full height `height`, with or without its two ends.
    pub(super) fn cylinder(radius: f64, height: f64, capped: bool) -> Self {
        let h = 0.5 * height;
        let points = [
            DVec2::new(0.0, -h),
            DVec2::new(radius, -h),
            DVec2::new(radius, h),
            DVec2::new(0.0, h),
        ];
        Self::new(if capped { &points } else { &points[1..3] })
    }

    /// Finger ring with 45° chamfers of width `bevel`.
    pub(super) fn band(inner: f64, outer: f64, height: f64, bevel: f64) -> Self {
        let h = 0.5 * height;
        let b = bevel.min(h).min(0.5 * (outer - inner));
        Self::new(&[
            DVec2::new(inner + b, -h),
            DVec2::new(outer - b, -h),
            DVec2::new(outer, -h + b),
            DVec2::new(outer, h - b),
            DVec2::new(outer - b, h),
            DVec2::new(inner + b, h),
            DVec2::new(inner, h - b),
            DVec2::new(inner, -h + b),
            DVec2::new(inner + b, -h),
        ])
    }

    fn new(points: &[DVec2]) -> Self {
        let size = points.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
        let piece = |ends: &[DVec2]| {
            let along = ends[1] - ends[0];
            let length = along.length();
            Segment {
                from: ends[0],
                along,
                length,
                normal: DVec2::new(along.y, -along.x) / length,
            }
        };
        let segments = points
            .windows(2)
            .map(piece)
            .filter(|s| s.length > 1e-9 * size)
            .collect();
        Self {
            segments,
            radius: points.iter().fold(0.0, |m, p| m.max(p.x)),
            half_height: points.iter().fold(0.0, |m, p| m.max(p.y.abs())),
        }
    }

    /// Largest radius and half the height.
    pub(super) fn extent(&self) -> (f64, f64) {
        (self.radius, self.half_height)
    }

    pub(super) fn faces(&self) -> u32 {
        self.segments.len() as u32
    }

    fn segment(&self, face: u32) -> &Segment {
        &self.segments[(face as usize).min(self.segments.len() - 1)]
    }

    pub(super) fn intersect(&self, o: DVec3, d: DVec3, (low, mut high): (f64, f64)) -> Option<ShapeHit> {
        let mut nearest = None;
        for (face, segment) in self.segments.iter().enumerate() {
            if let Some(t) = segment.intersect(o, d, (low, high)) {
                high = t;
                nearest = Some(ShapeHit { t, face: face as u32 });
            }
        }
        nearest
    }

    pub(super) fn project(&self, q: DVec3, face: u32) -> LocalPoint {
        let s = self.segment(face);
        let radius = (q.x * q.x + q.z * q.z).sqrt();
        let (x, z) = if radius > 0.0 {
            (q.x / radius, q.z / radius)
        } else {
            (1.0, 0.0)
        };
        let share = s.share(DVec2::new(radius, q.y)).clamp(0.0, 1.0);
        let p = s.from + s.along * share;
        LocalPoint {
            p: DVec3::new(p.x * x, p.y, p.x * z),
            n: DVec3::new(s.normal.x * x, s.normal.y, s.normal.x * z),
            uv: Vec2::new(share_of_turn(z, x) as f32, share as f32),
        }
    }

    /// From one edge of a face to the other.
    pub(super) fn length(&self, face: u32) -> f64 {
        self.segment(face).length
    }

    /// Straight up and down, all normals of a face are one.
    pub(super) fn spread(&self, face: u32) -> Spread {
        if self.segment(face).normal.x == 0.0 {
            Spread::Flat
        } else {
            Spread::AroundAxis
        }
    }

    pub(super) fn point(&self, face: u32, u: DVec2) -> (DVec3, DVec3) {
        let s = self.segment(face);
        let (cos, sin) = turn(u.x);
        let (r0, r1) = (s.from.x, s.from.x + s.along.x);
        // Equal areas: the square of the radius, not the radius, grows in proportion.
        let r = (r0 * r0 + u.y * (r1 * r1 - r0 * r0)).max(0.0).sqrt();
        let share = if r + r0 > 0.0 { u.y * (r1 + r0) / (r + r0) } else { 0.0 };
        let p = s.from + s.along * share;
        let n = DVec3::new(s.normal.x * cos, s.normal.y, s.normal.x * sin);
        (DVec3::new(p.x * cos, p.y, p.x * sin), n * s.area())
    }

    pub(super) fn parameters(&self, face: u32, p: DVec3) -> DVec2 {
        let s = self.segment(face);
        let radius = (p.x * p.x + p.z * p.z).sqrt();
        let share = s.share(DVec2::new(radius, p.y)).clamp(0.0, 1.0);
        let (r0, r1) = (s.from.x, s.from.x + s.along.x);
        let r = r0 + share * (r1 - r0);
        DVec2::new(share_of_turn(p.x, p.z), share * (r + r0) / (r1 + r0))
    }
}

impl Segment {
    /// Where along the segment the nearest point of its line lies; 0 at its start, 1 at its end.
    fn share(&self, q: DVec2) -> f64 {
        (q - self.from).dot(self.along) / (self.length * self.length)
    }

    fn area(&self) -> f64 {
        PI * (2.0 * self.from.x + self.along.x) * self.length
    }

    fn intersect(&self, o: DVec3, d: DVec3, range: (f64, f64)) -> Option<f64> {
        let valid = |t: f64| {
            if !(t > range.0 && t < range.1) {
                return None;
            }
            let p = o + d * t;
            let share = if self.along.y == 0.0 {
                ((p.x * p.x + p.z * p.z).sqrt() - self.from.x) / self.along.x
            } else {
                (p.y - self.from.y) / self.along.y
            };
            (-OVERLAP..=1.0 + OVERLAP).contains(&share).then_some(t)
        };
        if self.along.y == 0.0 {
            return valid((self.from.y - o.y) / d.y);
        }
        // (o + t d)'s distance from the axis equals the radius at its height: a quadratic in t. Segments lie on one
        // side of the cone's tip, so that a share in [0, 1] excludes its mirror image.
        let slope = self.along.x / self.along.y;
        let r = self.from.x + slope * (o.y - self.from.y);
        let dr = slope * d.y;
        let a = d.x * d.x + d.z * d.z - dr * dr;
        let b = o.x * d.x + o.z * d.z - r * dr;
        let c = o.x * o.x + o.z * o.z - r * r;
        let discriminant = b * b - a * c;
        if !(discriminant >= 0.0) {
            return None;
        }
        // The root that adds numbers of one sign, and the other from the product of both; also right for a = 0.
        let q = -(b + discriminant.sqrt().copysign(b));
        let (first, second) = (q / a, c / q);
        let (near, far) = if first < second {
            (first, second)
        } else {
            (second, first)
        };
        valid(near).or_else(|| valid(far))
    }
}

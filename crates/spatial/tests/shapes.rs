//! Analytic shapes against their implicit functions: every crossing is found, at the right place, with the right normal.

mod common;

use common::{Kind, direction, one, shapes, stream, transform};
use glam::{DAffine3, DVec3, Vec3};
use spatial::{Ray, RayScene, Shape};

/// Signed function that is negative inside (or below) the shape's surface and whose zeros contain it, roughly a distance.
fn implicit(shape: &Shape, p: DVec3) -> f64 {
    let axis_distance = (p.x * p.x + p.z * p.z).sqrt();
    let box_distance = |q: DVec3| q.max_element();
    match *shape {
        Shape::Sphere { radius } => p.length() - f64::from(radius),
        Shape::Quad { .. } | Shape::Disc { .. } => p.z,
        Shape::Cuboid { size } => box_distance(p.abs() - size.as_dvec3() * 0.5),
        Shape::Cylinder {
            radius,
            height,
            capped: true,
        } => (axis_distance - f64::from(radius)).max(p.y.abs() - f64::from(height) * 0.5),
        Shape::Cylinder { radius, .. } => axis_distance - f64::from(radius),
        Shape::Torus {
            major_radius,
            minor_radius,
        } => ((axis_distance - f64::from(major_radius)).powi(2) + p.y * p.y).sqrt() - f64::from(minor_radius),
        Shape::Band {
            inner_radius,
            outer_radius,
            height,
            bevel,
        } => {
            let middle = f64::from(inner_radius + outer_radius) * 0.5;
            let wall = f64::from(outer_radius - inner_radius) * 0.5;
            let (a, b) = (
                (axis_distance - middle).abs() - wall,
                p.y.abs() - f64::from(height) * 0.5,
            );
            let chamfer = (a + b + f64::from(bevel)) * std::f64::consts::FRAC_1_SQRT_2;
            a.max(b).max(chamfer)
        }
    }
}

/// Whether a zero of the implicit function belongs to an open shape.
fn within(shape: &Shape, p: DVec3) -> bool {
    match *shape {
        Shape::Quad { size } => p.x.abs() < f64::from(size.x) * 0.5 && p.y.abs() < f64::from(size.y) * 0.5,
        Shape::Disc { radius } => p.truncate().length() < f64::from(radius),
        Shape::Cylinder {
            height, capped: false, ..
        } => p.y.abs() < f64::from(height) * 0.5,
        _ => true,
    }
}

/// First sign change along the ray, by dense sampling and bisection.
fn brute_force(shape: &Shape, o: DVec3, d: DVec3, t_max: f64) -> Option<f64> {
    const STEPS: u32 = 4000;
    let f = |t: f64| implicit(shape, o + d * t);
    let mut before = (0.0, f(0.0));
    for i in 1..=STEPS {
        let t = t_max * f64::from(i) / f64::from(STEPS);
        let now = (t, f(t));
        if (now.1 < 0.0) != (before.1 < 0.0) {
            let (mut a, mut b) = (before.0, t);
            for _ in 0..60 {
                let m = 0.5 * (a + b);
                if (f(m) < 0.0) == (before.1 < 0.0) { a = m } else { b = m }
            }
            if within(shape, o + d * a) {
                return Some(a);
            }
        }
        before = now;
    }
    None
}

fn random_ray(m: &DAffine3, i: u32) -> Ray {
    let s = stream("shapes", i);
    let from = m
        .transform_point3((direction(&s, 0) * 1.3 * s.draw_1d(0, 1)).as_dvec3())
        .as_vec3();
    let to = m
        .transform_point3((direction(&s, 2) * 0.7 * s.draw_1d(0, 3)).as_dvec3())
        .as_vec3();
    Ray::new(from, (to - from).normalize())
}

#[test]
fn hits_are_those_of_the_implicit_function() {
    for shape in shapes() {
        for (k, kind) in [Kind::Similar, Kind::Stretched, Kind::Mirrored].iter().enumerate() {
            for size in [1.0, 1e-3, 1e3] {
                let m = transform(&stream("transform", k as u32), kind, size, 0.7 * size);
                let inverse = m.inverse();
                let scene = one(shape, m);
                let (mut hits, mut doubtful) = (0, 0);
                for i in 0..400 {
                    let ray = random_ray(&m, i);
                    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
                    let (lo, ld) = (inverse.transform_point3(o), inverse.transform_vector3(d));
                    let expected = brute_force(&shape, lo, ld, 6.0 * size);
                    let found = scene.intersect(&ray);
                    assert_eq!(found.is_some(), scene.occluded(&ray));
                    match (expected, found) {
                        (Some(t), Some(hit)) if (t - f64::from(hit.t)).abs() <= 1e-5 * size => {
                            hits += 1;
                            check_surface(&shape, &scene, &m, &ray, size);
                        }
                        (None, None) => {}
                        // Dense sampling steps over two crossings less than a step apart: what was found must be true.
                        (t, Some(hit)) => {
                            let p = lo + ld * f64::from(hit.t);
                            assert!(implicit(&shape, p).abs() < 1e-5, "{shape:?}: a hit off the surface");
                            assert!(
                                t.is_none_or(|t| t > f64::from(hit.t)),
                                "{shape:?}: a nearer hit was missed"
                            );
                            doubtful += 1;
                        }
                        (Some(t), None) => {
                            // Only the rim of an open shape, within rounding.
                            let p = lo + ld * t;
                            assert!(!within(&shape, p * (1.0 + 1e-5)), "{shape:?}: missed at {p}");
                        }
                    }
                }
                assert!(
                    hits > 10 && doubtful < 10,
                    "{shape:?}: {hits} hits, {doubtful} unsampled"
                );
            }
        }
    }
}

fn check_surface(shape: &Shape, scene: &RayScene, m: &DAffine3, ray: &Ray, size: f64) {
    let hit = scene.intersect(ray).expect("it was just hit");
    let p = scene.surface(ray, &hit);
    assert!((ray.at(hit.t) - p.p).length() < 1e-5 * size as f32);
    let inverse = m.inverse();
    let local = inverse.transform_point3(p.p.as_dvec3());
    assert!(
        implicit(shape, local).abs() < 3e-6,
        "{shape:?}: {} off",
        implicit(shape, local)
    );
    assert!((p.ng.length() - 1.0).abs() < 1e-5 && p.ns == p.ng);
    assert!(p.uv.is_finite() && p.uv.cmpge(glam::Vec2::ZERO).all() && p.uv.cmple(glam::Vec2::ONE).all());
    // The gradient of the implicit function in world space, by differences; skipped where edges make it jump.
    let f = |q: DVec3| implicit(shape, inverse.transform_point3(q));
    let step = 1e-4 * size;
    let gradient = |s: f64| {
        let q = p.p.as_dvec3();
        DVec3::new(
            f(q + DVec3::X * s) - f(q - DVec3::X * s),
            f(q + DVec3::Y * s) - f(q - DVec3::Y * s),
            f(q + DVec3::Z * s) - f(q - DVec3::Z * s),
        )
        .normalize()
    };
    if gradient(step).dot(gradient(30.0 * step)) > 0.99 && gradient(step).dot(gradient(5.0 * step)) > 0.9999 {
        assert!(
            p.ng.as_dvec3().dot(gradient(step)) > 0.999,
            "{shape:?}: normal {} is not {}",
            p.ng,
            gradient(step)
        );
    }
}

/// Closed shapes are entered and left in turn, along any line.
#[test]
fn closed_shapes_have_an_inside() {
    for shape in shapes().into_iter().filter(Shape::is_closed) {
        let m = transform(&stream("inside", 0), &Kind::Mirrored, 1.0, 2.0);
        let scene = one(shape, m);
        for i in 0..2000 {
            let mut ray = random_ray(&m, i);
            ray.origin -= ray.direction * 10.0;
            let mut outside = true;
            let mut crossings = 0;
            while let Some(hit) = scene.intersect(&ray) {
                crossings += 1;
                assert!(crossings <= 8, "{shape:?}: ray {i} is stuck");
                let p = scene.surface(&ray, &hit);
                assert_eq!(p.ng.dot(ray.direction) < 0.0, outside, "{shape:?}, ray {i}");
                outside = !outside;
                ray.origin = spatial::spawn_origin(p.p, p.error, p.ng, ray.direction);
            }
            assert!(outside, "{shape:?}: ray {i} never came out");
        }
    }
}

/// No ray from inside a closed shape escapes, least of all at its edges.
#[test]
fn closed_shapes_have_no_holes() {
    for shape in shapes().into_iter().filter(Shape::is_closed) {
        let scene = one(shape, DAffine3::IDENTITY);
        let inside = match shape {
            Shape::Torus { major_radius, .. } => Vec3::X * major_radius,
            Shape::Band {
                inner_radius,
                outer_radius,
                ..
            } => Vec3::X * (inner_radius + outer_radius) * 0.5,
            _ => Vec3::ZERO,
        };
        let edge = |i: u32| {
            let s = stream("edge", i);
            let (sin, cos) = radiometry::math::sin_cos(s.draw_1d(0, 0) * std::f32::consts::TAU);
            match shape {
                Shape::Cuboid { size } => Vec3::new(0.5, 0.5, s.draw_1d(0, 1) - 0.5) * size,
                Shape::Cylinder { radius, height, .. } => Vec3::new(radius * cos, 0.5 * height, radius * sin),
                Shape::Band {
                    outer_radius,
                    height,
                    bevel,
                    ..
                } => Vec3::new(outer_radius * cos, 0.5 * height - bevel, outer_radius * sin),
                _ => inside + direction(&s, 2),
            }
        };
        for i in 0..100_000 {
            let ray = Ray::new(inside, (edge(i) - inside).normalize());
            assert!(scene.occluded(&ray), "{shape:?}: ray {i} escapes");
        }
    }
}

#[test]
fn areas_are_the_closed_forms() {
    use std::f64::consts::PI;
    let expected = [
        4.0 * PI * 0.25,
        0.6,
        PI * 0.25,
        2.0 * (0.6 + 0.4 + 0.24),
        2.0 * PI * 0.4 * (0.8 + 0.4),
        2.0 * PI * 0.4 * 0.8,
        4.0 * PI * PI * 0.4 * 0.15,
        4.0 * PI * PI * 0.5 * 0.01,
        band(0.4, 0.5, 0.3, 0.03),
        band(0.2, 0.5, 0.3, 0.0),
    ];
    for (shape, area) in shapes().into_iter().zip(expected) {
        let m = transform(&stream("area", 0), &Kind::Similar, 3.0, 5.0);
        let found = one(shape, m).instance_area(0);
        assert!(
            (found - 9.0 * area).abs() < 1e-6 * 9.0 * area,
            "{shape:?}: {found} is not {}",
            9.0 * area
        );
    }
    // A prolate spheroid with semi-axes 1, 1, 2, and an elliptic cylinder's wall with semi-axes 1 and 2.
    let scale = |x, y, z| DAffine3::from_scale(DVec3::new(x, y, z));
    let e = 0.75_f64.sqrt();
    let spheroid = 2.0 * PI * (1.0 + 2.0 / e * e.asin_for_tests());
    let found = one(Shape::Sphere { radius: 1.0 }, scale(1.0, 1.0, 2.0)).instance_area(0);
    assert!((found - spheroid).abs() < 1e-9 * spheroid, "{found} is not {spheroid}");
    let wall = Shape::Cylinder {
        radius: 1.0,
        height: 1.0,
        capped: false,
    };
    let found = one(wall, scale(1.0, 1.0, 2.0)).instance_area(0);
    // Perimeter of the ellipse: 4·2·E(3/4), E the complete elliptic integral of the second kind.
    assert!((found - 9.688_448_220_547_675).abs() < 1e-9, "{found}");
}

fn band(inner: f64, outer: f64, height: f64, bevel: f64) -> f64 {
    use std::f64::consts::{PI, SQRT_2};
    let walls = 2.0 * PI * (inner + outer) * (height - 2.0 * bevel);
    let ends = 2.0 * PI * ((outer - bevel).powi(2) - (inner + bevel).powi(2));
    let chamfers = 2.0 * PI * bevel * SQRT_2 * ((2.0 * outer - bevel) + (2.0 * inner + bevel));
    walls + ends + chamfers
}

trait ArcSine {
    fn asin_for_tests(self) -> f64;
}

impl ArcSine for f64 {
    fn asin_for_tests(self) -> f64 {
        std::f64::consts::FRAC_PI_2 - radiometry::math::acos_f64(self)
    }
}

/// Bounds contain the shape and touch it: no hit outside, and the box is not larger than it must be.
#[test]
fn bounds_are_tight() {
    for shape in shapes() {
        let m = transform(&stream("bounds", 3), &Kind::Stretched, 2.0, 1.0);
        let scene = one(shape, m);
        let b = scene.instance_bounds(0);
        assert_eq!(b, scene.bounds());
        let sampler = spatial::SurfaceSampler::new(&scene, 0).unwrap();
        let mut reached = spatial::Bounds::EMPTY;
        for i in 0..20_000 {
            let p = sampler.sample_area(stream("bounds", i).draw_2d(0, 0), 0.0).p;
            assert!(p.cmpge(b.min - 1e-6).all() && p.cmple(b.max + 1e-6).all());
            reached = reached.extend(p);
        }
        let slack = (b.max - b.min - (reached.max - reached.min)).max_element();
        assert!(slack < 0.05 * b.diagonal(), "{shape:?}: {slack} to spare");
    }
}

//! Instances that move while the shutter is open.

#![allow(clippy::unwrap_used, reason = "a test that meets an error should fail")]

mod common;

use common::{cube, mesh, stream};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use radiometry::warp;
use spatial::{Geometry, Instance, Placement, Ray, RayScene, Shape, SurfacePoint, SurfaceSampler};

/// A turn about Y by up to 60°, on the way along X, growing along Z; at times 0, ½ and 1.
fn keys() -> [DAffine3; 3] {
    [0.0, 0.5, 1.0].map(|t: f64| DAffine3 {
        matrix3: DMat3::from_rotation_y(t) * DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.0 + t)),
        translation: DVec3::new(2.0 * t, 0.3, -1.0),
    })
}

fn geometries() -> [(&'static str, Geometry); 5] {
    [
        ("sphere", Geometry::Shape(Shape::Sphere { radius: 0.8 })),
        (
            "quad",
            Geometry::Shape(Shape::Quad {
                size: (1.0, 2.0).into(),
            }),
        ),
        (
            "cuboid",
            Geometry::Shape(Shape::Cuboid {
                size: Vec3::new(1.0, 0.5, 1.5),
            }),
        ),
        (
            "cylinder",
            Geometry::Shape(Shape::Cylinder {
                radius: 0.5,
                height: 1.0,
                capped: true,
            }),
        ),
        ("mesh", mesh(cube())),
    ]
}

fn moving(geometry: &Geometry) -> RayScene {
    let instance = Instance {
        geometry: 0,
        placement: Placement::Moving(keys().into()),
    };
    RayScene::build(vec![geometry.clone()], vec![instance]).unwrap()
}

fn ray_at(i: u32, time: f32) -> Ray {
    let s = stream("motion", i);
    let origin = Vec3::new(1.0, 0.3, -1.0) + warp::sample_uniform_sphere(s.draw_2d(0, 0)) * 5.0;
    let target = Vec3::new(1.0, 0.3, -1.0) + warp::sample_uniform_sphere(s.draw_2d(0, 1)) * 1.5;
    Ray {
        time,
        ..Ray::new(origin, (target - origin).normalize())
    }
}

#[test]
fn a_ray_meets_what_stands_there_at_its_time() {
    for (name, geometry) in geometries() {
        let scene = moving(&geometry);
        scene.validate().unwrap();
        for (time, key) in [0.0, 0.5, 1.0].into_iter().zip(keys()) {
            let still = RayScene::build(vec![geometry.clone()], vec![Instance::fixed(0, key)]).unwrap();
            let mut met = 0;
            for i in 0..2000 {
                let ray = ray_at(i, time);
                let (a, b) = (scene.intersect(&ray), still.intersect(&ray));
                assert_eq!(a.is_some(), b.is_some(), "{name} at {time}, ray {i}");
                assert_eq!(scene.occluded(&ray), a.is_some(), "{name}");
                let (Some(a), Some(b)) = (a, b) else { continue };
                met += 1;
                let (p, q) = (scene.surface(&ray, &a), still.surface(&ray, &b));
                assert!(
                    (p.p - q.p).length() < 1e-4 && (p.ng - q.ng).length() < 1e-4,
                    "{name}: {p:?} {q:?}"
                );
                assert_eq!(p.time, time);
            }
            assert!(met > 100, "{name}: {met}");
        }
    }
}

#[test]
fn points_move_in_straight_lines_between_keys_inside_the_bounds() {
    for (name, geometry) in geometries() {
        let scene = moving(&geometry);
        let bounds = scene.instance_bounds(0);
        let sampler = SurfaceSampler::new(&scene, 0).unwrap();
        for i in 0..500 {
            let u = stream("between", i).draw_2d(0, 0);
            let [a, m, b] = [0.5, 0.75, 1.0].map(|time| sampler.sample_area(u, time).p);
            assert!((0.5 * (a + b) - m).length() < 1e-5, "{name}");
            for p in [a, m, b] {
                assert!(
                    (p - p.clamp(bounds.min - 1e-5, bounds.max + 1e-5)).length() == 0.0,
                    "{name}: {p}"
                );
            }
        }
    }
}

#[test]
fn densities_hold_at_every_time() {
    for (name, geometry) in geometries() {
        let scene = moving(&geometry);
        let sampler = SurfaceSampler::new(&scene, 0).unwrap();
        for time in [0.0_f32, 0.3, 1.0] {
            // The inverse density integrates to the area at that time.
            let n = 4096;
            let points = (0..n).map(|i| sampler.sample_area(stream("area", i).draw_2d(0, 0), time));
            let area = points.map(|s| 1.0 / f64::from(s.pdf_area)).sum::<f64>() / f64::from(n);
            let expected = area_at(&geometry, time);
            assert!(
                (area - expected).abs() < 2e-2 * expected,
                "{name} at {time}: {area}, not {expected}"
            );
            // Both sides of multiple importance sampling agree.
            let from = Vec3::new(1.0, 4.0, 2.0);
            for i in 0..200 {
                let piece = i % sampler.piece_count();
                let Some(d) = sampler.sample_toward(from, piece, stream("toward", i).draw_2d(0, 0), time) else {
                    continue;
                };
                let point = SurfacePoint {
                    p: d.sample.p,
                    error: d.sample.error,
                    ng: d.sample.ng,
                    ns: d.sample.ng,
                    uv: d.sample.uv,
                    instance: 0,
                    primitive: d.sample.primitive,
                    time,
                };
                let pdf = sampler.pdf_toward(from, &point);
                assert!((pdf - d.pdf).abs() <= 1e-3 * pdf, "{name}: {pdf} {}", d.pdf);
            }
        }
    }
}

/// Area of the geometry where it stands at a time, by a scene of its own.
fn area_at(geometry: &Geometry, time: f32) -> f64 {
    let [a, b, c] = keys();
    let (from, to, share) = if time < 0.5 {
        (a, b, f64::from(time) * 2.0)
    } else {
        (b, c, f64::from(time) * 2.0 - 1.0)
    };
    let m = DAffine3 {
        matrix3: from.matrix3 * (1.0 - share) + to.matrix3 * share,
        translation: from.translation,
    };
    let still = RayScene::build(vec![geometry.clone()], vec![Instance::fixed(0, m)]).unwrap();
    still.instance_area(0)
}

#[test]
fn an_instance_that_is_turned_inside_out_is_refused() {
    let instance = Instance {
        geometry: 0,
        placement: Placement::Moving(vec![DAffine3::IDENTITY, DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0))].into()),
    };
    let sphere = Geometry::Shape(Shape::Sphere { radius: 1.0 });
    assert!(RayScene::build(vec![sphere], vec![instance]).is_err());
}

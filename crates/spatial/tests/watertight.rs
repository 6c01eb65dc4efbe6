//! No ray from inside a closed mesh escapes through a shared edge or vertex.

mod common;

use common::{Kind, cube, direction, icosphere, mesh, place, stream, transform};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use spatial::{Geometry, Ray, RayScene, TriangleMesh};

/// Shoots `n` rays from points inside at points of edges and at vertices; returns how many escape.
fn escapes(scene: &RayScene, m: &TriangleMesh, transforms: &[DAffine3], n: u32) -> usize {
    (0..n)
        .into_par_iter()
        .filter(|i| {
            let s = stream("watertight", *i);
            let t = &transforms[*i as usize % transforms.len()];
            let world = |p: Vec3| t.transform_point3(p.as_dvec3()).as_vec3();
            let triangle = m.triangles[(s.draw_1d(0, 0) * m.triangles.len() as f32) as usize];
            let corner = (i % 3) as usize;
            let a = world(m.positions[triangle[corner] as usize]);
            let b = world(m.positions[triangle[(corner + 1) % 3] as usize]);
            let share = if i % 4 == 0 { 0.0 } else { s.draw_1d(0, 1) };
            let target = a + (b - a) * share;
            let inside = if i % 5 == 0 {
                Vec3::ZERO
            } else {
                direction(&s, 2) * 0.45 * s.draw_1d(0, 3)
            };
            let origin = world(inside);
            let ray = Ray::new(origin, (target - origin).normalize());
            scene.intersect(&ray).is_none() || !scene.occluded(&ray)
        })
        .count()
}

fn run(rays: u32) {
    for (m, share) in [(cube(), 1), (icosphere(0), 1), (icosphere(4), 2), (icosphere(6), 3)] {
        let geometry = mesh(m.clone());
        assert!(geometry.is_closed());
        for (k, (scale, offset)) in [(1.0, 0.0), (1e-3, 1.0), (1e3, 1e4), (0.37, 3.0)]
            .into_iter()
            .enumerate()
        {
            let t = if k == 0 {
                DAffine3::IDENTITY
            } else {
                transform(&stream("place", k as u32), &Kind::Stretched, scale, offset)
            };
            // Once as triangles in the world, once as an instance with a tree of its own.
            let flat = place(geometry.clone(), &[t]);
            assert_eq!(
                escapes(&flat, &m, &[t], rays / 16 * share / 2),
                0,
                "flat, scale {scale}"
            );
            let other = DAffine3::from_translation(t.matrix3.x_axis * 5.0) * t;
            let instanced = place(geometry.clone(), &[t, other]);
            assert_eq!(
                escapes(&instanced, &m, &[t, other], rays / 32 * share / 2),
                0,
                "instanced, scale {scale}"
            );
        }
    }
}

#[test]
fn no_ray_slips_through_edges_or_vertices() {
    run(1_000_000);
}

#[test]
#[ignore = "the same with ten million rays, for changes to the triangle test"]
fn none_of_ten_million_rays_slips_through() {
    run(10_000_000);
}

/// Rays along axes through the cube's own symmetry planes meet edges, vertices and box faces exactly.
#[test]
fn axis_aligned_rays_meet_what_they_graze_exactly() {
    let scene = place(mesh(cube()), &[DAffine3::IDENTITY]);
    let steps = [-0.5, -0.25, 0.0, 0.25, 0.5_f32];
    for x in steps {
        for y in steps {
            for d in [Vec3::Z, Vec3::NEG_Z] {
                for turned in 0..3 {
                    let turn = |v: Vec3| match turned {
                        0 => v,
                        1 => Vec3::new(v.y, v.z, v.x),
                        _ => Vec3::new(v.z, v.x, v.y),
                    };
                    let ray = Ray::new(turn(Vec3::new(x, y, 0.0) - d * 2.0), turn(d));
                    let hit = scene.intersect(&ray).expect("it touches the cube");
                    let inner = x.abs() < 0.5 && y.abs() < 0.5;
                    assert!((hit.t - 1.5).abs() < 1e-6 || !inner, "at {}", hit.t);
                }
            }
        }
    }
}

/// From a hundred thousand radii away, a mesh still has no holes.
#[test]
fn far_origins_see_no_holes() {
    let m = icosphere(5);
    let scene = place(
        Geometry::Mesh(m.into()),
        &[DAffine3::from_translation(DVec3::new(3.0, -2.0, 1.0))],
    );
    for i in 0..100_000 {
        let s = stream("far", i);
        let target = Vec3::new(3.0, -2.0, 1.0) + direction(&s, 0) * 0.9 * s.draw_1d(0, 1);
        let distance = radiometry::math::powf(10.0, 1.0 + 4.0 * s.draw_1d(0, 2));
        let from = direction(&s, 3) * distance;
        let ray = Ray::new(from, (target - from).normalize());
        // Single precision misses the target by this much.
        if distance * 3e-7 < 0.05 {
            let hit = scene.intersect(&ray).expect("through the middle of the ball");
            let point = scene.surface(&ray, &hit);
            assert!(
                point.ng.dot(ray.direction) < 0.0,
                "the far side, through a hole in the near one"
            );
            let p = point.p - Vec3::new(3.0, -2.0, 1.0);
            assert!((p.length() - 1.0).abs() < 2e-3);
        }
    }
}

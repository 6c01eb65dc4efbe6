//! A ray that leaves a surface does not meet the same place again, and does not skip what is close by.

mod common;

use common::{Kind, cube, direction, icosphere, mesh, place, shapes, stream, transform};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use rayon::prelude::*;
use spatial::{Geometry, Instance, Ray, RayScene, Shape, SurfacePoint, spawn_origin};

/// Where a random ray at the instance meets it.
fn random_hit(scene: &RayScene, m: &DAffine3, i: u32) -> Option<(Ray, SurfacePoint)> {
    let s = stream("self", i);
    let from = m
        .transform_point3((direction(&s, 0) * (0.2 + 2.0 * s.draw_1d(0, 1))).as_dvec3())
        .as_vec3();
    let to = m
        .transform_point3((direction(&s, 2) * 0.6 * s.draw_1d(0, 3)).as_dvec3())
        .as_vec3();
    let ray = Ray::new(from, (to - from).normalize());
    let hit = scene.intersect(&ray)?;
    Some((ray, scene.surface(&ray, &hit)))
}

fn geometries() -> Vec<Geometry> {
    let mut all: Vec<Geometry> = shapes().into_iter().map(Geometry::Shape).collect();
    all.push(mesh(cube()));
    all.push(mesh(icosphere(3)));
    all
}

/// Distance within which a second hit of a curved face would be the same place, in units of the size of the geometry:
/// the tightest curvature here has a radius of 10⁻³, whose chords at [`GRAZING`] are 2·10⁻⁴ long. At 100 sizes from the
/// origin a point may be 10⁻⁵ off its surface, which a ray at that angle crosses within 10⁻⁴.
const SAME_PLACE: f32 = 1.5e-4;

/// Smallest cosine tested on curved faces. On flat ones it is 100 times smaller, and there is no limit to the distance.
const GRAZING: f32 = 0.1;

fn is_flat(geometry: &Geometry) -> bool {
    match geometry {
        Geometry::Mesh(_) => true,
        Geometry::Shape(shape) => matches!(shape, Shape::Quad { .. } | Shape::Disc { .. } | Shape::Cuboid { .. }),
    }
}

#[test]
fn no_ray_meets_the_surface_it_leaves() {
    for geometry in geometries() {
        for (size, offset) in [
            (1.0, 0.0),
            (1.0, 1.0),
            (1e-3, 0.0),
            (1e-3, 0.1),
            (1e3, 0.0),
            (1e3, 1e5),
            (1.0, 100.0),
        ] {
            for kind in [Kind::Similar, Kind::Stretched, Kind::Mirrored] {
                let m = transform(&stream("place", size as u32), &kind, size, offset);
                let far = DAffine3::from_translation(m.matrix3.x_axis * 20.0) * m;
                for instances in [vec![m], vec![m, far]] {
                    let scene = place(geometry.clone(), &instances);
                    let hits: u32 = (0..2000)
                        .into_par_iter()
                        .map(|i| {
                            let Some((_, p)) = random_hit(&scene, &m, i) else {
                                return 0;
                            };
                            let s = stream("leave", i);
                            let d = direction(&s, 0);
                            let flat = is_flat(&geometry);
                            if d.dot(p.ng).abs() < GRAZING * if flat { 0.01 } else { 1.0 } {
                                return 0;
                            }
                            let mut ray = Ray::new(spawn_origin(p.p, p.error, p.ng, d), d);
                            if !flat {
                                ray.t_max = SAME_PLACE * size as f32;
                            }
                            if let Some(hit) = scene.intersect(&ray) {
                                assert!(
                                    (hit.instance, hit.primitive) != (p.instance, p.primitive),
                                    "{geometry:?} met again at {} of {size}, offset {offset}, error {}",
                                    hit.t,
                                    p.error
                                );
                            }
                            1
                        })
                        .sum();
                    assert!(hits >= 50, "{geometry:?}: {hits} tests");
                }
            }
        }
    }
}

/// The bound holds: the stored point lies within `error` of the true surface, and the bound is a few units in the last place.
#[test]
fn error_bounds_are_true_and_tight() {
    for shape in shapes() {
        for (size, offset) in [(1.0, 0.0), (1e-3, 0.1), (1e3, 1e5)] {
            let m = transform(&stream("place", 7), &Kind::Stretched, size, offset);
            let scene = common::one(shape, m);
            for i in 0..500 {
                let Some((_, p)) = random_hit(&scene, &m, i) else {
                    continue;
                };
                let coordinate = p.p.abs().max_element().max(size as f32 * 1e-3);
                assert!(
                    p.error <= 2.0 * f32::EPSILON * coordinate,
                    "{shape:?}: {} at {coordinate}",
                    p.error
                );
                // Probe along the normal, from both sides, with rays that start three bounds away.
                for side in [1.0, -1.0] {
                    let reach = 3.0 * p.error + 4.0 * f32::EPSILON * coordinate;
                    let mut probe = Ray::new(p.p + p.ng * side * reach, -p.ng * side);
                    probe.t_max = 2.0 * reach;
                    let near_edge = scene.intersect(&probe).is_none();
                    // Only points at the rim of a face may miss it.
                    if near_edge {
                        let n = m.inverse().transform_point3(p.p.as_dvec3());
                        assert!(on_rim(&shape, n), "{shape:?} at {n}");
                    }
                }
            }
        }
    }
}

fn on_rim(shape: &Shape, p: DVec3) -> bool {
    let near = |a: f64, b: f32| (a.abs() - f64::from(b)).abs() < 1e-3;
    match *shape {
        Shape::Quad { size } => near(p.x, size.x / 2.0) || near(p.y, size.y / 2.0),
        Shape::Disc { radius } => near(p.truncate().length(), radius),
        Shape::Cylinder { height, .. } => near(p.y, height / 2.0),
        // Rounding may carry a probe past the edge of a closed body.
        _ => true,
    }
}

/// Two parallel walls a ten-thousandth of the scene apart: nothing leaks, even 100 scene sizes from the origin.
#[test]
fn thin_gaps_hold_light() {
    for (size, offset) in [(1.0_f64, 0.0), (1.0, 100.0), (1e3, 1e5), (1e-3, 0.1)] {
        for walls in [
            Geometry::Shape(Shape::Quad { size: Vec2::ONE }),
            Geometry::Shape(Shape::Cuboid {
                size: Vec3::new(1.0, 1.0, 1e-5),
            }),
            mesh(spatial::TriangleMesh {
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                positions: vec![
                    Vec3::new(-0.5, -0.5, 0.0),
                    Vec3::new(0.5, -0.5, 0.0),
                    Vec3::new(0.5, 0.5, 0.0),
                    Vec3::new(-0.5, 0.5, 0.0),
                ],
                ..Default::default()
            }),
        ] {
            let m = transform(&stream("walls", 1), &Kind::Similar, size, offset);
            let gap = DAffine3::from_translation(m.matrix3.z_axis * 1.2e-4) * m;
            let place = |m: DAffine3, geometry| Instance::fixed(geometry, m);
            for geometries in [1_u32, 2] {
                let list = vec![walls.clone(); geometries as usize];
                let scene = RayScene::build(list, vec![place(m, 0), place(gap, geometries - 1)]).unwrap();
                for i in 0..2000 {
                    let s = stream("gap", i);
                    let d = direction(&s, 0);
                    let d = d * d.dot(m.matrix3.z_axis.as_vec3()).signum();
                    let start = m
                        .transform_point3(((s.draw_2d(0, 1) - 0.5) * 0.9).extend(-0.4).as_dvec3())
                        .as_vec3();
                    let up = m.matrix3.z_axis.normalize().as_vec3();
                    let first = Ray::new(start, up);
                    let hit = scene.intersect(&first).unwrap();
                    assert_eq!(hit.instance, 0);
                    let p = scene.surface(&first, &hit);
                    // Between the walls, the second is the next thing, unless the ray leaves at the side.
                    if d.dot(up) > 0.05 {
                        let leave = Ray::new(spawn_origin(p.p, p.error, p.ng, d), d);
                        let next = scene.intersect(&leave).expect("the other wall");
                        // A cuboid has a back of its own before that.
                        if matches!(walls, Geometry::Shape(Shape::Cuboid { .. })) {
                            continue;
                        }
                        assert_eq!(next.instance, 1, "size {size}, offset {offset}");
                    }
                }
            }
        }
    }
}

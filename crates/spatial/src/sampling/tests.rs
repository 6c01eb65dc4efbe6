use super::*;
use crate::{Geometry, Instance, Ray, Shape, TriangleMesh};
use glam::{DAffine3, DMat3, DQuat};
use radiometry::{SampleStream, StageKey};

fn numbers(name: &str, i: u32) -> SampleStream {
    SampleStream::new(8, StageKey::new(name), 0, i)
}

fn quad_of_two_triangles() -> Geometry {
    Geometry::Mesh(Arc::new(TriangleMesh {
        positions: [(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)]
            .map(|(x, y)| Vec3::new(x, y, 0.0))
            .into(),
        uvs: Some([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(Vec2::from).into()),
        triangles: vec![[1, 2, 0], [2, 3, 0]],
        ..TriangleMesh::default()
    }))
}

fn three_triangles() -> Geometry {
    Geometry::Mesh(Arc::new(TriangleMesh {
        positions: [
            (0.0, 0.0, 0.0),
            (0.7, 0.0, 0.1),
            (0.0, 0.5, 0.0),
            (-0.4, -0.1, 0.3),
            (0.1, -0.6, -0.2),
        ]
        .map(Vec3::from)
        .into(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]],
        ..TriangleMesh::default()
    }))
}

fn geometries() -> Vec<Geometry> {
    let shapes = [
        Shape::Sphere { radius: 0.5 },
        Shape::Quad {
            size: Vec2::new(1.0, 0.6),
        },
        Shape::Disc { radius: 0.5 },
        Shape::Cuboid {
            size: Vec3::new(1.0, 0.6, 0.4),
        },
        Shape::Cylinder {
            radius: 0.3,
            height: 0.8,
            capped: true,
        },
        Shape::Torus {
            major_radius: 0.4,
            minor_radius: 0.15,
        },
        Shape::Band {
            inner_radius: 0.4,
            outer_radius: 0.5,
            height: 0.3,
            bevel: 0.05,
        },
    ];
    let mut all: Vec<Geometry> = shapes.into_iter().map(Geometry::Shape).collect();
    all.extend([quad_of_two_triangles(), three_triangles()]);
    all
}

fn transforms() -> [DAffine3; 3] {
    let turn = DMat3::from_quat(DQuat::from_xyzw(0.1, 0.5, -0.3, 0.8).normalize());
    let place = |matrix3| DAffine3 {
        matrix3,
        translation: DVec3::new(1.0, -2.0, 0.5),
    };
    [
        place(turn * 2.0),
        place(turn * DMat3::from_diagonal(DVec3::new(2.0, 0.7, 1.1))),
        place(turn * DMat3::from_diagonal(DVec3::new(-0.6, 1.0, 1.0)) * turn),
    ]
}

/// Chooses a piece evenly, and a direction to it; the density is that of both.
fn toward(sampler: &SurfaceSampler, from: Vec3, i: u32, key: &'static str) -> Option<DirectionSample> {
    let stream = numbers(key, i);
    let pieces = sampler.piece_count();
    let piece = ((stream.draw_1d(0, 7) * pieces as f32) as u32).min(pieces - 1);
    let mut d = sampler.sample_toward(from, piece, stream.draw_2d(0, 0), 0.0)?;
    assert_eq!(sampler.piece_of(d.sample.primitive), piece);
    d.pdf /= pieces as f32;
    Some(d)
}

fn scene(geometry: &Geometry, m: DAffine3) -> RayScene {
    let instance = Instance::fixed(0, m);
    RayScene::build(vec![geometry.clone()], vec![instance]).unwrap()
}

/// Every (geometry, transform) with its scene and sampler.
fn cases() -> Vec<(String, DAffine3, RayScene, SurfaceSampler)> {
    let mut all = Vec::new();
    for geometry in geometries() {
        for (k, m) in transforms().into_iter().enumerate() {
            let scene = scene(&geometry, m);
            let sampler = SurfaceSampler::new(&scene, 0).unwrap();
            let name = match &geometry {
                Geometry::Shape(shape) => format!("{shape:?}, transform {k}"),
                Geometry::Mesh(mesh) => format!("{} triangles, transform {k}", mesh.triangles.len()),
            };
            all.push((name, m, scene, sampler));
        }
    }
    all
}

#[test]
fn samples_lie_on_the_surface_and_face_outward() {
    for (name, _, scene, sampler) in cases() {
        for i in 0..500 {
            let s = sampler.sample_area(numbers("on", i).draw_2d(0, 0), 0.0);
            // A ray from just outside meets the sample where it says it is.
            let probe = Ray::new(s.p + s.ng * 1e-3, -s.ng);
            let Some(hit) = scene.intersect(&probe) else { continue };
            let q = scene.surface(&probe, &hit);
            if q.primitive == s.primitive {
                assert!((hit.t - 1e-3).abs() < 1e-5, "{name}: {}", hit.t);
                assert!(
                    q.ng.dot(s.ng) > 0.999 && (q.uv - s.uv).length() < 2e-2,
                    "{name}: {} {}",
                    q.uv,
                    s.uv
                );
            }
            assert!(s.error > 0.0 && s.error < 1e-5 && (s.ng.length() - 1.0).abs() < 1e-5);
        }
    }
}

/// E[1/pdf] over area samples is the area; so is that of every half-space's share, found by uniform rays instead.
#[test]
fn area_densities_integrate_to_the_area() {
    for (name, _, scene, sampler) in cases() {
        let n = 1 << 14;
        let mean = (0..n)
            .map(|i| 1.0 / f64::from(sampler.sample_area(numbers("area", i).draw_2d(0, 0), 0.0).pdf_area))
            .sum::<f64>()
            / f64::from(n);
        assert!(
            (mean - sampler.area()).abs() < 2e-3 * sampler.area(),
            "{name}: {mean} and {}",
            sampler.area()
        );
        assert!((sampler.area() - scene.instance_area(0)).abs() < 1e-9);
    }
}

/// Chi-square over cells of equal world area: lines through space cross a surface in proportion to its area
/// (Cauchy–Crofton), which gives the expected counts without using the sampler.
#[test]
fn samples_are_spread_by_world_area() {
    for (name, m, scene, sampler) in cases() {
        let cell = |p: Vec3, primitive: u32| {
            let q = m.inverse().transform_point3(p.as_dvec3());
            let octant = usize::from(q.x > 0.05) + 2 * usize::from(q.y > 0.02) + 4 * usize::from(q.z > 0.03);
            octant + 8 * (primitive as usize % 8)
        };
        let bounds = scene.bounds();
        let (center, radius) = (bounds.center(), 0.51 * bounds.diagonal());
        let (mut crossed, mut chosen) = ([0_u32; 64], [0_f64; 64]);
        for i in 0..200_000 {
            let s = numbers("lines", i);
            let d = warp::sample_uniform_sphere(s.draw_2d(0, 0)).normalize();
            let disc = warp::sample_unit_disc(s.draw_2d(0, 1)) * radius;
            let frame = radiometry::Frame::from_normal(d);
            let mut ray = Ray::new(center + frame.world_from_local(disc.extend(-radius)), d);
            for _ in 0..8 {
                let Some(hit) = scene.intersect(&ray) else { break };
                let p = scene.surface(&ray, &hit);
                crossed[cell(p.p, p.primitive)] += 1;
                ray.origin = crate::spawn_origin(p.p, p.error, p.ng, d);
            }
            // Weighted by 1/pdf, so that densities that are not quite uniform are held to what they say.
            let a = sampler.sample_area(s.draw_2d(0, 2), 0.0);
            chosen[cell(a.p, a.primitive)] += 1.0 / f64::from(a.pdf_area);
        }
        let (all, weight) = (f64::from(crossed.iter().sum::<u32>()), chosen.iter().sum::<f64>());
        for (k, (n, c)) in crossed.iter().zip(&chosen).enumerate() {
            let (found, expected) = (c / weight, f64::from(*n) / all);
            // Five standard deviations of the count of crossings, several of which may belong to one line.
            let sigma = (expected.max(1.0 / all) * 2.0 / all).sqrt();
            assert!(
                (found - expected).abs() < 5.0 * sigma,
                "{name}, cell {k}: {found} and {expected}"
            );
        }
    }
}

/// Points from which surfaces are looked at: near, far, beside, inside.
fn viewpoints(m: &DAffine3) -> Vec<Vec3> {
    [
        (0.0, 0.2, 1.0),
        (3.0, 2.0, 5.0),
        (0.9, 0.1, 0.05),
        (-0.2, 0.7, -0.6),
        (0.05, 0.03, 0.02),
        (20.0, -30.0, 40.0),
    ]
    .map(|(x, y, z)| m.transform_point3(DVec3::new(x, y, z)).as_vec3())
    .into()
}

/// The density that `sample_toward` reports is the one that `pdf_toward` gives for what a ray finds there.
#[test]
fn both_sides_of_multiple_importance_sampling_agree() {
    for (name, m, scene, sampler) in cases() {
        for from in viewpoints(&m) {
            let (mut agree, mut compared) = (0, 0);
            for i in 0..500 {
                let Some(d) = toward(&sampler, from, i, "mis") else {
                    continue;
                };
                let pieces = sampler.piece_count() as f32;
                let s = &d.sample;
                assert!((d.wi.length() - 1.0).abs() < 1e-5 && d.pdf > 0.0);
                assert!((from + d.wi * d.distance - s.p).length() < 1e-5 * (1.0 + d.distance));
                let same = SurfacePoint {
                    p: s.p,
                    error: s.error,
                    ng: s.ng,
                    ns: s.ng,
                    uv: s.uv,
                    instance: 0,
                    primitive: s.primitive,
                    time: 0.0,
                };
                assert_eq!(d.pdf, sampler.pdf_toward(from, &same) / pieces, "{name}");
                let ray = Ray::new(from, d.wi);
                let Some(hit) = scene.intersect(&ray) else { continue };
                let found = scene.surface(&ray, &hit);
                // Hidden points and grazing views apart, the ray finds the same point.
                if found.primitive == s.primitive && (found.p - s.p).length() < 1e-4 * d.distance.min(0.1) {
                    compared += 1;
                    let pdf = sampler.pdf_toward(from, &found) / pieces;
                    let cos = d.wi.dot(s.ng).abs();
                    if cos > 0.05 {
                        // Where the point falls into another cell of a table, densities differ by a cell's share.
                        let tolerance = 2e-3 + 1e-4 / cos;
                        agree += u32::from((pdf - d.pdf).abs() <= tolerance * d.pdf);
                        assert!(
                            (pdf - d.pdf).abs() <= 0.2 * d.pdf,
                            "{name} from {from}: {pdf} and {}",
                            d.pdf
                        );
                    } else {
                        agree += 1;
                    }
                }
            }
            assert!(
                compared > 10 && agree * 20 > compared * 19,
                "{name} from {from}: {agree} of {compared} agree"
            );
        }
    }
}

/// The solid angle of what is visible, by `sample_toward` and by uniform directions.
#[test]
fn direction_densities_integrate_to_the_solid_angle() {
    for (name, m, scene, sampler) in cases() {
        for (k, from) in viewpoints(&m).into_iter().enumerate().take(5) {
            let n = 20_000;
            let (mut sum, mut squares, mut hits) = (0.0, 0.0, 0);
            for i in 0..n {
                let s = numbers("solid angle", i);
                if let Some(d) = toward(&sampler, from, i, "solid angle") {
                    let ray = Ray::new(from, d.wi);
                    let visible = scene.intersect(&ray).is_none_or(|hit| hit.t > d.distance * 0.9999);
                    let estimate = if visible { 1.0 / f64::from(d.pdf) } else { 0.0 };
                    sum += estimate;
                    squares += estimate * estimate;
                }
                let around = warp::sample_uniform_sphere(s.draw_2d(0, 1)).normalize();
                hits += u32::from(scene.occluded(&Ray::new(from, around)));
            }
            let n = f64::from(n);
            let (mean, expected) = (sum / n, f64::from(hits) / n * 4.0 * std::f64::consts::PI);
            let share = (f64::from(hits) / n).max(1.0 / n);
            let own = ((squares / n - mean * mean).max(0.0) / n).sqrt();
            let sigma = own + (share * (1.0 - share) / n).sqrt() * 4.0 * std::f64::consts::PI;
            assert!(
                (mean - expected).abs() < 5.0 * sigma + 1e-3 * mean,
                "{name} from {k}: {mean} and {expected}, σ {sigma}"
            );
        }
    }
}

/// Rectangles and spheres are sampled with one density over all of their solid angle, so the estimate has no variance.
#[test]
fn special_shapes_are_uniform_in_solid_angle() {
    let m = transforms()[0];
    for (geometry, view) in [
        (
            Geometry::Shape(Shape::Sphere { radius: 0.5 }),
            DVec3::new(1.0, 0.4, 0.3),
        ),
        (
            Geometry::Shape(Shape::Sphere { radius: 1e-4 }),
            DVec3::new(100.0, 0.4, 0.3),
        ),
        (
            Geometry::Shape(Shape::Quad {
                size: Vec2::new(1.0, 0.6),
            }),
            DVec3::new(0.4, 0.2, 0.3),
        ),
        (quad_of_two_triangles(), DVec3::new(0.4, 0.2, 0.3)),
    ] {
        let scene = scene(&geometry, m);
        let sampler = SurfaceSampler::new(&scene, 0).unwrap();
        let from = m.transform_point3(view).as_vec3();
        let first = sampler.sample_toward(from, 0, Vec2::splat(0.5), 0.0).unwrap().pdf;
        let mut seen = [0_u32; 2];
        for i in 0..1000 {
            let d = sampler
                .sample_toward(from, 0, numbers("special", i).draw_2d(0, 0), 0.0)
                .unwrap();
            assert_eq!(d.pdf, first);
            seen[d.sample.primitive as usize] += 1;
            let hit = scene.intersect(&Ray::new(from, d.wi));
            if d.wi.dot(d.sample.ng).abs() > 0.1 && view.x < 10.0 {
                let t = hit.unwrap().t;
                assert!((t - d.distance).abs() < 1e-4 * d.distance, "{t} and {}", d.distance);
            }
        }
        if let Geometry::Mesh(_) = geometry {
            assert!(seen.iter().all(|n| *n > 100), "{seen:?}");
        }
    }
}

/// Pieces add up to the surface, each point lies in the box of its piece, and its normal within its spread.
#[test]
fn pieces_hold_their_points_and_normals() {
    for (name, _, _, sampler) in cases() {
        let pieces: Vec<SurfacePiece> = (0..sampler.piece_count()).map(|i| sampler.piece(i)).collect();
        let area: f64 = pieces.iter().map(|piece| piece.area).sum();
        assert!((area - sampler.area()).abs() < 1e-6 * area, "{name}");
        for i in 0..500 {
            let s = sampler.sample_area(numbers("piece", i).draw_2d(0, 0), 0.0);
            let piece = &pieces[sampler.piece_of(s.primitive) as usize];
            let outside = s.p - s.p.clamp(piece.bounds.min - 1e-5, piece.bounds.max + 1e-5);
            assert_eq!(outside, Vec3::ZERO, "{name}");
            assert!(s.ng.dot(piece.axis) >= piece.cos_spread - 1e-5, "{name}");
        }
    }
}

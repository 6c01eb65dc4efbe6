//! Instanced and flattened meshes agree; the scene refuses what it cannot trace and survives what it can.

mod common;

use common::{Kind, cube, direction, icosphere, mesh, one, place, stream, transform};
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3, Vec3Swizzles};
use spatial::{Geometry, Instance, Ray, RayScene, Shape, SpatialError, TriangleMesh};
use std::sync::Arc;

fn with_attributes(mut m: TriangleMesh) -> TriangleMesh {
    m.normals = Some(m.positions.iter().map(|p| p.normalize()).collect());
    m.uvs = Some(m.positions.iter().map(|p| Vec2::new(p.x, p.y)).collect());
    m
}

#[test]
fn instanced_and_flattened_meshes_give_the_same_hits() {
    let m = Arc::new(with_attributes(icosphere(3)));
    let transforms: Vec<DAffine3> = (0..12)
        .map(|i| {
            let kind = [Kind::Similar, Kind::Stretched, Kind::Mirrored];
            transform(&stream("copies", i), &kind[i as usize % 3], 0.5, 2.0)
        })
        .collect();
    let instanced = place(Geometry::Mesh(m.clone()), &transforms);
    // One geometry each: nothing is shared, so all triangles lie in the world.
    let instances = (0..12).map(|i| Instance::fixed(i, transforms[i as usize])).collect();
    let flat = RayScene::build(vec![Geometry::Mesh(m); 12], instances).unwrap();
    instanced.validate().unwrap();
    flat.validate().unwrap();
    assert!(instanced.memory_bytes() < flat.memory_bytes() / 4);
    for i in 0..12 {
        let (a, b) = (instanced.instance_area(i), flat.instance_area(i));
        assert!((a - b).abs() < 1e-5 * a);
    }
    let (mut hits, mut other) = (0, 0);
    for i in 0..20_000 {
        let s = stream("rays", i);
        let ray = Ray::new(direction(&s, 0) * 4.0 * s.draw_1d(0, 1), direction(&s, 2));
        match (instanced.intersect(&ray), flat.intersect(&ray)) {
            (Some(a), Some(b)) => {
                assert!((a.t - b.t).abs() < 1e-5, "{} and {}", a.t, b.t);
                hits += 1;
                if (a.instance, a.primitive) == (b.instance, b.primitive) {
                    let (p, q) = (instanced.surface(&ray, &a), flat.surface(&ray, &b));
                    assert!((p.p - q.p).length() < 1e-5 && (p.ng - q.ng).length() < 1e-3);
                    assert!((p.ns - q.ns).length() < 1e-3 && (p.uv - q.uv).length() < 1e-3);
                    assert!(p.ng.dot(p.ns) > 0.9);
                } else {
                    other += 1;
                }
            }
            (None, None) => {}
            (a, b) => other += u32::from(a.is_some() != b.is_some()),
        }
        assert_eq!(instanced.occluded(&ray), instanced.intersect(&ray).is_some());
    }
    assert!(hits > 3000 && other < hits / 200, "{hits} hits, {other} at edges");
}

#[test]
fn outward_normals_stay_outward_under_mirrors() {
    for geometry in [
        mesh(with_attributes(icosphere(2))),
        mesh(cube()),
        Geometry::Shape(Shape::Sphere { radius: 1.0 }),
    ] {
        for kind in [Kind::Similar, Kind::Stretched, Kind::Mirrored] {
            let m = transform(&stream("mirror", 0), &kind, 1.0, 3.0);
            for copies in [1, 2] {
                let scene = place(geometry.clone(), &vec![m; copies]);
                for i in 0..300 {
                    let ray = Ray::new(m.translation.as_vec3(), direction(&stream("out", i), 0));
                    let p = scene.surface(&ray, &scene.intersect(&ray).unwrap());
                    assert!(p.ng.dot(ray.direction) > 0.0 && p.ns.dot(p.ng) > 0.0);
                }
            }
        }
    }
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let build = || {
        let m = Geometry::Mesh(Arc::new(icosphere(4)));
        let list = vec![m, Geometry::Shape(Shape::Sphere { radius: 0.5 })];
        let instances = (0..30)
            .map(|i| Instance::fixed(i % 2, transform(&stream("same", i), &Kind::Stretched, 0.5, 3.0)))
            .collect();
        RayScene::build(list, instances).unwrap()
    };
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    let (a, b) = (pool(1).install(build), pool(3).install(build));
    for i in 0..5000 {
        let s = stream("same rays", i);
        let ray = Ray::new(direction(&s, 0) * 5.0, direction(&s, 1));
        assert_eq!(a.intersect(&ray), b.intersect(&ray));
    }
}

#[test]
fn what_cannot_be_traced_is_refused_with_its_row() {
    let sphere = || Geometry::Shape(Shape::Sphere { radius: 1.0 });
    let at = |m| Instance::fixed(0, m);
    let build = |g: Geometry, m: DAffine3| RayScene::build(vec![g], vec![at(DAffine3::IDENTITY), at(m)]).unwrap_err();
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(build(sphere(), flat), SpatialError::SingularTransform { instance: 1 });
    let sheared = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::X + DVec3::Y));
    assert_eq!(
        build(sphere(), sheared),
        SpatialError::SingularTransform { instance: 1 }
    );
    let nan = DAffine3::from_translation(DVec3::new(f64::NAN, 0.0, 0.0));
    assert_eq!(build(sphere(), nan), SpatialError::NonFiniteTransform { instance: 1 });
    let far = DAffine3::from_translation(DVec3::X * 1e60);
    assert_eq!(build(sphere(), far), SpatialError::Overflow { instance: 1 });
    // Single precision holds these coordinates, but not the areas of the boxes.
    let large = DAffine3::from_scale(DVec3::splat(1e19));
    assert_eq!(build(sphere(), large), SpatialError::Overflow { instance: 1 });
    let unknown = Instance::fixed(7, DAffine3::IDENTITY);
    let error = RayScene::build(vec![sphere()], vec![unknown]).unwrap_err();
    assert_eq!(error.to_string(), "instance 0: geometry 7 does not exist, there are 1");
    let broken = |f: &dyn Fn(&mut TriangleMesh)| {
        let mut m = with_attributes(cube());
        f(&mut m);
        RayScene::build(vec![mesh(m)], vec![]).unwrap_err().to_string()
    };
    assert_eq!(
        broken(&|m| m.triangles[3][1] = 8),
        "geometry 0: triangle 3 names vertex 8, there are 8"
    );
    assert_eq!(
        broken(&|m| m.positions[2].y = f32::NAN),
        "geometry 0: the position of vertex 2 is not finite"
    );
    assert_eq!(
        broken(&|m| m.uvs.as_mut().unwrap().truncate(3)),
        "geometry 0: 3 uvs for 8 positions"
    );
    for shape in [
        Shape::Sphere { radius: 0.0 },
        Shape::Quad {
            size: Vec2::new(1.0, -1.0),
        },
        Shape::Torus {
            major_radius: 0.1,
            minor_radius: 0.2,
        },
        Shape::Band {
            inner_radius: 0.5,
            outer_radius: 0.4,
            height: 1.0,
            bevel: 0.0,
        },
        Shape::Band {
            inner_radius: 0.4,
            outer_radius: 0.5,
            height: 1.0,
            bevel: 0.1,
        },
        Shape::Cylinder {
            radius: f32::NAN,
            height: 1.0,
            capped: true,
        },
    ] {
        let error = RayScene::build(vec![Geometry::Shape(shape)], vec![]).unwrap_err();
        assert!(matches!(error, SpatialError::InvalidShape { geometry: 0, .. }));
    }
}

#[test]
fn degenerate_input_neither_panics_nor_hits() {
    let empty = RayScene::build(vec![], vec![]).unwrap();
    assert!(empty.bounds().is_empty() && !empty.occluded(&Ray::new(Vec3::ZERO, Vec3::X)));
    let no_triangles = place(mesh(TriangleMesh::default()), &[DAffine3::IDENTITY; 2]);
    assert!(no_triangles.instance_bounds(1).is_empty());
    assert!(spatial::SurfaceSampler::new(&no_triangles, 0).is_none());
    // Triangles without an area, and thousands in the same place.
    let mut m = cube();
    m.triangles.extend([[0, 0, 0], [1, 1, 2]]);
    let repeated = m.triangles[0];
    m.triangles.extend(std::iter::repeat_n(repeated, 5000));
    let scene = place(mesh(m), &[DAffine3::IDENTITY]);
    scene.validate().unwrap();
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-30,
        1e30,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
        0.5,
    ];
    let shape_scenes = common::shapes().into_iter().map(|s| one(s, DAffine3::IDENTITY));
    for scene in shape_scenes.chain([scene]) {
        for a in numbers {
            for b in numbers {
                for c in numbers {
                    for (o, d) in [
                        (Vec3::new(a, b, c), Vec3::Z),
                        (Vec3::new(0.1, 0.2, 0.3), Vec3::new(a, b, c)),
                    ] {
                        let ray = Ray::new(o, d);
                        let _ = scene.occluded(&ray);
                        if let Some(hit) = scene.intersect(&ray) {
                            let p = scene.surface(&ray, &hit);
                            assert!(hit.t > 0.0 && p.p.is_finite() && p.ng.is_finite() && p.ns.is_finite());
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn limits_are_open_intervals() {
    let scene = one(Shape::Quad { size: Vec2::ONE }, DAffine3::IDENTITY);
    let mut ray = Ray::new(Vec3::Z, Vec3::NEG_Z);
    assert_eq!(scene.intersect(&ray).unwrap().t, 1.0);
    ray.t_max = 1.0;
    assert!(scene.intersect(&ray).is_none() && !scene.occluded(&ray));
    ray.t_max = 1.0_f32.next_up();
    assert!(scene.intersect(&ray).is_some() && scene.occluded(&ray));
}

#[test]
fn connected_points_see_each_other_unless_something_is_between() {
    let list = vec![Geometry::Shape(Shape::Sphere { radius: 1.0 }), mesh(cube())];
    let place = |geometry, x: f64| Instance::fixed(geometry, DAffine3::from_translation(DVec3::X * x));
    for gap in [3.0, 30.0, 3000.0] {
        let scene = RayScene::build(list.clone(), vec![place(0, 0.0), place(1, gap)]).unwrap();
        let blocked = RayScene::build(list.clone(), vec![place(0, 0.0), place(1, gap), place(1, gap * 0.7)]).unwrap();
        let samplers = [0, 1].map(|i| spatial::SurfaceSampler::new(&scene, i).unwrap());
        let mut edges = 0;
        for i in 0..5000 {
            let s = stream("connect", i);
            let [a, b] = [0, 1].map(|k| samplers[k as usize].sample_area(s.draw_2d(0, k), 0.0));
            let between = b.p - a.p;
            if between.dot(a.ng) <= 0.0 || between.dot(b.ng) >= 0.0 {
                continue;
            }
            let ray = spatial::connect(a.p, a.error, a.ng, b.p, b.error, b.ng);
            assert!(!scene.occluded(&ray), "from {} to {}", a.p, b.p);
            // Without its limit the ray meets what it was shot at, unless it only grazes it or ends at an edge.
            let grazes = between.dot(b.ng) > -0.01 * between.length();
            let missed = !grazes
                && !scene.occluded(&Ray {
                    t_max: f32::INFINITY,
                    ..ray
                });
            edges += u32::from(missed);
            if (a.p + between * 0.7).yz().abs().max_element() < 0.4 {
                assert!(blocked.occluded(&ray));
            }
        }
        assert!(edges < 20, "{edges} segments miss their ends");
    }
}

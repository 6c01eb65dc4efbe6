//! Texture coordinates, colours and tangents at surface points.
#![allow(clippy::unwrap_used, reason = "a test that meets an error should fail")]

mod common;

use common::{direction, shapes, stream};
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3, Vec4};
use spatial::{Geometry, Instance, Ray, RayScene, SurfacePoint, TriangleMesh};
use std::sync::Arc;

fn placed(geometry: Geometry, transforms: &[DAffine3]) -> RayScene {
    let instances = transforms.iter().map(|m| Instance::fixed(0, *m)).collect();
    RayScene::build(vec![geometry], instances).unwrap()
}

fn hit(scene: &RayScene, ray: &Ray) -> Option<SurfacePoint> {
    Some(scene.surface(ray, &scene.intersect(ray)?))
}

/// Sheared, scaled and mirrored.
fn crooked() -> DAffine3 {
    DAffine3 {
        matrix3: DMat3::from_cols(
            DVec3::new(-1.2, 0.3, 0.1),
            DVec3::new(0.2, 0.9, -0.4),
            DVec3::new(0.1, 0.2, 1.5),
        ),
        translation: DVec3::new(0.1, -0.2, 0.3),
    }
}

/// Steps are not infinitely small, and the thinnest tube curves within them.
const CURVATURE: f32 = 0.2;

#[test]
fn tangents_of_shapes_are_the_slopes_of_their_coordinates() {
    for shape in shapes() {
        let scene = placed(Geometry::Shape(shape), &[crooked()]);
        let mut tried = 0;
        for i in 0..400 {
            let s = stream("tangents", i);
            let target = direction(&s, 1) * 0.6;
            let origin = direction(&s, 0) * 5.0;
            let ray = Ray::new(origin, (target - origin).normalize());
            let Some(point) = hit(&scene, &ray) else { continue };
            let Some((dpdu, dpdv)) = scene.tangents(&point, 0) else {
                continue;
            };
            assert!(dpdu.dot(point.ng.as_dvec3()).abs() < 1e-5 * dpdu.length());
            // A ray to a place a little further along either tangent meets the coordinates that they say.
            for (step, expected) in [(dpdu, Vec2::X), (dpdv, Vec2::Y)] {
                const SHARE: f32 = 2e-4;
                let near = Ray::new(origin, (point.p + step.as_vec3() * SHARE - origin).normalize());
                let Some(other) = hit(&scene, &near).filter(|other| other.primitive == point.primitive) else {
                    continue;
                };
                let change = (other.uv - point.uv) / SHARE;
                if change.length() < 3.0 && point.ng.dot(ray.direction).abs() > 0.3 {
                    assert!(
                        (change - expected).length() < CURVATURE,
                        "{shape:?} {change} {expected}"
                    );
                    tried += 1;
                }
            }
        }
        assert!(tried > 30, "{shape:?}: {tried}");
    }
}

/// A square of two triangles in XY, from 0 to 1, with two sets of coordinates and colours.
fn square() -> TriangleMesh {
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    TriangleMesh {
        positions: corners.map(|c| c.extend(0.0)).to_vec(),
        uvs: Some(corners.to_vec()),
        more_uvs: vec![corners.map(|c| Vec2::new(3.0 * c.y, -2.0 * c.x)).to_vec()],
        colours: Some(corners.map(|c| Vec4::new(c.x, c.y, 1.0 - c.x, 0.5 * c.y)).to_vec()),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..TriangleMesh::default()
    }
}

#[test]
fn attributes_of_meshes_are_interpolated_under_every_transform() {
    let twice = [crooked(), DAffine3::from_translation(DVec3::X * 50.0)];
    for transforms in [&twice[..1], &twice] {
        let scene = placed(Geometry::Mesh(Arc::new(square())), transforms);
        for i in 0..100 {
            let place = stream("attributes", i).draw_2d(0, 0);
            let target = crooked().transform_point3(place.extend(0.0).as_dvec3()).as_vec3();
            let origin = target + Vec3::new(0.3, 0.2, 4.0);
            let point = hit(&scene, &Ray::new(origin, (target - origin).normalize())).unwrap();
            assert!((point.uv - place).length() < 1e-5);
            assert_eq!(scene.uv_set(&point, 0), point.uv);
            let second = scene.uv_set(&point, 1);
            assert!((second - Vec2::new(3.0 * place.y, -2.0 * place.x)).length() < 1e-5);
            assert_eq!(scene.uv_set(&point, 2), point.uv, "a set that is not there");
            let colour = scene.vertex_colour(&point);
            let expected = Vec4::new(place.x, place.y, 1.0 - place.x, 0.5 * place.y);
            assert!((colour - expected).length() < 1e-5, "{colour} {expected}");
            let axes = crooked().matrix3;
            let (dpdu, dpdv) = scene.tangents(&point, 0).unwrap();
            assert!((dpdu - axes.x_axis).length() < 1e-6 && (dpdv - axes.y_axis).length() < 1e-6);
            let (dpdu, dpdv) = scene.tangents(&point, 1).unwrap();
            assert!((dpdu - axes.y_axis / 3.0).length() < 1e-6 && (dpdv + axes.x_axis / 2.0).length() < 1e-6);
            assert!(scene.tangents(&point, 2).is_none());
        }
    }
}

#[test]
fn geometry_without_attributes_says_so() {
    let mesh = TriangleMesh {
        uvs: Some(vec![Vec2::ZERO; 4]),
        colours: None,
        ..square()
    };
    let scene = placed(Geometry::Mesh(Arc::new(mesh)), &[DAffine3::IDENTITY]);
    let point = hit(&scene, &Ray::new(Vec3::new(0.4, 0.3, 2.0), -Vec3::Z)).unwrap();
    assert!(scene.tangents(&point, 0).is_none(), "coordinates without an area");
    assert_eq!(scene.vertex_colour(&point), Vec4::ONE);
}

#[test]
fn attributes_that_do_not_fit_are_refused() {
    for broken in [
        TriangleMesh {
            colours: Some(vec![Vec4::ONE; 3]),
            ..square()
        },
        TriangleMesh {
            more_uvs: vec![vec![Vec2::NAN; 4]],
            ..square()
        },
    ] {
        let scene = RayScene::build(
            vec![Geometry::Mesh(Arc::new(broken))],
            vec![Instance::fixed(0, DAffine3::IDENTITY)],
        );
        assert!(scene.is_err());
    }
}

#[test]
fn a_tilted_normal_keeps_to_its_frame() {
    let scene = placed(Geometry::Mesh(Arc::new(square())), &[DAffine3::IDENTITY]);
    let point = hit(&scene, &Ray::new(Vec3::new(0.4, 0.3, 2.0), -Vec3::Z)).unwrap();
    let tilted = |dpdu, dpdv, tilt| point.tilted_normal(dpdu, dpdv, tilt);
    assert_eq!(tilted(DVec3::X, DVec3::Y, Vec3::Z * 3.0), point.ns);
    assert_eq!(
        tilted(DVec3::X * 9.0, DVec3::Y, Vec3::new(0.6, 0.0, 0.8)),
        Vec3::new(0.6, 0.0, 0.8)
    );
    assert_eq!(
        tilted(DVec3::X, DVec3::Y, Vec3::new(0.0, 0.6, 0.8)),
        Vec3::new(0.0, 0.6, 0.8)
    );
    // A mirrored map: what is right in it leans to the left.
    assert_eq!(
        tilted(DVec3::NEG_X, DVec3::Y, Vec3::new(0.6, 0.0, 0.8)),
        Vec3::new(-0.6, 0.0, 0.8)
    );
    assert_eq!(
        tilted(DVec3::NEG_X, DVec3::Y, Vec3::new(0.0, 0.6, 0.8)),
        Vec3::new(0.0, 0.6, 0.8)
    );
    let below = tilted(DVec3::X, DVec3::Y, Vec3::new(1.0, 0.0, -0.5));
    assert!(below.is_normalized() && below.z > 0.0 && below.z < 0.01, "{below}");
    assert_eq!(tilted(DVec3::ZERO, DVec3::Y, Vec3::X), point.ns);
}

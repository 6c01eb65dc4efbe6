//! Scenes and random numbers that the tests share.
#![allow(dead_code, unreachable_pub, reason = "each test takes what it needs")]

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec2, Vec3};
use radiometry::{SampleStream, StageKey, warp};
use spatial::{Geometry, Instance, RayScene, Shape, TriangleMesh};
use std::sync::Arc;

pub fn stream(name: &str, i: u32) -> SampleStream {
    SampleStream::new(3, StageKey::new(name), 0, i)
}

pub fn direction(s: &SampleStream, dimension: u32) -> Vec3 {
    warp::sample_uniform_sphere(s.draw_2d(0, dimension)).normalize()
}

/// One of each shape, all about one metre across.
pub fn shapes() -> Vec<Shape> {
    vec![
        Shape::Sphere { radius: 0.5 },
        Shape::Quad {
            size: Vec2::new(1.0, 0.6),
        },
        Shape::Disc { radius: 0.5 },
        Shape::Cuboid {
            size: Vec3::new(1.0, 0.6, 0.4),
        },
        Shape::Cylinder {
            radius: 0.4,
            height: 0.8,
            capped: true,
        },
        Shape::Cylinder {
            radius: 0.4,
            height: 0.8,
            capped: false,
        },
        Shape::Torus {
            major_radius: 0.4,
            minor_radius: 0.15,
        },
        Shape::Torus {
            major_radius: 0.5,
            minor_radius: 0.01,
        },
        Shape::Band {
            inner_radius: 0.4,
            outer_radius: 0.5,
            height: 0.3,
            bevel: 0.03,
        },
        Shape::Band {
            inner_radius: 0.2,
            outer_radius: 0.5,
            height: 0.3,
            bevel: 0.0,
        },
    ]
}

pub enum Kind {
    Similar,
    Stretched,
    Mirrored,
}

/// A transform of this kind that scales by about `scale` and moves by `offset`.
pub fn transform(s: &SampleStream, kind: &Kind, scale: f64, offset: f64) -> DAffine3 {
    let axis = direction(s, 90).as_dvec3().normalize();
    let turn = DQuat::from_axis_angle(axis, f64::from(s.draw_1d(0, 91)) * 6.0);
    let stretch = match kind {
        Kind::Similar => DVec3::ONE,
        Kind::Stretched => DVec3::new(1.0, 0.4, 1.7),
        Kind::Mirrored => DVec3::new(-1.0, 0.6, 1.3),
    };
    let second = DQuat::from_axis_angle(
        direction(s, 92).as_dvec3().normalize(),
        f64::from(s.draw_1d(0, 93)) * 6.0,
    );
    let matrix = DMat3::from_quat(turn) * DMat3::from_diagonal(stretch * scale) * DMat3::from_quat(second);
    let matrix = if matches!(kind, Kind::Similar) {
        DMat3::from_quat(turn) * scale
    } else {
        matrix
    };
    DAffine3 {
        matrix3: matrix,
        translation: direction(s, 94).as_dvec3() * offset,
    }
}

pub fn place(geometry: Geometry, transforms: &[DAffine3]) -> RayScene {
    let instances = transforms.iter().map(|m| Instance::fixed(0, *m)).collect();
    RayScene::build(vec![geometry], instances).expect("the geometry of a test")
}

pub fn one(shape: Shape, m: DAffine3) -> RayScene {
    place(Geometry::Shape(shape), &[m])
}

/// An icosahedron whose triangles were split into four, `levels` times, pushed out to radius 1.
pub fn icosphere(levels: u32) -> TriangleMesh {
    let g = 1.618_034;
    let mut mesh = TriangleMesh::default();
    for a in [-1.0, 1.0] {
        for b in [-g, g] {
            mesh.positions
                .extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
        }
    }
    // Faces of the icosahedron: triples of vertices at mutual distance 2, wound outward.
    let p = mesh.positions.clone();
    let near = |i: usize, j: usize| (p[i].distance(p[j]) - 2.0).abs() < 1e-3;
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(i, k) {
                    let out = (p[j] - p[i]).cross(p[k] - p[i]).dot(p[i]) > 0.0;
                    mesh.triangles
                        .push(if out { [i, j, k] } else { [i, k, j] }.map(|v| v as u32));
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = std::collections::BTreeMap::new();
        let old = std::mem::take(&mut mesh.triangles);
        for [a, b, c] in old {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let m = (mesh.positions[i as usize] + mesh.positions[j as usize]) * 0.5;
                    mesh.positions.push(m);
                    mesh.positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            mesh.triangles
                .extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        for p in &mut mesh.positions {
            *p = p.normalize();
        }
    }
    mesh
}

pub fn mesh(m: TriangleMesh) -> Geometry {
    Geometry::Mesh(Arc::new(m))
}

/// The unit cube around the origin, 12 triangles.
pub fn cube() -> TriangleMesh {
    let positions = (0..8)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5)
        .collect();
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    TriangleMesh {
        positions,
        triangles: quads
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
            .collect(),
        ..TriangleMesh::default()
    }
}

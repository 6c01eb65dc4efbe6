use super::*;
use glam::{Vec2 as Size, Vec3};
use proptest::prelude::*;

fn solids() -> Vec<Solid> {
    let shapes = [
        Shape::Sphere { radius: 0.7 },
        Shape::Quad {
            size: Size::new(1.0, 2.0),
        },
        Shape::Disc { radius: 0.7 },
        Shape::Cuboid {
            size: Vec3::new(1.0, 2.0, 3.0),
        },
        Shape::Cylinder {
            radius: 0.5,
            height: 2.0,
            capped: true,
        },
        Shape::Torus {
            major_radius: 1.0,
            minor_radius: 0.3,
        },
        Shape::Band {
            inner_radius: 0.8,
            outer_radius: 1.0,
            height: 0.5,
            bevel: 0.05,
        },
    ];
    shapes.iter().map(|s| Solid::new(s).unwrap()).collect()
}

proptest! {
    #[test]
    fn parameters_and_points_are_inverse(x in 0.001..0.999_f64, y in 0.001..0.999_f64) {
        for solid in solids() {
            for face in 0..solid.faces() {
                let u = DVec2::new(x, y);
                let (p, _) = solid.point(face, u);
                let back = solid.parameters(face, p);
                prop_assert!((u - back).length() < 1e-9, "{:?} face {}: {} became {}", solid, face, u, back);
                // Points are already on the surface.
                let local = solid.project(p, face);
                prop_assert!((local.p - p).length() < 1e-12);
            }
        }
    }

    #[test]
    fn area_vectors_are_cross_products_of_derivatives(x in 0.01..0.99_f64, y in 0.01..0.99_f64) {
        const STEP: f64 = 1e-6;
        for solid in solids() {
            for face in 0..solid.faces() {
                let at = |dx: f64, dy: f64| solid.point(face, DVec2::new(x + dx * STEP, y + dy * STEP)).0;
                let across = (at(1.0, 0.0) - at(-1.0, 0.0)).cross(at(0.0, 1.0) - at(0.0, -1.0)) / (4.0 * STEP * STEP);
                let (p, area) = solid.point(face, DVec2::new(x, y));
                prop_assert!((across.length() - area.length()).abs() < 1e-4 * area.length(), "{:?} face {}", solid, face);
                prop_assert!(across.normalize().dot(area.normalize()).abs() > 1.0 - 1e-6);
                prop_assert!(solid.project(p, face).n.dot(area.normalize()) > 1.0 - 1e-9);
            }
        }
    }

    #[test]
    fn double_precision_angles_are_exact(turn in -3.1..3.1_f64, length in 1e-30..1e30_f64) {
        let (sin, cos) = radiometry::math::sin_cos_f64(turn);
        prop_assert!((atan2(sin * length, cos * length) - turn).abs() < 1e-14);
    }
}

#[test]
fn fejer_weights_integrate_polynomials() {
    let integral = |f: &dyn Fn(f64) -> f64| (0..64).map(|i| fejer(i, 64)).map(|(x, w)| w * f(x)).sum::<f64>();
    assert!((integral(&|_| 1.0) - 2.0).abs() < 1e-13);
    assert!((integral(&|x| x.powi(10)) - 2.0 / 11.0).abs() < 1e-13);
}

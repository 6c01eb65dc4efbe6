use crate::TextureTransform;
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::FRAC_PI_2;

fn assert_near(found: DVec2, expected: [f64; 2]) {
    assert!((found - DVec2::from(expected)).length() < 1e-12, "{found} {expected:?}");
}

#[test]
fn coordinates_start_at_the_lower_left_and_places_at_the_upper_left() {
    let none = TextureTransform::default();
    assert_near(none.place(Vec2::new(0.25, 0.0)), [0.25, 1.0]);
    assert_near(none.place(Vec2::new(0.25, 1.0)), [0.25, 0.0]);
}

/// The example in the text of `KHR_texture_transform`: "only the lower left quadrant of the source image, rotated clockwise
/// 90°".
#[test]
fn the_example_of_the_specification() {
    let transform = TextureTransform::new(DVec2::new(0.0, 1.0), FRAC_PI_2, DVec2::splat(0.5));
    // The upper left corner shows what was lowest on the left; turned clockwise, the left edge is on top.
    assert_near(transform.place(Vec2::new(0.0, 1.0)), [0.0, 1.0]);
    assert_near(transform.place(Vec2::new(1.0, 1.0)), [0.0, 0.5]);
    assert_near(transform.place(Vec2::new(0.0, 0.0)), [0.5, 1.0]);
    assert_near(transform.place(Vec2::new(1.0, 0.0)), [0.5, 0.5]);
}

#[test]
fn scale_comes_before_rotation_before_translation() {
    let transform = TextureTransform::new(DVec2::new(0.1, 0.2), 0.5, DVec2::new(2.0, 3.0));
    let (sin, cos) = radiometry::math::sin_cos_f64(0.5);
    let (u, v) = (2.0 * 0.25, 3.0 * 0.25);
    assert_near(
        transform.place(Vec2::new(0.25, 0.75)),
        [cos * u + sin * v + 0.1, cos * v - sin * u + 0.2],
    );
}

/// The other example there "inverts the T axis, effectively defining a bottom-left origin".
#[test]
fn a_negative_scale_mirrors() {
    let transform = TextureTransform::new(DVec2::new(0.0, 1.0), 0.0, DVec2::new(1.0, -1.0));
    assert_near(transform.place(Vec2::new(0.375, 0.75)), [0.375, 0.75]);
}

#[test]
fn tangents_are_the_steps_of_the_picture() {
    // A plane whose point (u, v) is (u, v, 0).
    for transform in [
        TextureTransform::default(),
        TextureTransform::new(DVec2::new(0.3, 0.1), 0.7, DVec2::new(2.0, 0.5)),
        TextureTransform::new(DVec2::ZERO, -2.0, DVec2::new(-1.0, 3.0)),
    ] {
        let (right, up) = transform.tangents(DVec3::X, DVec3::Y).unwrap();
        let start = Vec2::new(0.5, 0.25);
        let step = |to: DVec3| transform.place(start + to.truncate().as_vec2() * 0.125) - transform.place(start);
        assert!(
            (step(right) - DVec2::new(0.125, 0.0)).length() < 1e-6,
            "{:?}",
            step(right)
        );
        assert!((step(up) - DVec2::new(0.0, -0.125)).length() < 1e-6, "{:?}", step(up));
    }
    let flat = TextureTransform::new(DVec2::ZERO, 0.0, DVec2::new(0.0, 1.0));
    assert!(flat.tangents(DVec3::X, DVec3::Y).is_none());
}

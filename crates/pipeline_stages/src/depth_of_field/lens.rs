use bevy_ecs::resource::Resource;
use glam::{Affine3A, Vec2, Vec3};
use radiometry::{math, warp};
use spatial::Ray;
use std::f32::consts::TAU;

/// A thin lens in front of a pinhole. Written by `fit_lens`.
#[derive(Resource, Clone, Copy, Debug)]
pub(super) struct ThinLens {
    /// Metres; of a polygon the radius of its corners.
    pub radius: f32,
    /// Distance of the plane of focus along the view, metres.
    pub focus_distance: f32,
    /// Corners of the aperture; 0 for a round one.
    pub blades: u32,
}

impl ThinLens {
    /// The ray through a place of the lens that meets the given one on the plane of focus.
    ///
    /// - `ray`: from the middle of the lens.
    /// - `frame`: of the camera at the time of the ray.
    /// - `u`: in [0, 1)².
    pub(super) fn bend(&self, ray: &Ray, frame: &Affine3A, u: Vec2) -> Ray {
        let view = -Vec3::from(frame.matrix3.z_axis);
        // Per metre of the way to the plane of focus, which may be as far off as numbers go.
        let nearness = ray.direction.dot(view) / self.focus_distance;
        let place = self.sample(u) * self.radius;
        let offset = Vec3::from(frame.matrix3.x_axis) * place.x + Vec3::from(frame.matrix3.y_axis) * place.y;
        Ray {
            origin: ray.origin + offset,
            direction: (ray.direction - offset * nearness).normalize(),
            ..*ray
        }
    }

    /// A place of the aperture, uniform by area, of radius 1.
    fn sample(&self, u: Vec2) -> Vec2 {
        if self.blades < 3 {
            return warp::sample_unit_disc(u);
        }
        // One of the triangles between the middle and two corners, the first corner upwards.
        let blades = self.blades as f32;
        let blade = (u.x * blades).floor().min(blades - 1.0);
        let b = warp::sample_triangle(Vec2::new(u.x * blades - blade, u.y));
        let corner = |k: f32| {
            let (sin, cos) = math::sin_cos(TAU * k / blades);
            Vec2::new(-sin, cos)
        };
        corner(blade) * b.x + corner(blade + 1.0) * b.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radiometry::{SampleStream, StageKey};

    fn numbers(i: u32) -> Vec2 {
        SampleStream::new(1, StageKey::new("lens"), 0, i).draw_2d(0, 0)
    }

    #[test]
    fn all_rays_of_a_place_meet_on_the_plane_of_focus() {
        let lens = ThinLens {
            radius: 0.1,
            focus_distance: 3.0,
            blades: 5,
        };
        let frame = Affine3A::from_rotation_translation(glam::Quat::from_rotation_y(0.4), Vec3::new(1.0, 2.0, 3.0));
        let view = -Vec3::from(frame.matrix3.z_axis);
        let ray = Ray::new(
            frame.translation.into(),
            (view + Vec3::from(frame.matrix3.x_axis) * 0.3).normalize(),
        );
        let meet = ray.at(3.0 / ray.direction.dot(view));
        for i in 0..100 {
            let bent = lens.bend(&ray, &frame, numbers(i));
            let along = (meet - bent.origin).dot(bent.direction);
            assert!((bent.at(along) - meet).length() < 1e-5);
            assert!((bent.origin - ray.origin).length() <= 0.1001);
            assert!((bent.origin - ray.origin).dot(view).abs() < 1e-6);
        }
    }

    #[test]
    fn a_lens_may_be_focused_on_infinity() {
        let lens = ThinLens {
            radius: 0.1,
            focus_distance: 1e20,
            blades: 0,
        };
        let ray = Ray::new(Vec3::ZERO, Vec3::new(0.6, 0.0, -0.8));
        let bent = lens.bend(&ray, &Affine3A::IDENTITY, numbers(0));
        assert!((bent.direction - ray.direction).length() < 1e-6, "{}", bent.direction);
    }

    #[test]
    fn an_aperture_with_corners_is_filled_evenly() {
        for blades in [3, 4, 6, 7] {
            let lens = ThinLens {
                radius: 1.0,
                focus_distance: 1.0,
                blades,
            };
            let n = 1 << 14;
            let (mut mean, mut square) = (Vec2::ZERO, 0.0);
            let apothem = math::cos(TAU / 2.0 / blades as f32);
            for i in 0..n {
                let p = lens.sample(numbers(i));
                mean += p;
                square += p.length_squared();
                for k in 0..blades {
                    let (sin, cos) = math::sin_cos(TAU * (k as f32 + 0.5) / blades as f32);
                    assert!(p.dot(Vec2::new(-sin, cos)) <= apothem + 1e-5, "{p} outside of {blades}");
                }
            }
            assert!((mean / n as f32).length() < 1e-2);
            // The polar moment of a regular polygon over its area: a²/2 + s²/24, s the side.
            let side = 2.0 * math::sin(TAU / 2.0 / blades as f32);
            let expected = 0.5 * apothem * apothem + side * side / 24.0;
            assert!((square / n as f32 - expected).abs() < 0.01 * expected, "{blades}");
        }
    }
}

use crate::frame::MovingFrame;
use glam::{Vec2, Vec3};
use radiometry::math;
use spatial::Ray;

/// A pinhole camera that looks along −Z of its own space, Y up.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Where it is and looks, in the scene's rebased world.
    pub frame: MovingFrame,
    /// Half the height of the image plane at distance 1: tan(fov/2).
    tan_half_fov: f32,
    resolution: Vec2,
}

impl Camera {
    /// - `vertical_fov`: radians, in (0, π).
    /// - `resolution`: pixels of the whole film, crop or no crop.
    #[must_use]
    pub fn new(frame: MovingFrame, vertical_fov: f32, resolution: Vec2) -> Self {
        Self {
            frame,
            tan_half_fov: math::tan(0.5 * vertical_fov),
            resolution,
        }
    }

    /// The ray through a place on the film.
    ///
    /// - `film`: pixels from the top left corner; the centre of pixel (x, y) is (x + ½, y + ½).
    /// - `time`: in [0, 1] of the shutter; where a moving camera is, and the time of the ray.
    #[must_use]
    pub fn ray(&self, film: Vec2, time: f32) -> Ray {
        let frame = self.frame.at(time);
        Ray {
            time,
            ..Ray::new(
                frame.translation.into(),
                frame.transform_vector3(self.on_plane(film)).normalize(),
            )
        }
    }

    /// Height of a pixel at a distance of one metre from the eye, in metres, in the middle of the film.
    #[must_use]
    pub fn pixel_size(&self) -> f32 {
        2.0 * self.tan_half_fov / self.resolution.y
    }

    /// The place on the film, in pixels from the top left corner, where a point is seen; `None` behind the camera.
    ///
    /// - `time`: in [0, 1] of the shutter.
    #[must_use]
    pub fn film_position(&self, point: Vec3, time: f32) -> Option<Vec2> {
        let local = self.frame.at(time).inverse().transform_point3(point);
        let scale = self.pixel_size();
        (local.z < 0.0).then(|| {
            let plane = Vec2::new(local.x, -local.y) / -local.z;
            plane / scale + 0.5 * self.resolution
        })
    }

    /// Where a place on the film is seen, in camera space, on the plane at distance 1.
    fn on_plane(&self, film: Vec2) -> Vec3 {
        let scale = self.pixel_size();
        Vec3::new(
            (film.x - 0.5 * self.resolution.x) * scale,
            (0.5 * self.resolution.y - film.y) * scale,
            -1.0,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Affine3A;

    #[test]
    fn corners_of_the_film_span_the_field_of_view() {
        let camera = Camera::new(
            MovingFrame::fixed(Affine3A::IDENTITY),
            90_f32.to_radians(),
            Vec2::new(200.0, 100.0),
        );
        assert!((camera.ray(Vec2::new(100.0, 50.0), 0.0).direction + Vec3::Z).length() < 1e-6);
        let top = camera.ray(Vec2::new(100.0, 0.0), 0.0).direction;
        assert!((top.y - std::f32::consts::FRAC_1_SQRT_2).abs() < 1e-6 && top.z < 0.0);
        let right = camera.ray(Vec2::new(200.0, 50.0), 0.0).direction;
        assert!((right.x / -right.z - 2.0).abs() < 1e-5);
        for place in [Vec2::new(3.0, 96.5), Vec2::new(150.25, 12.0)] {
            let seen = camera.film_position(camera.ray(place, 0.0).at(7.0), 0.0);
            assert!(seen.is_some_and(|seen| seen.distance(place) < 1e-3), "{seen:?}");
        }
        assert_eq!(camera.film_position(Vec3::Z, 0.0), None);
    }
}

use glam::Vec3;
use radiometry::Rgb;
use spatial::{Ray, SurfacePoint};

/// A light sampled from a point.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub wi: Vec3,
    /// Radiance that arrives when nothing is in the way; for a point light intensity over squared distance, for a
    /// distant point irradiance.
    pub radiance: Rgb,
    /// Density of this choice: per solid angle, or the probability of the light when `delta`.
    pub pdf: f32,
    /// True for a light that no ray can meet by chance.
    pub delta: bool,
    pub(super) target: Target,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
    Point { p: Vec3, error: f32, ng: Vec3 },
    Infinity,
}

impl LightSample {
    /// The ray that must be free for the light to arrive at `point`.
    #[inline]
    #[must_use]
    pub fn shadow_ray(&self, point: &SurfacePoint) -> Ray {
        let ray = match self.target {
            Target::Point { p, error, ng } => spatial::connect(point.p, point.error, point.ng, p, error, ng),
            Target::Infinity => Ray::new(spatial::spawn_origin(point.p, point.error, point.ng, self.wi), self.wi),
        };
        Ray {
            time: point.time,
            ..ray
        }
    }

    /// A point of light at `position` as seen from `from`; `None` where it is dark.
    ///
    /// - `probability`: of the light.
    /// - `intensity`: as seen along the direction towards the light.
    #[inline]
    pub(super) fn of_point(
        from: Vec3,
        position: Vec3,
        probability: f32,
        intensity: impl FnOnce(Vec3) -> Rgb,
    ) -> Option<Self> {
        let offset = position - from;
        let distance_sq = offset.length_squared();
        if distance_sq <= 0.0 {
            return None;
        }
        let wi = offset / distance_sq.sqrt();
        let intensity = intensity(wi);
        (!intensity.is_black()).then_some(Self {
            wi,
            radiance: intensity * (1.0 / distance_sq),
            pdf: probability,
            delta: true,
            target: Target::Point {
                p: position,
                error: 0.0,
                ng: Vec3::ZERO,
            },
        })
    }
}

use glam::{Vec2, Vec3};

/// A ray in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, metres. After a hit, take it from [`spawn_origin`].
    pub origin: Vec3,
    /// Where it goes, unit length.
    pub direction: Vec3,
    /// Only hits nearer than this count, metres; infinity for all.
    pub t_max: f32,
    /// When it is shot, in [0, 1] of the shutter: where moving instances are.
    pub time: f32,
}

impl Ray {
    /// An unlimited ray at the time 0 of the shutter.
    #[inline]
    #[must_use]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            t_max: f32::INFINITY,
            time: 0.0,
        }
    }

    /// The point at distance `t`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// The nearest hit of a ray, as little as [`RayScene::surface`](crate::RayScene::surface) needs to work out the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance along the ray, metres, in (0, `t_max`).
    pub t: f32,
    /// Row of the instance.
    pub instance: u32,
    /// Triangle of the mesh, or face of the shape.
    pub primitive: u32,
    /// Barycentric weights of a triangle's second and third vertex; zero for shapes.
    pub uv: Vec2,
}

const _: () = assert!(size_of::<RayHit>() <= 20);

/// A point on the surface of an instance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position, world space, metres: on the surface but for rounding.
    pub p: Vec3,
    /// Bound on the distance from `p` to the surface, metres.
    pub error: f32,
    /// Geometric normal, world space, unit length, on the outside of the geometry whichever side the ray came from.
    pub ng: Vec3,
    /// Shading normal, world space, unit length, in the hemisphere of `ng`.
    pub ns: Vec3,
    /// Texture coordinates: the file's, barycentric weights where it has none, or the shape's own (see [`Shape`](crate::Shape)).
    pub uv: Vec2,
    /// Row of the instance.
    pub instance: u32,
    /// Triangle of the mesh, or face of the shape.
    pub primitive: u32,
    /// When it is there, in [0, 1] of the shutter.
    pub time: f32,
}

/// Moves a surface point off its surface, to the side that `direction` goes to, so that a ray from there cannot meet
/// the same place again.
///
/// The step is the error bound along the normal, every coordinate then rounded away from the surface: a few units in
/// the last place, whatever the size of the scene. There is no epsilon to set.
///
/// Source: Wächter and Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems 2019, and
/// Pharr et al., "Physically Based Rendering", 4th ed., section 6.8.
/// Differs: intersections near t = 0 are decided in double precision, so the bound covers the rounding of `p` alone.
///
/// - `p`, `error`, `ng`: as in [`SurfacePoint`].
/// - `direction`: world space, any length.
#[inline]
#[must_use]
pub fn spawn_origin(p: Vec3, error: f32, ng: Vec3, direction: Vec3) -> Vec3 {
    let side = if direction.dot(ng) < 0.0 { -error } else { error };
    let away = |p: f32, step: f32| {
        let moved = p + step;
        if step > 0.0 {
            moved.next_up()
        } else if step < 0.0 {
            moved.next_down()
        } else {
            moved
        }
    };
    Vec3::new(away(p.x, ng.x * side), away(p.y, ng.y * side), away(p.z, ng.z * side))
}

/// The ray whose [`occluded`](crate::RayScene::occluded) answers whether two points see each other.
///
/// Both ends are moved off their surfaces. A point in free space (a camera, a point light) has `error` 0 and any `ng`.
///
/// - `from`, `to`: world space, metres, each with the `error` and `ng` of its [`SurfacePoint`].
/// - returns a ray from `from` that ends just before `to`; its `t_max` is 0 when the points coincide.
#[inline]
#[must_use]
pub fn connect(from: Vec3, from_error: f32, from_ng: Vec3, to: Vec3, to_error: f32, to_ng: Vec3) -> Ray {
    let between = to - from;
    // The unit direction is only good to half a unit in the last place of each component, which carries the far end
    // of the segment sideways in proportion to its length.
    let reach = between.length() * (4.0 * f32::EPSILON);
    let start = spawn_origin(from, from_error, from_ng, between);
    let end = if to_error > 0.0 {
        spawn_origin(to, to_error + reach, to_ng, -between)
    } else {
        to
    };
    let span = end - start;
    let length = span.length();
    Ray {
        origin: start,
        direction: if length > 0.0 { span / length } else { Vec3::Z },
        t_max: length * (1.0 - 2.0 * f32::EPSILON),
        time: 0.0,
    }
}

//! Watertight ray–triangle intersection, three edges at a time.

use glam::{DVec3, Vec2, Vec3, Vec3A, Vec4};

/// A primitive as leaves hold it: the vertices of a triangle coordinate by coordinate, or a mark that it is none.
///
/// Rows are x, y and z of the three vertices, so that a ray picks its dominant axis by row number and treats all three
/// vertices with one instruction. The fourth row holds bits, never used as numbers: kind, instance, primitive. One slot
/// fills a cache line, so that a hit costs no other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Slot {
    rows: [Vec4; 4],
}

const _: () = assert!(size_of::<Slot>() == 64);

/// A ray prepared for the test: dominant axis, shear, and the double-precision original for close calls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleRay {
    kx: usize,
    ky: usize,
    kz: usize,
    /// Origin along the axes kx, ky, kz, in every lane.
    origin: [Vec3A; 3],
    /// Shear of x and y, in every lane.
    shear: [Vec3A; 2],
    /// Factor from z to scaled distance.
    distance: f32,
    /// Largest coordinate of an origin that was rounded; 0 when it is exact.
    rounded: f32,
    exact_origin: DVec3,
    exact_direction: DVec3,
    scale: f32,
}

impl TriangleRay {
    /// - `o32`, `d32`: the ray in single precision; `o`, `d`: the same in double precision.
    /// - `exact`: whether `o32` is `o`.
    /// - `scale`: factor on returned distances.
    #[inline(always)]
    pub(crate) fn new(o32: Vec3, d32: Vec3, o: DVec3, d: DVec3, exact: bool, scale: f32) -> Self {
        let a = d32.abs();
        let kz = if a.x > a.y {
            if a.x > a.z { 0 } else { 2 }
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let kx = (kz + 1) % 3;
        let ky = (kz + 2) % 3;
        let direction = d32.to_array();
        let dz = direction[kz];
        let origin = o32.to_array();
        Self {
            kx,
            ky,
            kz,
            origin: [kx, ky, kz].map(|k| Vec3A::splat(origin[k])),
            shear: [kx, ky].map(|k| Vec3A::splat(direction[k] / dz)),
            distance: scale / dz,
            rounded: if exact { 0.0 } else { o32.abs().max_element() },
            exact_origin: o,
            exact_direction: d,
            scale,
        }
    }

    /// Origin and direction in double precision.
    #[inline]
    pub(crate) fn exact(&self) -> (DVec3, DVec3) {
        (self.exact_origin, self.exact_direction)
    }
}

/// Vertices relative to the origin, sheared so that the ray runs along z; lane i is vertex i.
struct Sheared {
    x: Vec3A,
    y: Vec3A,
    z: Vec3A,
}

/// Bound on the relative rounding error of the test's numerator; below it the sign is decided in double precision.
const CLOSE_CALL: f32 = 96.0 / (1 << 24) as f32;

const TRIANGLE: u32 = 0;
const OTHER: u32 = 1;

fn bits([kind, instance, primitive]: [u32; 3]) -> Vec4 {
    Vec4::new(
        f32::from_bits(kind),
        f32::from_bits(instance),
        f32::from_bits(primitive),
        0.0,
    )
}

impl Slot {
    pub(crate) fn triangle(v: [Vec3; 3], instance: u32, primitive: u32) -> Self {
        Self {
            rows: [
                Vec4::new(v[0].x, v[1].x, v[2].x, 0.0),
                Vec4::new(v[0].y, v[1].y, v[2].y, 0.0),
                Vec4::new(v[0].z, v[1].z, v[2].z, 0.0),
                bits([TRIANGLE, instance, primitive]),
            ],
        }
    }

    /// A slot that stands for a shape or for an instanced mesh.
    pub(crate) fn other(instance: u32) -> Self {
        Self {
            rows: [Vec4::ZERO, Vec4::ZERO, Vec4::ZERO, bits([OTHER, instance, 0])],
        }
    }

    #[inline(always)]
    pub(crate) fn is_triangle(&self) -> bool {
        self.rows[3].x.to_bits() == TRIANGLE
    }

    #[inline(always)]
    pub(crate) fn instance(&self) -> u32 {
        self.rows[3].y.to_bits()
    }

    #[inline(always)]
    pub(crate) fn primitive(&self) -> u32 {
        self.rows[3].z.to_bits()
    }

    #[inline(always)]
    fn shear(&self, ray: &TriangleRay) -> Sheared {
        // The mask tells the compiler that the row exists.
        let row = |k: usize| Vec3A::from_vec4(self.rows[k & 3]);
        let z = row(ray.kz) - ray.origin[2];
        Sheared {
            x: (row(ray.kx) - ray.origin[0]) - z * ray.shear[0],
            y: (row(ray.ky) - ray.origin[1]) - z * ray.shear[1],
            z,
        }
    }

    /// Distance times the ray's scale at which it meets the triangle, in (0, `t_max`); infinity when it does not.
    ///
    /// Both sides count. Rays through a shared edge or vertex meet at least one of the triangles that share it: after a
    /// shear that is the same for all of them, the sign of each edge function is exact.
    ///
    /// Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
    /// Differs: distances that rounding could push through 0 are recomputed in double precision, so that a ray that
    /// starts next to the triangle's plane knows on which side it is.
    #[inline(always)]
    pub(crate) fn intersect(&self, ray: &TriangleRay, t_max: f32) -> f32 {
        let s = self.shear(ray);
        let mut edges = s.x.cross(s.y);
        let below = edges.cmplt(Vec3A::ZERO).bitmask();
        let above = edges.cmpgt(Vec3A::ZERO).bitmask();
        if below != 0 && above != 0 {
            return f32::INFINITY;
        }
        if below | above != 7 {
            edges = match exact_edges(&s) {
                Some(exact) => exact,
                None => return f32::INFINITY,
            };
        }
        let det = edges.x + edges.y + edges.z;
        let numerator = edges.dot(s.z);
        let t = numerator * ray.distance / det;
        // Also false for the NaN of a triangle seen edge on, or without an area.
        if !(t < t_max) {
            return f32::INFINITY;
        }
        let side = s.x.abs().max(s.y.abs()).max_element();
        let depth = s.z.abs().max_element() + ray.rounded;
        if numerator.abs() <= CLOSE_CALL * side * (side + depth) * depth {
            return self.intersect_exactly(ray, t_max);
        }
        if t > 0.0 { t } else { f32::INFINITY }
    }

    /// Distance to the triangle's plane in double precision.
    #[cold]
    #[inline(never)]
    fn intersect_exactly(&self, ray: &TriangleRay, t_max: f32) -> f32 {
        let [a, b, c] = self.vertices().map(|v| v.as_dvec3());
        let n = (b - a).cross(c - a);
        let t = n.dot(a - ray.exact_origin) / n.dot(ray.exact_direction);
        let scaled = (t as f32) * ray.scale;
        if t > 0.0 && scaled < t_max {
            scaled
        } else {
            f32::INFINITY
        }
    }

    /// Weights of the second and third vertex where the ray meets the triangle; each in [0, 1], their sum at most 1.
    pub(crate) fn barycentrics(&self, ray: &TriangleRay) -> Vec2 {
        let s = self.shear(ray);
        let edges = exact_edges(&s).unwrap_or(s.x.cross(s.y));
        let weights = edges / (edges.x + edges.y + edges.z);
        if !weights.is_finite() {
            return Vec2::splat(1.0 / 3.0);
        }
        let uv = Vec2::new(weights.y, weights.z).clamp(Vec2::ZERO, Vec2::ONE);
        if uv.x + uv.y > 1.0 { uv / (uv.x + uv.y) } else { uv }
    }

    fn vertices(&self) -> [Vec3; 3] {
        let [x, y, z, _] = self.rows;
        [
            Vec3::new(x.x, y.x, z.x),
            Vec3::new(x.y, y.y, z.y),
            Vec3::new(x.z, y.z, z.z),
        ]
    }
}

/// Edge functions whose signs are right even when single precision yields zero; `None` when the ray passes outside.
#[cold]
#[inline(never)]
fn exact_edges(s: &Sheared) -> Option<Vec3A> {
    let e = s.x.as_dvec3().cross(s.y.as_dvec3());
    let outside = e.cmplt(DVec3::ZERO).any() && e.cmpgt(DVec3::ZERO).any();
    (!outside).then(|| e.as_vec3a())
}

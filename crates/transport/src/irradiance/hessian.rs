use super::strata::Strata;
use glam::{Vec2, Vec3};
use radiometry::math;

/// How fast the gradient of irradiance changes as the place moves within the surface: the size of the second derivative of the
/// mean of the channels, W·m⁻² per square metre.
///
/// What the rays met is taken for a net of triangles around the place, and each triangle for a light of even radiance: that of
/// its furthest corner, since it is what lies behind that comes into view or goes out of it. Then
/// `E = ½ Σ L Σ Γ·n`, with `Γ = θ (a × b)/|a × b|` for an edge from a to b that is seen under the angle θ, and the second
/// derivative of each edge is exact.
///
/// Noise alone would make it large: of its square, what the spread of samples within strata makes by itself is taken off.
///
/// Source: Schwarzhaupt, Wann Jensen and Jarosz, "Practical Hessian-Based Error Control for Irradiance Caching", SIGGRAPH Asia
/// 2012. Differs: by strata that are joined before they are compared, and by the noise.
///
/// - returns a finite number, 0 where there is nothing but noise.
pub(super) fn curvature(strata: &Strata) -> f32 {
    let (mut sum, mut noise_sq) = (Second::default(), 0.0);
    for (weight, cell) in weights(strata).iter().zip(&strata.cells) {
        sum = sum.plus(weight, cell.light.mean());
        noise_sq += weight.size_sq() * cell.variance;
    }
    let square = sum.size_sq() - noise_sq;
    // What is too much to be counted is as much as there can be.
    let square = if square.is_nan() { f32::MAX } else { square };
    square.clamp(0.0, f32::MAX).sqrt()
}

/// A corner of a triangle: where joined strata have met something, in the frame of the normal.
#[derive(Clone, Copy)]
struct Corner {
    place: Vec3,
    distance: f32,
    /// The joined strata whose radiance it has.
    cell: usize,
}

/// What the radiance of each joined stratum counts in the second derivative of irradiance.
fn weights(strata: &Strata) -> Vec<Second> {
    let mut weights = vec![Second::default(); strata.cells.len()];
    let (rings, columns) = (strata.rings(), strata.columns());
    let near: f32 = (0..columns).map(|column| strata.cell(0, column).near).sum();
    let distance = columns as f32 / near.max(FURTHEST);
    for column in 0..columns {
        let next = (column + 1) % columns;
        // The middle of the hemisphere, which has the radiance of the innermost stratum on its side.
        let pole = Corner {
            place: Vec3::Z * distance,
            distance,
            cell: strata.index(0, column),
        };
        let mut inner = [pole; 2];
        // Ring by ring outwards, and from the last one down to the plane of the surface.
        for ring in 0..=rings {
            let outer = [column, next].map(|column| corner(strata, ring, column));
            if ring > 0 {
                add(&mut weights, [inner[0], outer[1], inner[1]]);
            }
            add(&mut weights, [inner[0], outer[0], outer[1]]);
            inner = outer;
        }
    }
    weights
}

/// The middle of joined strata; behind the last ring, what is below its middle in the plane of the surface.
fn corner(strata: &Strata, ring: usize, column: usize) -> Corner {
    let is_rim = ring == strata.rings();
    let ring = ring.min(strata.rings() - 1);
    let distance = 1.0 / strata.cell(ring, column).near.max(FURTHEST);
    let middle = strata.middle(ring, column) * distance;
    Corner {
        place: if is_rim { middle.with_z(0.0) } else { middle },
        distance,
        cell: strata.index(ring, column),
    }
}

/// One over the distance beyond which all is equally far, m⁻¹.
const FURTHEST: f32 = 1e-6;

/// Adds what a triangle's radiance counts to that of its furthest corner.
fn add(weights: &mut [Second], corners: [Corner; 3]) {
    let [a, b, c] = corners;
    let furthest = corners.into_iter().fold(a, |furthest, corner| {
        if corner.distance > furthest.distance {
            corner
        } else {
            furthest
        }
    });
    let mut sum = Second::default();
    for (from, to) in [(a, b), (b, c), (c, a)] {
        sum = sum.plus(&edge(from.place, to.place), 0.5);
    }
    if sum.size_sq().is_finite() {
        let weight = &mut weights[furthest.cell];
        *weight = weight.plus(&sum, 1.0);
    }
}

/// Second derivatives by the two coordinates of the surface: by x twice, by x and y, by y twice.
#[derive(Clone, Copy, Debug, Default)]
struct Second([f32; 3]);

impl Second {
    fn plus(self, other: &Self, factor: f32) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + factor * other.0[i]))
    }

    /// Square of the root mean square over directions of what a symmetric matrix makes: its square norm halved.
    fn size_sq(&self) -> f32 {
        let [xx, xy, yy] = self.0;
        0.5 * (xx * xx + 2.0 * xy * xy + yy * yy)
    }
}

/// A number and how it changes as the place moves within the surface, to the second order.
#[derive(Clone, Copy)]
struct Jet {
    value: f32,
    first: Vec2,
    second: Second,
}

/// The three products of two pairs, symmetric.
fn outer(a: Vec2, b: Vec2) -> Second {
    Second([a.x * b.x, 0.5 * (a.x * b.y + a.y * b.x), a.y * b.y])
}

impl Jet {
    /// A function of one number, given its value and derivatives there.
    fn map(self, value: f32, slope: f32, bend: f32) -> Self {
        let second = Second::default().plus(&self.second, slope);
        Self {
            value,
            first: self.first * slope,
            second: second.plus(&outer(self.first, self.first), bend),
        }
    }

    fn times(self, other: Self) -> Self {
        let second = Second::default()
            .plus(&self.second, other.value)
            .plus(&other.second, self.value);
        Self {
            value: self.value * other.value,
            first: self.first * other.value + other.first * self.value,
            second: second.plus(&outer(self.first, other.first), 2.0),
        }
    }

    /// The angle whose tangent is `self/other`, in [0, π] for positive `self`.
    fn angle(self, other: Self) -> Self {
        let (s, d) = (self.value, other.value);
        let square = s * s + d * d;
        let (by_s, by_d) = (d / square, -s / square);
        let (twice, mixed) = (2.0 * s * d / (square * square), (s * s - d * d) / (square * square));
        let second = Second::default().plus(&self.second, by_s).plus(&other.second, by_d);
        let second = second
            .plus(&outer(self.first, self.first), -twice)
            .plus(&outer(other.first, other.first), twice)
            .plus(&outer(self.first, other.first), 2.0 * mixed);
        Self {
            value: math::atan2(s, d),
            first: self.first * by_s + other.first * by_d,
            second,
        }
    }
}

/// Second derivative of Γ·n of an edge from `a` to `b`.
fn edge(a: Vec3, b: Vec3) -> Second {
    let (cross, along) = (a.cross(b), a - b);
    // (a − δ) × (b − δ) = a × b + δ × (a − b).
    let turned = [Vec3::X.cross(along), Vec3::Y.cross(along)];
    let by = |v: Vec3| Vec2::new(v.dot(turned[0]), v.dot(turned[1]));
    let up = Jet {
        value: cross.z,
        first: by(Vec3::Z),
        second: Second::default(),
    };
    let square = Jet {
        value: cross.length_squared(),
        first: 2.0 * by(cross),
        second: Second([
            2.0 * turned[0].length_squared(),
            2.0 * turned[0].dot(turned[1]),
            2.0 * turned[1].length_squared(),
        ]),
    };
    let dot = Jet {
        value: a.dot(b),
        first: -(a + b).truncate(),
        second: Second([2.0, 0.0, 2.0]),
    };
    let length = square.value.sqrt();
    let sine = square.map(length, 0.5 / length, -0.25 / (length * square.value));
    let inverse = sine.map(1.0 / length, -1.0 / square.value, 2.0 / (length * square.value));
    sine.angle(dot).times(inverse).times(up).second
}

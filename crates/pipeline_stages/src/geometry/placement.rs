//! Transforms as matrices. Pure functions in `f64`.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use pipeline_data::vocabulary::{LookAt, Transform};
use radiometry::math;
use spatial::Shape;

/// Why a prim cannot be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlacementError {
    /// Some entry overflows.
    NotFinite,
    /// The axes span no volume.
    Singular,
    /// The quaternion has no length.
    NoRotation,
    /// The last row of the matrix is not (0, 0, 0, 1).
    NotAffine,
    /// The prim is where it looks.
    TargetIsOrigin,
    /// Up is along the view, or has no length.
    UpAlongView,
}

/// Axes that span less than this share of their box count as singular, and so does an axis that is shorter than this
/// share of the longest. The former is the limit of `spatial`.
const SINGULAR: f64 = 1e-12;
/// Sine of the least angle between up and view.
const PARALLEL: f64 = 1e-7;
/// A target nearer than this share of its distance from the world's origin is lost in rounding.
const SAME_PLACE: f64 = 1e-14;

/// Places a prim in the world.
///
/// - `parent`: world from the parent's space.
/// - returns world from the prim's space.
pub(super) fn place(
    parent: &DAffine3,
    transform: Option<&Transform>,
    look_at: Option<&LookAt>,
) -> Result<DAffine3, PlacementError> {
    let local = transform.map_or(Ok(DAffine3::IDENTITY), parent_from_local)?;
    let world = match look_at {
        None => *parent * local,
        Some(look_at) => {
            let origin = parent.transform_point3(local.translation);
            let rotation = look_along(origin, look_at)?;
            DAffine3 {
                matrix3: rotation * DMat3::from_diagonal(scale_of(&local.matrix3)),
                translation: origin,
            }
        }
    };
    if !world.is_finite() {
        return Err(PlacementError::NotFinite);
    }
    let axes = world.matrix3;
    let lengths = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
    let spans = axes.determinant().abs() > SINGULAR * lengths.element_product();
    if spans && lengths.min_element() > SINGULAR * lengths.max_element() {
        Ok(world)
    } else {
        Err(PlacementError::Singular)
    }
}

/// T·R·S with R = Rz·Ry·Rx, or the matrix.
fn parent_from_local(transform: &Transform) -> Result<DAffine3, PlacementError> {
    if let Some(matrix) = transform.matrix {
        if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
            return Err(PlacementError::NotAffine);
        }
        return Ok(DAffine3::from_mat4(matrix));
    }
    let rotation = match transform.quaternion {
        Some(quaternion) => rotation_of(quaternion)?,
        None => rotation_about_axes(transform.rotate),
    };
    Ok(DAffine3 {
        matrix3: rotation * DMat3::from_diagonal(transform.scale),
        translation: transform.translate,
    })
}

fn rotation_of(quaternion: DQuat) -> Result<DMat3, PlacementError> {
    let length = quaternion.length();
    if length > 0.0 && length.is_finite() {
        Ok(DMat3::from_quat(quaternion / length))
    } else {
        Err(PlacementError::NoRotation)
    }
}

/// Rz·Ry·Rx for angles in degrees.
fn rotation_about_axes(degrees: DVec3) -> DMat3 {
    let (x, y, z) = (sin_cos(degrees.x), sin_cos(degrees.y), sin_cos(degrees.z));
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, x.1, x.0), DVec3::new(0.0, -x.0, x.1));
    let about_y = DMat3::from_cols(DVec3::new(y.1, 0.0, -y.0), DVec3::Y, DVec3::new(y.0, 0.0, y.1));
    let about_z = DMat3::from_cols(DVec3::new(z.1, z.0, 0.0), DVec3::new(-z.0, z.1, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

/// Sine and cosine of an angle in degrees; exact for quarter turns, so that walls stay flat.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let turned = degrees % 360.0;
    let quarter = (turned / 90.0).round();
    let (sin, cos) = math::sin_cos_f64((turned - 90.0 * quarter).to_radians());
    match (quarter as i32).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The rotation that turns −Z from `origin` to the target, Y as far up as it goes.
fn look_along(origin: DVec3, look_at: &LookAt) -> Result<DMat3, PlacementError> {
    let view = look_at.target - origin;
    let distance = view.length();
    let extent = look_at.target.abs().max(origin.abs()).max_element();
    if !distance.is_finite() {
        return Err(PlacementError::NotFinite);
    }
    if distance <= SAME_PLACE * extent {
        return Err(PlacementError::TargetIsOrigin);
    }
    let back = -view / distance;
    let right = look_at.up.normalize_or_zero().cross(back);
    if right.length() <= PARALLEL {
        return Err(PlacementError::UpAlongView);
    }
    let right = right.normalize();
    Ok(DMat3::from_cols(right, back.cross(right), back))
}

/// Length of the axes; the first is negative where they are mirrored.
fn scale_of(axes: &DMat3) -> DVec3 {
    let sign = if axes.determinant() < 0.0 { -1.0 } else { 1.0 };
    DVec3::new(sign * axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length())
}

/// A box around everything, in `f64`.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorldBox {
    low: DVec3,
    high: DVec3,
}

impl WorldBox {
    /// Around nothing.
    pub(super) const EMPTY: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    /// Grows around a box of object space.
    pub(super) fn add(&mut self, world_from_object: &DAffine3, low: DVec3, high: DVec3) {
        for corner in 0..8 {
            let side = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            let p = world_from_object.transform_point3(DVec3::new(side(0), side(1), side(2)));
            self.low = self.low.min(p);
            self.high = self.high.max(p);
        }
    }

    /// Its middle; the world's origin for an empty box.
    pub(super) fn centre(&self) -> DVec3 {
        let centre = self.low * 0.5 + self.high * 0.5;
        if centre.is_finite() { centre } else { DVec3::ZERO }
    }
}

/// Half the extent of a shape along each axis; it lies around its origin.
pub(super) fn half_extent(shape: &Shape) -> DVec3 {
    let extent = |x: f32, y: f32, z: f32| DVec3::new(f64::from(x), f64::from(y), f64::from(z));
    match *shape {
        Shape::Sphere { radius } => DVec3::splat(f64::from(radius)),
        Shape::Quad { size } => 0.5 * extent(size.x, size.y, 0.0),
        Shape::Disc { radius } => extent(radius, radius, 0.0),
        Shape::Cuboid { size } => 0.5 * size.as_dvec3(),
        Shape::Cylinder { radius, height, .. } => extent(radius, 0.5 * height, radius),
        Shape::Torus {
            major_radius,
            minor_radius,
        } => extent(major_radius + minor_radius, minor_radius, major_radius + minor_radius),
        Shape::Band {
            outer_radius, height, ..
        } => extent(outer_radius, 0.5 * height, outer_radius),
    }
}

//! Places of cameras and lights as light transport wants them. Pure functions in `f64`.

use glam::{Affine3A, DAffine3, DMat3, DVec3, Mat3};
use pipeline_data::{WorldMotion, WorldTransform};
use spatial::MOST_DISTANT;
use transport::MovingFrame;

/// Moves a camera or a light to the scene's origin, over the time of the shutter.
///
/// - returns `None` where a place is too far to compute with in single precision.
pub(super) fn moving_frame(world: &WorldTransform, motion: Option<&WorldMotion>, origin: DVec3) -> Option<MovingFrame> {
    let keys = motion.map_or(std::slice::from_ref(&world.0), |motion| &*motion.0);
    let frames = keys.iter().map(|key| rigid_frame(key, origin));
    frames.collect::<Option<Vec<_>>>().map(MovingFrame::new)
}

/// The rotation of a prim, without scale, shear and mirroring.
pub(super) fn rotation_of(world: &WorldTransform) -> Mat3 {
    rotation(&world.0.matrix3).as_mat3()
}

/// Moves a frame to the scene's origin and drops scale, shear and mirroring from its transform.
///
/// The view (−Z) is kept exactly, then up as far as it is perpendicular.
///
/// - `world_from_local`: invertible.
/// - returns `None` where the place is too far to compute with in single precision.
fn rigid_frame(world_from_local: &DAffine3, origin: DVec3) -> Option<Affine3A> {
    let rotation = rotation(&world_from_local.matrix3);
    let place = world_from_local.translation - origin;
    let frame = Affine3A::from_mat3_translation(rotation.as_mat3(), place.as_vec3());
    let is_near = frame.translation.abs().max_element() <= MOST_DISTANT;
    (frame.is_finite() && is_near).then_some(frame)
}

fn rotation(axes: &DMat3) -> DMat3 {
    let back = axes.z_axis.normalize();
    let up = axes.y_axis.normalize();
    let up = (up - back * up.dot(back)).normalize();
    DMat3::from_cols(up.cross(back), up, back)
}

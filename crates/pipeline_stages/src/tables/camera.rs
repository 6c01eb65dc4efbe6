//! The camera's place as light transport wants it. Pure functions in `f64`.

use glam::{Affine3A, DAffine3, DMat3, DVec3};
use spatial::MOST_DISTANT;

/// Moves a camera to the scene's origin and drops scale, shear and mirroring from its transform.
///
/// The view (−Z) is kept exactly, then up as far as it is perpendicular.
///
/// - `world_from_camera`: invertible.
/// - returns `None` where the place is too far to compute with in single precision.
pub(super) fn rigid_frame(world_from_camera: &DAffine3, origin: DVec3) -> Option<Affine3A> {
    let axes = world_from_camera.matrix3;
    let back = axes.z_axis.normalize();
    let up = axes.y_axis.normalize();
    let up = (up - back * up.dot(back)).normalize();
    let rotation = DMat3::from_cols(up.cross(back), up, back);
    let place = world_from_camera.translation - origin;
    let frame = Affine3A::from_mat3_translation(rotation.as_mat3(), place.as_vec3());
    let is_near = frame.translation.abs().max_element() <= MOST_DISTANT;
    (frame.is_finite() && is_near).then_some(frame)
}

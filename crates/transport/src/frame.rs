use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use spatial::Bounds;
use std::sync::Arc;

/// A place with a direction, over the time of the shutter: of a camera or a light. Rigid: no scale, shear or mirroring.
#[derive(Clone, Debug)]
pub struct MovingFrame {
    /// World from local space at evenly spaced times from 0 to 1 of the shutter; one for what stands still.
    keys: Arc<[Affine3A]>,
}

impl MovingFrame {
    /// A frame that stays where it is.
    #[must_use]
    pub fn fixed(world_from_local: Affine3A) -> Self {
        Self {
            keys: Arc::new([world_from_local]),
        }
    }

    /// A frame that is at `keys` at evenly spaced times from 0 to 1 of the shutter, and moves straight in between, so
    /// turning takes as many as the arc needs to look round.
    ///
    /// # Panics
    /// Without keys.
    #[must_use]
    pub fn new(keys: Vec<Affine3A>) -> Self {
        assert!(!keys.is_empty(), "a frame is somewhere");
        Self { keys: keys.into() }
    }

    /// True when it changes while the shutter is open.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.keys.len() > 1
    }

    /// World from local space at a time in [0, 1] of the shutter.
    #[inline]
    #[must_use]
    pub fn at(&self, time: f32) -> Affine3A {
        match &*self.keys {
            [only] => *only,
            keys => between(keys, time),
        }
    }

    /// Where it is, metres.
    #[inline]
    #[must_use]
    pub fn position(&self, time: f32) -> Vec3 {
        self.at(time).translation.into()
    }

    /// Its unit Z axis: where it comes from, as it looks or shines along −Z.
    #[inline]
    #[must_use]
    pub fn back(&self, time: f32) -> Vec3 {
        self.at(time).matrix3.z_axis.into()
    }

    /// Box around where it is while the shutter is open.
    pub(crate) fn bounds(&self) -> Bounds {
        let places = self.keys.iter().map(|key| Vec3::from(key.translation));
        places.fold(Bounds::EMPTY, |all, place| all.extend(place))
    }
}

fn between(keys: &[Affine3A], time: f32) -> Affine3A {
    let last = keys.len() - 1;
    let along = time.clamp(0.0, 1.0) * last as f32;
    let index = (along as usize).min(last - 1);
    let share = along - index as f32;
    let (a, b) = (&keys[index], &keys[index + 1]);
    let mix = |a: Vec3A, b: Vec3A| a + (b - a) * share;
    // The view is kept; up as far as it is perpendicular.
    let z = mix(a.matrix3.z_axis, b.matrix3.z_axis).normalize();
    let x = mix(a.matrix3.y_axis, b.matrix3.y_axis).cross(z).normalize();
    Affine3A {
        matrix3: Mat3A::from_cols(x, z.cross(x), z),
        translation: mix(a.translation, b.translation),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_turns_and_moves_and_stays_rigid() {
        let key = |t: f32| Affine3A::from_rotation_translation(glam::Quat::from_rotation_y(t), Vec3::new(t, 2.0, 0.0));
        let frame = MovingFrame::new((0..=8).map(|i| key(i as f32 / 8.0)).collect());
        for i in 0..=100 {
            let time = i as f32 / 100.0;
            let (found, exact) = (frame.at(time), key(time));
            assert!((found.translation - exact.translation).length() < 1e-5);
            assert!((found.matrix3.x_axis - exact.matrix3.x_axis).length() < 1e-3, "{time}");
            assert!((found.matrix3.determinant() - 1.0).abs() < 1e-5);
        }
        assert!(frame.moves() && !MovingFrame::fixed(key(0.0)).moves());
    }
}

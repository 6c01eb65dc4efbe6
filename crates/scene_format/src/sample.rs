//! Values between time samples.

use bevy_reflect::PartialReflect;
use glam::{DQuat, DVec2, DVec3, DVec4, Quat, Vec2, Vec3, Vec4};

use crate::scene::ValueAt;

/// Gives the value of `samples`, ascending in time, at `time`; none if there are none.
pub(crate) fn at<'v>(samples: &'v [(f64, Box<dyn PartialReflect>)], time: f64) -> Option<ValueAt<'v>> {
    let next = samples.partition_point(|(at, _)| *at <= time);
    let Some(before) = next.checked_sub(1).map(|earlier| &samples[earlier]) else {
        return samples.first().map(|(_, value)| ValueAt::Written(&**value));
    };
    let Some(after) = samples.get(next) else {
        return Some(ValueAt::Written(&*before.1));
    };
    let share = (time - before.0) / (after.0 - before.0);
    Some(match between(&*before.1, &*after.1, share) {
        Some(value) => ValueAt::Between(value),
        None => ValueAt::Written(&*before.1),
    })
}

/// Mixes two values of a type that can be mixed.
fn between(a: &dyn PartialReflect, b: &dyn PartialReflect, share: f64) -> Option<Box<dyn PartialReflect>> {
    macro_rules! try_mix {
        ($($kind:ty => $mix:expr),* $(,)?) => {
            $(
                let mix: fn($kind, $kind, f64) -> $kind = $mix;
                if let (Some(&a), Some(&b)) =
                    (a.try_downcast_ref::<$kind>(), b.try_downcast_ref::<$kind>())
                {
                    return Some(Box::new(mix(a, b, share)));
                }
                if let (Some(&Some(a)), Some(&Some(b))) = (
                    a.try_downcast_ref::<Option<$kind>>(),
                    b.try_downcast_ref::<Option<$kind>>(),
                ) {
                    return Some(Box::new(Some(mix(a, b, share))));
                }
            )*
        };
    }
    try_mix! {
        f64 => |a, b, t| a + (b - a) * t,
        f32 => |a, b, t| (f64::from(a) + (f64::from(b) - f64::from(a)) * t) as f32,
        DVec3 => |a, b, t| a + (b - a) * t,
        DVec2 => |a, b, t| a + (b - a) * t,
        DVec4 => |a, b, t| a + (b - a) * t,
        Vec3 => |a, b, t| (a.as_dvec3() + (b.as_dvec3() - a.as_dvec3()) * t).as_vec3(),
        Vec2 => |a, b, t| (a.as_dvec2() + (b.as_dvec2() - a.as_dvec2()) * t).as_vec2(),
        Vec4 => |a, b, t| (a.as_dvec4() + (b.as_dvec4() - a.as_dvec4()) * t).as_vec4(),
        Quat => |a, b, t| a.slerp(b, t as f32),
        DQuat => |a, b, t| a.slerp(b, t),
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value_at<T: bevy_reflect::Reflect + Copy>(samples: &[(f64, T)], time: f64) -> T {
        let boxed: Vec<(f64, Box<dyn PartialReflect>)> = samples
            .iter()
            .map(|&(at, value)| (at, Box::new(value) as Box<dyn PartialReflect>))
            .collect();
        let value = at(&boxed, time).unwrap();
        *value.get().try_downcast_ref::<T>().unwrap()
    }

    #[test]
    fn mixes_numbers_and_holds_the_rest() {
        let numbers = [(0.0, 0.0_f32), (10.0, 1.0), (20.0, 3.0)];
        for (time, expected) in [
            (-1.0, 0.0),
            (0.0, 0.0),
            (2.5, 0.25),
            (10.0, 1.0),
            (15.0, 2.0),
            (99.0, 3.0),
        ] {
            assert_eq!(value_at(&numbers, time), expected, "at {time}");
        }
        assert_eq!(value_at(&[(0.0, 0_u32), (10.0, 8)], 9.9), 0);
        assert_eq!(value_at(&[(0.0, 0_u32), (10.0, 8)], 10.0), 8);
        assert_eq!(value_at(&[(0.0, Some(1.0_f64)), (1.0, Some(2.0))], 0.5), Some(1.5));
    }

    #[test]
    fn turns_along_the_arc() {
        let samples = [(0.0, DQuat::IDENTITY), (1.0, DQuat::from_rotation_y(1.0))];
        let quarter = value_at(&samples, 0.25);
        assert!(quarter.angle_between(DQuat::from_rotation_y(0.25)) < 1e-7);
    }
}

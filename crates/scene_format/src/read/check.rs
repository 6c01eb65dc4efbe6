//! What every value must be beside its type: finite, in range, not endless.

use bevy_reflect::{PartialReflect, ReflectRef};

use crate::attributes::Range;
use crate::options::Limits;
use crate::schema::FieldInfo;

/// What is wrong with a value; the message goes on after the field's name.
pub(super) struct Problem {
    pub(super) code: &'static str,
    pub(super) message: String,
}

/// Checks a value of a field with everything in it.
pub(super) fn check(value: &dyn PartialReflect, field: &FieldInfo, limits: &Limits) -> Result<(), Problem> {
    if let Some(&number) = value.try_downcast_ref::<f32>() {
        let range = field.range.map(Range::in_single_precision);
        return check_number(f64::from(number), range, field, ", at most 3.4e38");
    }
    if let Some(number) = number(value) {
        return check_number(number, field.range, field, "");
    }
    if let Some(text) = value.try_downcast_ref::<String>() {
        return check_text(text);
    }
    let each = |part: &dyn PartialReflect| check(part, field, limits);
    match value.reflect_ref() {
        ReflectRef::Struct(parts) => parts.iter_fields().try_for_each(|(_, part)| each(part)),
        ReflectRef::TupleStruct(parts) => parts.iter_fields().try_for_each(each),
        ReflectRef::Tuple(parts) => parts.iter_fields().try_for_each(each),
        ReflectRef::List(parts) => {
            check_length(parts.len(), limits)?;
            parts.iter().try_for_each(each)
        }
        ReflectRef::Array(parts) => parts.iter().try_for_each(each),
        ReflectRef::Map(parts) => {
            check_length(parts.len(), limits)?;
            parts
                .iter()
                .try_for_each(|(key, part)| each(key).and_then(|()| each(part)))
        }
        ReflectRef::Set(parts) => {
            check_length(parts.len(), limits)?;
            parts.iter().try_for_each(each)
        }
        ReflectRef::Enum(parts) => parts.iter_fields().try_for_each(|part| each(part.value())),
        _ => Ok(()),
    }
}

/// - `allowed`: the range of the field, in its own precision.
fn check_number(number: f64, allowed: Option<Range>, field: &FieldInfo, largest: &str) -> Result<(), Problem> {
    if !number.is_finite() {
        return Err(Problem {
            code: "not-finite",
            message: format!("must be finite{largest}"),
        });
    }
    match (field.range, allowed) {
        (Some(range), Some(allowed)) if !allowed.contains(number) => {
            let unit = field.unit.map_or(String::new(), |unit| format!(" {unit}"));
            Err(Problem {
                code: "out-of-range",
                message: format!("must be {range}{unit}, but is {number}"),
            })
        }
        _ => Ok(()),
    }
}

fn check_text(text: &str) -> Result<(), Problem> {
    if text.contains('\0') {
        return Err(Problem {
            code: "wrong-type",
            message: "cannot contain a zero byte".to_owned(),
        });
    }
    Ok(())
}

fn check_length(length: usize, limits: &Limits) -> Result<(), Problem> {
    if length > limits.list_items {
        return Err(Problem {
            code: "too-long",
            message: format!("has {length} items; at most {} are read", limits.list_items),
        });
    }
    Ok(())
}

/// Gives a number of any type but `f32` as an `f64`.
fn number(value: &dyn PartialReflect) -> Option<f64> {
    macro_rules! any_of {
        ($($kind:ty)*) => {
            $(if let Some(&number) = value.try_downcast_ref::<$kind>() {
                // The integers that a float cannot hold are far outside of any sensible range.
                return Some(number as f64);
            })*
        };
    }
    any_of!(f64 u8 u16 u32 u64 usize i8 i16 i32 i64 isize);
    None
}

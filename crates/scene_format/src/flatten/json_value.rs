//! Reflected values as JSON.

use bevy_reflect::{PartialReflect, ReflectRef};
use glam::{DMat4, DQuat, DVec2, DVec3, DVec4, Quat, UVec2, UVec3, Vec2, Vec3, Vec4};
use serde_json::{Map, Value, json};

use crate::relation::{AssetPath, Target, Targets};

/// Writes a value: numbers, texts, arrays for vectors and lists, objects for structs, the name of a
/// variant without fields, else an object with that one key; `null` for nothing.
pub(super) fn json_value(value: &dyn PartialReflect) -> Value {
    if let Some(leaf) = leaf(value) {
        return leaf;
    }
    match value.reflect_ref() {
        ReflectRef::Struct(parts) => {
            let fields = parts
                .iter_fields()
                .map(|(name, part)| (name.to_owned(), json_value(part)));
            Value::Object(fields.collect::<Map<_, _>>())
        }
        ReflectRef::TupleStruct(parts) => match parts.field_len() {
            1 => parts.field(0).map_or(Value::Null, json_value),
            _ => parts.iter_fields().map(json_value).collect(),
        },
        ReflectRef::Tuple(parts) => parts.iter_fields().map(json_value).collect(),
        ReflectRef::List(parts) => parts.iter().map(json_value).collect(),
        ReflectRef::Array(parts) => parts.iter().map(json_value).collect(),
        ReflectRef::Map(parts) => parts
            .iter()
            .map(|(key, part)| json!([json_value(key), json_value(part)]))
            .collect(),
        ReflectRef::Set(parts) => parts.iter().map(json_value).collect(),
        ReflectRef::Enum(parts) => enum_value(parts),
        _ => Value::String(format!("{value:?}")),
    }
}

fn enum_value(parts: &dyn bevy_reflect::enums::Enum) -> Value {
    let is_option = parts.reflect_type_ident() == Some("Option");
    let name = parts.variant_name();
    if is_option {
        return parts.field_at(0).map_or(Value::Null, json_value);
    }
    if parts.field_len() == 0 {
        return Value::String(name.to_owned());
    }
    let named = parts.iter_fields().all(|field| field.name().is_some());
    let inner = if named {
        let fields = parts
            .iter_fields()
            .map(|field| (field.name().unwrap_or_default().to_owned(), json_value(field.value())));
        Value::Object(fields.collect::<Map<_, _>>())
    } else {
        parts.iter_fields().map(|field| json_value(field.value())).collect()
    };
    json!({ name: inner })
}

fn leaf(value: &dyn PartialReflect) -> Option<Value> {
    macro_rules! plain {
        ($($kind:ty)*) => {
            $(if let Some(&found) = value.try_downcast_ref::<$kind>() {
                return Some(json!(found));
            })*
        };
    }
    macro_rules! vectors {
        ($($kind:ty)*) => {
            $(if let Some(found) = value.try_downcast_ref::<$kind>() {
                return Some(found.to_array().into_iter().map(number).collect());
            })*
        };
    }
    macro_rules! whole_vectors {
        ($($kind:ty)*) => {
            $(if let Some(found) = value.try_downcast_ref::<$kind>() {
                return Some(json!(found.to_array()));
            })*
        };
    }
    plain!(bool f64 u8 u16 u32 u64 usize i8 i16 i32 i64 isize);
    if let Some(&found) = value.try_downcast_ref::<f32>() {
        return Some(number(found));
    }
    vectors!(Vec2 Vec3 Vec4 Quat DVec2 DVec3 DVec4 DQuat);
    whole_vectors!(UVec2 UVec3);
    if let Some(matrix) = value.try_downcast_ref::<DMat4>() {
        return Some(json!(matrix.to_cols_array_2d()));
    }
    if let Some(text) = value.try_downcast_ref::<String>() {
        return Some(json!(text));
    }
    if let Some(Target(path)) = value.try_downcast_ref() {
        return Some(json!(path));
    }
    if let Some(AssetPath(path)) = value.try_downcast_ref() {
        return Some(json!(path));
    }
    let Targets(paths) = value.try_downcast_ref()?;
    Some(json!(paths))
}

/// A number as it would be written: `0.1` for the `f32` next to it.
fn number(value: impl ToString) -> Value {
    let value: f64 = value.to_string().parse().unwrap_or(f64::NAN);
    json!(value)
}

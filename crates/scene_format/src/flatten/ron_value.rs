//! Reflected values as RON.

use bevy_reflect::{PartialReflect, ReflectRef};
use glam::{DMat4, DQuat, DVec2, DVec3, DVec4, Quat, UVec2, UVec3, Vec2, Vec3, Vec4};

use crate::relation::{AssetPath, Target, Targets};

/// Writes a value the way a scene does.
///
/// - `asset`: how a file is named in the text that is written.
pub(crate) fn ron_value(value: &dyn PartialReflect, asset: &dyn Fn(&str) -> String) -> String {
    let each = |part: &dyn PartialReflect| ron_value(part, asset);
    if let Some(leaf) = leaf(value, asset) {
        return leaf;
    }
    match value.reflect_ref() {
        ReflectRef::Struct(parts) => {
            let fields = parts
                .iter_fields()
                .map(|(name, part)| format!("{name}: {}", each(part)));
            format!("({})", join(fields))
        }
        ReflectRef::TupleStruct(parts) => format!("({})", join(parts.iter_fields().map(each))),
        ReflectRef::Tuple(parts) => format!("({})", join(parts.iter_fields().map(each))),
        ReflectRef::List(parts) => format!("[{}]", join(parts.iter().map(each))),
        ReflectRef::Array(parts) => format!("({})", join(parts.iter().map(each))),
        ReflectRef::Set(parts) => format!("[{}]", join(parts.iter().map(each))),
        ReflectRef::Map(parts) => {
            let entries = parts.iter().map(|(key, part)| format!("{}: {}", each(key), each(part)));
            format!("{{{}}}", join(entries))
        }
        ReflectRef::Enum(parts) => {
            if parts.reflect_type_ident() == Some("Option") {
                return parts.field_at(0).map_or("None".to_owned(), each);
            }
            let name = parts.variant_name();
            if parts.field_len() == 0 {
                return name.to_owned();
            }
            let fields = parts.iter_fields().map(|field| match field.name() {
                Some(key) => format!("{key}: {}", each(field.value())),
                None => each(field.value()),
            });
            format!("{name}({})", join(fields))
        }
        _ => format!("{value:?}"),
    }
}

fn join(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(", ")
}

/// Writes a text in quotes.
pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::with_capacity(text.len() + 2);
    quoted.push('"');
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\r' => quoted.push_str("\\r"),
            '\t' => quoted.push_str("\\t"),
            c if c.is_control() => quoted.push_str(&format!("\\u{{{:x}}}", c as u32)),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

fn leaf(value: &dyn PartialReflect, asset: &dyn Fn(&str) -> String) -> Option<String> {
    macro_rules! plain {
        ($($kind:ty)*) => {
            $(if let Some(found) = value.try_downcast_ref::<$kind>() {
                return Some(found.to_string());
            })*
        };
    }
    macro_rules! vectors {
        ($($kind:ty)*) => {
            $(if let Some(found) = value.try_downcast_ref::<$kind>() {
                return Some(format!("({})", join(found.to_array().iter().map(ToString::to_string))));
            })*
        };
    }
    // The shortest text that gives the same number again.
    plain!(bool f32 f64 u8 u16 u32 u64 usize i8 i16 i32 i64 isize);
    vectors!(Vec2 Vec3 Vec4 Quat DVec2 DVec3 DVec4 DQuat UVec2 UVec3);
    if let Some(matrix) = value.try_downcast_ref::<DMat4>() {
        return Some(format!(
            "({})",
            join(matrix.to_cols_array().iter().map(ToString::to_string))
        ));
    }
    if let Some(text) = value.try_downcast_ref::<String>() {
        return Some(quoted(text));
    }
    if let Some(Target(path)) = value.try_downcast_ref() {
        return Some(quoted(path));
    }
    if let Some(AssetPath(path)) = value.try_downcast_ref() {
        return Some(quoted(&asset(path)));
    }
    let Targets(paths) = value.try_downcast_ref()?;
    Some(format!("[{}]", join(paths.iter().map(|path| quoted(path)))))
}

//! What `pipeline schema` prints.

use std::fmt::Write;

use bevy_reflect::std_traits::ReflectDefault;
use bevy_reflect::{PartialReflect, ReflectRef, TypeInfo, TypeRegistry};

use crate::attributes::Shorthand;
use crate::diagnostic::Diagnostic;
use crate::read::unknown_component;
use crate::relation::{AssetPath, Target, Targets};
use crate::schema::{ComponentInfo, FieldInfo, Schema, held_by_option};

/// Describes one component, or all of them by name: doc comment, then each field with its type,
/// unit, range, default and doc comment.
///
/// # Errors
///
/// `unknown-component`, with a suggestion.
pub fn schema_text(schema: &Schema<'_>, component: Option<&str>) -> Result<String, Diagnostic> {
    let mut text = String::new();
    match component {
        Some(name) => {
            let found = schema.component(name).ok_or_else(|| unknown_component(schema, name))?;
            write_component(&mut text, schema, found);
        }
        None => {
            for (number, found) in schema.components().iter().enumerate() {
                if number > 0 {
                    text.push('\n');
                }
                write_component(&mut text, schema, found);
            }
        }
    }
    Ok(text)
}

fn write_component(text: &mut String, schema: &Schema<'_>, component: &ComponentInfo) {
    let registry = schema.registry();
    let _ = writeln!(text, "{}", component.name);
    write_docs(text, component.docs, "  ");
    let default = registry
        .get_type_data::<ReflectDefault>(component.type_id)
        .map(ReflectDefault::default);
    for field in &component.fields {
        let default = default
            .as_deref()
            .and_then(|value| value.reflect_ref().as_struct().ok()?.field_at(field.index));
        let _ = writeln!(text, "  {}: {}", field.name, facts(field, default, registry));
        write_docs(text, field.docs, "      ");
    }
}

fn write_docs(text: &mut String, docs: Option<&str>, margin: &str) {
    for line in docs.unwrap_or("").trim().lines() {
        let _ = writeln!(text, "{margin}{}", line.trim());
    }
}

/// Type, unit, range, default of a field, separated by commas.
fn facts(field: &FieldInfo, default: Option<&dyn PartialReflect>, registry: &TypeRegistry) -> String {
    let held = held_by_option(field.type_info).and_then(|held| registry.get_type_info(held));
    let mut facts = vec![describe_type(held.unwrap_or(field.type_info), registry)];
    if let Some(unit) = field.unit {
        facts[0] = format!("{} in {unit}", facts[0]);
    }
    if let Some(range) = field.range {
        facts.push(range.to_string());
    }
    if held.is_some() {
        facts.push("optional".to_owned());
    }
    if field.required {
        facts.push("required".to_owned());
    } else if let Some(default) = default {
        let shown = describe_value(default);
        if shown != "None" {
            facts.push(format!("default {shown}"));
        }
    }
    if let Some(exclusive) = field.exclusive {
        facts.push(format!("excludes the other `{}` fields", exclusive.group));
    }
    facts.join(", ")
}

/// Says in words what a field's value is.
pub(crate) fn describe_type(info: &'static TypeInfo, registry: &TypeRegistry) -> String {
    let named = |id| {
        registry
            .get_type_info(id)
            .map_or_else(|| "a value".to_owned(), |inner| describe_type(inner, registry))
    };
    if let Some(held) = held_by_option(info) {
        return format!("{} or `None`", named(held));
    }
    if info.is::<Target>() {
        return "the path of a prim".to_owned();
    }
    if info.is::<Targets>() {
        return "a list of paths of prims".to_owned();
    }
    if info.is::<AssetPath>() {
        return "a file".to_owned();
    }
    match info {
        TypeInfo::Opaque(_) => describe_opaque(info.type_path()),
        TypeInfo::Enum(variants) => format!("one of {}", variants.variant_names().join(", ")),
        TypeInfo::List(list) => format!("a list, each {}", named(list.item_ty().id())),
        TypeInfo::Array(array) => {
            format!("{} items, each {}", array.capacity(), named(array.item_ty().id()))
        }
        TypeInfo::Tuple(tuple) => {
            let items: Vec<String> = tuple.iter().map(|field| named(field.type_id())).collect();
            describe_items(&items)
        }
        TypeInfo::Struct(fields) if info.type_path().starts_with("glam::") => {
            let items: Vec<String> = fields.iter().map(|field| named(field.type_id())).collect();
            describe_items(&items)
        }
        TypeInfo::Struct(fields) => {
            let whole = format!("({}: ..)", fields.field_names().join(": .., "));
            let short = fields.get_attribute::<Shorthand>();
            match short.and_then(|short| fields.field(short.0)) {
                Some(field) => format!("{}, or {whole}", named(field.type_id())),
                None => whole,
            }
        }
        _ => format!("a `{}`", info.type_path_table().short_path()),
    }
}

fn describe_items(items: &[String]) -> String {
    let count = items.len();
    match items.first() {
        Some(first) if items.iter().all(|item| item == first) => match first.as_str() {
            "a number" => format!("{count} numbers"),
            "a whole number" => format!("{count} whole numbers"),
            "a whole number from 0" => format!("{count} whole numbers from 0"),
            _ => format!("({})", items.join(", ")),
        },
        _ => format!("({})", items.join(", ")),
    }
}

fn describe_opaque(path: &str) -> String {
    match path {
        "f32" | "f64" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number from 0",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "bool" => "`true` or `false`",
        "alloc::string::String" => "a text in quotes",
        other => return format!("a `{other}`"),
    }
    .to_owned()
}

/// Writes a value as a scene would.
pub(crate) fn describe_value(value: &dyn PartialReflect) -> String {
    let all =
        |parts: &mut dyn Iterator<Item = &dyn PartialReflect>| parts.map(describe_value).collect::<Vec<_>>().join(", ");
    if let Some(Target(path)) = value.try_downcast_ref() {
        return format!("{path:?}");
    }
    if let Some(Targets(paths)) = value.try_downcast_ref() {
        return format!("{paths:?}");
    }
    if let Some(AssetPath(path)) = value.try_downcast_ref() {
        return format!("{path:?}");
    }
    match value.reflect_ref() {
        ReflectRef::Struct(parts) => {
            let glam = value
                .get_represented_type_info()
                .is_some_and(|info| info.type_path().starts_with("glam::"));
            let fields = parts.iter_fields().map(|(name, part)| {
                let part = describe_value(part);
                if glam { part } else { format!("{name}: {part}") }
            });
            format!("({})", fields.collect::<Vec<_>>().join(", "))
        }
        ReflectRef::Tuple(parts) => format!("({})", all(&mut parts.iter_fields())),
        ReflectRef::TupleStruct(parts) => format!("({})", all(&mut parts.iter_fields())),
        ReflectRef::List(parts) => format!("[{}]", all(&mut parts.iter())),
        ReflectRef::Array(parts) => format!("({})", all(&mut parts.iter())),
        ReflectRef::Enum(parts) if parts.field_len() == 0 => parts.variant_name().to_owned(),
        ReflectRef::Enum(parts) => {
            let fields: Vec<String> = parts.iter_fields().map(|part| describe_value(part.value())).collect();
            if parts.variant_name() == "Some" {
                return fields.join(", ");
            }
            format!("{}({})", parts.variant_name(), fields.join(", "))
        }
        _ => describe_leaf(value),
    }
}

fn describe_leaf(value: &dyn PartialReflect) -> String {
    if let Some(number) = value.try_downcast_ref::<f32>() {
        return number.to_string();
    }
    if let Some(number) = value.try_downcast_ref::<f64>() {
        return number.to_string();
    }
    format!("{value:?}")
}

//! Checks of a composed scene that need more than one opinion: required fields, fields that
//! exclude each other, targets and files that exist.

use std::collections::BTreeMap;
use std::path::PathBuf;

use bevy_reflect::{PartialReflect, ReflectMut};

use crate::asset::{self, Folders};
use crate::compose::{Composed, TargetUse};
use crate::diagnostic::{Diagnostic, Report, nearest};
use crate::relation::AssetPath;
use crate::scene::{AssetUse, ComponentValue, FieldState, FieldValue, Prim};
use crate::schema::{ComponentInfo, Schema};
use crate::source::{Place, Sources};

/// Checks every component that is present: classes and overs may leave fields to others, but
/// nothing may say two things that exclude each other.
pub(crate) fn check_fields(prims: &[Prim], schema: &Schema<'_>, report: &mut Report) {
    for prim in prims {
        for component in &prim.components {
            let Some(info) = schema.component(component.name) else {
                continue;
            };
            if prim.rendered {
                check_required(component, info, report);
            }
            check_exclusive(component, info, prim.rendered, report);
        }
    }
}

fn written<'c>(component: &'c ComponentValue, name: &str) -> Option<&'c FieldValue> {
    component
        .field(name)
        .filter(|field| !matches!(field.state, FieldState::Blocked))
}

fn check_required(component: &ComponentValue, info: &ComponentInfo, report: &mut Report) {
    for field in info.fields.iter().filter(|field| field.required) {
        if written(component, field.name).is_none() {
            let message = format!("`{}` needs the field `{}`", info.name, field.name);
            report.push_once(
                Diagnostic::error("missing-field", message)
                    .at(component.place)
                    .note(format!("pipeline schema {}", info.name)),
            );
        }
    }
}

fn check_exclusive(component: &ComponentValue, info: &ComponentInfo, complete: bool, report: &mut Report) {
    // For each group the side that was written first, by the field that stands for it.
    let mut chosen: BTreeMap<&str, (&str, &FieldValue)> = BTreeMap::new();
    let mut reported: Vec<(&str, &str)> = Vec::new();
    for field in &info.fields {
        let Some(exclusive) = field.exclusive else {
            continue;
        };
        let Some(value) = written(component, field.name) else {
            continue;
        };
        let side = if exclusive.side.is_empty() {
            field.name
        } else {
            exclusive.side
        };
        let &mut (first_side, first) = chosen.entry(exclusive.group).or_insert((side, value));
        if first_side != side && !reported.contains(&(exclusive.group, side)) {
            reported.push((exclusive.group, side));
            let name = info.name;
            let message = format!("`{name}` cannot have both `{}` and `{}`", first.name, field.name);
            report.push_once(
                Diagnostic::error("exclusive-fields", message)
                    .at(value.place)
                    .also(first.place, format!("`{}` is written", first.name))
                    .note(format!(
                        "to use `{}`, write `{name}: ({}: Block)` where it should win",
                        field.name, first.name
                    )),
            );
        }
    }
    if complete {
        check_sides(component, info, &chosen, report);
    }
}

/// Fields of one side need each other.
fn check_sides(
    component: &ComponentValue,
    info: &ComponentInfo,
    chosen: &BTreeMap<&str, (&str, &FieldValue)>,
    report: &mut Report,
) {
    for field in &info.fields {
        let Some(exclusive) = field.exclusive.filter(|found| !found.side.is_empty()) else {
            continue;
        };
        if let Some((side, first)) = chosen.get(exclusive.group)
            && *side == exclusive.side
            && written(component, field.name).is_none()
        {
            let message = format!("`{}` needs `{}` too", first.name, field.name);
            report.push_once(Diagnostic::error("missing-field", message).at(first.place));
        }
    }
}

/// Checks that what relationships name is there.
pub(crate) fn check_targets(composed: &Composed, report: &mut Report) {
    for TargetUse { path, place } in &composed.targets {
        if !composed.index.contains_key(path) {
            let message = format!("there is no prim `{path}`");
            // What is not shown needs no suggestion, and looking for one takes time.
            let names = composed.index.keys().map(String::as_str);
            let names = names.take(if report.has_room() { usize::MAX } else { 0 });
            report.push_once(
                Diagnostic::error("unknown-target", message)
                    .at(*place)
                    .suggest(nearest(path, names)),
            );
        }
    }
}

/// Makes the files that fields of rendered prims name absolute, and checks that they exist.
pub(crate) fn resolve_assets(
    prims: &mut [Prim],
    sources: &Sources,
    folders: &Folders,
    report: &mut Report,
) -> Vec<AssetUse> {
    let mut uses = Vec::new();
    for prim in prims.iter_mut().filter(|prim| prim.rendered) {
        for component in &mut prim.components {
            for field in &mut component.fields {
                let place = field.place;
                let mut resolve = |path: &mut String| {
                    resolve_one(path, place, sources, folders, &mut uses)
                        .unwrap_or_else(|error| report.push_once(error));
                };
                match &mut field.state {
                    FieldState::Constant(value) => each_asset(&mut **value, &mut resolve),
                    FieldState::Samples(samples) => samples
                        .iter_mut()
                        .for_each(|(_, value)| each_asset(&mut **value, &mut resolve)),
                    FieldState::Blocked => {}
                }
            }
        }
    }
    uses
}

fn resolve_one(
    text: &mut String,
    place: Place,
    sources: &Sources,
    folders: &Folders,
    uses: &mut Vec<AssetUse>,
) -> Result<(), Diagnostic> {
    let path: PathBuf = asset::resolve(text, place, sources, folders)?;
    let Some(shown) = path.to_str() else {
        let message = format!("the folder of `{text}` is not UTF-8");
        return Err(Diagnostic::error("unreadable-file", message).at(place));
    };
    *text = shown.to_owned();
    uses.push(AssetUse { path, place });
    Ok(())
}

/// Visits every file name in a value.
fn each_asset(value: &mut dyn PartialReflect, visit: &mut impl FnMut(&mut String)) {
    if let Some(AssetPath(path)) = value.try_downcast_mut() {
        return visit(path);
    }
    match value.reflect_mut() {
        ReflectMut::Struct(parts) => {
            for index in 0..parts.field_len() {
                if let Some(part) = parts.field_at_mut(index) {
                    each_asset(part, visit);
                }
            }
        }
        ReflectMut::TupleStruct(parts) => {
            for index in 0..parts.field_len() {
                if let Some(part) = parts.field_mut(index) {
                    each_asset(part, visit);
                }
            }
        }
        ReflectMut::Tuple(parts) => {
            for index in 0..parts.field_len() {
                if let Some(part) = parts.field_mut(index) {
                    each_asset(part, visit);
                }
            }
        }
        ReflectMut::List(parts) => {
            for index in 0..parts.len() {
                if let Some(part) = parts.get_mut(index) {
                    each_asset(part, visit);
                }
            }
        }
        ReflectMut::Enum(parts) => {
            for index in 0..parts.field_len() {
                if let Some(part) = parts.field_at_mut(index) {
                    each_asset(part, visit);
                }
            }
        }
        _ => {}
    }
}

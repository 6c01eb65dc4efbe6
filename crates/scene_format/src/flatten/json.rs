//! JSON for tools: prims in order, values, relationships, and who has opinions.

use std::path::Path;

use bevy_reflect::PartialReflect;
use serde_json::{Map, Value, json};

use super::json_value::json_value;
use crate::diagnostic::Diagnostics;
use crate::layer::Specifier;
use crate::relation::{Target, Targets};
use crate::sample;
use crate::scene::{ComponentValue, FieldState, FieldValue, Prim, Scene};
use crate::source::{Place, Sources};

/// Writes a composed scene as one JSON object.
///
/// `{"status": "ok", "prims": [..]}`, each prim with `path`, `specifier`, `active`, and where there is
/// any `type`, `components`, `variants`, `props`, `rels` and `explain`: for each field
/// `Component.field` the places of all opinions, strongest first, as `LAYER:PRIM`. Samples have their
/// values at four times, too: before, a quarter, half, after.
pub fn flatten_json(scene: &Scene) -> String {
    let prims: Vec<Value> = scene.prims.iter().map(|prim| prim_json(prim, scene)).collect();
    json!({ "status": "ok", "prims": prims }).to_string()
}

/// Writes what is wrong with a scene as one JSON object: `{"status": "error", "errors": [..]}`.
pub fn errors_json(refusal: &Diagnostics) -> String {
    let errors: Vec<Value> = refusal
        .list
        .iter()
        .map(|error| {
            let mut entry = Map::new();
            entry.insert("code".into(), json!(error.code));
            if let Some(place) = error.place {
                let (line, column) = refusal.sources.line_column(place);
                entry.insert("file".into(), json!(refusal.sources.name(place.source)));
                entry.insert("line".into(), json!(line));
                entry.insert("col".into(), json!(column));
            }
            entry.insert("message".into(), json!(error.message));
            Value::Object(entry)
        })
        .collect();
    json!({ "status": "error", "errors": errors }).to_string()
}

fn prim_json(prim: &Prim, scene: &Scene) -> Value {
    let mut entry = Map::new();
    entry.insert("path".into(), json!(prim.path));
    let specifier = match prim.specifier {
        Specifier::Def => "def",
        Specifier::Over => "over",
        Specifier::Class => "class",
    };
    entry.insert("specifier".into(), json!(specifier));
    entry.insert("active".into(), json!(prim.active));
    if let Some(label) = &prim.type_label {
        entry.insert("type".into(), json!(label));
    }
    let components: Vec<&str> = prim.components.iter().map(|component| component.name).collect();
    let variants = prim.variants.iter().filter_map(|choice| {
        let chosen = choice.chosen.as_ref()?;
        Some((choice.set.clone(), json!(chosen)))
    });
    let variants: Map<String, Value> = variants.collect();
    let mut props = Map::new();
    let mut rels = Map::new();
    let mut explain = Map::new();
    for component in prim.components.iter().chain(&prim.removed) {
        for field in &component.fields {
            let key = key(component, field);
            match targets(field) {
                Some(paths) => {
                    rels.insert(key.clone(), json!(paths));
                }
                None => add(&mut props, key.clone(), state_json(field)),
            }
            let layers: Vec<String> = field
                .opinions
                .iter()
                .map(|opinion| {
                    let path = scene.path_of(&prim.contributors[opinion.contributor as usize]);
                    format!("{}:{path}", layer_name(opinion.place, &scene.sources))
                })
                .collect();
            explain.insert(key, json!(layers));
        }
    }
    add(&mut entry, "components".into(), json!(components));
    add(&mut entry, "variants".into(), Value::Object(variants));
    add(&mut entry, "props".into(), Value::Object(props));
    add(&mut entry, "rels".into(), Value::Object(rels));
    add(&mut entry, "explain".into(), Value::Object(explain));
    Value::Object(entry)
}

fn key(component: &ComponentValue, field: &FieldValue) -> String {
    format!("{}.{}", component.name, field.name)
}

/// Adds what is not empty.
fn add(map: &mut Map<String, Value>, key: String, value: Value) {
    let is_empty = match &value {
        Value::Array(items) => items.is_empty(),
        Value::Object(items) => items.is_empty(),
        _ => false,
    };
    if !is_empty {
        map.insert(key, value);
    }
}

/// The file without `.ron`; `session` for the command line.
fn layer_name(place: Place, sources: &Sources) -> String {
    if sources.is_argument(place.source) {
        return "session".to_owned();
    }
    let name = sources.name(place.source);
    match Path::new(name).extension() {
        Some(ending) if ending == "ron" => name[..name.len() - 4].to_owned(),
        _ => name.to_owned(),
    }
}

/// The targets of a relationship; none for a field of another kind.
fn targets(field: &FieldValue) -> Option<Vec<String>> {
    if !field.is_relationship() {
        return None;
    }
    let FieldState::Constant(value) = &field.state else {
        return Some(Vec::new());
    };
    if let Some(Target(path)) = value.try_downcast_ref() {
        return Some(vec![path.clone()]);
    }
    if let Some(Some(Target(path))) = value.try_downcast_ref::<Option<Target>>() {
        return Some(vec![path.clone()]);
    }
    if let Some(Targets(paths)) = value.try_downcast_ref() {
        return Some(paths.clone());
    }
    let Targets(paths) = value.try_downcast_ref::<Option<Targets>>()?.as_ref()?;
    Some(paths.clone())
}

fn state_json(field: &FieldValue) -> Value {
    match &field.state {
        FieldState::Constant(value) => json!({ "value": json_value(&**value) }),
        FieldState::Blocked => json!({ "blocked": true }),
        FieldState::Samples(samples) => {
            let list: Vec<Value> = samples
                .iter()
                .map(|(time, value)| json!([time, json_value(&**value)]))
                .collect();
            let at: Vec<Value> = probe_times(samples)
                .into_iter()
                .filter_map(|time| Some(json!([time, json_value(sample::at(samples, time)?.get())])))
                .collect();
            json!({ "samples": list, "at": at })
        }
    }
}

/// Before, a quarter, half, after.
fn probe_times(samples: &[(f64, Box<dyn PartialReflect>)]) -> Vec<f64> {
    let (Some((first, _)), Some((last, _))) = (samples.first(), samples.last()) else {
        return Vec::new();
    };
    let span = last - first;
    vec![first - 1.0, first + span / 4.0, first + span / 2.0, last + 1.0]
}

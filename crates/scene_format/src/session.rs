//! What the command line says: opinions above all layers.

use std::cell::RefCell;

use crate::diagnostic::{Diagnostic, Report, nearest};
use crate::layer::FieldSpec;
use crate::lex;
use crate::namespace::Namespace;
use crate::options::Limits;
use crate::read::{Reader, unknown_component, unknown_field};
use crate::schema::{ComponentInfo, Schema};
use crate::source::{Place, SourceId, Sources};

/// One `--set`.
#[derive(Debug)]
pub(crate) struct SetOpinion {
    /// Position in the namespace.
    pub(crate) prim: usize,
    /// Position in the schema.
    pub(crate) component: usize,
    pub(crate) field: FieldSpec,
}

/// Checks one `--variant /Prim{set=variant}`, and refuses it, since variants are not composed yet.
pub(crate) fn refuse_variant(text: &str, sources: &mut Sources, tree: &Namespace, report: &mut Report) {
    let source = sources.add_argument("--variant", text);
    let place = |part: &str| {
        let start = (part.as_ptr() as usize - text.as_ptr() as usize) as u32;
        Place {
            source,
            start,
            end: start + part.len() as u32,
        }
    };
    let choice = text
        .strip_suffix('}')
        .and_then(|rest| rest.split_once('{'))
        .and_then(|(path, choice)| Some((path, choice.split_once('=')?)));
    let Some((path, (set, variant))) = choice else {
        let message = "this must be `/Prim{set=variant}`";
        return report.push(Diagnostic::error("bad-variant", message).at(place(text)));
    };
    let Some(prim) = tree.find(path) else {
        return report.push(unknown_prim(path, tree).at(place(path)));
    };
    let body = &tree.entries[prim].body;
    let sets = body.variants.as_ref().map_or(&[][..], |sets| &sets.value);
    let Some(found) = sets.iter().find(|found| found.name.value == set) else {
        let names = sets.iter().map(|found| found.name.value.as_str());
        let message = format!("`{path}` has no set of variants `{set}`");
        let error = Diagnostic::error("unknown-variant-set", message).suggest(nearest(set, names));
        return report.push(error.at(place(set)));
    };
    let names = || found.variants.iter().map(|(name, _)| name.value.as_str());
    if !names().any(|name| name == variant) {
        let message = format!("the set `{set}` of `{path}` has no variant `{variant}`");
        let listed: Vec<&str> = names().collect();
        let error = Diagnostic::error("unknown-variant", message)
            .suggest(nearest(variant, names()))
            .note(format!("variants of {set}: {}", listed.join(", ")));
        return report.push(error.at(place(variant)));
    }
    let message = "variants cannot be composed yet";
    report.push(Diagnostic::error("not-supported-yet", message).at(place(text)));
}

fn unknown_prim(path: &str, tree: &Namespace) -> Diagnostic {
    Diagnostic::error("unknown-prim", format!("there is no prim `{path}`")).suggest(tree.nearest_path(path))
}

/// Reads one `--set /Prim.Component.field=RON` or `--set /Prim.field=RON`, which is in `sources`.
/// What is wrong is reported.
pub(crate) fn read_set(
    sources: &Sources,
    source: SourceId,
    tree: &Namespace,
    schema: &Schema<'_>,
    limits: &Limits,
    report: &RefCell<Report>,
) -> Option<SetOpinion> {
    let text = &sources.get(source)?.text;
    let reader = Reader::new(schema, limits, source, text, report);
    let fail = |error: Diagnostic, at: &str| {
        reader.report(error.at(reader.place(at)));
        None
    };
    let malformed = |at: &str| {
        let message = "this must be `/Prim.Component.field=value` or `/Prim.field=value`";
        fail(Diagnostic::error("bad-set", message), at)
    };
    let Some((left, right)) = text.split_once('=') else {
        return malformed(text);
    };
    let words: Vec<&str> = left.trim().split('.').collect();
    let (path, component, field) = match words[..] {
        [path, field] => (path, None, field),
        [path, component, field] => (path, Some(component), field),
        _ => return malformed(left),
    };
    let Some(prim) = tree.find(path) else {
        return fail(unknown_prim(path, tree), path);
    };
    let found = match component {
        Some(name) => schema
            .index_of(name)
            .ok_or_else(|| (unknown_component(schema, name), name)),
        None => component_with(field, prim, tree, schema).map_err(|error| (error, field)),
    };
    let component = match found {
        Ok(component) => component,
        Err((error, at)) => return fail(error, at),
    };
    let info = &schema.components()[component];
    let Some(field_info) = info.field(field) else {
        return fail(unknown_field(info, field), field);
    };
    let raw = &right[lex::trim(right)];
    if raw.is_empty() {
        return fail(Diagnostic::error("bad-set", "there is no value after `=`"), right);
    }
    let opinion = reader.field_value(info.name, field_info, raw)?;
    Some(SetOpinion {
        prim,
        component,
        field: FieldSpec {
            index: field_info.index,
            place: reader.place(raw),
            opinion,
        },
    })
}

/// Finds the one component of a prim that has such a field.
fn component_with(field: &str, prim: usize, tree: &Namespace, schema: &Schema<'_>) -> Result<usize, Diagnostic> {
    let entry = &tree.entries[prim];
    let mut mentioned: Vec<usize> = entry.body.components.iter().map(|spec| spec.index).collect();
    mentioned.sort_unstable();
    let info = |index: &usize| -> &ComponentInfo { &schema.components()[*index] };
    let with: Vec<usize> = mentioned
        .iter()
        .copied()
        .filter(|index| info(index).field(field).is_some())
        .collect();
    match with[..] {
        [one] => Ok(one),
        [] => {
            let path = &entry.path;
            let fields = mentioned
                .iter()
                .flat_map(|index| info(index).fields.iter().map(|field| field.name));
            let names: Vec<&str> = mentioned.iter().map(|index| info(index).name).collect();
            let note = if names.is_empty() {
                format!("{path} has no components")
            } else {
                format!("components of {path}: {}", names.join(", "))
            };
            let message = format!("no component of `{path}` has a field `{field}`");
            Err(Diagnostic::error("unknown-field", message)
                .suggest(nearest(field, fields))
                .note(note))
        }
        _ => {
            let path = &entry.path;
            let choices: Vec<String> = with
                .iter()
                .map(|index| format!("{path}.{}.{field}", info(index).name))
                .collect();
            let message = format!("`{path}` has {} components with a field `{field}`", with.len());
            Err(Diagnostic::error("ambiguous-field", message).note(format!("write {}", choices.join(" or "))))
        }
    }
}

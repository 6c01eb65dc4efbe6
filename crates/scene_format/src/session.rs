//! What the command line says: a layer above all others.

use std::cell::RefCell;

use crate::compose::{Arcs, Composed, FlatLayer, LayerId, Library, PathId, Selection, Spec};
use crate::diagnostic::{Diagnostic, Report, nearest};
use crate::layer::{ComponentSpec, FieldSpec, Specifier};
use crate::lex;
use crate::options::Options;
use crate::path::absolute_path_problem;
use crate::read::{Reader, unknown_component, unknown_field};
use crate::scene::Prim;
use crate::schema::{ComponentInfo, Schema};
use crate::source::{Place, SourceId};

/// The arguments of a command line that change a scene.
#[derive(Default)]
pub(crate) struct Session {
    variants: Vec<VariantArgument>,
    sets: Vec<SetArgument>,
}

/// `--variant /Prim{set=variant}`.
struct VariantArgument {
    prim: Word,
    set: Word,
    variant: Word,
}

/// `--set /Prim.Component.field=RON` or `--set /Prim.field=RON`.
struct SetArgument {
    source: SourceId,
    prim: Word,
    component: Option<Word>,
    field: Word,
    /// Where the value stands in the argument.
    value: Place,
}

/// A part of an argument.
struct Word {
    text: String,
    place: Place,
}

/// Splits the arguments; what is malformed is reported.
pub(crate) fn read_session(library: &mut Library<'_, '_>, options: &Options) -> Session {
    let mut session = Session::default();
    for text in &options.variants {
        let source = library.sources.add_argument("--variant", text);
        match read_variant(text, source) {
            Ok(argument) => session.variants.push(argument),
            Err(error) => library.report.push(error),
        }
    }
    for text in &options.sets {
        let source = library.sources.add_argument("--set", text);
        match read_set(text, source) {
            Ok(argument) => session.sets.push(argument),
            Err(error) => library.report.push(error),
        }
    }
    session
}

fn place_of(part: &str, whole: &str, source: SourceId) -> Place {
    let start = (part.as_ptr() as usize - whole.as_ptr() as usize) as u32;
    Place {
        source,
        start,
        end: start + part.len() as u32,
    }
}

fn read_variant(text: &str, source: SourceId) -> Result<VariantArgument, Diagnostic> {
    let choice = text
        .strip_suffix('}')
        .and_then(|rest| rest.split_once('{'))
        .and_then(|(path, choice)| Some((path, choice.split_once('=')?)));
    let word = |part: &str| Word {
        text: part.to_owned(),
        place: place_of(part, text, source),
    };
    match choice {
        Some((prim, (set, variant))) => Ok(VariantArgument {
            prim: word(prim),
            set: word(set),
            variant: word(variant),
        }),
        None => {
            let message = "this must be `/Prim{set=variant}`";
            Err(Diagnostic::error("bad-variant", message).at(place_of(text, text, source)))
        }
    }
}

fn read_set(text: &str, source: SourceId) -> Result<SetArgument, Diagnostic> {
    let place = |part: &str| place_of(part, text, source);
    let malformed = |part: &str| {
        let message = "this must be `/Prim.Component.field=value` or `/Prim.field=value`";
        Diagnostic::error("bad-set", message).at(place(part))
    };
    let (left, right) = text.split_once('=').ok_or_else(|| malformed(text))?;
    let words: Vec<&str> = left.trim().split('.').collect();
    let (prim, component, field) = match words[..] {
        [prim, field] => (prim, None, field),
        [prim, component, field] => (prim, Some(component), field),
        _ => return Err(malformed(left)),
    };
    let raw = &right[lex::trim(right)];
    if raw.is_empty() {
        return Err(Diagnostic::error("bad-set", "there is no value after `=`").at(place(right)));
    }
    let word = |part: &str| Word {
        text: part.to_owned(),
        place: place(part),
    };
    Ok(SetArgument {
        source,
        prim: word(prim),
        component: component.map(word),
        field: word(field),
        value: place(raw),
    })
}

impl Session {
    pub(crate) fn is_empty(&self) -> bool {
        self.variants.is_empty() && self.sets.is_empty()
    }

    /// Whether an argument leaves the component to be found, for which the scene has to be composed
    /// once without it.
    pub(crate) fn has_short_sets(&self) -> bool {
        self.sets.iter().any(|set| set.component.is_none())
    }

    /// Makes the layer of the arguments.
    ///
    /// - `found`: the scene without short arguments; none leaves them out.
    pub(crate) fn layer(&self, library: &mut Library<'_, '_>, found: Option<&Composed>) -> LayerId {
        let source = library.sources.add_argument("", "");
        let mut layer = FlatLayer {
            source,
            default_prim: None,
            time: None,
            sublayers: Vec::new(),
            specs: vec![Spec::new(PathId::ROOT, None)],
            is_session: true,
        };
        for argument in &self.variants {
            let Some(path) = prim_path(&argument.prim, library) else {
                continue;
            };
            let selection = Selection {
                set: library.paths.word(&argument.set.text),
                // `{set=}` chooses nothing, as in a file.
                variant: (!argument.variant.text.is_empty()).then(|| library.paths.word(&argument.variant.text)),
                place: argument.variant.place,
            };
            let spec = spec_at(&mut layer, path, library);
            let arcs: &mut Arcs = spec.arcs.get_or_insert_default();
            // A later argument wins.
            arcs.select.retain(|other| other.set != selection.set);
            arcs.select.push(selection);
            library.session_selections.insert(path, arcs.select.clone());
        }
        for argument in &self.sets {
            if argument.component.is_none() && found.is_none() {
                continue;
            }
            let Some(path) = prim_path(&argument.prim, library) else {
                continue;
            };
            if let Some((component, field)) = argument.opinion(library, found) {
                let spec = spec_at(&mut layer, path, library);
                add_opinion(spec, component, argument.field.place, field);
            }
        }
        library.add_layer(layer)
    }

    /// Reports arguments about prims and sets that the scene does not have.
    pub(crate) fn check(&self, composed: &Composed, report: &mut Report) {
        let prims = self.variants.iter().map(|argument| &argument.prim);
        for word in prims.chain(self.sets.iter().map(|argument| &argument.prim)) {
            if !composed.index.contains_key(&word.text) || composed.session_only.contains(&word.text) {
                let message = format!("there is no prim `{}`", word.text);
                let names = composed.index.keys().map(String::as_str);
                let names = names.filter(|name| !composed.session_only.contains(*name));
                let error = Diagnostic::error("unknown-prim", message).suggest(nearest(&word.text, names));
                report.push(error.at(word.place));
            }
        }
        for argument in &self.variants {
            if let Some(&prim) = composed.index.get(&argument.prim.text)
                && !composed.session_only.contains(&argument.prim.text)
            {
                argument.check_set(&composed.prims[prim], report);
            }
        }
    }
}

impl VariantArgument {
    fn check_set(&self, prim: &Prim, report: &mut Report) {
        let (path, set) = (&prim.path, &self.set.text);
        let Some(found) = prim.variants.iter().find(|choice| choice.set == *set) else {
            let names = || prim.variants.iter().map(|choice| choice.set.as_str());
            let message = format!("`{path}` has no set of variants `{set}`");
            let mut error = Diagnostic::error("unknown-variant-set", message).suggest(nearest(set, names()));
            if error.suggestion.is_none() && !prim.variants.is_empty() {
                let listed: Vec<&str> = names().collect();
                error = error.note(format!("sets of {path}: {}", listed.join(", ")));
            }
            return report.push(error.at(self.set.place));
        };
        if !self.variant.text.is_empty() && !found.variants.contains(&self.variant.text) {
            let variant = &self.variant.text;
            let names = found.variants.iter().map(String::as_str);
            let message = format!("the set `{set}` of `{path}` has no variant `{variant}`");
            let error = Diagnostic::error("unknown-variant", message)
                .suggest(nearest(variant, names))
                .note(format!("variants of {set}: {}", found.variants.join(", ")));
            report.push_once(error.at(self.variant.place));
        }
    }
}

/// Gives the number of a prim's path; none for a text that is no path, which no prim has.
fn prim_path(word: &Word, library: &mut Library<'_, '_>) -> Option<PathId> {
    if absolute_path_problem(&word.text, library.limits.name_bytes).is_some() {
        return None;
    }
    Some(library.paths.intern(&word.text))
}

/// Finds or adds the spec of a prim, and specs of those above it, each listed by its parent as in any
/// layer. A prim that only these specs bring into being is none: see [`Composed::session_only`].
fn spec_at<'s>(layer: &'s mut FlatLayer, path: PathId, library: &Library<'_, '_>) -> &'s mut Spec {
    let mut missing = Vec::new();
    let mut above = path;
    let number = loop {
        if let Some(number) = layer.specs.iter().position(|spec| spec.path == above) {
            break number;
        }
        missing.push(above);
        above = library.paths.parent(above);
    };
    let mut number = number;
    for path in missing.into_iter().rev() {
        layer.specs[number].children.extend(library.paths.name(path));
        layer.specs.push(Spec::new(path, Some(Specifier::Over)));
        number = layer.specs.len() - 1;
    }
    &mut layer.specs[number]
}

/// Adds an opinion to a spec; an earlier one about the same field is replaced.
fn add_opinion(spec: &mut Spec, component: usize, place: Place, field: FieldSpec) {
    let at = match spec.components.iter().position(|known| known.index == component) {
        Some(at) => at,
        None => {
            spec.components.push(ComponentSpec {
                index: component,
                place,
                fields: Vec::new(),
            });
            spec.components.len() - 1
        }
    };
    let fields = &mut spec.components[at].fields;
    fields.retain(|known| known.index != field.index);
    fields.push(field);
}

impl SetArgument {
    /// Reads the value; gives it with the component's position in the schema. What is wrong is
    /// reported, once.
    fn opinion(&self, library: &mut Library<'_, '_>, found: Option<&Composed>) -> Option<(usize, FieldSpec)> {
        let schema = library.schema;
        let component = match &self.component {
            Some(name) => schema
                .index_of(&name.text)
                .ok_or_else(|| unknown_component(schema, &name.text).at(name.place)),
            None => {
                let composed = found?;
                let prim = &composed.prims[*composed.index.get(&self.prim.text)?];
                component_with(&self.field.text, prim, schema).map_err(|error| error.at(self.field.place))
            }
        };
        let component = match component {
            Ok(component) => component,
            Err(error) => {
                library.report.push_once(error);
                return None;
            }
        };
        let info = &schema.components()[component];
        let Some(field) = info.field(&self.field.text) else {
            let error = unknown_field(info, &self.field.text).at(self.field.place);
            library.report.push_once(error);
            return None;
        };
        let source = std::sync::Arc::clone(library.sources.get(self.source)?);
        let raw = &source.text[self.value.start as usize..self.value.end as usize];
        let report = RefCell::new(Report::default());
        let reader = Reader::new(schema, library.limits, self.source, &source.text, &report);
        let opinion = reader.field_value(info.name, field, raw);
        for error in report.into_inner().errors {
            library.report.push_once(error);
        }
        let mut opinion = opinion?;
        if let crate::layer::FieldOpinion::Targets(edit) = &mut opinion {
            *edit = edit.filter_map(|item| {
                let resolved = crate::path::resolve_target(&item.value, &self.prim.text, library.limits.name_bytes);
                match resolved {
                    Ok(value) => Some(crate::layer::Spanned {
                        value,
                        place: item.place,
                    }),
                    Err(problem) => {
                        let error = Diagnostic::error("bad-path", problem).at(item.place);
                        library.report.push_once(error);
                        None
                    }
                }
            });
        }
        let field = FieldSpec {
            index: field.index,
            place: self.value,
            opinion,
        };
        Some((component, field))
    }
}

/// Finds the one component of a prim that has such a field.
fn component_with(field: &str, prim: &Prim, schema: &Schema<'_>) -> Result<usize, Diagnostic> {
    let mentioned: Vec<usize> = prim
        .components
        .iter()
        .filter_map(|component| schema.index_of(component.name))
        .collect();
    let info = |index: &usize| -> &ComponentInfo { &schema.components()[*index] };
    let with: Vec<usize> = mentioned
        .iter()
        .copied()
        .filter(|index| info(index).field(field).is_some())
        .collect();
    let path = &prim.path;
    match with[..] {
        [one] => Ok(one),
        [] => {
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
            let choices: Vec<String> = with
                .iter()
                .map(|index| format!("{path}.{}.{field}", info(index).name))
                .collect();
            let message = format!("`{path}` has {} components with a field `{field}`", with.len());
            Err(Diagnostic::error("ambiguous-field", message).note(format!("write {}", choices.join(" or "))))
        }
    }
}

//! From layers to a scene. For now from one layer and the command line; the arcs between files
//! and prims are refused, never ignored.

use std::collections::BTreeMap;

use crate::diagnostic::{Diagnostic, Report};
use crate::layer::{Body, ComponentSpec, FieldOpinion, FieldSpec, Layer, ListEdit, Spanned, Specifier};
use crate::namespace::{Entry, Namespace};
use crate::options::Limits;
use crate::path::resolve_target;
use crate::relation::{Target, Targets};
use crate::scene::{ComponentValue, FieldState, FieldValue, Opinion, Prim};
use crate::schema::{FieldInfo, FieldKind, Schema};
use crate::session::SetOpinion;
use crate::source::Place;

/// A prim that a relationship of a rendered prim names.
pub(crate) struct TargetUse {
    pub(crate) path: String,
    pub(crate) place: Place,
}

/// The prims of a scene before checks that need all of them.
#[derive(Default)]
pub(crate) struct Composed {
    pub(crate) prims: Vec<Prim>,
    pub(crate) index: BTreeMap<String, usize>,
    pub(crate) targets: Vec<TargetUse>,
}

/// Reports every arc of a layer, since none is composed yet.
pub(crate) fn refuse_arcs(layer: &Layer, tree: &Namespace, report: &mut Report) {
    if let Some(sublayers) = &layer.sublayers {
        refuse("sublayers", sublayers.place, report);
    }
    for entry in &tree.entries {
        refuse_arcs_of(&entry.body, report);
    }
}

fn refuse(what: &str, place: Place, report: &mut Report) {
    let message = format!("`{what}` cannot be composed yet");
    report.push(
        Diagnostic::error("not-supported-yet", message)
            .at(place)
            .note("this version reads scenes of one file without variants"),
    );
}

fn refuse_arcs_of(body: &Body, report: &mut Report) {
    let arcs = [
        ("references", body.references.as_ref().map(|arc| arc.place)),
        ("payloads", body.payloads.as_ref().map(|arc| arc.place)),
        ("inherits", body.inherits.as_ref().map(|arc| arc.place)),
        ("specializes", body.specializes.as_ref().map(|arc| arc.place)),
        ("select", body.select.as_ref().map(|arc| arc.place)),
        ("variants", body.variants.as_ref().map(|arc| arc.place)),
    ];
    for (name, place) in arcs {
        if let Some(place) = place {
            refuse(name, place, report);
        }
    }
}

/// Composes one layer with the session above it.
pub(crate) fn compose(
    tree: Namespace,
    sets: Vec<SetOpinion>,
    schema: &Schema<'_>,
    limits: &Limits,
    report: &mut Report,
) -> Composed {
    let mut by_prim: BTreeMap<usize, Vec<SetOpinion>> = BTreeMap::new();
    // A later flag is stronger, so it comes first.
    for set in sets.into_iter().rev() {
        by_prim.entry(set.prim).or_default().push(set);
    }
    let mut composed = Composed::default();
    let mut entries: Vec<Option<Entry>> = tree.entries.into_iter().map(Some).collect();
    let mut waiting: Vec<(usize, Option<usize>)> = tree.roots.iter().rev().map(|&root| (root, None)).collect();
    while let Some((number, parent)) = waiting.pop() {
        let Some(entry) = entries[number].take() else {
            continue;
        };
        let position = composed.prims.len();
        let children = entry.children.clone();
        let session = by_prim.remove(&number).unwrap_or_default();
        let mut composer = PrimComposer {
            schema,
            limits,
            report,
            targets: &mut composed.targets,
        };
        let above = parent.is_none_or(|parent: usize| composed.prims[parent].rendered);
        let prim = composer.compose(entry, session, parent, above);
        if prim.active {
            waiting.extend(children.iter().rev().map(|&child| (child, Some(position))));
        }
        composed.index.insert(prim.path.clone(), position);
        composed.prims.push(prim);
    }
    composed
}

/// All opinions about one component of one prim, strongest first.
struct Opinions {
    place: Place,
    present: bool,
    fields: BTreeMap<usize, Vec<(FieldSpec, bool)>>,
}

struct PrimComposer<'a, 'r> {
    schema: &'a Schema<'r>,
    limits: &'a Limits,
    report: &'a mut Report,
    targets: &'a mut Vec<TargetUse>,
}

impl PrimComposer<'_, '_> {
    fn compose(&mut self, entry: Entry, session: Vec<SetOpinion>, parent: Option<usize>, above: bool) -> Prim {
        let active = entry.body.active.unwrap_or(true);
        let rendered = above && active && entry.specifier == Specifier::Def;
        let path = entry.path;
        for name in &entry.body.without {
            let message = format!("`{}` is not there to be removed", name.value);
            let warning = Diagnostic::warning("without-effect", message).at(name.place);
            self.report
                .push(warning.note("`without` removes what weaker opinions add"));
        }
        let gathered = gather(entry.body.components, session);
        let mut components = Vec::new();
        let mut removed = Vec::new();
        // Positions in the schema ascend with the names.
        for (index, opinions) in gathered {
            let present = opinions.present;
            let value = self.component(index, opinions, &path, rendered && present);
            if present {
                components.push(value);
            } else {
                removed.push(value);
            }
        }
        Prim {
            path,
            name: entry.name,
            parent,
            specifier: entry.specifier,
            active,
            rendered,
            type_label: entry.body.type_label,
            doc: entry.body.doc,
            place: entry.place,
            components,
            removed,
        }
    }

    fn component(&mut self, index: usize, opinions: Opinions, owner: &str, counts: bool) -> ComponentValue {
        let info = &self.schema.components()[index];
        let fields = opinions
            .fields
            .into_iter()
            .map(|(field, specs)| {
                let field = &info.fields[field];
                self.field(info.name, field, specs, owner, counts)
            })
            .collect();
        ComponentValue {
            name: info.name,
            type_id: info.type_id,
            place: opinions.place,
            fields,
        }
    }

    fn field(
        &mut self,
        component: &str,
        field: &FieldInfo,
        specs: Vec<(FieldSpec, bool)>,
        owner: &str,
        counts: bool,
    ) -> FieldValue {
        let opinions: Vec<Opinion> = specs
            .iter()
            .map(|(spec, session)| Opinion {
                place: spec.place,
                prim: owner.to_owned(),
                session: *session,
            })
            .collect();
        let place = opinions[0].place;
        let state = match field.kind {
            FieldKind::Value => match specs.into_iter().next().map(|(spec, _)| spec.opinion) {
                Some(FieldOpinion::Constant(value)) => FieldState::Constant(value),
                Some(FieldOpinion::Samples(samples)) => FieldState::Samples(samples),
                _ => FieldState::Blocked,
            },
            FieldKind::Target { .. } | FieldKind::Targets { .. } => {
                let targets = self.combine_targets(&specs, owner);
                self.relationship(component, field, targets, place, counts)
            }
        };
        FieldValue {
            name: field.name,
            index: field.index,
            type_id: field.type_id,
            place,
            state,
            opinions,
        }
    }

    /// Combines lists of targets from the weakest to the strongest; none if they are blocked.
    fn combine_targets(&mut self, specs: &[(FieldSpec, bool)], owner: &str) -> Option<Vec<Spanned<String>>> {
        let mut list = None;
        for (spec, _) in specs.iter().rev() {
            match &spec.opinion {
                FieldOpinion::Targets(edit) => {
                    let edit = self.make_absolute(edit, owner);
                    let list = list.get_or_insert_with(Vec::new);
                    edit.apply(list, |a: &Spanned<String>, b| a.value == b.value);
                }
                _ => list = None,
            }
        }
        list
    }

    fn make_absolute(&mut self, edit: &ListEdit<Spanned<String>>, owner: &str) -> ListEdit<Spanned<String>> {
        let mut each = |items: &[Spanned<String>]| -> Vec<Spanned<String>> {
            items
                .iter()
                .filter_map(
                    |item| match resolve_target(&item.value, owner, self.limits.name_bytes) {
                        Ok(value) => Some(Spanned {
                            value,
                            place: item.place,
                        }),
                        Err(problem) => {
                            let error = Diagnostic::error("bad-path", problem);
                            self.report.push(error.at(item.place));
                            None
                        }
                    },
                )
                .collect()
        };
        match edit {
            ListEdit::Explicit(items) => ListEdit::Explicit(each(items)),
            ListEdit::Edit {
                prepend,
                append,
                delete,
            } => ListEdit::Edit {
                prepend: each(prepend),
                append: each(append),
                delete: each(delete),
            },
        }
    }

    /// Makes the value of a relationship and remembers what has to exist.
    fn relationship(
        &mut self,
        component: &str,
        field: &FieldInfo,
        targets: Option<Vec<Spanned<String>>>,
        place: Place,
        counts: bool,
    ) -> FieldState {
        let Some(targets) = targets else {
            return FieldState::Blocked;
        };
        if counts {
            self.targets.extend(targets.iter().map(|target| TargetUse {
                path: target.value.clone(),
                place: target.place,
            }));
        }
        let mut paths = targets.into_iter().map(|target| target.value);
        match field.kind {
            FieldKind::Targets { optional: false } => FieldState::Constant(Box::new(Targets(paths.collect()))),
            FieldKind::Targets { optional: true } => {
                let list: Vec<String> = paths.collect();
                FieldState::Constant(Box::new((!list.is_empty()).then_some(Targets(list))))
            }
            FieldKind::Target { optional } => {
                let first = paths.next();
                if paths.next().is_some() {
                    let message = format!("`{component}.{}` names one prim, not several", field.name);
                    self.report.push(Diagnostic::error("wrong-type", message).at(place));
                }
                match (first, optional) {
                    (first, true) => FieldState::Constant(Box::new(first.map(Target))),
                    (Some(first), false) => FieldState::Constant(Box::new(Target(first))),
                    (None, false) => FieldState::Blocked,
                }
            }
            FieldKind::Value => FieldState::Blocked,
        }
    }
}

/// Sorts the opinions about a prim by component and field, the session's first.
fn gather(components: Vec<ComponentSpec>, session: Vec<SetOpinion>) -> BTreeMap<usize, Opinions> {
    let mut gathered: BTreeMap<usize, Opinions> = BTreeMap::new();
    let mut mention = |component: usize, place: Place, fields: Vec<FieldSpec>, session: bool| {
        let opinions = gathered.entry(component).or_insert_with(|| Opinions {
            place,
            // `without` of the same layer is weaker than its mentions, and there is no weaker
            // layer yet that it could remove something of.
            present: true,
            fields: BTreeMap::new(),
        });
        for field in fields {
            let list = opinions.fields.entry(field.index).or_default();
            list.push((field, session));
        }
    };
    for set in session {
        mention(set.component, set.field.place, vec![set.field], true);
    }
    for component in components {
        mention(component.index, component.place, component.fields, false);
    }
    gathered
}

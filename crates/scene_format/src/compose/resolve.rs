//! What a prim is, from the tree of the places that say something about it.

use std::collections::{BTreeMap, BTreeSet};

use super::checks::variants_of;
use super::graph::{ArcKind, Graph, NodeId};
use super::library::{LayerId, Library};
use super::mapping::TimeMap;
use super::paths::{Step, Word};
use super::spec::Spec;
use super::values::{clone_samples, clone_value, list_length};
use crate::diagnostic::Diagnostic;
use crate::layer::{FieldOpinion, FieldSpec, Specifier};
use crate::scene::{ComponentValue, Contributor, FieldState, FieldValue, Opinion, Prim, VariantChoice};
use crate::schema::{FieldInfo, FieldKind};
use crate::source::Place;

/// A prim that a relationship of a rendered prim names.
pub(crate) struct TargetUse {
    pub(crate) path: String,
    pub(crate) place: Place,
}

/// Turns trees into prims.
#[derive(Default)]
pub(crate) struct Resolver {
    pub(crate) targets: Vec<TargetUse>,
    /// Opinions so far, counted anew wherever an arc brings them.
    pub(crate) opinions: usize,
    /// Each `without`, and whether it ever removed something.
    removals: BTreeMap<Place, bool>,
}

/// One spec that says something about a prim.
#[derive(Clone, Copy)]
pub(super) struct Contribution {
    pub(super) node: NodeId,
    pub(super) layer: LayerId,
    pub(super) spec: u32,
    pub(super) time: TimeMap,
}

/// A field of a component in a spec.
#[derive(Clone, Copy)]
pub(super) struct FieldPlace {
    pub(super) contribution: usize,
    pub(super) component: usize,
    pub(super) field: usize,
}

/// All opinions about one component, strongest first.
struct Opinions {
    place: Place,
    fields: BTreeMap<usize, Vec<FieldPlace>>,
}

impl Resolver {
    pub(crate) fn resolve(
        &mut self,
        library: &mut Library<'_, '_>,
        graph: &Graph,
        parent: Option<usize>,
        above: bool,
    ) -> Prim {
        let contributions = contributions(library, graph);
        library.work += graph.len() + 4 * contributions.len();
        self.opinions += graph.len() / 4;
        let mut prim = Resolving {
            resolver: self,
            library,
            graph,
            contributions: &contributions,
            counts: false,
            owner: String::new(),
        };
        prim.run(parent, above)
    }

    /// Warns of each `without` that removed nothing anywhere.
    pub(crate) fn warn_of_idle_removals(&mut self, library: &mut Library<'_, '_>) {
        for (&place, &worked) in &self.removals {
            if !worked {
                let name = library.sources.text(place).to_owned();
                let message = format!("`{name}` is not there to be removed");
                let warning = Diagnostic::warning("without-effect", message).at(place);
                library
                    .report
                    .push_once(warning.note("`without` removes what weaker opinions add"));
            }
        }
    }
}

/// Lists the specs of a tree, strong to weak.
fn contributions(library: &Library<'_, '_>, graph: &Graph) -> Vec<Contribution> {
    let mut list = Vec::new();
    for node in graph.strong_to_weak() {
        let found = graph.node(node);
        if !(found.has_specs && found.contributes()) {
            continue;
        }
        for (layer, time, spec) in library.spec_numbers(found.site.stack, found.site.path) {
            list.push(Contribution {
                node,
                layer,
                spec,
                time: found.map_to_root.time.after(time),
            });
        }
    }
    list
}

/// One prim in the making.
pub(super) struct Resolving<'s, 'l, 'a, 'r> {
    pub(super) resolver: &'s mut Resolver,
    pub(super) library: &'l mut Library<'a, 'r>,
    pub(super) graph: &'s Graph,
    pub(super) contributions: &'s [Contribution],
    /// Whether the prim is rendered, so that its targets have to exist.
    pub(super) counts: bool,
    /// Path of the prim.
    pub(super) owner: String,
}

impl Resolving<'_, '_, '_, '_> {
    fn spec(&self, contribution: &Contribution) -> &Spec {
        &self.library.layer(contribution.layer).specs[contribution.spec as usize]
    }

    fn run(&mut self, parent: Option<usize>, above: bool) -> Prim {
        let first = |get: fn(&Spec) -> Option<&Box<str>>| {
            let mut specs = self.contributions.iter().map(|one| self.spec(one));
            specs.find_map(|spec| get(spec).map(ToString::to_string))
        };
        let type_label = first(|spec| spec.type_label.as_ref());
        let doc = first(|spec| spec.doc.as_ref());
        let specs = || self.contributions.iter().map(|one| self.spec(one));
        let active = specs().find_map(|spec| spec.active).unwrap_or(true);
        let place = specs().find_map(|spec| spec.place);
        let specifier = self.specifier();
        let rendered = above && active && specifier == Specifier::Def;
        let path = self.graph.root().site.path;
        self.owner = self.library.paths.text(path);
        let name = self.library.paths.name(path);
        let name = name.map_or(String::new(), |name| self.library.paths.word_text(name).to_owned());
        let present = self.present_components();
        let (contributors, numbers) = self.contributors();
        let mut components = Vec::new();
        let mut removed = Vec::new();
        // Positions in the schema ascend with the names.
        for (index, opinions) in self.gather() {
            let is_present = present.contains(&index);
            self.counts = rendered && is_present;
            let value = self.component(index, opinions, &numbers);
            if is_present {
                components.push(value);
            } else {
                removed.push(value);
            }
        }
        let variants = self.variants();
        Prim {
            path: std::mem::take(&mut self.owner),
            name,
            parent,
            specifier,
            active,
            rendered,
            type_label,
            doc,
            place,
            components,
            removed,
            variants,
            contributors,
        }
    }

    /// The strongest mention that defines the prim. A class that this very prim inherits counts only
    /// if nothing else says more than `Over`.
    fn specifier(&self) -> Specifier {
        let mut inherited_class = false;
        for one in self.contributions {
            match self.spec(one).specifier {
                Some(Specifier::Def) => return Specifier::Def,
                Some(Specifier::Class) => {
                    let direct = |node: NodeId| {
                        let node = self.graph.node(node);
                        node.kind == ArcKind::Inherits && !node.ancestral
                    };
                    if !self.graph.up(one.node).any(direct) {
                        return Specifier::Class;
                    }
                    inherited_class = true;
                }
                _ => {}
            }
        }
        if inherited_class {
            Specifier::Class
        } else {
            Specifier::Over
        }
    }

    /// Weak to strong: a mention adds a component, `without` removes it. In one spec the mention
    /// counts.
    fn present_components(&mut self) -> BTreeSet<usize> {
        let mut present = BTreeSet::new();
        let mut removals = Vec::new();
        for one in self.contributions.iter().rev() {
            let spec = self.spec(one);
            for &(index, place) in &spec.without {
                removals.push((place, present.remove(&index)));
            }
            present.extend(spec.components.iter().map(|component| component.index));
        }
        for (place, worked) in removals {
            *self.resolver.removals.entry(place).or_insert(false) |= worked;
        }
        present
    }

    /// Sorts all opinions by component and field, strongest first.
    fn gather(&mut self) -> BTreeMap<usize, Opinions> {
        let mut gathered: BTreeMap<usize, Opinions> = BTreeMap::new();
        let mut count = 0;
        for (contribution, one) in self.contributions.iter().enumerate() {
            let spec = self.spec(one);
            for (component, written) in spec.components.iter().enumerate() {
                let opinions = gathered.entry(written.index).or_insert_with(|| Opinions {
                    place: written.place,
                    fields: BTreeMap::new(),
                });
                for (field, found) in written.fields.iter().enumerate() {
                    count += 1;
                    let list = opinions.fields.entry(found.index).or_default();
                    list.push(FieldPlace {
                        contribution,
                        component,
                        field,
                    });
                }
            }
        }
        self.resolver.opinions += count;
        gathered
    }

    /// Describes the nodes that contribute and those that they hang on; gives also the position of
    /// each contribution's node among them.
    fn contributors(&self) -> (Vec<Contributor>, Vec<u32>) {
        let mut wanted: BTreeSet<NodeId> = BTreeSet::new();
        for one in self.contributions {
            wanted.extend(self.graph.up(one.node));
        }
        let order: Vec<NodeId> = self.graph.strong_to_weak();
        let order: Vec<NodeId> = order.into_iter().filter(|node| wanted.contains(node)).collect();
        let positions: BTreeMap<NodeId, u32> = order.iter().copied().zip(0..).collect();
        let list = order
            .iter()
            .map(|&node| {
                let found = self.graph.node(node);
                Contributor {
                    path: found.site.path,
                    arc: found.kind,
                    arc_place: found.place,
                    parent: self.graph.parent(node).map(|parent| positions[&parent]),
                    depth: found.depth,
                }
            })
            .collect();
        let numbers = self.contributions.iter().map(|one| positions[&one.node]).collect();
        (list, numbers)
    }

    fn component(&mut self, index: usize, opinions: Opinions, numbers: &[u32]) -> ComponentValue {
        let info = &self.library.schema.components()[index];
        let (name, type_id) = (info.name, info.type_id);
        let fields = opinions
            .fields
            .into_iter()
            .map(|(field, places)| {
                let schema = self.library.schema;
                let info = &schema.components()[index];
                self.field(name, &info.fields[field], &places, numbers)
            })
            .collect();
        ComponentValue {
            name,
            type_id,
            place: opinions.place,
            fields,
        }
    }

    pub(super) fn field_spec(&self, place: FieldPlace) -> &FieldSpec {
        let contribution = &self.contributions[place.contribution];
        &self.spec(contribution).components[place.component].fields[place.field]
    }

    fn field(&mut self, component: &str, field: &FieldInfo, places: &[FieldPlace], numbers: &[u32]) -> FieldValue {
        let opinions: Vec<Opinion> = places
            .iter()
            .map(|&place| Opinion {
                place: self.field_spec(place).place,
                contributor: numbers[place.contribution],
            })
            .collect();
        let place = opinions[0].place;
        let state = match field.kind {
            FieldKind::Value => self.value(places[0]),
            FieldKind::Target { .. } | FieldKind::Targets { .. } => {
                let targets = self.combine_targets(field.kind, places);
                self.relationship(component, field, targets, place)
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

    fn value(&mut self, strongest: FieldPlace) -> FieldState {
        let contribution = &self.contributions[strongest.contribution];
        let time = contribution.time;
        let spec = &self.library.layer(contribution.layer).specs[contribution.spec as usize];
        let spec = &spec.components[strongest.component].fields[strongest.field];
        let (state, trouble) = match &spec.opinion {
            FieldOpinion::Constant(value) => {
                self.resolver.opinions += list_length(&**value);
                let message = "values of this type cannot be copied; its component has to derive `Clone`";
                let copy = clone_value(&**value).map(FieldState::Constant);
                (copy, ("wrong-type", message))
            }
            FieldOpinion::Samples(samples) => {
                self.resolver.opinions += samples.len();
                let message = "the offsets and scales up to here leave no distinct times for these samples";
                let copy = clone_samples(samples, time).map(FieldState::Samples);
                (copy, ("bad-layer-offset", message))
            }
            FieldOpinion::Block | FieldOpinion::Targets(_) => return FieldState::Blocked,
        };
        let place = spec.place;
        state.unwrap_or_else(|| {
            let error = Diagnostic::error(trouble.0, trouble.1).at(place);
            self.library.report.push_once(error);
            FieldState::Blocked
        })
    }

    /// The variant in force in each set that has one, the strongest place's sets first, with all that
    /// could be chosen.
    fn variants(&self) -> Vec<VariantChoice> {
        let mut list: Vec<(Word, VariantChoice)> = Vec::new();
        let text = |word: Word| self.library.paths.word_text(word).to_owned();
        if self.graph.len() > 1 {
            for node in self.graph.strong_to_weak() {
                let Step::Variant { set, variant } = self.library.paths.step(self.graph.node(node).site.path) else {
                    continue;
                };
                if !list.iter().any(|(other, _)| *other == set) {
                    list.push((set, self.choice(set, Some(text(variant)))));
                }
            }
        }
        for one in self.contributions {
            let sets = self.spec(one).arcs.as_ref().map_or(&[][..], |arcs| &arcs.sets);
            for set in sets {
                if !list.iter().any(|(other, _)| *other == set.name) {
                    list.push((set.name, self.choice(set.name, None)));
                }
            }
        }
        list.into_iter().map(|(_, choice)| choice).collect()
    }

    fn choice(&self, set: Word, chosen: Option<String>) -> VariantChoice {
        let text = |word: Word| self.library.paths.word_text(word).to_owned();
        let variants = variants_of(self.library, self.graph, set);
        VariantChoice {
            set: text(set),
            chosen,
            variants: variants.into_iter().map(text).collect(),
        }
    }
}

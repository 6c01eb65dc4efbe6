//! Fields that point to prims: lists combined from all opinions, carried to the scene's namespace.

use super::graph::NodeId;
use super::list_edits::{Combined, EditTrouble};
use super::resolve::{FieldPlace, Resolving, TargetUse};
use crate::diagnostic::Diagnostic;
use crate::layer::{FieldOpinion, ListEdit, Spanned};
use crate::relation::{Target, Targets};
use crate::scene::FieldState;
use crate::schema::{FieldInfo, FieldKind};
use crate::source::Place;

/// A target on its way to the scene's namespace.
#[derive(Clone)]
struct CarriedTarget {
    /// None where the arcs leave it behind.
    image: Option<String>,
    written: Spanned<String>,
    node: NodeId,
}

impl Resolving<'_, '_, '_, '_> {
    /// Combines lists of targets, each item carried to the scene's namespace; none if blocked.
    pub(super) fn combine_targets(&mut self, kind: FieldKind, places: &[FieldPlace]) -> Option<Vec<Spanned<String>>> {
        let is_targets = |place: &&FieldPlace| matches!(self.field_spec(**place).opinion, FieldOpinion::Targets(_));
        // What is weaker than `Block` is hidden.
        let visible: Vec<FieldPlace> = places.iter().take_while(is_targets).copied().collect();
        if visible.is_empty() {
            return None;
        }
        let mut combined = Combined::default();
        for &place in visible.iter().rev() {
            let FieldOpinion::Targets(edit) = &self.field_spec(place).opinion else {
                continue;
            };
            let edit = edit.clone();
            self.library.work += edit.len() * 16;
            if self.library.is_exhausted() {
                break;
            }
            let edit = self.carry_targets(edit, place.contribution);
            let key = |item: &CarriedTarget| item.image.clone().ok_or(item.written.place);
            combined.add(&edit, key);
        }
        let is_list = matches!(kind, FieldKind::Targets { .. });
        for (place, trouble) in combined.troubles(|item| item.written.place) {
            // To point somewhere else is what a stronger opinion about one target is for.
            if !is_list && trouble == EditTrouble::Dropped {
                continue;
            }
            let name = self.library.sources.text(place).to_owned();
            self.library.report.push_once(trouble.warning(&name).at(place));
        }
        let mut list = Vec::with_capacity(combined.items.len());
        for item in combined.items {
            match item.image {
                Some(value) => list.push(Spanned {
                    value,
                    place: item.written.place,
                }),
                None => self.refuse_target(&item),
            }
        }
        Some(list)
    }

    fn carry_targets(&mut self, edit: ListEdit<Spanned<String>>, contribution: usize) -> ListEdit<CarriedTarget> {
        let node = self.contributions[contribution].node;
        let map = &self.graph.node(node).map_to_root;
        let paths = &mut self.library.paths;
        let mut carry = |item: &Spanned<String>| {
            let image = if node == NodeId::ROOT {
                Some(item.value.clone())
            } else {
                let path = paths.intern(&item.value);
                let image = map.to_target(path, paths);
                image.map(|image| paths.text(image))
            };
            CarriedTarget {
                image,
                written: item.clone(),
                node,
            }
        };
        match edit {
            ListEdit::Explicit(items) => ListEdit::Explicit(items.iter().map(carry).collect()),
            ListEdit::Edit {
                prepend,
                append,
                delete,
            } => ListEdit::Edit {
                prepend: prepend.iter().map(&mut carry).collect(),
                append: append.iter().map(&mut carry).collect(),
                // What has no image cannot be in the list.
                delete: delete.iter().map(carry).filter(|item| item.image.is_some()).collect(),
            },
        }
    }

    fn refuse_target(&mut self, target: &CarriedTarget) {
        let message = format!(
            "`{}` lies outside of what is brought here, so `{}` cannot point to it",
            target.written.value, self.owner
        );
        let mut error = Diagnostic::error("target-outside-reference", message).at(target.written.place);
        for above in self.graph.up(target.node) {
            let found = self.graph.node(above);
            if let Some(place) = found.place {
                let text = self.library.sources.text(place).to_owned();
                error = error.also(place, format!("brought by {} {text}", found.kind.word()));
            }
        }
        let error = error.note("move the target below the prim that is brought, or set it from the outside");
        self.library.report.push_once(error);
    }

    /// Makes the value of a relationship and remembers what has to exist.
    pub(super) fn relationship(
        &mut self,
        component: &str,
        field: &FieldInfo,
        targets: Option<Vec<Spanned<String>>>,
        place: Place,
    ) -> FieldState {
        let Some(targets) = targets else {
            return FieldState::Blocked;
        };
        if self.counts {
            self.resolver.targets.extend(targets.iter().map(|target| TargetUse {
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
                    let error = Diagnostic::error("wrong-type", message).at(place);
                    self.library.report.push_once(error);
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

//! Variants: which one is selected, looking through all that is composed so far.
//!
//! They are chosen in the tree of a prim of the scene alone, where everything is known that may select
//! them. For an arc to a prim below the top level, the sets of the prims above its target are chosen
//! from there too: the body `/A{set=variant}B` then hangs on the node of `/A/B`.

use super::graph::{ArcKind, Graph, NodeId, Site};
use super::indexer::{ArcOptions, Composer, Indexer, VariantTask, new_arc};
use super::mapping::PathMap;
use super::paths::{PathId, Step, Word};
use super::spec::Selection;
use crate::source::Place;

/// A variant, and where it is selected.
type Selected = (Word, Option<Place>);

impl Indexer<'_> {
    /// Adds the body of the variant that is selected in a set; without a selection none.
    pub(crate) fn choose_variant(&mut self, composer: &mut Composer<'_, '_, '_>, task: VariantTask) {
        let found = self.graph.node(task.node);
        if !found.contributes_at(task.owner, &composer.library.paths) {
            return;
        }
        let site = found.site;
        let Some((variant, place)) = self.selection(composer, task) else {
            return self.no_selection(task);
        };
        let step = Step::Variant { set: task.set, variant };
        let paths = &mut composer.library.paths;
        let chosen = paths.join(task.owner, step);
        let body = Site {
            path: paths.replace_prefix(site.path, task.owner, chosen),
            ..site
        };
        let depth = paths.depth(task.owner);
        let ancestral = task.owner != site.path;
        let options = ArcOptions {
            with_ancestors: ancestral,
            skip_duplicates: ancestral && self.is_in_new_class(composer, task.node),
            ..ArcOptions::default()
        };
        let map = PathMap::identity();
        let arc = new_arc(
            ArcKind::Variants,
            task.node,
            task.node,
            map,
            task.position,
            depth,
            place,
        );
        if self.add_arc(composer, body, &arc, options).is_some() {
            self.retry_variants();
        }
    }

    /// Whether a node is, or hangs on, a class that was written on the prim itself: no place may come
    /// twice through such a class.
    fn is_in_new_class(&self, composer: &Composer<'_, '_, '_>, node: NodeId) -> bool {
        self.graph.up(node).any(|above| {
            let found = self.graph.node(above);
            above != NodeId::ROOT
                && found.kind.is_class()
                && !found.inert
                && self.graph.depth_below_introduction(above, &composer.library.paths) == 0
        })
    }

    /// Finds the selection for a set: the first one, strong to weak, in the part of the tree where its
    /// prim has a path. A choice that was made is not made again.
    fn selection(&self, composer: &mut Composer<'_, '_, '_>, task: VariantTask) -> Option<Selected> {
        let graph = &self.graph;
        let paths = &mut composer.library.paths;
        let mut first = task.node;
        let mut path = paths.without_variants(task.owner);
        if let Some(above) = graph.node(first).map_to_root.to_target(path, paths) {
            (first, path) = (NodeId::ROOT, above);
        } else {
            while let Some(parent) = graph.parent(first)
                && let Some(above) = graph.node(first).map_to_parent.to_target(path, paths)
            {
                (first, path) = (parent, above);
            }
        }
        let chosen = search(composer, graph, first, path, &mut |composer, node, inside| {
            chosen_at(composer, graph, node, inside, task.set)
        });
        if chosen.is_some() {
            return chosen;
        }
        let found = search(composer, graph, first, path, &mut |composer, node, inside| {
            selected_at(composer, graph, node, inside, task.set)
        })?;
        Some((found.variant?, Some(found.place)))
    }
}

/// Walks a subtree, strong to weak, as far as the path of a prim has an image, until `find` finds.
fn search<T>(
    composer: &mut Composer<'_, '_, '_>,
    graph: &Graph,
    node: NodeId,
    path: PathId,
    find: &mut impl FnMut(&mut Composer<'_, '_, '_>, NodeId, PathId) -> Option<T>,
) -> Option<T> {
    composer.library.work += 1;
    if let Some(found) = find(composer, node, path) {
        return Some(found);
    }
    graph.node(node).children.iter().find_map(|&child| {
        let map = &graph.node(child).map_to_parent;
        let inside = map.to_source(path, &mut composer.library.paths)?;
        search(composer, graph, child, inside, find)
    })
}

/// Gives the choice that a node of a variant stands for, if it is one of the set and prim in question.
fn chosen_at(
    composer: &Composer<'_, '_, '_>,
    graph: &Graph,
    node: NodeId,
    path: PathId,
    set: Word,
) -> Option<Selected> {
    let found = graph.node(node);
    if found.kind != ArcKind::Variants {
        return None;
    }
    let paths = &composer.library.paths;
    let at = graph.path_at_introduction(node, paths);
    match paths.step(at) {
        Step::Variant { set: other, variant } if other == set && paths.without_last_variants(at) == path => {
            Some((variant, found.place))
        }
        _ => None,
    }
}

/// Gives the selection that the specs of one node make of a prim.
fn selected_at(
    composer: &mut Composer<'_, '_, '_>,
    graph: &Graph,
    node: NodeId,
    path: PathId,
    set: Word,
) -> Option<Selection> {
    let found = graph.node(node);
    let paths = &mut composer.library.paths;
    if !found.contributes_at(path, paths) {
        return None;
    }
    let path = if found.kind == ArcKind::Variants {
        let body = graph.path_at_introduction(node, paths);
        let prim = paths.without_variants(body);
        paths.replace_prefix(path, prim, body)
    } else {
        path
    };
    let mut specs = composer.library.specs(found.site.stack, path);
    specs.find_map(|(_, _, spec)| {
        let selections = &spec.arcs.as_ref()?.select;
        selections.iter().find(|one| one.set == set).copied()
    })
}

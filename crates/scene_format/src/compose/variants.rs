//! Variants: which one is selected, looking through all that is composed so far.

use super::graph::{ArcKind, Graph, NodeId, Site};
use super::indexer::{ArcOptions, Composer, Frame, Indexer, VariantTask, new_arc};
use super::mapping::PathMap;
use super::paths::{PathId, Step, Word};
use super::spec::Selection;
use crate::source::Place;

/// A variant, and where it is selected.
type Selected = (Word, Option<Place>);

/// A tree around the one in work, and the first node of the next tree within it.
struct Around<'g> {
    parent: NodeId,
    map: &'g PathMap,
    inner: &'g Graph,
}

impl Indexer<'_> {
    /// Adds the body of the variant that is selected in a set; without a selection none.
    pub(crate) fn choose_variant(&mut self, composer: &mut Composer<'_, '_, '_>, task: VariantTask) {
        let found = self.graph.node(task.node);
        if !found.contributes() {
            return;
        }
        let site = found.site;
        let Some((variant, place)) = self.selection(composer, task.node, task.set) else {
            return self.no_selection(task);
        };
        let step = Step::Variant { set: task.set, variant };
        let body = Site {
            path: composer.library.paths.join(site.path, step),
            ..site
        };
        let depth = composer.library.paths.depth(site.path);
        let arc = new_arc(
            ArcKind::Variants,
            task.node,
            task.node,
            PathMap::identity(),
            task.position,
            depth,
            place,
        );
        if self.add_arc(composer, body, &arc, ArcOptions::default()).is_some() {
            self.retry_variants();
        }
    }

    /// Finds the selection for a set of a node's prim: the first one, strong to weak, in the whole
    /// tree, those around it included. A choice that was made is not made again.
    fn selection(&self, composer: &mut Composer<'_, '_, '_>, node: NodeId, set: Word) -> Option<Selected> {
        let levels = self.options.ancestor_levels;
        let site = self.graph.node(node).site;
        let mut path = composer.library.paths.without_variants(site.path);
        let mut graph = &self.graph;
        // As far up as the path has a meaning.
        let mut first = node;
        if let Some(above) = graph
            .node(node)
            .map_to_root
            .to_target(path, &mut composer.library.paths)
        {
            path = above;
            first = NodeId::ROOT;
        }
        if first == NodeId::ROOT
            && let Some(chosen) = chosen_before(composer, graph, NodeId::ROOT, path, levels, set)
        {
            return Some(chosen);
        }
        let mut around = Vec::new();
        let mut frame: Option<&Frame<'_>> = self.frame;
        while let Some(found) = frame {
            let (outer, parent, map) = found.around();
            let paths = &mut composer.library.paths;
            let Some(outside) = map.to_target(path, paths) else {
                break;
            };
            let Some(outside) = outer.node(parent).map_to_root.to_target(outside, paths) else {
                break;
            };
            if let Some(chosen) = chosen_before(composer, outer, NodeId::ROOT, outside, levels, set) {
                return Some(chosen);
            }
            around.push(Around {
                parent,
                map,
                inner: graph,
            });
            graph = outer;
            path = outside;
            first = NodeId::ROOT;
            frame = found.previous();
        }
        let found = search(composer, graph, first, path, set, &mut around)?;
        Some((found.variant?, Some(found.place)))
    }
}

/// Looks for a node of a variant of the set and prim in question.
fn chosen_before(
    composer: &mut Composer<'_, '_, '_>,
    graph: &Graph,
    node: NodeId,
    path: PathId,
    levels: u16,
    set: Word,
) -> Option<Selected> {
    composer.work += 1;
    let found = graph.node(node);
    let paths = &mut composer.library.paths;
    if found.kind == ArcKind::Variants && graph.depth_below_introduction(node, paths) == levels {
        let at = graph.path_at_introduction(node, paths);
        if let Step::Variant { set: other, variant } = paths.step(at)
            && other == set
        {
            let inside = found.map_to_root.to_source(path, paths)?;
            if paths.without_last_variants(at) == inside {
                return Some((variant, found.place));
            }
        }
    }
    let children = found.children.iter();
    children
        .copied()
        .find_map(|child| chosen_before(composer, graph, child, path, levels, set))
}

/// Looks for a selection, strong to weak; where the tree within begins, goes on there.
fn search(
    composer: &mut Composer<'_, '_, '_>,
    graph: &Graph,
    node: NodeId,
    path: PathId,
    set: Word,
    around: &mut Vec<Around<'_>>,
) -> Option<Selection> {
    composer.work += 1;
    let found = graph.node(node);
    if found.contributes()
        && let Some(selection) = selected_at(composer, found.site, found.kind, path, set)
    {
        return Some(selection);
    }
    if around.last().is_some_and(|next| next.parent == node) {
        let next = around.pop()?;
        let inside = next.map.to_source(path, &mut composer.library.paths)?;
        return search(composer, next.inner, NodeId::ROOT, inside, set, around);
    }
    found.children.iter().find_map(|&child| {
        let map = &graph.node(child).map_to_parent;
        let inside = map.to_source(path, &mut composer.library.paths)?;
        search(composer, graph, child, inside, set, around)
    })
}

/// Gives the selection that the specs of one site make.
fn selected_at(
    composer: &mut Composer<'_, '_, '_>,
    site: Site,
    kind: ArcKind,
    path: PathId,
    set: Word,
) -> Option<Selection> {
    let paths = &mut composer.library.paths;
    let path = if kind == ArcKind::Variants {
        let prim = paths.without_variants(site.path);
        paths.replace_prefix(path, prim, site.path)
    } else {
        path
    };
    let mut specs = composer.library.specs(site.stack, path);
    specs.find_map(|(_, _, spec)| {
        let selections = &spec.arcs.as_ref()?.select;
        selections.iter().find(|one| one.set == set).copied()
    })
}

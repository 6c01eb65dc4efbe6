//! What can be wrong with a finished tree: arcs to prims that are not there, variants that nobody
//! has, classes that nobody wrote.

use super::graph::{ArcKind, Graph, NodeId};
use super::library::Library;
use super::paths::{PathId, Step, Word};
use crate::diagnostic::{Diagnostic, nearest};

/// Reports what is wrong with the arcs of a tree that were not there in the parent's.
pub(crate) fn check_graph(library: &mut Library<'_, '_>, graph: &Graph) {
    if graph.len() == 1 {
        return;
    }
    for node in graph.ids().filter(|&node| node != NodeId::ROOT) {
        let found = graph.node(node);
        match found.kind {
            ArcKind::References | ArcKind::Payloads if found.new => check_target(library, graph, node),
            ArcKind::Variants => check_variant(library, graph, node),
            ArcKind::Inherits | ArcKind::Specializes if !found.ancestral && found.origin == found.parent => {
                check_class(library, graph, node);
            }
            _ => {}
        }
    }
}

fn subtree(graph: &Graph, top: NodeId) -> Vec<NodeId> {
    let mut list = Vec::new();
    let mut waiting = vec![top];
    while let Some(node) = waiting.pop() {
        list.push(node);
        waiting.extend_from_slice(&graph.node(node).children);
    }
    list
}

fn check_target(library: &mut Library<'_, '_>, graph: &Graph, node: NodeId) {
    let found = graph.node(node);
    // Of an arc that was written above its node, what counts is whether the target is there.
    let above = graph.depth_below_introduction(node, &library.paths) > 0;
    let there = subtree(graph, node).into_iter().any(|below| {
        if !above {
            return graph.node(below).has_specs;
        }
        let path = graph.path_at_introduction(below, &library.paths);
        library.stack(graph.node(below).site.stack).has_specs(path)
    });
    if there {
        return;
    }
    let path = graph.path_at_introduction(node, &library.paths);
    let text = library.paths.text(path);
    let names = prims_beside(library, graph, node, path);
    let mut error = Diagnostic::error("missing-prim", format!("there is no prim `{text}` to bring"))
        .suggest(nearest(&text, names.iter().map(String::as_str)));
    if error.suggestion.is_none() && !names.is_empty() {
        error = error.note(format!("there are {}", names.join(", ")));
    }
    if let Some(place) = found.place {
        error = error.at(place);
    }
    library.report.push_once(error);
}

/// Lists some prims of the target's file that may have been meant.
fn prims_beside(library: &Library<'_, '_>, graph: &Graph, node: NodeId, path: PathId) -> Vec<String> {
    let stack = graph.node(node).site.stack;
    let mut parent = library.paths.parent(path);
    while !library.stack(stack).has_specs(parent) && parent != PathId::ROOT {
        parent = library.paths.parent(parent);
    }
    let prefix = match library.paths.text(parent) {
        text if text == "/" => String::new(),
        text => text,
    };
    let mut list: Vec<String> = Vec::new();
    for (_, _, spec) in library.specs(stack, parent) {
        for name in spec.children.iter().take(20) {
            let text = format!("{prefix}/{}", library.paths.word_text(*name));
            if !list.contains(&text) {
                list.push(text);
            }
        }
    }
    list.truncate(20);
    list
}

/// A variant has to have a body in at least one place.
fn check_variant(library: &mut Library<'_, '_>, graph: &Graph, node: NodeId) {
    let step = library.paths.step(graph.node(node).site.path);
    let Step::Variant { set, variant } = step else {
        return;
    };
    let same = |other: &NodeId| library.paths.step(graph.node(*other).site.path) == step;
    if graph.ids().filter(same).any(|other| graph.node(other).has_specs) {
        return;
    }
    let known: Vec<String> = variants_of(library, graph, set)
        .into_iter()
        .map(|word| library.paths.word_text(word).to_owned())
        .collect();
    let (set, variant) = (library.paths.word_text(set), library.paths.word_text(variant));
    let prim = library.paths.text(graph.root().site.path);
    let message = format!("the set `{set}` of `{prim}` has no variant `{variant}`");
    let mut error = Diagnostic::error("unknown-variant", message)
        .suggest(nearest(variant, known.iter().map(String::as_str)))
        .note(format!("variants of {set}: {}", known.join(", ")));
    if let Some(place) = graph.node(node).place {
        error = error.at(place);
    }
    library.report.push_once(error);
}

/// Lists the variants that the places in a tree have in a set.
pub(crate) fn variants_of(library: &Library<'_, '_>, graph: &Graph, set: Word) -> Vec<Word> {
    let mut list = Vec::new();
    for node in graph.strong_to_weak() {
        let found = graph.node(node);
        for (_, _, spec) in library.specs(found.site.stack, found.site.path) {
            let sets = spec.arcs.as_ref().map_or(&[][..], |arcs| &arcs.sets);
            for variant in sets.iter().filter(|one| one.name == set).flat_map(|one| &one.variants) {
                if !list.contains(variant) {
                    list.push(*variant);
                }
            }
        }
    }
    list
}

/// A class that no place has, here or implied, is most likely misspelt.
fn check_class(library: &mut Library<'_, '_>, graph: &Graph, node: NodeId) {
    // In huge trees the search would cost more than the warning is worth.
    if graph.node(node).has_specs || graph.len() > 4096 {
        return;
    }
    let of_it = |other: &NodeId| *other == node || graph.origin_root(*other).0 == node;
    let there = graph.ids().filter(of_it).any(|other| {
        subtree(graph, other)
            .into_iter()
            .any(|below| graph.node(below).has_specs)
    });
    if there {
        return;
    }
    let found = graph.node(node);
    let text = library.paths.text(found.site.path);
    let names = prims_beside(library, graph, node, found.site.path);
    let mut warning = Diagnostic::warning(
        "unknown-class",
        format!("there is no prim `{text}` to take anything from"),
    )
    .suggest(nearest(&text, names.iter().map(String::as_str)));
    if let Some(place) = found.place {
        warning = warning.at(place);
    }
    library.report.push_once(warning);
}

/// Prims nested too deep, through arcs, are refused.
pub(crate) fn refuse_children(library: &mut Library<'_, '_>, graph: &Graph) {
    let names = super::children::child_names(library, graph);
    if names.is_empty() {
        return;
    }
    let message = format!(
        "prims are nested more than {} deep",
        library.limits.prim_depth.min(crate::options::DEEPEST)
    );
    let place = graph.strong_to_weak().into_iter().find_map(|node| {
        let site = graph.node(node).site;
        library.specs(site.stack, site.path).find_map(|(_, _, spec)| spec.place)
    });
    let error = Diagnostic::error("too-deep", message);
    library.report.push_once(match place {
        Some(place) => error.at(place),
        None => error,
    });
}

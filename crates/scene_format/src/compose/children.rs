//! The children of a prim, and their order.

use std::collections::{HashMap, HashSet};

use super::graph::{Graph, NodeId};
use super::library::Library;
use super::paths::Word;
use crate::diagnostic::Diagnostic;
use crate::source::Place;

/// Lists the children that the places in a tree name.
///
/// Weak to strong, each layer appends the names that are new and then applies its `order`.
pub(crate) fn child_names(library: &mut Library<'_, '_>, graph: &Graph) -> Vec<Word> {
    let mut names = Vec::new();
    let mut seen = HashSet::new();
    let mut idle: Vec<(Word, Place)> = Vec::new();
    let mut weak_to_strong = Vec::new();
    list_weak_to_strong(graph, NodeId::ROOT, &mut weak_to_strong);
    for node in weak_to_strong {
        let found = graph.node(node);
        if !(found.has_specs && found.contributes()) {
            continue;
        }
        let specs: Vec<_> = library.specs(found.site.stack, found.site.path).collect();
        let mut met = 0;
        for (_, _, spec) in specs.into_iter().rev() {
            met += 1 + spec.children.len() + 2 * spec.order.len();
            names.extend(spec.children.iter().copied().filter(|&name| seen.insert(name)));
            if !spec.order.is_empty() {
                met += names.len();
                idle.extend(reorder(&mut names, &spec.order));
            }
        }
        library.work += met;
        if library.is_exhausted() {
            break;
        }
    }
    for (name, place) in idle {
        if !seen.contains(&name) {
            let message = format!("`order` names `{}`, which is not here", library.paths.word_text(name));
            let warning = Diagnostic::warning("order-without-effect", message);
            library.report.push_once(warning.at(place));
        }
    }
    names
}

/// Lists a subtree weak to strong: children from the last to the first, then the node.
fn list_weak_to_strong(graph: &Graph, node: NodeId, list: &mut Vec<NodeId>) {
    for &child in graph.node(node).children.iter().rev() {
        list_weak_to_strong(graph, child, list);
    }
    list.push(node);
}

/// Moves the named prims, each with the unnamed ones that follow it, into the order given; unnamed
/// ones at the front stay there. Gives the names that are not in the list.
fn reorder(names: &mut Vec<Word>, order: &[(Word, Place)]) -> Vec<(Word, Place)> {
    let mut rank = HashMap::new();
    for (position, &(name, _)) in order.iter().enumerate() {
        rank.entry(name).or_insert(position);
    }
    let mut front = Vec::new();
    let mut blocks: Vec<(usize, Vec<Word>)> = Vec::new();
    let mut met = HashSet::new();
    for &name in names.iter() {
        match (rank.get(&name), blocks.last_mut()) {
            (Some(&position), _) => {
                met.insert(name);
                blocks.push((position, vec![name]));
            }
            (None, Some((_, block))) => block.push(name),
            (None, None) => front.push(name),
        }
    }
    blocks.sort_by_key(|(position, _)| *position);
    front.extend(blocks.into_iter().flat_map(|(_, block)| block));
    *names = front;
    order.iter().copied().filter(|(name, _)| !met.contains(name)).collect()
}

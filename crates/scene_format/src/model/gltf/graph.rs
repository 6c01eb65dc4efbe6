//! The node hierarchy: a forest, or an error.

use super::super::error::Fault;
use super::json::Root;

/// Gives the roots of the scene to show: the default one, else the first, else all nodes without a parent.
///
/// # Errors
///
/// For an index out of range, a node with two parents, a loop, a scene that names a node which is not a root.
pub(super) fn scene_roots(root: &Root) -> Result<Vec<u32>, Fault> {
    let parents = find_parents(root)?;
    refuse_loops(&parents)?;
    for (number, scene) in root.scenes.iter().enumerate() {
        let mut named: Vec<u32> = Vec::new();
        for (slot, node) in scene.nodes.iter().enumerate() {
            let at = || format!("scenes[{number}].nodes[{slot}]");
            match parents.get(*node as usize) {
                None => return Err(no_such(&at(), "node", *node, root.nodes.len())),
                Some(Some(parent)) => {
                    let message = format!("node {node} is a child of node {parent}, so no root of a scene");
                    return Err(Fault::invalid(&at(), message));
                }
                Some(None) => named.push(*node),
            }
        }
        named.sort_unstable();
        if let Some(pair) = named.windows(2).find(|pair| pair[0] == pair[1]) {
            let at = format!("scenes[{number}].nodes");
            return Err(Fault::invalid(&at, format!("node {} is named twice", pair[0])));
        }
    }
    let shown = root.scene.unwrap_or(0) as usize;
    match root.scenes.get(shown) {
        Some(scene) => Ok(scene.nodes.clone()),
        None if root.scene.is_some() => Err(no_such("scene", "scene", shown as u32, root.scenes.len())),
        None => Ok((0..)
            .zip(&parents)
            .filter(|(_, parent)| parent.is_none())
            .map(|(node, _)| node)
            .collect()),
    }
}

/// Says that an index points nowhere.
pub(super) fn no_such(at: &str, what: &str, index: u32, count: usize) -> Fault {
    Fault::invalid(at, format!("there is no {what} {index}, the file has {count}"))
}

fn find_parents(root: &Root) -> Result<Vec<Option<u32>>, Fault> {
    let mut parents = vec![None; root.nodes.len()];
    for (number, node) in (0_u32..).zip(&root.nodes) {
        for (slot, child) in node.children.iter().enumerate() {
            let at = || format!("nodes[{number}].children[{slot}]");
            match parents.get_mut(*child as usize) {
                None => return Err(no_such(&at(), "node", *child, root.nodes.len())),
                Some(Some(other)) => {
                    let message = format!("node {child} is a child of node {other} already");
                    return Err(Fault::invalid(&at(), message).remedy("give each parent a node of its own"));
                }
                Some(free) => *free = Some(number),
            }
        }
    }
    Ok(parents)
}

/// Each node has one parent at most, so a loop is a chain of parents that does not end.
fn refuse_loops(parents: &[Option<u32>]) -> Result<(), Fault> {
    /// On the chain that is followed, or known to end.
    #[derive(Clone, Copy, PartialEq)]
    enum Seen {
        No,
        Now,
        Ends,
    }
    let mut seen = vec![Seen::No; parents.len()];
    let mut chain: Vec<usize> = Vec::new();
    for start in 0..parents.len() {
        let mut at = Some(start);
        while let Some(node) = at {
            match seen[node] {
                Seen::Ends => break,
                Seen::Now => {
                    let message = "the node is its own ancestor";
                    return Err(Fault::invalid(&format!("nodes[{node}]"), message).remedy("break the loop of children"));
                }
                Seen::No => {}
            }
            seen[node] = Seen::Now;
            chain.push(node);
            at = parents[node].map(|parent| parent as usize);
        }
        for node in chain.drain(..) {
            seen[node] = Seen::Ends;
        }
    }
    Ok(())
}

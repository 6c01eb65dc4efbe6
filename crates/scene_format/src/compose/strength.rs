//! Which of two nodes is stronger.
//!
//! The order is that of `OpenUSD`'s strength ordering; for the ties among bases, which are moved below
//! the first node, see `bases.rs`.

use std::cmp::Ordering;

use super::graph::{ArcKind, Graph, NodeId};
use super::paths::PathTable;

impl Graph {
    /// Whether `a` comes before its sibling `b`.
    pub(crate) fn is_stronger(&self, a: NodeId, b: NodeId, paths: &PathTable) -> bool {
        self.compare_siblings(a, b, paths) == Ordering::Less
    }

    /// Compares siblings: `Less` is stronger.
    fn compare_siblings(&self, a: NodeId, b: NodeId, paths: &PathTable) -> Ordering {
        let (first, second) = (self.node(a), self.node(b));
        first.kind.cmp(&second.kind).then_with(|| {
            if first.kind == ArcKind::Specializes {
                return self.compare_bases(a, b, paths);
            }
            // An arc written deeper in the namespace, on the prim rather than above it, is stronger.
            let by_depth = second.depth.cmp(&first.depth);
            by_depth
                .then_with(|| self.compare_origins(first.origin, second.origin))
                .then(first.position.cmp(&second.position))
        })
    }

    /// Compares by which node the whole tree lists first.
    fn compare_origins(&self, a: NodeId, b: NodeId) -> Ordering {
        if a == b {
            return Ordering::Equal;
        }
        self.compare_in_tree(a, b)
    }

    /// Compares by the order of the tree: a parent before its children, siblings as they stand.
    pub(crate) fn compare_in_tree(&self, a: NodeId, b: NodeId) -> Ordering {
        if a == b {
            return Ordering::Equal;
        }
        let way = |node: NodeId| -> Vec<NodeId> {
            let mut way: Vec<NodeId> = self.up(node).collect();
            way.reverse();
            way
        };
        let (to_a, to_b) = (way(a), way(b));
        let fork = to_a.iter().zip(&to_b).take_while(|(a, b)| a == b).count();
        match (to_a.get(fork), to_b.get(fork)) {
            (Some(a), Some(b)) => {
                let siblings = &self.node(to_a[fork - 1]).children;
                let position = |node: &NodeId| siblings.iter().position(|other| other == node);
                position(a).cmp(&position(b))
            }
            (None, _) => Ordering::Less,
            (_, None) => Ordering::Greater,
        }
    }

    fn compare_bases(&self, a: NodeId, b: NodeId, paths: &PathTable) -> Ordering {
        let (first, second) = (self.node(a), self.node(b));
        let ((root_a, steps_a), (root_b, steps_b)) = (self.origin_root(a), self.origin_root(b));
        // A base of a base is weaker, however deep it was written.
        let nested = self.came_through(root_a, root_b) || self.came_through(root_b, root_a);
        if !nested && first.depth != second.depth {
            return second.depth.cmp(&first.depth);
        }
        let written = |node: NodeId| self.node(node).origin == self.node(node).parent;
        // The copy in the outer place is stronger than the one that was moved as it is.
        let implied = |node: NodeId| self.node(node).site != self.node(self.node(node).origin).site;
        if first.origin == second.origin {
            let by_copy = if written(a) || written(b) {
                Ordering::Equal
            } else {
                implied(b).cmp(&implied(a))
            };
            return by_copy.then(first.position.cmp(&second.position));
        }
        if root_a != root_b {
            return self.compare_in_tree(root_a, root_b);
        }
        let instance_depth = |node: NodeId| {
            if written(node) {
                return 0;
            }
            let (instance, _) = self.start_of_class_hierarchy(self.node(node).origin, paths);
            self.node(instance).depth
        };
        let in_scene = |node: NodeId| self.node(node).site.stack == self.root().site.stack;
        instance_depth(a)
            .cmp(&instance_depth(b))
            // Implied further up is more local.
            .then(steps_b.cmp(&steps_a))
            .then_with(|| {
                if in_scene(a) && in_scene(b) && !written(a) && !written(b) {
                    implied(b).cmp(&implied(a))
                } else {
                    Ordering::Equal
                }
            })
            .then_with(|| self.compare_in_tree(first.origin, second.origin))
            .then(first.position.cmp(&second.position))
    }
}

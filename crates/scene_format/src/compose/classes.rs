//! Implied classes: a class that a referenced prim inherits is looked up in every place on the way
//! up, so that the outside can overrule it.

use super::graph::{NewArc, NodeId};
use super::indexer::{Composer, Indexer};
use super::mapping::PathMap;
use std::rc::Rc;

impl Indexer<'_> {
    /// Implies the classes of a node at its parent.
    pub(crate) fn imply_classes(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId) {
        let Some(parent) = self.graph.parent(node) else {
            return;
        };
        if !self.graph.has_class(node) {
            return;
        }
        let transfer = self.graph.node(node).map_to_parent.keeping_others();
        self.imply_tree(composer, parent, node, &transfer, true);
    }

    /// Implies the class children of `source` at `target`, and theirs below them.
    ///
    /// - `transfer`: carries paths from `source` to `target`.
    /// - `is_start`: `source` itself is not implied, only what is below it.
    fn imply_tree(
        &mut self,
        composer: &mut Composer<'_, '_, '_>,
        target: NodeId,
        source: NodeId,
        transfer: &PathMap,
        is_start: bool,
    ) {
        let holder = self.graph.moved_base_of(source).unwrap_or(source);
        for child in self.graph.node(holder).children.clone() {
            if !self.graph.node(child).kind.is_class() {
                continue;
            }
            let paths = &composer.library.paths;
            // Not the next class of a chain that leads through `source`: that hangs on it anyway.
            let continues = is_start
                && self.graph.node(source).kind.is_class()
                && self.graph.depth_below_introduction(source, paths)
                    == self.graph.depth_below_introduction(child, paths);
            if continues {
                continue;
            }
            let map = implied_map(composer, transfer, &self.graph.node(child).map_to_parent);
            let siblings = &self.graph.node(target).children;
            let known = siblings.iter().copied().find(|&sibling| {
                let sibling = self.graph.node(sibling);
                sibling.origin == child && *sibling.map_to_parent == map
            });
            let class = known.or_else(|| {
                // The composed map may still map what its parts, one after the other, do not.
                let site = self.graph.node(target).site;
                let paths = &mut composer.library.paths;
                let inside = paths.without_variants(site.path);
                let inside = transfer.to_source(inside, paths)?;
                let inside = self.graph.node(child).map_to_parent.to_source(inside, paths)?;
                transfer.to_target(inside, paths)?;
                let found = self.graph.node(child);
                let arc = NewArc {
                    kind: found.kind,
                    parent: target,
                    origin: child,
                    map: Rc::new(map.clone()),
                    position: found.position,
                    depth: composer.library.paths.depth(self.graph.node(target).site.path),
                    place: found.place,
                };
                let source = found.site;
                self.add_class(composer, &arc, Some(source))
            });
            if let Some(class) = class
                && self.graph.has_class(child)
            {
                let class = self.graph.moved_base_of(class).unwrap_or(class);
                let paths = &mut composer.library.paths;
                let up = transfer.after(&self.graph.node(child).map_to_parent, paths);
                let transfer = map.inverse().after(&up, paths);
                self.imply_tree(composer, class, child, &transfer, false);
            }
        }
    }
}

/// Carries a class arc along with the two namespaces that it connects.
fn implied_map(composer: &mut Composer<'_, '_, '_>, transfer: &PathMap, class: &PathMap) -> PathMap {
    if *transfer == PathMap::identity() {
        return class.clone();
    }
    let paths = &mut composer.library.paths;
    let inner = class.after(&transfer.inverse(), paths);
    transfer.after(&inner, paths).keeping_others()
}

//! Specializes: bases are weaker than everything else, so they are moved below the first node,
//! behind all its arcs, wherever they were written.
//!
//! When a base that was moved brings new arcs, they are first taken back to where it came from, so
//! that classes are implied as everywhere else, and moved again from there.

use std::rc::Rc;

use super::graph::{ArcKind, NewArc, NodeId};
use super::indexer::{ArcOptions, Composer, Indexer};
use super::mapping::PathMap;

impl Indexer<'_> {
    /// Moves the bases at or below a node to the first node; or takes what hangs on a base that was
    /// moved back to its origin.
    pub(crate) fn imply_bases(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId) {
        if node == NodeId::ROOT {
            return;
        }
        if self.graph.is_moved_base(node) {
            let origin = self.graph.node(node).origin;
            for child in self.graph.node(node).children.clone() {
                let map = Rc::clone(&self.graph.node(child).map_to_parent);
                self.take_back(composer, origin, child, map, node);
            }
        } else {
            self.move_bases(composer, node);
        }
    }

    fn move_bases(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId) {
        if self.graph.node(node).kind == ArcKind::Specializes {
            self.graph.node_mut(node).inert = false;
            let map = Rc::clone(&self.graph.node(node).map_to_root);
            self.move_to_root(composer, NodeId::ROOT, node, map, node);
        }
        for child in self.graph.node(node).children.clone() {
            self.move_bases(composer, child);
        }
    }

    fn move_to_root(
        &mut self,
        composer: &mut Composer<'_, '_, '_>,
        parent: NodeId,
        source: NodeId,
        map: Rc<PathMap>,
        top: NodeId,
    ) {
        let options = ArcOptions {
            skip_implied_bases: true,
            ..ArcOptions::default()
        };
        let Some(new) = self.copy_node(composer, parent, source, map, top, options) else {
            return;
        };
        for child in self.graph.node(source).children.clone() {
            if self.graph.node(child).kind != ArcKind::Specializes {
                let map = Rc::clone(&self.graph.node(child).map_to_parent);
                self.move_to_root(composer, new, child, map, top);
            }
        }
    }

    fn take_back(
        &mut self,
        composer: &mut Composer<'_, '_, '_>,
        parent: NodeId,
        source: NodeId,
        map: Rc<PathMap>,
        top: NodeId,
    ) {
        let options = ArcOptions {
            skip_written_arcs: true,
            ..ArcOptions::default()
        };
        let Some(new) = self.copy_node(composer, parent, source, map, top, options) else {
            return;
        };
        for child in self.graph.node(source).children.clone() {
            let map = Rc::clone(&self.graph.node(child).map_to_parent);
            self.take_back(composer, new, child, map, top);
        }
    }

    /// Makes a node below `parent` that takes over the opinions of `source`, which becomes inert.
    ///
    /// - `top`: the first node of the subtree that is copied.
    fn copy_node(
        &mut self,
        composer: &mut Composer<'_, '_, '_>,
        parent: NodeId,
        source: NodeId,
        map: Rc<PathMap>,
        top: NodeId,
        mut options: ArcOptions,
    ) -> Option<NodeId> {
        if self.graph.node(source).parent == parent {
            return Some(source);
        }
        let site = self.graph.node(source).site;
        let children = &self.graph.node(parent).children;
        let known = children
            .iter()
            .copied()
            .find(|&child| self.graph.node(child).site == site);
        let new = known.or_else(|| {
            let implied = self.graph.is_implied(source);
            // Of implied classes within the subtree others will be made from the copies.
            if implied && self.graph.is_below(self.graph.node(source).origin, top) {
                return None;
            }
            let found = self.graph.node(source);
            let arc = NewArc {
                kind: found.kind,
                parent,
                origin: if source == top || implied { source } else { parent },
                map,
                position: found.position,
                depth: if source == top {
                    composer.library.paths.depth(self.graph.node(parent).site.path)
                } else {
                    found.depth
                },
                place: found.place,
            };
            options.inert = found.inert;
            self.add_arc(composer, site, &arc, options)
        });
        match new {
            Some(new) => {
                let inert = self.graph.node(source).inert;
                self.graph.node_mut(new).inert = inert;
                self.graph.node_mut(source).inert = true;
            }
            None => self.graph.make_inert(source),
        }
        new
    }
}

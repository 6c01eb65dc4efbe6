//! Specializes: bases are weaker than everything else, so they hang below the first node, behind all
//! its arcs, wherever they were written.
//!
//! Where the arc is written a placeholder without opinions and children stays. It says through which
//! places the base came: strength and implied classes are reckoned from there. What a base brings,
//! classes and bases among them, hangs on the base that was moved.

use std::rc::Rc;

use super::graph::{ArcKind, NewArc, NodeId, Site};
use super::indexer::{ArcOptions, Composer, Indexer};

impl Indexer<'_> {
    /// Adds a placeholder for a base, and the base itself below the first node; gives the latter. In
    /// a tree within another it is moved when that tree is complete.
    pub(crate) fn add_base(&mut self, composer: &mut Composer<'_, '_, '_>, site: Site, arc: &NewArc) -> Option<NodeId> {
        let options = ArcOptions {
            inert: true,
            without_tasks: true,
            ..ArcOptions::default()
        };
        let placeholder = self.add_arc(composer, site, arc, options)?;
        if self.frame.is_some() {
            return Some(placeholder);
        }
        let Some(base) = self.move_base(composer, placeholder) else {
            return Some(placeholder);
        };
        if self.graph.node(base).origin != placeholder {
            // It was there before. Its classes have to be implied from this place too.
            self.imply_class_later(composer, placeholder);
        }
        Some(base)
    }

    /// Moves the bases of a subtree, which was made as a tree of its own, below the first node.
    pub(crate) fn move_bases(&mut self, composer: &mut Composer<'_, '_, '_>, top: NodeId) {
        let mut waiting = vec![top];
        while let Some(node) = waiting.pop() {
            if self.graph.node(node).kind == ArcKind::Specializes && self.graph.parent(node) != Some(NodeId::ROOT) {
                self.move_base(composer, node);
            }
            waiting.extend(self.graph.node(node).children.iter().rev());
        }
    }

    /// Adds the base of a placeholder below the first node, unless its place is there already.
    fn move_base(&mut self, composer: &mut Composer<'_, '_, '_>, placeholder: NodeId) -> Option<NodeId> {
        let found = self.graph.node(placeholder);
        let site = found.site;
        let mut children = self.graph.root().children.iter().copied();
        if let Some(known) = children.find(|&child| self.graph.node(child).site == site) {
            return Some(known);
        }
        let arc = NewArc {
            kind: found.kind,
            parent: NodeId::ROOT,
            origin: placeholder,
            map: Rc::clone(&found.map_to_root),
            position: found.position,
            depth: composer.library.paths.depth(self.graph.root().site.path),
            place: found.place,
        };
        let ancestral = found.ancestral;
        let options = ArcOptions {
            skip_duplicates: true,
            with_ancestors: !composer.library.paths.is_top_level_prim(site.path),
            ..ArcOptions::default()
        };
        let base = self.add_arc(composer, site, &arc, options)?;
        self.graph.node_mut(base).ancestral = ancestral;
        Some(base)
    }
}

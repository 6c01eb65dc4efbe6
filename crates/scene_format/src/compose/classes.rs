//! Implied classes: a class that a referenced prim inherits is looked up in every place on the way
//! up, so that the outside can overrule it.

use std::rc::Rc;

use super::graph::{NewArc, NodeId};
use super::indexer::{Composer, Indexer};
use super::mapping::PathMap;
use super::paths::{PathId, PathTable};

/// Classes within classes up to here are carried exactly; each doubles what has to be asked.
const MOST_EXACT: usize = 8;

/// Carries paths from the place of a class to the place where the class is implied.
struct Transfer {
    /// Over the arc between the two places; below a class, over what leads from one class to the other.
    map: PathMap,
    /// The arc alone.
    arc: Rc<PathMap>,
    /// Arcs of the classes that lead to this place, the first one first.
    classes: Vec<Rc<PathMap>>,
}

impl Transfer {
    /// Tells whether a path can be carried, by the first `count` classes and over the arc.
    ///
    /// The way is: over a class to its instance, over the arc, and back over the implied class. Maps that
    /// are composed into one may forget that a step on such a way is not possible.
    fn reaches(&self, path: PathId, count: usize, paths: &mut PathTable) -> bool {
        let Some(last) = count.checked_sub(1) else {
            return self.arc.to_target(path, paths).is_some();
        };
        if !self.reaches(path, last, paths) {
            return false;
        }
        let instance = self.classes[last].to_target(path, paths);
        instance.is_some_and(|instance| self.reaches(instance, last, paths))
    }

    /// Whether an implied class has a place where it is implied.
    fn implies(&self, target: PathId, class: &PathMap, paths: &mut PathTable) -> bool {
        let count = self.classes.len().min(MOST_EXACT);
        let plain = paths.without_variants(target);
        let Some(instance) = self.arc.to_source(plain, paths) else {
            return false;
        };
        let inside = class.to_source(instance, paths);
        self.reaches(instance, count, paths) && inside.is_some_and(|inside| self.reaches(inside, count, paths))
    }
}

impl Indexer<'_> {
    /// Implies the classes of a node at its parent.
    pub(crate) fn imply_classes(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId) {
        let Some(parent) = self.graph.parent(node) else {
            return;
        };
        if !self.graph.has_class(node) {
            return;
        }
        let map = self.graph.node(node).map_to_parent.keeping_others();
        let transfer = Transfer {
            arc: Rc::new(map.clone()),
            map,
            classes: Vec::new(),
        };
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
        transfer: &Transfer,
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
            let map = implied_map(composer, &transfer.map, &self.graph.node(child).map_to_parent);
            let siblings = &self.graph.node(target).children;
            // A base that was moved from there stands in for the placeholder, not for what it implies.
            let known = siblings.iter().copied().find(|&sibling| {
                let found = self.graph.node(sibling);
                found.origin == child && *found.map_to_parent == map && !self.graph.is_moved_base(sibling)
            });
            let class = known.or_else(|| {
                let class = &self.graph.node(child).map_to_parent;
                let path = self.graph.node(target).site.path;
                if !transfer.implies(path, class, &mut composer.library.paths) {
                    return None;
                }
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
                let class_map = Rc::clone(&self.graph.node(child).map_to_parent);
                let up = transfer.map.after(&class_map, paths);
                let mut classes = transfer.classes.clone();
                classes.push(class_map);
                let transfer = Transfer {
                    map: map.inverse().after(&up, paths),
                    arc: Rc::clone(&transfer.arc),
                    classes,
                };
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

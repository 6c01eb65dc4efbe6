//! The places that may say something about one prim, as a tree of arcs.

use std::rc::Rc;

use super::library::{Library, StackId};
use super::mapping::PathMap;
use super::paths::{PathId, PathTable, Step, Word};
use crate::source::Place;

/// Kinds of arcs, in the order of their strength.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ArcKind {
    /// What a layer stack says of the prim itself; every tree begins with it.
    Local,
    /// From a class, which the outside may overrule.
    Inherits,
    /// From the body of the variant that is chosen.
    Variants,
    /// From a prim in another file, or elsewhere in this one.
    References,
    /// Like a reference, but may be left out.
    Payloads,
    /// From a base that everything else overrules.
    Specializes,
}

impl ArcKind {
    /// The keyword that writes it; `local` for the prim's own opinions.
    pub fn word(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Inherits => "inherits",
            Self::Variants => "variants",
            Self::References => "references",
            Self::Payloads => "payloads",
            Self::Specializes => "specializes",
        }
    }

    /// Whether it is a class that may be implied at the places on the way up.
    pub(crate) fn is_class(self) -> bool {
        matches!(self, Self::Inherits | Self::Specializes)
    }
}

/// A layer stack and a path in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Site {
    pub(crate) stack: StackId,
    pub(crate) path: PathId,
}

/// Position of a node in its graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct NodeId(pub(crate) u32);

impl NodeId {
    pub(crate) const ROOT: Self = Self(0);
}

/// What is known of an arc before its node is there.
#[derive(Clone, Debug)]
pub(crate) struct NewArc {
    pub(crate) kind: ArcKind,
    pub(crate) parent: NodeId,
    /// The parent for an arc that is written there; for an implied one the node that implies it.
    pub(crate) origin: NodeId,
    pub(crate) map: Rc<PathMap>,
    /// Position in the list at the origin.
    pub(crate) position: u32,
    /// Names in the path of the prim that the arc was written on.
    pub(crate) depth: u16,
    /// Where it is written.
    pub(crate) place: Option<Place>,
}

/// A place that may say something, and the arc that brought it.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) site: Site,
    pub(crate) kind: ArcKind,
    pub(crate) parent: NodeId,
    pub(crate) origin: NodeId,
    pub(crate) map_to_parent: Rc<PathMap>,
    pub(crate) map_to_root: Rc<PathMap>,
    pub(crate) position: u32,
    pub(crate) depth: u16,
    pub(crate) place: Option<Place>,
    /// Its opinions do not count; it is there for what hangs on it.
    pub(crate) inert: bool,
    /// Steps of the shallowest path of this place that may not say anything; 0 if all may. Above it,
    /// the place may still select variants.
    pub(crate) restricted: u16,
    /// Nothing at or below it says anything.
    pub(crate) culled: bool,
    pub(crate) has_specs: bool,
    /// The arc was written on an ancestor of the prim.
    pub(crate) ancestral: bool,
    /// It is not in the tree of the parent.
    pub(crate) new: bool,
    /// Strong to weak.
    pub(crate) children: Vec<NodeId>,
}

impl Node {
    /// Whether its opinions count, if it has any.
    pub(crate) fn contributes(&self) -> bool {
        !self.inert && !self.culled
    }

    /// Whether the place may say something at a path that is its own or begins it.
    pub(crate) fn contributes_at(&self, path: PathId, paths: &PathTable) -> bool {
        self.restricted == 0 || self.restricted > paths.steps(path)
    }
}

/// The tree of one prim; the first node is the prim itself in the scene's layer stack, or in that of
/// an arc's target while the target's tree is built.
#[derive(Clone, Debug)]
pub(crate) struct Graph {
    nodes: Vec<Node>,
}

impl Graph {
    pub(crate) fn new(site: Site, library: &Library<'_, '_>) -> Self {
        let identity = Rc::new(PathMap::identity());
        Self {
            nodes: vec![Node {
                site,
                kind: ArcKind::Local,
                parent: NodeId::ROOT,
                origin: NodeId::ROOT,
                map_to_parent: Rc::clone(&identity),
                map_to_root: identity,
                position: 0,
                depth: 0,
                place: None,
                inert: false,
                restricted: 0,
                culled: false,
                has_specs: library.stack(site.stack).has_specs(site.path),
                ancestral: false,
                new: true,
                children: Vec::new(),
            }],
        }
    }

    pub(crate) fn node(&self, node: NodeId) -> &Node {
        &self.nodes[node.0 as usize]
    }

    pub(crate) fn node_mut(&mut self, node: NodeId) -> &mut Node {
        &mut self.nodes[node.0 as usize]
    }

    pub(crate) fn root(&self) -> &Node {
        &self.nodes[0]
    }

    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn ids(&self) -> impl Iterator<Item = NodeId> + use<> {
        (0..self.nodes.len() as u32).map(NodeId)
    }

    /// Gives the parent; none of the first node.
    pub(crate) fn parent(&self, node: NodeId) -> Option<NodeId> {
        (node != NodeId::ROOT).then(|| self.node(node).parent)
    }

    /// Lists a node and those above it, ending with the first.
    pub(crate) fn up(&self, node: NodeId) -> impl Iterator<Item = NodeId> {
        std::iter::successors(Some(node), |&node| self.parent(node))
    }

    /// Gives the node itself; of a base that was moved, the placeholder where its arc is.
    fn written_at(&self, node: NodeId) -> NodeId {
        if self.is_moved_base(node) {
            self.node(node).origin
        } else {
            node
        }
    }

    /// Lists a node and those that it came through: like [`Self::up`], but from a base that was
    /// moved on to where its arc is.
    pub(crate) fn up_as_written(&self, node: NodeId) -> impl Iterator<Item = NodeId> {
        std::iter::successors(Some(node), |&node| {
            if self.is_moved_base(node) {
                Some(self.node(node).origin)
            } else {
                self.parent(node)
            }
        })
    }

    /// Whether `node` is `top` or came through it.
    pub(crate) fn came_through(&self, node: NodeId, top: NodeId) -> bool {
        self.up_as_written(node).any(|above| above == top)
    }

    /// Lists all nodes, strong to weak.
    pub(crate) fn strong_to_weak(&self) -> Vec<NodeId> {
        let mut list = Vec::with_capacity(self.nodes.len());
        let mut waiting = vec![NodeId::ROOT];
        while let Some(node) = waiting.pop() {
            list.push(node);
            waiting.extend(self.node(node).children.iter().rev());
        }
        list
    }

    /// Counts the names between the prim and the one that the arc was written on.
    pub(crate) fn depth_below_introduction(&self, node: NodeId, paths: &PathTable) -> u16 {
        let Some(parent) = self.parent(node) else {
            return 0;
        };
        paths
            .depth(self.node(parent).site.path)
            .saturating_sub(self.node(node).depth)
    }

    /// Gives the path that the arc targets, before the names of descendants were added.
    pub(crate) fn path_at_introduction(&self, node: NodeId, paths: &PathTable) -> PathId {
        paths.ancestor(self.node(node).site.path, self.depth_below_introduction(node, paths))
    }

    /// Whether a node has a class or base; those of a placeholder hang on the base that was moved.
    pub(crate) fn has_class(&self, node: NodeId) -> bool {
        let children = &self.node(self.moved_base_of(node).unwrap_or(node)).children;
        children.iter().any(|&child| self.node(child).kind.is_class())
    }

    /// Finds the base that was moved below the first node from a placeholder.
    pub(crate) fn moved_base_of(&self, node: NodeId) -> Option<NodeId> {
        if self.node(node).kind != ArcKind::Specializes {
            return None;
        }
        let bases = self.root().children.iter().rev().copied();
        bases
            .take_while(|&base| self.node(base).kind == ArcKind::Specializes)
            .find(|&base| self.node(base).origin == node && self.is_moved_base(base))
    }

    /// Follows the origins of an implied class to the arc that is written; gives also the steps.
    pub(crate) fn origin_root(&self, mut node: NodeId) -> (NodeId, usize) {
        let mut steps = 0;
        while node != NodeId::ROOT && self.node(node).origin != self.node(node).parent {
            node = self.node(node).origin;
            steps += 1;
        }
        (node, steps)
    }

    /// Of a class and the classes that it came through, written at one depth of the namespace: gives
    /// the node that has the first of them, and that first one.
    pub(crate) fn start_of_class_hierarchy(&self, node: NodeId, paths: &PathTable) -> (NodeId, NodeId) {
        let (mut instance, mut class) = (self.written_at(node), node);
        let depth = self.depth_below_introduction(instance, paths);
        while self.node(instance).kind.is_class() && self.depth_below_introduction(instance, paths) == depth {
            class = instance;
            match self.parent(instance) {
                Some(parent) => instance = self.written_at(parent),
                None => break,
            }
        }
        (instance, class)
    }

    /// Whether a base that was moved below the first node, where it is weakest.
    pub(crate) fn is_moved_base(&self, node: NodeId) -> bool {
        let found = self.node(node);
        node != NodeId::ROOT
            && found.kind == ArcKind::Specializes
            && found.parent == NodeId::ROOT
            && found.origin != found.parent
            && found.site == self.node(found.origin).site
    }

    /// Finds the node of a site whose opinions count.
    pub(crate) fn contributing_site(&self, site: Site) -> Option<NodeId> {
        let found = self
            .nodes
            .iter()
            .position(|node| node.site == site && node.contributes())?;
        Some(NodeId(found as u32))
    }

    /// Adds a node, in its place among its siblings.
    pub(crate) fn insert(&mut self, site: Site, arc: &NewArc, paths: &mut PathTable, has_specs: bool) -> NodeId {
        let map_to_root = Rc::new(self.node(arc.parent).map_to_root.after(&arc.map, paths));
        let id = NodeId(self.nodes.len() as u32);
        self.nodes.push(Node {
            site,
            kind: arc.kind,
            parent: arc.parent,
            origin: arc.origin,
            map_to_parent: Rc::clone(&arc.map),
            map_to_root,
            position: arc.position,
            depth: arc.depth,
            place: arc.place,
            inert: false,
            restricted: 0,
            culled: false,
            has_specs,
            ancestral: false,
            new: true,
            children: Vec::new(),
        });
        self.insert_in_order(id, paths);
        id
    }

    /// Hangs the tree of an arc's target into this one.
    pub(crate) fn append(&mut self, other: Self, arc: &NewArc, paths: &mut PathTable) -> NodeId {
        let first = self.nodes.len() as u32;
        let shift = |node: NodeId| NodeId(node.0 + first);
        for mut node in other.nodes {
            if self.nodes.len() as u32 == first {
                node.kind = arc.kind;
                node.parent = arc.parent;
                node.origin = arc.origin;
                node.map_to_parent = Rc::clone(&arc.map);
                node.position = arc.position;
                node.depth = arc.depth;
                node.place = arc.place;
            } else {
                node.parent = shift(node.parent);
                node.origin = shift(node.origin);
            }
            node.new = true;
            node.children.iter_mut().for_each(|child| *child = shift(*child));
            // A parent comes before its children.
            let above = Rc::clone(&self.node(node.parent).map_to_root);
            node.map_to_root = Rc::new(above.after(&node.map_to_parent, paths));
            self.nodes.push(node);
        }
        self.insert_in_order(NodeId(first), paths);
        NodeId(first)
    }

    fn insert_in_order(&mut self, new: NodeId, paths: &PathTable) {
        let parent = self.node(new).parent;
        let siblings = &self.node(parent).children;
        let stronger = |other: &NodeId| self.is_stronger(new, *other, paths);
        let at = if self.node(new).kind == ArcKind::Specializes {
            // The order of bases is not always transitive, so it matters what is asked first.
            match (siblings.first(), siblings.last()) {
                (Some(first), _) if stronger(first) => 0,
                (_, Some(last)) if stronger(last) => siblings.iter().position(stronger).unwrap_or(siblings.len()),
                _ => siblings.len(),
            }
        } else {
            siblings.partition_point(|other| !stronger(other))
        };
        self.node_mut(parent).children.insert(at, new);
    }

    /// Makes the tree that a child of the prim begins with: the same arcs, one name further.
    ///
    /// - `finished`: the tree is complete; what nobody needs goes, and the rest is numbered strong to
    ///   weak. That order decides which of two arcs is followed first.
    pub(crate) fn for_child(
        &self,
        name: Word,
        finished: bool,
        paths: &mut PathTable,
        library_has: impl Fn(Site) -> bool,
    ) -> Self {
        let old_ids: Vec<NodeId> = if finished {
            let kept = self.kept();
            let mut list = self.strong_to_weak();
            list.retain(|id| kept[id.0 as usize]);
            list
        } else {
            self.ids().collect()
        };
        let mut new_ids = vec![None; self.nodes.len()];
        for (new, old) in old_ids.iter().enumerate() {
            new_ids[old.0 as usize] = Some(NodeId(new as u32));
        }
        let moved = |node: NodeId| new_ids[node.0 as usize].unwrap_or(NodeId::ROOT);
        let mut nodes = Vec::with_capacity(old_ids.len());
        for id in old_ids {
            let old = self.node(id);
            let site = Site {
                path: paths.join(old.site.path, Step::Child(name)),
                ..old.site
            };
            nodes.push(Node {
                site,
                parent: moved(old.parent),
                origin: moved(old.origin),
                has_specs: old.has_specs && library_has(site),
                ancestral: id != NodeId::ROOT,
                new: false,
                children: old
                    .children
                    .iter()
                    .filter_map(|child| new_ids[child.0 as usize])
                    .collect(),
                map_to_parent: Rc::clone(&old.map_to_parent),
                map_to_root: Rc::clone(&old.map_to_root),
                ..*old
            });
        }
        Self { nodes }
    }

    /// Tells which nodes a child needs: those that are not culled, and what they hang on.
    fn kept(&self) -> Vec<bool> {
        let mut kept = vec![false; self.nodes.len()];
        let mut waiting: Vec<NodeId> = self.ids().filter(|&node| !self.node(node).culled).collect();
        while let Some(node) = waiting.pop() {
            if std::mem::replace(&mut kept[node.0 as usize], true) {
                continue;
            }
            waiting.extend([self.node(node).parent, self.node(node).origin]);
        }
        kept
    }

    /// Marks the subtrees that say nothing.
    pub(crate) fn cull(&mut self, scene: StackId, paths: &PathTable) {
        for id in self.strong_to_weak().into_iter().rev() {
            if self.can_be_culled(id, scene, paths) {
                self.node_mut(id).culled = true;
                self.restrict(id, paths);
            }
        }
    }

    /// Whether nothing at or below a node says anything, and nobody needs it.
    fn can_be_culled(&self, node: NodeId, scene: StackId, paths: &PathTable) -> bool {
        let found = self.node(node);
        if found.culled {
            return true;
        }
        if node == NodeId::ROOT || self.depth_below_introduction(node, paths) == 0 {
            return false;
        }
        if found.kind == ArcKind::Inherits && found.site.stack == scene {
            let (origin, _) = self.origin_root(node);
            if !paths.is_top_level_prim(self.path_at_introduction(origin, paths)) {
                return false;
            }
        }
        let silent = !(found.has_specs && found.contributes());
        silent && found.children.iter().all(|&child| self.node(child).culled)
    }

    /// Makes the opinions of a node not count.
    pub(crate) fn make_inert(&mut self, node: NodeId, paths: &PathTable) {
        self.node_mut(node).inert = true;
        self.restrict(node, paths);
    }

    /// Makes the opinions of a subtree not count.
    pub(crate) fn make_subtree_inert(&mut self, top: NodeId, paths: &PathTable) {
        let mut waiting = vec![top];
        while let Some(node) = waiting.pop() {
            self.make_inert(node, paths);
            waiting.extend_from_slice(&self.node(node).children);
        }
    }

    fn restrict(&mut self, node: NodeId, paths: &PathTable) {
        let found = self.node_mut(node);
        if found.restricted == 0 {
            found.restricted = paths.steps(found.site.path);
        }
    }
}

//! Builds the tree of one prim: the work list of LIVRPS.
//!
//! The algorithm is that of `OpenUSD`'s prim indexing, so that ties fall as they do there: the tree of
//! the parent with one more name, then arcs in the order references, payloads, inherits, specializes,
//! bases to be moved, implied classes, variants. Each new node brings tasks of its own.

use std::collections::BTreeSet;
use std::rc::Rc;

use super::arcs::AssetArcKind;
use super::graph::{ArcKind, Graph, NewArc, NodeId, Site};
use super::library::Library;
use super::mapping::PathMap;
use super::paths::{PathId, Step, Word};
use crate::diagnostic::Diagnostic;
use crate::source::Place;

/// What all trees of a scene share while they are built.
pub(crate) struct Composer<'l, 'a, 'r> {
    pub(crate) library: &'l mut Library<'a, 'r>,
    pub(crate) load_payloads: bool,
    /// Nodes made for the prim in work, those that arrive through trees within its tree too.
    pub(crate) nodes: usize,
}

impl Composer<'_, '_, '_> {
    /// Whether the prim in work takes more than a scene may need.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.nodes > self.library.limits.index_nodes || self.library.is_exhausted()
    }
}

/// The tree around the one that is built for an arc's target.
pub(crate) struct Frame<'f> {
    /// What the arc targets; the tree begins above it in the namespace and grows towards it.
    pub(crate) requested: Site,
    pub(crate) parent: NodeId,
    pub(crate) arc: &'f NewArc,
    skip_duplicates: bool,
    pub(crate) graph: &'f Graph,
    pub(crate) previous: Option<&'f Frame<'f>>,
}

/// How a tree is to be built.
#[derive(Clone, Copy)]
pub(crate) struct BuildOptions {
    /// Else that is left to the tree around, where more is known.
    choose_variants: bool,
}

impl BuildOptions {
    /// For a prim of the scene.
    pub(crate) const WHOLE: Self = Self { choose_variants: true };

    /// For the target of an arc.
    const WITHIN: Self = Self { choose_variants: false };
}

/// What to do when an arc is added.
#[derive(Clone, Copy, Default)]
pub(crate) struct ArcOptions {
    pub(crate) inert: bool,
    /// The target lies below the top level, so arcs of its ancestors bring opinions too.
    pub(crate) with_ancestors: bool,
    pub(crate) skip_duplicates: bool,
    /// Nothing follows of the node.
    pub(crate) without_tasks: bool,
}

/// A set of variants to choose from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VariantTask {
    pub(crate) node: NodeId,
    /// Where the set is written: the path of the node or one that begins it.
    pub(crate) owner: PathId,
    pub(crate) set: Word,
    pub(crate) position: u32,
}

/// What is left to do; fields in the order of urgency.
#[derive(Default)]
struct Tasks {
    references: BTreeSet<NodeId>,
    payloads: BTreeSet<NodeId>,
    inherits: BTreeSet<NodeId>,
    specializes: BTreeSet<NodeId>,
    bases: BTreeSet<NodeId>,
    implied_classes: BTreeSet<NodeId>,
    ancestral_sets: BTreeSet<NodeId>,
    ancestral_variants: Variants,
    sets: BTreeSet<NodeId>,
    variants: Variants,
}

/// Sets of variants that are left to choose from.
#[derive(Default)]
struct Variants {
    waiting: Vec<VariantTask>,
    /// Sets without a selection so far; a variant that is chosen may bring one.
    unselected: Vec<VariantTask>,
}

/// One tree in the making.
pub(crate) struct Indexer<'f> {
    pub(crate) graph: Graph,
    pub(crate) frame: Option<&'f Frame<'f>>,
    pub(crate) options: BuildOptions,
    /// The site of the tree's prim.
    pub(crate) site: Site,
    tasks: Tasks,
}

/// Builds the tree of a site. `parent` is the finished tree of the parent, if there is one.
pub(crate) fn build_graph(
    composer: &mut Composer<'_, '_, '_>,
    site: Site,
    options: BuildOptions,
    parent: Option<&Graph>,
    frame: Option<&Frame<'_>>,
) -> Graph {
    let graph = match composer.library.paths.step(site.path) {
        Step::Root => return Graph::new(site, composer.library),
        Step::Variant { .. } => Graph::new(site, composer.library),
        Step::Child(name) => child_graph(composer, site, name, options, parent, frame),
    };
    composer.library.work += graph.len();
    if frame.is_none() {
        composer.nodes += graph.len();
    }
    let mut indexer = Indexer {
        graph,
        frame,
        options,
        site,
        tasks: Tasks::default(),
    };
    indexer.add_tasks_below(composer, NodeId::ROOT, ArcOptions::default());
    indexer.run(composer);
    if frame.is_none() {
        indexer.graph.cull(site.stack, &composer.library.paths);
    }
    indexer.graph
}

/// Makes the tree that a prim begins with from that of its parent.
fn child_graph(
    composer: &mut Composer<'_, '_, '_>,
    site: Site,
    name: Word,
    options: BuildOptions,
    parent: Option<&Graph>,
    frame: Option<&Frame<'_>>,
) -> Graph {
    let built;
    let parent = match parent {
        Some(parent) => parent,
        None => {
            let above = Site {
                path: composer.library.paths.parent(site.path),
                ..site
            };
            built = build_graph(composer, above, options, None, frame);
            &built
        }
    };
    let library = &mut *composer.library;
    let mut paths = std::mem::take(&mut library.paths);
    let has_specs = |site: Site| library.stack(site.stack).has_specs(site.path);
    let graph = parent.for_child(name, frame.is_none(), &mut paths, has_specs);
    library.paths = paths;
    graph
}

impl Indexer<'_> {
    fn run(&mut self, composer: &mut Composer<'_, '_, '_>) {
        loop {
            if composer.is_exhausted() {
                return self.report_size(composer);
            }
            let tasks = &mut self.tasks;
            if let Some(node) = tasks.references.pop_first() {
                self.add_asset_arcs(composer, node, AssetArcKind::References);
            } else if let Some(node) = tasks.payloads.pop_first() {
                self.add_asset_arcs(composer, node, AssetArcKind::Payloads);
            } else if let Some(node) = tasks.inherits.pop_first() {
                self.add_written_classes(composer, node, ArcKind::Inherits);
            } else if let Some(node) = tasks.specializes.pop_first() {
                self.add_written_classes(composer, node, ArcKind::Specializes);
            } else if let Some(node) = tasks.bases.pop_first() {
                self.move_bases(composer, node);
            } else if let Some(node) = take_first_implied(composer, &self.graph, &mut tasks.implied_classes) {
                self.imply_classes(composer, node);
            } else if let Some(node) = tasks.ancestral_sets.pop_first() {
                self.add_ancestral_variant_tasks(composer, node);
            } else if let Some(task) = take_strongest(composer, &self.graph, &mut tasks.ancestral_variants.waiting) {
                self.choose_variant(composer, task);
            } else if let Some(node) = tasks.sets.pop_first() {
                self.add_variant_tasks(composer, node);
            } else if let Some(task) = take_strongest(composer, &self.graph, &mut tasks.variants.waiting) {
                self.choose_variant(composer, task);
            } else {
                return;
            }
        }
    }

    fn report_size(&self, composer: &mut Composer<'_, '_, '_>) {
        let library = &mut *composer.library;
        if library.is_exhausted() {
            return library.report_exhaustion();
        }
        let path = library.paths.text(self.site.path);
        let message = format!(
            "`{path}` is composed of more than {} places; do references double at every level?",
            library.limits.index_nodes
        );
        let last = self.graph.node(NodeId(self.graph.len() as u32 - 1)).place;
        let error = Diagnostic::error("index-too-large", message);
        library.report.push_once(match last {
            Some(place) => error.at(place),
            None => error,
        });
    }

    fn add_variant_tasks(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId) {
        let found = self.graph.node(node);
        if found.contributes() {
            let tasks = variant_tasks(composer, node, found.site);
            self.tasks.variants.waiting.extend(tasks);
        }
    }

    /// Lists the sets that are written above the path of a node, up to the next variant: those further
    /// up were chosen from before it was.
    fn add_ancestral_variant_tasks(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId) {
        let found = self.graph.node(node);
        let mut path = composer.library.paths.parent(found.site.path);
        while path != PathId::ROOT {
            if found.contributes_at(path, &composer.library.paths) {
                let tasks = variant_tasks(composer, node, Site { path, ..found.site });
                self.tasks.ancestral_variants.waiting.extend(tasks);
                if matches!(composer.library.paths.step(path), Step::Variant { .. }) {
                    break;
                }
            }
            path = composer.library.paths.parent(path);
        }
    }

    pub(crate) fn no_selection(&mut self, task: VariantTask) {
        let tasks = &mut self.tasks;
        let list = if task.owner == self.graph.node(task.node).site.path {
            &mut tasks.variants
        } else {
            &mut tasks.ancestral_variants
        };
        list.unselected.push(task);
    }

    /// Looks once more at the sets without a selection, since there are new opinions.
    pub(crate) fn retry_variants(&mut self) {
        for list in [&mut self.tasks.ancestral_variants, &mut self.tasks.variants] {
            list.waiting.append(&mut list.unselected);
        }
    }

    /// Has a class, with those that it came through, implied upwards.
    pub(crate) fn imply_class_later(&mut self, composer: &Composer<'_, '_, '_>, class: NodeId) {
        let start = self.start_of_implied_classes(composer, class);
        self.tasks.implied_classes.insert(start);
    }

    /// Adds a node for an arc with everything that follows of it; none if that would be a cycle or
    /// repeat what is there.
    pub(crate) fn add_arc(
        &mut self,
        composer: &mut Composer<'_, '_, '_>,
        site: Site,
        arc: &NewArc,
        mut options: ArcOptions,
    ) -> Option<NodeId> {
        composer.nodes += 1;
        if composer.nodes > composer.library.limits.index_nodes || !self.may_reach(composer, site, arc) {
            return None;
        }
        options.skip_duplicates |= self.frame.is_some_and(|frame| frame.skip_duplicates);
        if options.skip_duplicates && self.is_known(composer, site) {
            return None;
        }
        let new = if options.with_ancestors {
            let frame = Frame {
                requested: site,
                parent: arc.parent,
                arc,
                skip_duplicates: options.skip_duplicates,
                graph: &self.graph,
                previous: self.frame,
            };
            let target = build_graph(composer, site, BuildOptions::WITHIN, None, Some(&frame));
            self.graph.append(target, arc, &mut composer.library.paths)
        } else {
            let has_specs = composer.library.stack(site.stack).has_specs(site.path);
            let new = self.graph.insert(site, arc, &mut composer.library.paths, has_specs);
            if options.inert {
                // Nor does it say anything of the prims above.
                let node = self.graph.node_mut(new);
                node.inert = true;
                node.restricted = 1;
            }
            new
        };
        let mut above = arc.parent;
        while self.graph.node(above).culled {
            let node = self.graph.node_mut(above);
            node.culled = false;
            above = node.parent;
        }
        if !options.without_tasks {
            self.add_tasks(composer, new, options);
        }
        Some(new)
    }

    /// Lists what a new node brings: implied classes first, then what its specs write.
    fn add_tasks(&mut self, composer: &mut Composer<'_, '_, '_>, node: NodeId, options: ArcOptions) {
        if self.graph.node(node).kind.is_class() {
            self.imply_class_later(composer, node);
        } else if self.graph.has_class(node) {
            self.tasks.implied_classes.insert(node);
        }
        if options.with_ancestors && self.frame.is_none() {
            self.tasks.bases.insert(node);
        }
        self.add_tasks_below(composer, node, options);
    }

    fn add_tasks_below(&mut self, composer: &mut Composer<'_, '_, '_>, top: NodeId, options: ArcOptions) {
        let mut waiting = vec![top];
        while let Some(node) = waiting.pop() {
            let found = self.graph.node(node);
            waiting.extend_from_slice(&found.children);
            if options.with_ancestors && self.options.choose_variants {
                self.tasks.ancestral_sets.insert(node);
            }
            if !(found.has_specs && found.contributes()) {
                continue;
            }
            let written = composer.library.written_arcs(found.site);
            if self.options.choose_variants && written.variants {
                self.tasks.sets.insert(node);
            }
            if options.with_ancestors {
                // Its arcs were followed when its own tree was built.
                continue;
            }
            for (is_written, list) in [
                (written.references, &mut self.tasks.references),
                (written.payloads, &mut self.tasks.payloads),
                (written.inherits, &mut self.tasks.inherits),
                (written.specializes, &mut self.tasks.specializes),
            ] {
                if is_written {
                    list.insert(node);
                }
            }
        }
    }

    /// Finds the node from which a class, with those that it came through, is implied upwards.
    fn start_of_implied_classes(&self, composer: &Composer<'_, '_, '_>, node: NodeId) -> NodeId {
        let paths = &composer.library.paths;
        let mut start = node;
        while self.graph.node(start).kind.is_class() {
            let (instance, class) = self.graph.start_of_class_hierarchy(start, paths);
            start = instance;
            if self.graph.node(instance).kind.is_class() {
                let ancestral = self.graph.path_at_introduction(instance, paths);
                if paths.has_prefix(self.graph.node(class).site.path, ancestral) {
                    break;
                }
            }
        }
        start
    }
}

fn variant_tasks(composer: &Composer<'_, '_, '_>, node: NodeId, site: Site) -> Vec<VariantTask> {
    let sets = composer.library.variant_sets(site).into_iter().zip(0..);
    let task = |(set, position)| VariantTask {
        node,
        owner: site.path,
        set,
        position,
    };
    sets.map(task).collect()
}

/// Takes the strongest node whose classes are to be implied, but those below it first: what is implied
/// first keeps its place, and places do not come twice.
fn take_first_implied(
    composer: &mut Composer<'_, '_, '_>,
    graph: &Graph,
    tasks: &mut BTreeSet<NodeId>,
) -> Option<NodeId> {
    if tasks.len() < 2 {
        return tasks.pop_first();
    }
    let mut waiting = vec![(NodeId::ROOT, false)];
    while let Some((node, below_done)) = waiting.pop() {
        composer.library.work += 1;
        if below_done {
            if tasks.remove(&node) {
                return Some(node);
            }
            continue;
        }
        waiting.push((node, true));
        let children = graph.node(node).children.iter().rev();
        waiting.extend(children.map(|&child| (child, false)));
    }
    None
}

/// Takes the task of the strongest node; of one node the set written furthest up, and the first there.
fn take_strongest(
    composer: &mut Composer<'_, '_, '_>,
    graph: &Graph,
    tasks: &mut Vec<VariantTask>,
) -> Option<VariantTask> {
    composer.library.work += tasks.len() * 16;
    let paths = &composer.library.paths;
    let best = (0..tasks.len()).min_by(|&a, &b| {
        let (a, b) = (&tasks[a], &tasks[b]);
        let by_node = graph.compare_in_tree(a.node, b.node);
        by_node
            .then_with(|| paths.steps(a.owner).cmp(&paths.steps(b.owner)))
            .then(a.position.cmp(&b.position))
    })?;
    Some(tasks.remove(best))
}

/// Makes the description of an arc.
#[allow(clippy::too_many_arguments, reason = "each is one property of an arc")]
pub(crate) fn new_arc(
    kind: ArcKind,
    parent: NodeId,
    origin: NodeId,
    map: PathMap,
    position: u32,
    depth: u16,
    place: Option<Place>,
) -> NewArc {
    NewArc {
        kind,
        parent,
        origin,
        map: Rc::new(map),
        position,
        depth,
        place,
    }
}

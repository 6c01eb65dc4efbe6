//! From layers to prims: USD's composition.
//!
//! Every layer is laid out by path (`spec`); layers stack (`library`). For each prim of the scene a
//! tree of the places that may say something about it is built (`indexer`, with `arcs`, `classes`,
//! `bases`, `variants`), whose order is the order of strength (`graph`, `strength`). Walking it gives
//! the prim's values and children (`resolve`, `children`).
//!
//! Trees grow from that of the parent, and places that say nothing are left out, so that the work is
//! linear in the opinions that there are.

mod arcs;
mod bases;
mod checks;
mod children;
mod classes;
mod graph;
mod idle_variants;
mod indexer;
mod library;
mod list_edits;
mod mapping;
mod paths;
mod reach;
mod resolve;
mod spec;
mod strength;
mod targets;
mod values;
mod variants;

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

pub use graph::ArcKind;
pub(crate) use library::{LayerId, Library, StackId};
pub(crate) use paths::{PathId, PathTable};
pub(crate) use resolve::TargetUse;
pub(crate) use spec::{Arcs, FlatLayer, Selection, Spec};

use crate::diagnostic::Diagnostic;
use crate::options::DEEPEST;
use crate::scene::Prim;
use graph::{Graph, Site};
use indexer::{BuildOptions, Composer, build_graph};
use resolve::Resolver;

/// The prims of a scene before checks that need all of them.
#[derive(Default)]
pub(crate) struct Composed {
    pub(crate) prims: Vec<Prim>,
    pub(crate) index: BTreeMap<String, usize>,
    pub(crate) targets: Vec<TargetUse>,
    /// Whether a limit ended it early, which was reported; what is missing then means nothing.
    pub(crate) is_cut_short: bool,
    /// Prims that nothing but the command line mentions, which are none.
    pub(crate) session_only: BTreeSet<String>,
}

/// A prim to be composed.
struct Waiting {
    path: PathId,
    parent: Option<usize>,
    above: Rc<Graph>,
}

/// Composes all prims of a stack, depth first, children in their order.
pub(crate) fn compose(library: &mut Library<'_, '_>, stack: StackId, load_payloads: bool) -> Composed {
    let root = Graph::new(
        Site {
            stack,
            path: PathId::ROOT,
        },
        library,
    );
    let mut resolver = Resolver::default();
    let mut composed = Composed::default();
    let mut waiting = Vec::new();
    push_children(library, &mut waiting, Rc::new(root), None);
    while let Some(next) = waiting.pop() {
        let limits = library.limits;
        if composed.prims.len() >= limits.prims || resolver.opinions > limits.opinions {
            report_size(library, composed.prims.len());
            composed.is_cut_short = true;
            break;
        }
        let site = Site { stack, path: next.path };
        let mut composer = Composer {
            library: &mut *library,
            load_payloads,
            nodes: 0,
        };
        let graph = build_graph(&mut composer, site, BuildOptions::WHOLE, Some(&next.above), None);
        if composer.is_exhausted() {
            // It was reported, unless it was met outside of the tree; the other prims would take as long.
            if library.is_exhausted() {
                library.report_exhaustion();
            }
            composed.is_cut_short = true;
            break;
        }
        checks::check_graph(library, &graph);
        let above = next.parent.is_none_or(|parent| composed.prims[parent].rendered);
        let prim = resolver.resolve(library, &graph, next.parent, above);
        idle_variants::warn_of_idle_variants(library, &graph, &prim);
        let position = composed.prims.len();
        let is_active = prim.active;
        if is_session_only(library, &graph) {
            composed.session_only.insert(prim.path.clone());
        }
        composed.index.insert(prim.path.clone(), position);
        composed.prims.push(prim);
        if !is_active {
            continue;
        }
        if usize::from(library.paths.depth(next.path)) >= limits.prim_depth.min(DEEPEST) {
            checks::refuse_children(library, &graph);
            continue;
        }
        push_children(library, &mut waiting, Rc::new(graph), Some(position));
    }
    if library.is_exhausted() {
        library.report_exhaustion();
        composed.is_cut_short = true;
    }
    resolver.warn_of_idle_removals(library);
    composed.targets = resolver.targets;
    composed
}

/// Whether the command line alone says that there is such a prim.
fn is_session_only(library: &Library<'_, '_>, graph: &Graph) -> bool {
    let mut specs = graph.ids().flat_map(|node| {
        let site = graph.node(node).site;
        library.spec_numbers(site.stack, site.path)
    });
    specs.all(|(layer, _, _)| library.layer(layer).is_session)
}

fn push_children(library: &mut Library<'_, '_>, waiting: &mut Vec<Waiting>, graph: Rc<Graph>, parent: Option<usize>) {
    let names = children::child_names(library, &graph);
    let path = graph.root().site.path;
    for name in names.into_iter().rev() {
        waiting.push(Waiting {
            path: library.paths.child(path, name),
            parent,
            above: Rc::clone(&graph),
        });
    }
}

fn report_size(library: &mut Library<'_, '_>, prims: usize) {
    let limits = library.limits;
    let error = if prims >= limits.prims {
        Diagnostic::error("too-many-prims", format!("a scene has at most {} prims", limits.prims))
    } else {
        let message = format!(
            "the prims of a scene have at most {} opinions, counted anew wherever an arc brings them",
            limits.opinions
        );
        Diagnostic::error("too-many-opinions", message)
    };
    library.report.push_once(error);
}

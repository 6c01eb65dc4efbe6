//! How far arcs may reach: neither in a circle nor too far, and what is said of those that do.

use super::graph::{ArcKind, NewArc, NodeId, Site};
use super::indexer::{Composer, Indexer};
use crate::diagnostic::Diagnostic;
use crate::source::Place;

impl Indexer<'_> {
    /// Whether a node for a site is there, here or in a tree around this one.
    pub(super) fn is_known(&self, composer: &mut Composer<'_, '_, '_>, mut site: Site) -> bool {
        let mut graph = &self.graph;
        let mut frame = self.frame;
        loop {
            composer.library.work += graph.len();
            if graph.contributing_site(site).is_some() {
                return true;
            }
            let Some(around) = frame else {
                return false;
            };
            let current = graph.root().site.path;
            site.path = composer
                .library
                .paths
                .replace_prefix(around.requested.path, current, site.path);
            graph = around.graph;
            frame = around.previous;
        }
    }

    /// Whether an arc leads neither in a circle nor too far. If not, says so.
    pub(super) fn may_reach(&self, composer: &mut Composer<'_, '_, '_>, site: Site, arc: &NewArc) -> bool {
        if arc.kind == ArcKind::Variants {
            return true;
        }
        let mut graph = &self.graph;
        let mut frame = self.frame;
        let mut node = arc.parent;
        let mut sought = site;
        let mut arcs = 1;
        loop {
            let paths = &mut composer.library.paths;
            // Through where bases are written: below the first node they would seem one arc away.
            arcs += graph.up_as_written(node).count();
            for above in graph.up(node) {
                let other = graph.node(above).site;
                let meets = other.stack == sought.stack
                    && (paths.has_prefix(other.path, sought.path) || paths.has_prefix(sought.path, other.path));
                if meets {
                    // Of an implied class nobody wrote that it should be here.
                    if arc.origin == arc.parent {
                        self.report_cycle(composer, site, arc);
                    }
                    return false;
                }
            }
            let Some(around) = frame else {
                break;
            };
            let current = graph.root().site.path;
            sought.path = paths.replace_prefix(around.requested.path, current, sought.path);
            graph = around.graph;
            node = around.parent;
            frame = around.previous;
        }
        let limit = composer.library.limits.arc_depth;
        if arcs > limit + 1 {
            let message = format!("more than {limit} arcs lead from a prim to here");
            let error = Diagnostic::error("arcs-too-deep", message);
            self.report_at(composer, error, arc, true);
            return false;
        }
        true
    }

    fn report_cycle(&self, composer: &mut Composer<'_, '_, '_>, site: Site, arc: &NewArc) {
        let target = composer.library.paths.text(site.path);
        let message = format!("`{}` leads back to `{target}`", arc.kind.word());
        let error = Diagnostic::error("arc-cycle", message)
            .note("a prim cannot be made of itself; break the circle at one of these arcs");
        self.report_at(composer, error, arc, true);
    }

    /// Reports something about an arc, with the arcs that lead to it.
    pub(crate) fn report_at(&self, composer: &mut Composer<'_, '_, '_>, error: Diagnostic, arc: &NewArc, chain: bool) {
        let library = &mut *composer.library;
        let mut error = error;
        let place = arc
            .place
            .or_else(|| self.arc_places(arc.parent).first().map(|&(_, place)| place));
        if let Some(place) = place {
            error = error.at(place);
        }
        if chain {
            let mut places = self.arc_places(arc.parent);
            places.reverse();
            for (kind, place) in places {
                if Some(place) != error.place {
                    let text = library.sources.text(place).to_owned();
                    error = error.also(place, format!("reached by {} {text}", kind.word()));
                }
            }
        }
        library.report.push_once(error);
    }

    /// Lists the arcs from a node up to the prim, through all trees around this one.
    fn arc_places(&self, mut node: NodeId) -> Vec<(ArcKind, Place)> {
        let mut list = Vec::new();
        let mut graph = &self.graph;
        let mut frame = self.frame;
        loop {
            for above in graph.up(node) {
                let found = graph.node(above);
                if let Some(place) = found.place {
                    list.push((found.kind, place));
                }
            }
            let Some(around) = frame else {
                return list;
            };
            if let Some(place) = around.arc.place {
                list.push((around.arc.kind, place));
            }
            graph = around.graph;
            node = around.parent;
            frame = around.previous;
        }
    }
}

//! Warns of a `--variant` that changes nothing: selected anyway, or overruled in all it says.

use super::graph::Graph;
use super::library::Library;
use super::paths::{Step, Word};
use super::spec::{Selection, Spec};
use crate::diagnostic::Diagnostic;
use crate::scene::{FieldValue, Prim};
use crate::source::Place;

/// Looks at the variants that the command line selects on a prim.
pub(crate) fn warn_of_idle_variants(library: &mut Library<'_, '_>, graph: &Graph, prim: &Prim) {
    let Some(selections) = library.session_selections.get(&graph.root().site.path) else {
        return;
    };
    for selection in selections.clone() {
        let Some(variant) = selection.variant else { continue };
        let name = format!(
            "{}{{{}={}}}",
            prim.path,
            library.paths.word_text(selection.set),
            library.paths.word_text(variant)
        );
        let warning = match selected_by_layers(library, graph, selection.set) {
            Some((same, place)) if same == Some(variant) => {
                let message = format!("`--variant` changes nothing: {name} is selected anyway");
                Diagnostic::warning("variant-without-effect", message).also(place, "selected")
            }
            _ => match overruled(library, graph, prim, selection) {
                Some(place) => {
                    let message =
                        format!("`--variant` changes nothing: stronger opinions overrule all that {name} says");
                    Diagnostic::warning("variant-without-effect", message).also(place, "for example")
                }
                None => continue,
            },
        };
        library.report.push_once(warning.at(selection.place));
    }
}

/// The selection that would hold without the command line.
fn selected_by_layers(library: &Library<'_, '_>, graph: &Graph, set: Word) -> Option<(Option<Word>, Place)> {
    graph.strong_to_weak().into_iter().find_map(|node| {
        let node = graph.node(node);
        if !(node.has_specs && node.contributes()) {
            return None;
        }
        let mut specs = library.specs(node.site.stack, node.site.path);
        specs.find_map(|(layer, _, spec)| {
            if library.layer(layer).is_session {
                return None;
            }
            let found = spec.arcs.as_ref()?.select.iter().find(|one| one.set == set)?;
            Some((found.variant, found.place))
        })
    })
}

/// If a variant says something about fields alone, and nothing of that wins: where a winner stands.
fn overruled(library: &Library<'_, '_>, graph: &Graph, prim: &Prim, selection: Selection) -> Option<Place> {
    let step = Step::Variant {
        set: selection.set,
        variant: selection.variant?,
    };
    let brings_more = |spec: &Spec| {
        let arcs = spec.arcs.is_some() || !spec.children.is_empty() || !spec.without.is_empty();
        arcs || spec.active.is_some() || spec.components.iter().any(|component| component.fields.is_empty())
    };
    for node in graph
        .ids()
        .filter(|&node| library.paths.step(graph.node(node).site.path) == step)
    {
        let site = graph.node(node).site;
        if library
            .specs(site.stack, site.path)
            .any(|(_, _, spec)| brings_more(spec))
        {
            return None;
        }
    }
    let from_variant = |contributor: u32| library.paths.step(prim.contributors[contributor as usize].path) == step;
    let fields = prim.components.iter().flat_map(|component| &component.fields);
    let touched: Vec<&FieldValue> = fields
        .filter(|field| field.opinions.iter().any(|opinion| from_variant(opinion.contributor)))
        .collect();
    let wins = |field: &&FieldValue| field.is_relationship() || from_variant(field.opinions[0].contributor);
    if touched.iter().any(wins) {
        return None;
    }
    touched.first().map(|field| field.place)
}

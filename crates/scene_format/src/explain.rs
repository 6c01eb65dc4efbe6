//! Why a value is what it is: every opinion about a field, and why each loser loses.

use std::fmt::Write;

use crate::compose::ArcKind;
use crate::diagnostic::{Diagnostic, nearest};
use crate::flatten::ron_value;
use crate::scene::{ComponentValue, Contributor, FieldState, FieldValue, Opinion, Prim, Scene};

/// Longest text of a value that is shown.
const WIDTH: usize = 40;

/// Explains one field: `/World/Ring.Material.roughness`, or without the component if only one has
/// such a field.
///
/// ```text
/// /World/Ring.Material.roughness = 0.05
///   1  ring.ron:20     0.05   local                                       <- wins
///   2  layout.ron:6    0.2    inherits /_Metal (from layout.ron:16)       weaker: local beats inherits
/// ```
///
/// # Errors
///
/// `unknown-prim`, `unknown-component`, `unknown-field`, `ambiguous-field`, `no-opinion`, with what
/// was probably meant.
pub fn explain(scene: &Scene, question: &str) -> Result<String, Diagnostic> {
    let (prim, component, field) = find(scene, question)?;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}.{}.{} = {}",
        prim.path,
        component.name,
        field.name,
        state_text(field)
    );
    let rows: Vec<[String; 4]> = (0..field.opinions.len())
        .map(|number| row(scene, prim, field, number))
        .collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths = [width(0), width(1), width(2)];
    for (number, [place, value, arc, verdict]) in rows.iter().enumerate() {
        let [a, b, c] = widths;
        let line = format!("  {:<3}{place:<a$}  {value:<b$}  {arc:<c$}  {verdict}", number + 1);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    for warning in remarks(scene, prim, component, field) {
        let _ = writeln!(text, "  = {warning}");
    }
    Ok(text)
}

fn find<'s>(scene: &'s Scene, question: &str) -> Result<(&'s Prim, &'s ComponentValue, &'s FieldValue), Diagnostic> {
    let words: Vec<&str> = question.trim().split('.').collect();
    let (path, component, field) = match words[..] {
        [path, field] => (path, None, field),
        [path, component, field] => (path, Some(component), field),
        _ => {
            let message = format!("`{question}` is no field; ask for /Prim.Component.field");
            return Err(Diagnostic::error("bad-question", message));
        }
    };
    let Some(prim) = scene.prim(path) else {
        let names = scene.prims.iter().map(|prim| prim.path.as_str());
        let error = Diagnostic::error("unknown-prim", format!("there is no prim `{path}`"));
        return Err(error.suggest(nearest(path, names)));
    };
    let all = || prim.components.iter().chain(&prim.removed);
    let list = |names: Vec<&str>| {
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    };
    let fits = |found: &&ComponentValue| component.is_none_or(|name| name == found.name);
    if let Some(name) = component
        && !all().any(|found| found.name == name)
    {
        let names = || all().map(|found| found.name);
        let message = format!("nothing is said about `{name}` of `{path}`");
        return Err(Diagnostic::error("unknown-component", message)
            .suggest(nearest(name, names()))
            .note(format!("components of {path}: {}", list(names().collect()))));
    }
    let found: Vec<(&ComponentValue, &FieldValue)> = all()
        .filter(fits)
        .filter_map(|component| Some((component, component.field(field)?)))
        .collect();
    match found[..] {
        [(component, field)] => Ok((prim, component, field)),
        [] => {
            let names = || {
                all()
                    .filter(fits)
                    .flat_map(|found| found.fields.iter().map(|field| field.name))
            };
            let message = format!("no layer has an opinion about `{question}`, so the default holds");
            Err(Diagnostic::error("no-opinion", message)
                .suggest(nearest(field, names()))
                .note(format!("fields with opinions: {}", list(names().collect()))))
        }
        _ => {
            let names: Vec<String> = found
                .iter()
                .map(|(component, _)| format!("{path}.{}.{field}", component.name))
                .collect();
            let message = format!("`{path}` has {} components with a field `{field}`", found.len());
            Err(Diagnostic::error("ambiguous-field", message).note(format!("ask for {}", names.join(" or "))))
        }
    }
}

fn shorten(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.chars().count() <= WIDTH {
        return line;
    }
    let cut: String = line.chars().take(WIDTH - 2).collect();
    format!("{cut}..")
}

fn state_text(field: &FieldValue) -> String {
    match &field.state {
        FieldState::Constant(value) => shorten(&ron_value(&**value, &str::to_owned)),
        FieldState::Samples(samples) => format!("{} samples over time", samples.len()),
        FieldState::Blocked => "the default (blocked)".to_owned(),
    }
}

fn row(scene: &Scene, prim: &Prim, field: &FieldValue, number: usize) -> [String; 4] {
    let opinion = &field.opinions[number];
    let verdict = if number == 0 {
        if field.is_relationship() && field.opinions.len() > 1 {
            "<- strongest; lists are combined from the weakest up".to_owned()
        } else {
            "<- wins".to_owned()
        }
    } else {
        format!("weaker: {}", reason(scene, prim, &field.opinions[0], opinion))
    };
    [
        scene.sources.describe_line(opinion.place).to_string(),
        shorten(scene.sources.text(opinion.place)),
        describe_arcs(scene, prim, opinion),
        verdict,
    ]
}

/// `inherits /_Metal (from layout.ron:16)`, with the arcs that led to its start.
fn describe_arcs(scene: &Scene, prim: &Prim, opinion: &Opinion) -> String {
    let mut parts = Vec::new();
    for number in ways(prim, opinion.contributor) {
        let found = &prim.contributors[number as usize];
        if found.arc == ArcKind::Local {
            continue;
        }
        let place = found.arc_place.map_or(String::new(), |place| {
            format!(" (from {})", scene.sources.describe_line(place))
        });
        parts.push(format!("{} {}{place}", found.arc.word(), scene.path_of(found)));
    }
    if parts.is_empty() {
        "local".to_owned()
    } else {
        parts.join(", ")
    }
}

/// The contributors from the prim itself to one of them.
fn ways(prim: &Prim, contributor: u32) -> Vec<u32> {
    let mut way = vec![contributor];
    while let Some(parent) = prim.contributors[way[way.len() - 1] as usize].parent {
        way.push(parent);
    }
    way.reverse();
    way
}

/// Why the second of two opinions is weaker.
fn reason(scene: &Scene, prim: &Prim, winner: &Opinion, loser: &Opinion) -> String {
    if winner.contributor == loser.contributor {
        if scene.sources.is_argument(winner.place.source) {
            return "the command line beats all layers".to_owned();
        }
        let name = |opinion: &Opinion| scene.sources.name(opinion.place.source).to_owned();
        return format!("{} is above {} in the sublayers", name(winner), name(loser));
    }
    let (to_winner, to_loser) = (ways(prim, winner.contributor), ways(prim, loser.contributor));
    let fork = to_winner.iter().zip(&to_loser).take_while(|(a, b)| a == b).count();
    let at = |way: &[u32]| way.get(fork).map(|&number| &prim.contributors[number as usize]);
    match (at(&to_winner), at(&to_loser)) {
        (None, Some(below)) => below_itself(below, fork),
        (Some(winner), Some(loser)) => between(winner, loser),
        _ => "it comes later".to_owned(),
    }
}

fn below_itself(below: &Contributor, fork: usize) -> String {
    match below.arc {
        ArcKind::Specializes => "specializes is weakest".to_owned(),
        arc if fork == 1 => format!("local beats {}", arc.word()),
        arc => format!("what a place says itself beats what it {}", verb(arc)),
    }
}

fn verb(arc: ArcKind) -> &'static str {
    match arc {
        ArcKind::Inherits => "inherits",
        ArcKind::Variants => "has in a variant",
        ArcKind::References => "references",
        ArcKind::Payloads => "loads as payload",
        ArcKind::Specializes => "specializes",
        ArcKind::Local => "says",
    }
}

fn between(winner: &Contributor, loser: &Contributor) -> String {
    if loser.arc == ArcKind::Specializes && winner.arc != ArcKind::Specializes {
        return "specializes is weakest".to_owned();
    }
    if winner.arc != loser.arc {
        return format!("{} beats {}", winner.arc.word(), loser.arc.word());
    }
    if winner.depth != loser.depth {
        return "an arc on the prim beats one on a prim above it".to_owned();
    }
    match winner.arc {
        ArcKind::Variants => "of two sets of variants the first counts".to_owned(),
        arc => format!("of several {} the first counts", arc.word()),
    }
}

/// What deserves a word beside the list.
fn remarks(scene: &Scene, prim: &Prim, component: &ComponentValue, field: &FieldValue) -> Vec<String> {
    let mut list = Vec::new();
    if prim.removed.iter().any(|removed| removed.name == component.name) {
        list.push(format!(
            "`without` removes {} from {}, so this has no effect",
            component.name, prim.path
        ));
    }
    let in_variant = |opinion: &Opinion| {
        let way = ways(prim, opinion.contributor);
        way.iter()
            .any(|&number| prim.contributors[number as usize].arc == ArcKind::Variants)
    };
    if !field.is_relationship()
        && !in_variant(&field.opinions[0])
        && let Some(hidden) = field.opinions.iter().find(|opinion| in_variant(opinion))
    {
        let path = scene.path_of(&prim.contributors[hidden.contributor as usize]);
        list.push(format!(
            "the stronger opinion makes the choice of a variant pointless here: {path} has one too"
        ));
    }
    list
}

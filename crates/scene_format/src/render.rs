//! Draws a [`Diagnostic`]: message, place, line, caret, notes.

use std::fmt::Write;

use crate::diagnostic::{Diagnostic, Severity};
use crate::source::{Origin, Place, Source, Sources};

/// Lines are cut to about this many characters around the caret.
const WIDTH: usize = 110;
/// Of more places that take part the middle ones are left out.
const MOST_RELATED: usize = 8;
/// A tab is shown as this many blanks.
const TAB: usize = 4;

const RED: &str = "\x1b[1;31m";
const YELLOW: &str = "\x1b[1;33m";
const BLUE: &str = "\x1b[1;34m";
const BOLD: &str = "\x1b[1m";
const PLAIN: &str = "\x1b[0m";

struct Paint(bool);

impl Paint {
    fn text(&self, colour: &str, text: &str) -> String {
        if self.0 {
            format!("{colour}{text}{PLAIN}")
        } else {
            text.to_owned()
        }
    }
}

pub(crate) fn render(diagnostic: &Diagnostic, sources: &Sources, colour: bool) -> String {
    let paint = Paint(colour);
    let (word, tint) = match diagnostic.severity {
        Severity::Error => ("error", RED),
        Severity::Warning => ("warning", YELLOW),
    };
    let head = paint.text(tint, &format!("{word}[{}]", diagnostic.code));
    let message = paint.text(BOLD, &format!(": {}", visible(&diagnostic.message)));
    let mut text = format!("{head}{message}\n");
    let beside = beside_caret(diagnostic);
    let mut margin = 2;
    match diagnostic
        .place
        .and_then(|place| Some((place, sources.get(place.source)?)))
    {
        Some((place, source)) => {
            margin = draw_line(&mut text, place, source, sources, &beside, tint, &paint);
        }
        None if !beside.is_empty() => {
            let _ = writeln!(text, "{:margin$} {} {beside}", "", paint.text(BLUE, "="));
        }
        None => {}
    }
    if let Some(chain) = diagnostic.place.and_then(|place| reached_by(place, sources)) {
        let _ = writeln!(text, "{:margin$} {} {chain}", "", paint.text(BLUE, "="));
    }
    let count = diagnostic.related.len();
    for (number, (place, what)) in diagnostic.related.iter().enumerate() {
        let left_out = count.saturating_sub(MOST_RELATED);
        if left_out > 0 && number == MOST_RELATED / 2 {
            let _ = writeln!(
                text,
                "{:margin$} {} .. and {left_out} more ..",
                "",
                paint.text(BLUE, "=")
            );
        }
        if (MOST_RELATED / 2..MOST_RELATED / 2 + left_out).contains(&number) {
            continue;
        }
        let _ = writeln!(
            text,
            "{:margin$} {} {}: {}",
            "",
            paint.text(BLUE, "="),
            visible(what),
            sources.describe(*place)
        );
    }
    for note in &diagnostic.notes {
        let _ = writeln!(text, "{:margin$} {} {}", "", paint.text(BLUE, "="), visible(note));
    }
    text
}

/// `reached by: ring.ron:6 sublayers -> lighting.ron`; none for the file that was asked for.
fn reached_by(place: Place, sources: &Sources) -> Option<String> {
    let mut steps = Vec::new();
    let mut source = sources.get(place.source)?;
    while let Some(reached) = source.reached {
        let naming = sources.get(reached.place.source)?;
        let place = sources.describe_line(reached.place).to_string();
        steps.push(format!("{} {} -> ", visible(&place), reached.word));
        source = naming;
    }
    steps.reverse();
    if steps.len() > MOST_RELATED {
        let left_out = steps.len() - MOST_RELATED;
        steps.splice(
            MOST_RELATED / 2..MOST_RELATED / 2 + left_out,
            [format!(".. {left_out} more .. -> ")],
        );
    }
    let name = &sources.get(place.source)?.name;
    (!steps.is_empty()).then(|| format!("reached by: {}{}", steps.concat(), visible(name)))
}

fn beside_caret(diagnostic: &Diagnostic) -> String {
    let mut parts = Vec::new();
    if let Some(label) = &diagnostic.label {
        parts.push(visible(label));
    }
    if let Some(name) = &diagnostic.suggestion {
        parts.push(format!("did you mean `{}`?", visible(name)));
    }
    parts.join("; ")
}

/// Writes the `-->` line, the line of the text and the carets; returns the width of the margin.
fn draw_line(
    text: &mut String,
    place: Place,
    source: &Source,
    sources: &Sources,
    beside: &str,
    tint: &str,
    paint: &Paint,
) -> usize {
    let (number, _) = source.line_column(place.start);
    let is_argument = source.origin == Origin::Argument;
    let number_text = if is_argument { String::new() } else { number.to_string() };
    let margin = number_text.len().max(2);
    let bar = paint.text(BLUE, "|");
    let (shown, caret, carets) = excerpt(source, number, place);
    let _ = writeln!(
        text,
        "{:margin$}{} {}",
        "",
        paint.text(BLUE, "-->"),
        sources.describe(place)
    );
    let _ = writeln!(text, "{:margin$} {bar}", "");
    let number_text = paint.text(BLUE, &format!("{number_text:>margin$}"));
    let _ = writeln!(text, "{}", format!("{number_text} {bar} {shown}").trim_end());
    let underline = paint.text(tint, format!("{} {beside}", "^".repeat(carets)).trim_end());
    let _ = writeln!(text, "{:margin$} {bar} {:caret$}{underline}", "", "");
    margin
}

/// Gives the line as it is shown, the column of the caret in it from 0, and how many carets.
fn excerpt(source: &Source, number: usize, place: Place) -> (String, usize, usize) {
    let (line_start, line) = source.line(number);
    let from = (place.start as usize).saturating_sub(line_start);
    let to = (place.end as usize).saturating_sub(line_start).min(line.len());
    let mut shown: Vec<char> = Vec::new();
    let mut caret = None;
    let mut caret_end = None;
    for (at, character) in line.char_indices() {
        if at >= from && caret.is_none() {
            caret = Some(shown.len());
        }
        if at >= to && caret_end.is_none() {
            caret_end = Some(shown.len());
        }
        push_visible(&mut shown, character);
    }
    let caret = caret.unwrap_or(shown.len());
    let caret_end = caret_end.unwrap_or(shown.len()).max(caret + 1);
    if shown.len() <= WIDTH {
        return (shown.into_iter().collect(), caret, caret_end - caret);
    }
    let first = caret.saturating_sub(WIDTH / 2);
    let last = shown.len().min(first + WIDTH);
    let lead = if first > 0 { "…" } else { "" };
    let trail = if last < shown.len() { "…" } else { "" };
    let middle: String = shown[first..last].iter().collect();
    let column = caret - first + lead.chars().count();
    (
        format!("{lead}{middle}{trail}"),
        column,
        caret_end.min(last.max(caret + 1)) - caret,
    )
}

fn push_visible(shown: &mut Vec<char>, character: char) {
    match character {
        '\t' => shown.extend([' '; TAB]),
        c if c.is_control() || is_direction_mark(c) => shown.push('\u{fffd}'),
        c => shown.push(c),
    }
}

/// Characters that reorder what a terminal shows.
fn is_direction_mark(c: char) -> bool {
    matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Makes text from a file harmless for a terminal, and short.
fn visible(text: &str) -> String {
    let mut shown = Vec::new();
    for character in text.chars() {
        push_visible(&mut shown, character);
    }
    shown.into_iter().collect()
}

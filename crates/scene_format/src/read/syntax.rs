//! ron's errors in plain words.

use ron::error::{Error, SpannedError};

use super::Reader;
use crate::diagnostic::Diagnostic;
use crate::lex;
use crate::source::{Place, Source};

/// Explains why the structure of `text`, which begins at byte `base` of the file, cannot be read.
pub(super) fn explain(reader: &Reader<'_, '_>, text: &str, base: usize, error: &SpannedError) -> Diagnostic {
    let place = place_of(reader, text, base, error);
    let (code, message, note) = words(&error.code, found_at(reader, place));
    let mut diagnostic = Diagnostic::error(code, message).at(place);
    if error.code == Error::Eof
        && let Some(open) = lex::unclosed_bracket(text)
    {
        let place = reader.place_at(base + open, base + open + 1);
        return diagnostic.also(place, format!("this `{}` is never closed", found_at(reader, place)));
    }
    if let Some(note) = note {
        diagnostic = diagnostic.note(note);
    }
    diagnostic
}

/// Gives the token that ron stopped at.
pub(super) fn place_of(reader: &Reader<'_, '_>, text: &str, base: usize, error: &SpannedError) -> Place {
    let position = match error.code {
        // The cursor is behind the name, which is what is wrong.
        Error::ExpectedDifferentStructName { .. }
        | Error::NoSuchEnumVariant { .. }
        | Error::NoSuchExtension(_)
        | Error::InvalidIntegerDigit { .. }
        | Error::IntegerOutOfBounds
        | Error::FloatUnderscore => error.span.start,
        _ => error.span.end,
    };
    let offset = Source::offset_of(text, position.line, position.col);
    let mut start = lex::skip_trivia(text, offset);
    if matches!(
        error.code,
        Error::IntegerOutOfBounds | Error::InvalidIntegerDigit { .. }
    ) {
        // ron has gone on past the number.
        start = lex::token_before(text, start);
    }
    let end = lex::token_end(text, start);
    // A text that is never closed would be underlined to the end of the file.
    let end = text[start..end].find('\n').map_or(end, |at| start + at);
    reader.place_at(base + start, base + end)
}

fn found_at<'a>(reader: &Reader<'a, '_>, place: Place) -> &'a str {
    &reader.text[place.start as usize..place.end as usize]
}

fn words(error: &Error, found: &str) -> (&'static str, String, Option<String>) {
    let found = if found.is_empty() {
        "the end of the file".to_owned()
    } else {
        format!("`{found}`")
    };
    let expected = |what: &str| format!("expected {what}, found {found}");
    let (message, note) = match error {
        Error::Eof => (
            "the file ends too early".to_owned(),
            Some("a bracket or a quote is not closed"),
        ),
        Error::ExpectedComma => (
            expected("a comma"),
            Some("is a comma missing before this, or a bracket not closed?"),
        ),
        Error::ExpectedMapColon => (expected("a colon"), None),
        Error::ExpectedMap => (
            expected("`{`"),
            Some("named things are written `{\"Name\": Def(..), ..}`"),
        ),
        Error::ExpectedMapEnd => (expected("`}`"), None),
        Error::ExpectedArray => (expected("`[`"), Some("lists are written `[a, b]`")),
        Error::ExpectedArrayEnd => (expected("`]`"), None),
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => {
            (expected("`(`"), Some("fields are written `(name: value, ..)`"))
        }
        Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd => (expected("`)`"), None),
        Error::ExpectedString => (
            expected("a text in quotes"),
            Some("names that you invent are quoted: `\"/World\": Def(..)`"),
        ),
        Error::ExpectedStringEnd => ("a text in quotes is never closed".to_owned(), None),
        Error::ExpectedIdentifier | Error::InvalidIdentifier(_) => (
            expected("a name without quotes"),
            Some("names the program knows are bare: `Def`, `children`, `Camera`"),
        ),
        Error::ExpectedDifferentStructName { expected: name, .. } => (expected(&format!("`{name}`")), None),
        Error::UnclosedBlockComment => ("a comment is never closed".to_owned(), None),
        Error::UnclosedLineComment => ("a comment runs to the end of the file".to_owned(), None),
        Error::TrailingCharacters => (
            format!("nothing can follow the end of `Layer(..)`, found {found}"),
            Some("is a closing bracket too many before this?"),
        ),
        Error::NoSuchExtension(name) => (
            format!("there is no RON extension `{name}`"),
            Some("`#![enable(implicit_some)]` is the one that scenes use, and it is on anyway"),
        ),
        Error::UnexpectedChar(c) => (format!("unexpected character `{c}`"), None),
        Error::ExceededRecursionLimit | Error::ExpectedRawValue => {
            let message = "values are nested too deep, or one is not closed".to_owned();
            return ("too-deep", message, None);
        }
        Error::Message(message) => return ("bad-name", message.clone(), None),
        other => (other.to_string(), None),
    };
    ("syntax", message, note.map(str::to_owned))
}

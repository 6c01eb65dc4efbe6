//! Just enough of RON's tokens to find where a value begins and ends.

use std::ops::Range;

/// Skips blanks and comments; gives the first byte after them.
pub(crate) fn skip_trivia(text: &str, mut at: usize) -> usize {
    loop {
        let rest = &text[at..];
        let blanks = rest.len() - rest.trim_start_matches(is_blank).len();
        at += blanks;
        let rest = &text[at..];
        if rest.starts_with("//") {
            at += rest.find('\n').map_or(rest.len(), |end| end + 1);
        } else if rest.starts_with("/*") {
            at += block_comment_length(rest);
        } else if blanks == 0 {
            return at;
        }
    }
}

/// What RON takes for a blank.
fn is_blank(c: char) -> bool {
    c.is_ascii_whitespace() || matches!(c, '\x0b' | '\u{85}' | '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}')
}

fn block_comment_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut depth = 0_usize;
    let mut at = 0;
    while at < bytes.len() {
        match (bytes[at], bytes.get(at + 1)) {
            (b'/', Some(b'*')) => {
                depth += 1;
                at += 2;
            }
            (b'*', Some(b'/')) => {
                depth -= 1;
                at += 2;
                if depth == 0 {
                    return at;
                }
            }
            _ => at += 1,
        }
    }
    bytes.len()
}

/// Gives the end of the token that begins at `at`, which is neither blank nor comment.
///
/// A token is a word or number, a text in quotes, or one other character.
pub(crate) fn token_end(text: &str, at: usize) -> usize {
    let rest = &text[at..];
    let Some(first) = rest.chars().next() else {
        return at;
    };
    if let Some(length) = quoted_length(rest) {
        return at + length;
    }
    if is_word(first) || matches!(first, '+' | '-' | '.') {
        let length = rest.find(|c: char| !is_word(c) && !matches!(c, '+' | '-' | '.'));
        return at + length.unwrap_or(rest.len());
    }
    at + first.len_utf8()
}

fn is_word(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

/// Gives the length of a text, raw text, byte text or character in quotes at the start of `text`.
fn quoted_length(text: &str) -> Option<usize> {
    let prefix = ["br", "b", "r", ""]
        .into_iter()
        .find(|prefix| text.starts_with(prefix))?;
    let raw = prefix.ends_with('r');
    let rest = &text[prefix.len()..];
    if raw {
        let hashes = rest.len() - rest.trim_start_matches('#').len();
        if rest[hashes..].starts_with('"') {
            let close = format!("\"{}", &rest[..hashes]);
            let body = prefix.len() + hashes + 1;
            return Some(
                text[body..]
                    .find(&close)
                    .map_or(text.len(), |end| body + end + close.len()),
            );
        }
        return None;
    }
    let quote = rest.bytes().next().filter(|&byte| byte == b'"' || byte == b'\'')?;
    let mut escaped = false;
    for (at, byte) in rest.bytes().enumerate().skip(1) {
        if escaped {
            escaped = false;
        } else if byte == b'\\' {
            escaped = true;
        } else if byte == quote {
            return Some(prefix.len() + at + 1);
        }
    }
    Some(text.len())
}

/// Gives the part of `text` without the blanks and comments around it.
pub(crate) fn trim(text: &str) -> Range<usize> {
    let start = skip_trivia(text, 0);
    let mut at = start;
    let mut end = start;
    while at < text.len() {
        end = token_end(text, at);
        at = skip_trivia(text, end);
    }
    start..end
}

/// Gives the word that a value begins with: `Samples` of `Samples({..})`.
pub(crate) fn first_word(text: &str) -> &str {
    let length = text.find(|c: char| !is_word(c)).unwrap_or(text.len());
    let word = &text[..length];
    if word.starts_with(|c: char| c.is_ascii_digit()) {
        return "";
    }
    word
}

/// Whether a value contains `..` outside of a text: RON's ranges of numbers.
pub(crate) fn has_number_range(text: &str) -> bool {
    let mut at = skip_trivia(text, 0);
    while at < text.len() {
        let end = token_end(text, at);
        if !text[at..end].ends_with(['"', '\'']) && text[at..end].contains("..") {
            return true;
        }
        at = skip_trivia(text, end);
    }
    false
}

/// Gives the start of the last word or number that begins before `at`, or `at` if there is none.
pub(crate) fn token_before(text: &str, at: usize) -> usize {
    let mut start = skip_trivia(text, 0);
    let mut last = at;
    while start < at {
        let end = token_end(text, start);
        if text[start..end].starts_with(|c: char| is_word(c) || matches!(c, '+' | '-' | '.')) {
            last = start;
        }
        start = skip_trivia(text, end);
    }
    last
}

/// Gives the innermost bracket that is open at the end.
pub(crate) fn unclosed_bracket(text: &str) -> Option<usize> {
    let mut open = Vec::new();
    let mut at = skip_trivia(text, 0);
    while at < text.len() {
        let end = token_end(text, at);
        match &text[at..end] {
            "(" | "[" | "{" => open.push(at),
            ")" | "]" | "}" => {
                open.pop();
            }
            _ => {}
        }
        at = skip_trivia(text, end);
    }
    open.pop()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_values_between_comments() {
        for (text, value) in [
            ("  1.5 ", "1.5"),
            ("/* a /* b */ */ (1, /* c */ 2) // d", "(1, /* c */ 2)"),
            ("\"// no\" ", "\"// no\""),
            ("// only", ""),
            (r##"r#"a"b"# // x"##, r##"r#"a"b"#"##),
            ("'\\'' ", "'\\''"),
            ("/* never closed", ""),
        ] {
            assert_eq!(&text[trim(text)], value, "{text}");
        }
    }

    #[test]
    fn sees_ranges_outside_of_texts_only() {
        assert!(has_number_range("1..3"));
        assert!(has_number_range("(1, ..=2)"));
        assert!(!has_number_range("\"../a\""));
        assert!(!has_number_range("1.5"));
    }
}

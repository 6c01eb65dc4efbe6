//! Lines of an OBJ or MTL file.

use std::borrow::Cow;

/// Gives the lines of a text with their numbers, from 1. A line that ends in `\` goes on in the
/// next one.
pub(crate) struct Lines<'t> {
    lines: std::iter::Enumerate<std::str::Lines<'t>>,
}

impl<'t> Lines<'t> {
    pub(crate) fn of(text: &'t str) -> Self {
        Self {
            lines: text.lines().enumerate(),
        }
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = (usize, Cow<'t, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let (at, first) = self.lines.next()?;
        let Some(start) = continued(first) else {
            return Some((at + 1, Cow::Borrowed(first)));
        };
        let mut joined = start.to_owned();
        for (_, next) in self.lines.by_ref() {
            joined.push(' ');
            match continued(next) {
                Some(start) => joined.push_str(start),
                None => {
                    joined.push_str(next);
                    break;
                }
            }
        }
        Some((at + 1, Cow::Owned(joined)))
    }
}

fn continued(line: &str) -> Option<&str> {
    line.trim_end().strip_suffix('\\')
}

/// Gives the words of a line up to a comment.
pub(crate) fn words(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split_once('#').map_or(line, |(code, _)| code);
    code.split_whitespace()
}

/// Splits a line behind its first word; the rest is a name, which may hold blanks and `#`.
pub(crate) fn keyword_and_rest(line: &str) -> (&str, &str) {
    let line = line.trim();
    match line.split_once(char::is_whitespace) {
        Some((keyword, rest)) => (keyword, rest.trim()),
        None => (line, ""),
    }
}

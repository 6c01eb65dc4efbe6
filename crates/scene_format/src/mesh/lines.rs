//! Lines of an OBJ file.

use std::borrow::Cow;

/// Gives the lines of a text with their numbers, from 1. A line that ends in `\` goes on in the
/// next one.
pub(super) struct Lines<'t> {
    lines: std::iter::Enumerate<std::str::Lines<'t>>,
}

impl<'t> Lines<'t> {
    pub(super) fn of(text: &'t str) -> Self {
        Self {
            lines: text.lines().enumerate(),
        }
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = (usize, Cow<'t, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let (at, first) = self.lines.next()?;
        let mut line = Cow::Borrowed(first);
        while let Some(start) = line.trim_end().strip_suffix('\\') {
            let mut joined = start.to_owned();
            joined.push(' ');
            let next = self.lines.next();
            joined.push_str(next.map_or("", |(_, text)| text));
            line = Cow::Owned(joined);
        }
        Some((at + 1, line))
    }
}

/// Gives the words of a line up to a comment.
pub(super) fn words(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split_once('#').map_or(line, |(code, _)| code);
    code.split_whitespace()
}

//! The texts that a scene was made of, and places in them.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of a text in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceId(u32);

/// A range of bytes of one text: where something was written.
///
/// 12 bytes, so that every opinion can carry one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Which text.
    pub source: SourceId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// Where a text came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A file; names in it are relative to this folder.
    File { folder: PathBuf },
    /// What a model file was translated to; names in it are relative to the model's folder.
    Model { folder: PathBuf },
    /// An argument of the command line.
    Argument,
}

/// Why a file was read: who names it, and as what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reached {
    /// The name, in the file that names it.
    pub(crate) place: Place,
    /// `sublayers`, `references` or `payloads`.
    pub(crate) word: &'static str,
}

/// One text with its name and its line starts.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) text: String,
    pub(crate) origin: Origin,
    /// None for the first file.
    pub(crate) reached: Option<Reached>,
    line_starts: Vec<u32>,
}

impl Source {
    fn new(name: String, text: String, origin: Origin, reached: Option<Reached>) -> Self {
        let mut line_starts = vec![0];
        line_starts.extend(
            text.bytes()
                .enumerate()
                .filter(|&(_, byte)| byte == b'\n')
                .map(|(at, _)| at as u32 + 1),
        );
        Self {
            name,
            text,
            origin,
            reached,
            line_starts,
        }
    }

    /// Gives line and column, both from 1, the column counted in characters.
    pub(crate) fn line_column(&self, offset: u32) -> (usize, usize) {
        let line = self.line_starts.partition_point(|&start| start <= offset);
        let start = self.line_starts[line - 1] as usize;
        let end = floor_boundary(&self.text, offset as usize);
        (line, 1 + self.text[start..end.max(start)].chars().count())
    }

    /// Gives one line without its end, counted from 1, and where it starts.
    pub(crate) fn line(&self, line: usize) -> (usize, &str) {
        let start = self.line_starts[line - 1] as usize;
        let end = self
            .line_starts
            .get(line)
            .map_or(self.text.len(), |&next| next as usize - 1);
        (start, self.text[start..end].trim_end_matches('\r'))
    }

    /// Gives the byte offset of a line and a column in characters, both from 1.
    pub(crate) fn offset_of(text: &str, line: usize, column: usize) -> usize {
        let mut start = 0;
        for _ in 1..line {
            match text[start..].find('\n') {
                Some(at) => start += at + 1,
                None => return text.len(),
            }
        }
        text[start..]
            .char_indices()
            .nth(column.saturating_sub(1))
            .map_or(text.len(), |(at, _)| start + at)
    }
}

fn floor_boundary(text: &str, offset: usize) -> usize {
    let mut at = offset.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// All the texts of one load; cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    list: Vec<Arc<Source>>,
}

impl Sources {
    /// Adds a file; other files that it names are relative to `folder`.
    pub(crate) fn add_file(&mut self, name: &str, folder: &Path, text: String, reached: Option<Reached>) -> SourceId {
        let origin = Origin::File {
            folder: folder.to_path_buf(),
        };
        self.add(Source::new(name.to_owned(), text, origin, reached))
    }

    /// Adds what a model file was translated to.
    pub(crate) fn add_model(&mut self, name: &str, folder: &Path, text: String, reached: Option<Reached>) -> SourceId {
        let origin = Origin::Model {
            folder: folder.to_path_buf(),
        };
        self.add(Source::new(name.to_owned(), text, origin, reached))
    }

    /// Gives the name to show for a file that another one names as `written`: beside that one.
    pub(crate) fn shown_beside(&self, naming: SourceId, written: &str) -> String {
        let mut parts: Vec<&str> = self.name(naming).split('/').collect();
        parts.pop();
        for part in written.split('/') {
            match part {
                "." => {}
                ".." if parts.last().is_some_and(|last| !matches!(*last, ".." | "." | "")) => {
                    parts.pop();
                }
                part => parts.push(part),
            }
        }
        parts.join("/")
    }

    /// Adds an argument such as `/W.Camera.fov=35` given to `flag`.
    pub(crate) fn add_argument(&mut self, flag: &str, text: &str) -> SourceId {
        self.add(Source::new(flag.to_owned(), text.to_owned(), Origin::Argument, None))
    }

    fn add(&mut self, source: Source) -> SourceId {
        self.list.push(Arc::new(source));
        SourceId(self.list.len() as u32 - 1)
    }

    pub(crate) fn get(&self, id: SourceId) -> Option<&Arc<Source>> {
        self.list.get(id.0 as usize)
    }

    /// Gives the name of a text as it is shown to people: a file name, or the flag of an argument.
    pub fn name(&self, id: SourceId) -> &str {
        self.get(id).map_or("", |source| &source.name)
    }

    /// Whether a text is an argument of the command line.
    pub fn is_argument(&self, id: SourceId) -> bool {
        self.get(id).is_some_and(|source| source.origin == Origin::Argument)
    }

    /// Gives line and column, both counted from 1, the column in characters.
    pub fn line_column(&self, place: Place) -> (usize, usize) {
        self.get(place.source)
            .map_or((1, 1), |source| source.line_column(place.start))
    }

    /// Gives the words at a place.
    pub fn text(&self, place: Place) -> &str {
        self.get(place.source)
            .and_then(|source| source.text.get(place.start as usize..place.end as usize))
            .unwrap_or("")
    }

    /// Says where a place is: `scene.ron:14:32`; for an argument its flag.
    pub fn describe(&self, place: Place) -> impl fmt::Display + '_ {
        let (_, column) = self.line_column(place);
        fmt::from_fn(move |f| {
            write!(f, "{}", self.describe_line(place))?;
            if self.is_argument(place.source) {
                return Ok(());
            }
            write!(f, ":{column}")
        })
    }

    /// Says in which line a place is: `scene.ron:14`; for an argument its flag, for a model
    /// `spot.obj, as RON:14`, a line of what it was translated to.
    pub fn describe_line(&self, place: Place) -> impl fmt::Display + '_ {
        let (line, _) = self.line_column(place);
        let found = self.get(place.source);
        fmt::from_fn(move |f| {
            let Some(source) = found else { return Ok(()) };
            match source.origin {
                Origin::File { .. } => write!(f, "{}:{line}", source.name),
                Origin::Model { .. } => write!(f, "{}, as RON:{line}", source.name),
                Origin::Argument => write!(f, "{}", source.name),
            }
        })
    }

}

//! What went wrong, where, and what to do about it.

use std::collections::BTreeSet;
use std::fmt;

use crate::render::render;
use crate::source::{Place, Sources};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The scene is refused.
    Error,
    /// The scene is used; the person should know.
    Warning,
}

/// One message with the place that caused it.
///
/// Other crates raise their own with [`Diagnostic::error`] and the methods that add to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// A stable name for the kind of trouble, in `kebab-case`.
    pub code: &'static str,
    /// Whether the scene is refused.
    pub severity: Severity,
    /// One sentence without a full stop.
    pub message: String,
    /// What to underline.
    pub place: Option<Place>,
    /// What to say beside the underline.
    pub label: Option<String>,
    /// A name that was probably meant.
    pub suggestion: Option<String>,
    /// Further places that take part, each with what it is.
    pub related: Vec<(Place, String)>,
    /// Background and remedies, one a line.
    pub notes: Vec<String>,
}

impl Diagnostic {
    /// Starts an error.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            place: None,
            label: None,
            suggestion: None,
            related: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Starts a warning.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, message)
        }
    }

    /// Underlines `place`.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place = Some(place);
        self
    }

    /// Says something beside the underline.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }

    /// Proposes a name, if there is one.
    #[must_use]
    pub fn suggest(mut self, name: Option<&str>) -> Self {
        self.suggestion = name.map(str::to_owned);
        self
    }

    /// Points to a further place.
    #[must_use]
    pub fn also(mut self, place: Place, what: impl Into<String>) -> Self {
        self.related.push((place, what.into()));
        self
    }

    /// Adds a line of background or a remedy.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// Writes the message the way a person reads it; see [`Diagnostics`] for an example.
    pub fn render(&self, sources: &Sources, colour: bool) -> String {
        render(self, sources, colour)
    }
}

/// Everything that is wrong with a scene, up to a limit, in the order of the text.
///
/// ```text
/// error[unknown-field]: `Camera` has no field `fvo`
///   --> scene.ron:3:29
///    |
///  3 |     "/W": Def(Camera: (fvo: 35)),
///    |                        ^^^ did you mean `fov`?
///    = fields of Camera: fov (pipeline schema Camera)
/// ```
#[derive(Clone, Debug)]
pub struct Diagnostics {
    /// The texts that the places refer to.
    pub sources: Sources,
    /// The messages.
    pub list: Vec<Diagnostic>,
    /// How many more there were.
    pub omitted: usize,
}

impl Diagnostics {
    /// Writes all messages, separated by blank lines.
    pub fn render(&self, colour: bool) -> String {
        let mut text = String::new();
        for (number, diagnostic) in self.list.iter().enumerate() {
            if number > 0 {
                text.push('\n');
            }
            text.push_str(&diagnostic.render(&self.sources, colour));
        }
        if self.omitted > 0 {
            text.push_str(&format!("\nand {} more\n", self.omitted));
        }
        text
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}

/// At most this many errors are reported at once.
const MOST_ERRORS: usize = 20;

/// At most this many warnings, since each may come from every reference to one file.
const MOST_WARNINGS: usize = 50;

/// Collects messages while a scene is read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    pub(crate) errors: Vec<Diagnostic>,
    pub(crate) warnings: Vec<Diagnostic>,
    pub(crate) omitted: usize,
    pub(crate) omitted_warnings: usize,
    said: BTreeSet<(&'static str, Option<Place>, String)>,
}

impl Report {
    pub(crate) fn push(&mut self, diagnostic: Diagnostic) {
        if diagnostic.severity == Severity::Warning {
            if self.warnings.len() < MOST_WARNINGS {
                self.warnings.push(diagnostic);
            } else {
                self.omitted_warnings += 1;
            }
        } else if self.errors.len() < MOST_ERRORS {
            self.errors.push(diagnostic);
        } else {
            self.omitted += 1;
        }
    }

    /// Adds a message unless the same was said of the same place before: one mistake in a file may
    /// be met on the way to many prims.
    pub(crate) fn push_once(&mut self, diagnostic: Diagnostic) {
        if self
            .said
            .insert((diagnostic.code, diagnostic.place, diagnostic.message.clone()))
        {
            self.push(diagnostic);
        }
    }

    /// Takes back what was said since, except about files, which are not read again.
    pub(crate) fn forget_since(&mut self, before: Self) {
        let now = std::mem::replace(self, before);
        for warning in now.warnings {
            if warning.code == "odd-model" {
                self.push_once(warning);
            }
        }
    }

    /// Whether a further error would be shown; if not, suggestions for it are not worth their time.
    pub(crate) fn has_room(&self) -> bool {
        self.errors.len() < MOST_ERRORS
    }

    /// Ends with the warnings, and how many more there were.
    pub(crate) fn into_warnings(mut self) -> Vec<Diagnostic> {
        if self.omitted_warnings > 0 {
            let message = format!("and {} more warnings", self.omitted_warnings);
            self.warnings.push(Diagnostic::warning("more-warnings", message));
        }
        self.warnings
    }

    pub(crate) fn is_refused(&self) -> bool {
        !self.errors.is_empty()
    }

    /// Ends with the errors in the order of the text.
    pub(crate) fn into_diagnostics(mut self, sources: Sources) -> Diagnostics {
        self.errors.sort_by_key(|error| error.place);
        Diagnostics {
            sources,
            list: self.errors,
            omitted: self.omitted,
        }
    }
}

/// Longer words are not compared with others, which takes time with the square of their length.
const LONGEST_GUESS: usize = 300;

/// Finds the name that was probably meant.
///
/// The nearest by Damerau-Levenshtein distance, if at most a third of it (and one at least) differs;
/// on a tie the first.
pub(crate) fn nearest<'n>(word: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    if word.len() > LONGEST_GUESS {
        return None;
    }
    let limit = (word.chars().count() / 3).max(1);
    let folded = word.to_ascii_lowercase();
    let mut best: Option<(usize, &str)> = None;
    for name in names {
        if name.len().abs_diff(word.len()) > limit * 4 {
            continue;
        }
        let distance = strsim::damerau_levenshtein(&folded, &name.to_ascii_lowercase());
        if distance <= limit && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, name));
        }
    }
    best.map(|(_, name)| name)
}

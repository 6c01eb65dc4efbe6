//! From text to a [`Layer`]: visitors for the structure, reflection for the values.
//!
//! ron hands out slices of the text it reads; the distance of their pointers is the place of
//! everything that is written, also of what is right.

mod check;
mod component;
mod fields;
mod leaf;
mod prim;
mod syntax;
mod value;

use std::cell::{Cell, RefCell};

use ron::extensions::Extensions;
use serde::de::DeserializeSeed;

use crate::diagnostic::{Diagnostic, Report};
use crate::layer::Layer;
use crate::options::{DEEPEST, Limits};
use crate::schema::Schema;
use crate::source::{Place, SourceId, Sources};

pub(crate) use component::{unknown_component, unknown_field};

/// ron counts five levels for each prim; what is left serves values.
const RON_LEVELS: usize = 5 * DEEPEST + 192;
/// A value by itself is nested less.
const VALUE_LEVELS: usize = 64;
/// Files are read on a thread of their own, so that all levels fit wherever a program loads from:
/// in a build without optimisation they need more than the 2 MiB that threads have by default.
const STACK_BYTES: usize = 32 << 20;

/// Everything that reading one text needs.
pub(crate) struct Reader<'a, 'r> {
    pub(crate) schema: &'a Schema<'r>,
    pub(crate) limits: &'a Limits,
    pub(crate) source: SourceId,
    text: &'a str,
    report: &'a RefCell<Report>,
    prims: Cell<usize>,
    opinions: Cell<usize>,
    /// Set with an error that was reported and ends the reading.
    stopped: Cell<bool>,
}

impl<'a, 'r> Reader<'a, 'r> {
    pub(crate) fn new(
        schema: &'a Schema<'r>,
        limits: &'a Limits,
        source: SourceId,
        text: &'a str,
        report: &'a RefCell<Report>,
    ) -> Self {
        Self {
            schema,
            limits,
            source,
            text,
            report,
            prims: Cell::new(0),
            opinions: Cell::new(0),
            stopped: Cell::new(false),
        }
    }

    pub(crate) fn report(&self, diagnostic: Diagnostic) {
        self.report.borrow_mut().push(diagnostic);
    }

    /// Reports an error after which nothing can be read, and gives what ron wants in such a case.
    fn stop<E: serde::de::Error>(&self, diagnostic: Diagnostic) -> E {
        self.report(diagnostic);
        self.stopped.set(true);
        E::custom("stopped")
    }

    /// Gives the place of a slice of the text.
    pub(crate) fn place(&self, slice: &str) -> Place {
        let start = (slice.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        self.place_at(start, start + slice.len())
    }

    fn place_at(&self, start: usize, end: usize) -> Place {
        let fit = |at: usize| at.min(self.text.len()) as u32;
        Place {
            source: self.source,
            start: fit(start),
            end: fit(end),
        }
    }

    /// Counts one more prim, field and so on; false with the first one too many.
    fn count(counter: &Cell<usize>, most: usize) -> bool {
        counter.set(counter.get() + 1);
        counter.get() <= most
    }
}

fn file_options() -> ron::Options {
    value_options().with_recursion_limit(RON_LEVELS)
}

fn value_options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_recursion_limit(VALUE_LEVELS)
}

/// Reads one file. What is wrong goes to the report; `None` if the structure could not be read.
pub(crate) fn read_layer(
    sources: &Sources,
    source: SourceId,
    schema: &Schema<'_>,
    limits: &Limits,
    report: &RefCell<Report>,
) -> Option<Layer> {
    let text = &sources.get(source)?.text;
    let mut collected = report.take();
    let layer = std::thread::scope(|scope| {
        let read = || {
            let own = RefCell::new(std::mem::take(&mut collected));
            let layer = read_text(text, source, schema, limits, &own);
            collected = own.into_inner();
            layer
        };
        let thread = std::thread::Builder::new()
            .stack_size(STACK_BYTES)
            .spawn_scoped(scope, read)
            .expect("a program that cannot start a thread cannot render either");
        match thread.join() {
            Ok(layer) => layer,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    });
    report.replace(collected);
    layer
}

fn read_text(
    text: &str,
    source: SourceId,
    schema: &Schema<'_>,
    limits: &Limits,
    report: &RefCell<Report>,
) -> Option<Layer> {
    let reader = Reader::new(schema, limits, source, text, report);
    if let Some(at) = text.find('\0') {
        reader
            .report(Diagnostic::error("syntax", "a scene cannot contain a zero byte").at(reader.place_at(at, at + 1)));
        return None;
    }
    if text[crate::lex::skip_trivia(text, 0)..].is_empty() {
        reader.report(
            Diagnostic::error("syntax", "the file is empty")
                .at(reader.place_at(0, 0))
                .note("the least scene is `Layer()`"),
        );
        return None;
    }
    let mut deserializer = match ron::Deserializer::from_str_with_options(text, &file_options()) {
        Ok(deserializer) => deserializer,
        Err(error) => {
            reader.report(syntax::explain(&reader, text, 0, &error));
            return None;
        }
    };
    let result = fields::LayerSeed(&reader)
        .deserialize(&mut deserializer)
        .and_then(|layer| deserializer.end().map(|()| layer));
    match result {
        Ok(layer) => Some(layer),
        Err(_) if reader.stopped.get() => None,
        Err(error) => {
            let error = deserializer.span_error(error);
            reader.report(syntax::explain(&reader, text, 0, &error));
            None
        }
    }
}

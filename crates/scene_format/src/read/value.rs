//! The value of a component's field: text to type, through reflection.

use std::fmt;

use bevy_reflect::PartialReflect;
use bevy_reflect::TypeInfo;
use bevy_reflect::serde::TypedReflectDeserializer;
use ron::value::RawValue;
use serde::de::{DeserializeSeed, Deserializer, MapAccess, Visitor};

use super::{Reader, check, syntax, value_options};
use crate::attributes::Shorthand;
use crate::diagnostic::{Diagnostic, nearest};
use crate::layer::{FieldOpinion, ListEdit};
use crate::lex;
use crate::schema::{FieldInfo, FieldKind, held_by_option, make_concrete};
use crate::schema_text::describe_type;

impl Reader<'_, '_> {
    /// Reads what is written for a field: a value, samples of it, `Block`, or an edit of a list of
    /// prims. What is wrong is reported.
    pub(crate) fn field_value(&self, component: &str, field: &FieldInfo, raw: &str) -> Option<FieldOpinion> {
        match lex::first_word(raw) {
            "Block" if raw == "Block" => return Some(FieldOpinion::Block),
            "Block" => {
                self.report(Diagnostic::error("syntax", "`Block` stands alone, without a value").at(self.place(raw)));
                return None;
            }
            "Samples" if field.kind == FieldKind::Value => {
                return self.samples(component, field, raw);
            }
            "Samples" => {
                let message = format!("`{component}.{}` cannot change over time", field.name);
                self.report(Diagnostic::error("wrong-type", message).at(self.place(raw)));
                return None;
            }
            "Edit" if field.kind == FieldKind::Value => {
                let message = "`Edit` changes lists of prims and files, not values";
                self.report(
                    Diagnostic::error("wrong-type", message)
                        .at(self.place(raw))
                        .note("write the whole value: it replaces the weaker one"),
                );
                return None;
            }
            _ => {}
        }
        match field.kind {
            FieldKind::Value => self.typed(component, field, raw).map(FieldOpinion::Constant),
            FieldKind::Target { .. } | FieldKind::Targets { .. } => {
                self.targets(field.kind, raw).map(FieldOpinion::Targets)
            }
        }
    }

    fn targets(&self, kind: FieldKind, raw: &str) -> Option<ListEdit<crate::layer::Spanned<String>>> {
        let optional = matches!(
            kind,
            FieldKind::Target { optional: true } | FieldKind::Targets { optional: true }
        );
        if optional && raw == "None" {
            return Some(ListEdit::Explicit(Vec::new()));
        }
        let edit = self.path_edit(raw)?;
        if matches!(kind, FieldKind::Target { .. })
            && let ListEdit::Explicit(items) = &edit
            && items.len() > 1
        {
            let message = format!("this names one prim, not {}", items.len());
            self.report(Diagnostic::error("wrong-type", message).at(self.place(raw)));
            return None;
        }
        Some(edit)
    }

    /// Reads one value of the field's type, and checks it.
    fn typed(&self, component: &str, field: &FieldInfo, raw: &str) -> Option<Box<dyn PartialReflect>> {
        let registry = self.schema.registry();
        let registration = registry.get(field.type_id)?;
        let seed = TypedReflectDeserializer::new(registration, registry);
        let value = match value_options().from_str_seed(raw, seed) {
            Ok(value) => make_concrete(value, registration),
            Err(error) => {
                self.report(self.wrong_type(component, field, raw, &error));
                return None;
            }
        };
        if let Err(problem) = check::check(&*value, field, self.limits) {
            let message = format!("`{component}.{}` {}", field.name, problem.message);
            self.report(Diagnostic::error(problem.code, message).at(self.place(raw)));
            return None;
        }
        Some(value)
    }

    fn wrong_type(
        &self,
        component: &str,
        field: &FieldInfo,
        raw: &str,
        error: &ron::error::SpannedError,
    ) -> Diagnostic {
        let registry = self.schema.registry();
        let wanted = describe_type(field.type_info, registry);
        let message = format!("`{component}.{}` must be {wanted}", field.name);
        let whole = self.place(raw);
        let inside = syntax::place_of(self, raw, whole.start as usize, error);
        let compound = raw.starts_with(['(', '[', '{']);
        let place = if compound && inside.start < whole.end {
            inside
        } else {
            whole
        };
        let mut diagnostic = Diagnostic::error("wrong-type", message).at(place);
        let held = held_by_option(field.type_info).and_then(|held| registry.get_type_info(held));
        if let TypeInfo::Enum(variants) = held.unwrap_or(field.type_info)
            && held_by_option(field.type_info).is_none_or(|_| held.is_some())
        {
            let word = raw.trim_matches('"');
            diagnostic = diagnostic.suggest(nearest(word, variants.variant_names().iter().copied()));
            if raw.starts_with('"') {
                diagnostic = diagnostic.note("values that the program knows are written without quotes");
            }
        } else if let Some(note) = complaint(held.unwrap_or(field.type_info), &error.code) {
            diagnostic = diagnostic.note(note);
        } else if lex::has_number_range(raw) {
            diagnostic = diagnostic.note("ranges of numbers are not values");
        } else if let Some(count) = wanted.split(' ').next().and_then(|word| word.parse().ok()) {
            let items: Vec<String> = (1..=usize::min(count, 16)).map(|n| n.to_string()).collect();
            diagnostic = diagnostic.note(format!("written as `({})`", items.join(", ")));
        }
        diagnostic
    }

    /// Reads `Samples({0: value, 24: value})`.
    fn samples(&self, component: &str, field: &FieldInfo, raw: &str) -> Option<FieldOpinion> {
        let written = match value_options().from_str_seed(raw, SamplesSeed) {
            Ok(written) => written,
            Err(error) => {
                let base = self.place(raw).start as usize;
                self.report(
                    Diagnostic::error("wrong-type", "this must be `Samples({time: value, ..})`")
                        .at(syntax::place_of(self, raw, base, &error)),
                );
                return None;
            }
        };
        if written.is_empty() || written.len() > self.limits.samples {
            let message = format!(
                "a field has 1 to {} samples, this one {}",
                self.limits.samples,
                written.len()
            );
            self.report(Diagnostic::error("too-long", message).at(self.place(raw)));
            return None;
        }
        let mut samples = Vec::with_capacity(written.len());
        let mut complete = true;
        for (key, value) in written {
            let time: Option<f64> = self.leaf(key, "the time of a sample", "a number");
            let value = self.typed(component, field, value);
            match (time, value) {
                (Some(time), Some(value)) => samples.push((time, value, key)),
                _ => complete = false,
            }
        }
        complete &= self.check_times(&mut samples);
        complete.then(|| {
            let samples = samples.into_iter().map(|(time, value, _)| (time, value));
            FieldOpinion::Samples(samples.collect())
        })
    }

    /// Sorts samples by time; false if a time is not finite or there twice.
    fn check_times(&self, samples: &mut [(f64, Box<dyn PartialReflect>, &str)]) -> bool {
        let mut fine = true;
        for (time, _, key) in samples.iter() {
            if !time.is_finite() {
                let error = Diagnostic::error("not-finite", "the time of a sample must be finite");
                self.report(error.at(self.place(key)));
                fine = false;
            }
        }
        // Stable, so that of two equal times the one written later comes second.
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in samples.windows(2) {
            if pair[0].0 == pair[1].0 {
                let message = format!("there are two samples at time {}", pair[1].0);
                self.report(
                    Diagnostic::error("duplicate-sample", message)
                        .at(self.place(pair[1].2))
                        .also(self.place(pair[0].2), "first written"),
                );
                fine = false;
            }
        }
        fine
    }
}

/// What a type that reads itself says is wrong.
fn complaint(info: &TypeInfo, error: &ron::Error) -> Option<String> {
    let reads_itself = info.as_struct().is_ok_and(|found| found.has_attribute::<Shorthand>());
    match error {
        ron::Error::Message(text) if reads_itself => Some(text.clone()),
        _ => None,
    }
}

/// Reads `Samples({..})` into slices of the text.
struct SamplesSeed;

impl<'de> DeserializeSeed<'de> for SamplesSeed {
    type Value = Vec<(&'de str, &'de str)>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_newtype_struct("Samples", self)
    }
}

impl<'de> Visitor<'de> for SamplesSeed {
    type Value = Vec<(&'de str, &'de str)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("`Samples({time: value, ..})`")
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, inner: D) -> Result<Self::Value, D::Error> {
        inner.deserialize_map(self)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut samples = Vec::new();
        while let Some((key, value)) = map.next_entry::<&'de RawValue, &'de RawValue>()? {
            let trimmed = |raw: &'de RawValue| {
                let text = raw.get_ron();
                &text[lex::trim(text)]
            };
            samples.push((trimmed(key), trimmed(value)));
        }
        Ok(samples)
    }
}

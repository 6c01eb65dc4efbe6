//! Values that belong to the layering itself: texts, flags, lists of names, paths and files.

use ron::value::RawValue;
use serde::Deserialize;

use super::fields::{FieldSink, MapInto, Seen, StructInto, raw_value};
use super::{Reader, syntax, value_options};
use crate::diagnostic::{Diagnostic, nearest};
use crate::layer::{AssetArc, ListEdit, Selection, Spanned};
use crate::lex;
use crate::path;
use serde::de::{DeserializeSeed, MapAccess};

impl Reader<'_, '_> {
    /// Reads a value of a known type; `what` says in words what `name` wants.
    pub(super) fn leaf<'de, T: Deserialize<'de>>(&self, raw: &'de str, name: &str, what: &str) -> Option<T> {
        match value_options().from_str(raw) {
            Ok(value) => Some(value),
            Err(error) => {
                let base = self.place(raw).start as usize;
                self.report(
                    Diagnostic::error("wrong-type", format!("`{name}` must be {what}"))
                        .at(syntax::place_of(self, raw, base, &error)),
                );
                None
            }
        }
    }

    /// Reads into a sink; false after an error, which is reported.
    fn leaf_into<'de>(&self, raw: &'de str, seed: impl DeserializeSeed<'de, Value = ()>, message: &str) -> bool {
        let error = match value_options().from_str_seed(raw, seed) {
            Ok(()) => return true,
            Err(error) => error,
        };
        if !self.stopped.get() {
            let base = self.place(raw).start as usize;
            self.report(Diagnostic::error("wrong-type", message).at(syntax::place_of(self, raw, base, &error)));
        }
        false
    }

    /// Reads a text in quotes without escapes; the place is that of the text itself.
    pub(super) fn quoted(&self, raw: &str, what: &str) -> Option<Spanned<String>> {
        let inner = raw
            .strip_prefix('"')
            .and_then(|rest| rest.strip_suffix('"'))
            .filter(|_| lex::token_end(raw, 0) == raw.len());
        let Some(inner) = inner else {
            self.report(
                Diagnostic::error("wrong-type", format!("{what} must be a text in quotes")).at(self.place(raw)),
            );
            return None;
        };
        let place = self.place(inner);
        if inner.contains('\\') {
            self.report(Diagnostic::error("bad-name", format!("{what} cannot contain `\\`")).at(place));
            return None;
        }
        Some(Spanned {
            value: inner.to_owned(),
            place,
        })
    }

    /// Reads the items of a list as slices of the text.
    pub(super) fn list<'de>(&self, raw: &'de str, message: &str) -> Option<Vec<&'de str>> {
        let items: Vec<&'de RawValue> = match value_options().from_str(raw) {
            Ok(items) => items,
            Err(error) => {
                let base = self.place(raw).start as usize;
                self.report(Diagnostic::error("wrong-type", message).at(syntax::place_of(self, raw, base, &error)));
                return None;
            }
        };
        if items.len() > self.limits.list_items {
            let message = format!(
                "a list has at most {} items, this one {}",
                self.limits.list_items,
                items.len()
            );
            self.report(Diagnostic::error("too-long", message).at(self.place(raw)));
            return None;
        }
        let trimmed = |item: &&'de RawValue| {
            let text = item.get_ron();
            &text[lex::trim(text)]
        };
        Some(items.iter().map(trimmed).collect())
    }

    /// Reads a list of names.
    pub(super) fn names(&self, raw: &str) -> Vec<Spanned<String>> {
        let items = self.list(raw, "this must be a list of names in quotes");
        items
            .into_iter()
            .flatten()
            .filter_map(|item| self.quoted(item, "a name"))
            .collect()
    }

    /// Reads `"World"` or `"/World"`.
    pub(super) fn default_prim(&self, raw: &str) -> Option<Spanned<String>> {
        let mut name = self.quoted(raw, "`default_prim`")?;
        if !name.value.starts_with('/') {
            name.value.insert(0, '/');
        }
        if let Some(problem) = path::absolute_path_problem(&name.value, self.limits.name_bytes) {
            self.report(Diagnostic::error("bad-name", problem).at(name.place));
            return None;
        }
        Some(name)
    }

    /// Reads a list of paths, an edit of one, or one path.
    pub(super) fn path_edit(&self, raw: &str) -> Option<ListEdit<Spanned<String>>> {
        if raw.starts_with('"') {
            return Some(ListEdit::Explicit(vec![self.quoted(raw, "a path")?]));
        }
        self.edit(raw, "this must be a list of paths in quotes, or an `Edit`", |item| {
            self.quoted(item, "a path")
        })
    }

    /// Reads a list of files and prims, or an edit of one.
    pub(super) fn asset_edit(&self, raw: &str) -> Option<ListEdit<AssetArc>> {
        self.edit(raw, "this must be a list of files, or an `Edit`", |item| {
            self.asset(item)
        })
    }

    /// Reads a list of files.
    pub(super) fn assets(&self, raw: &str) -> Option<Vec<AssetArc>> {
        let items = self.list(raw, "this must be a list of files in quotes")?;
        items.into_iter().map(|item| self.asset(item)).collect()
    }

    fn edit<T>(&self, raw: &str, message: &str, read: impl Fn(&str) -> Option<T>) -> Option<ListEdit<T>> {
        let all = |raw: &str| -> Option<Vec<T>> { self.list(raw, message)?.into_iter().map(&read).collect() };
        if lex::first_word(raw) != "Edit" {
            return Some(ListEdit::Explicit(all(raw)?));
        }
        let mut sink = EditSink {
            reader: self,
            seen: Seen::default(),
            lists: [None; 3],
        };
        let seed = StructInto {
            name: "Edit",
            sink: &mut sink,
        };
        if !self.leaf_into(raw, seed, message) {
            return None;
        }
        let [prepend, append, delete] = sink.lists;
        let part = |raw: Option<&str>| raw.map_or(Some(Vec::new()), &all);
        Some(ListEdit::Edit {
            prepend: part(prepend)?,
            append: part(append)?,
            delete: part(delete)?,
        })
    }

    /// Reads `"file#/Prim"` or `(to: "file#/Prim", offset: 10, scale: 1)`.
    fn asset(&self, raw: &str) -> Option<AssetArc> {
        let mut sink = AssetSink {
            reader: self,
            seen: Seen::default(),
            to: None,
            offset: Some(0.0),
            scale: Some(1.0),
        };
        if raw.starts_with('(') {
            let seed = StructInto {
                name: "Asset",
                sink: &mut sink,
            };
            let message = "this must be `(to: \"..\", offset: .., scale: ..)`";
            if !self.leaf_into(raw, seed, message) {
                return None;
            }
            if sink.to.is_none() {
                let error = Diagnostic::error("missing-field", "`to` is missing");
                self.report(error.at(self.place(raw)));
            }
        } else {
            sink.to = self.quoted(raw, "a file");
        }
        Some(AssetArc {
            to: sink.to?,
            offset: sink.offset?,
            scale: sink.scale?,
        })
    }
}

const EDIT_FIELDS: [&str; 3] = ["prepend", "append", "delete"];

struct EditSink<'a, 'b, 'r, 'de> {
    reader: &'a Reader<'b, 'r>,
    seen: Seen<'de>,
    lists: [Option<&'de str>; 3],
}

impl<'de> FieldSink<'de> for EditSink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let raw = raw_value(map)?;
        self.seen.is_new(self.reader, key, "duplicate-field");
        match EDIT_FIELDS.iter().position(|&name| name == key) {
            Some(which) => self.lists[which] = Some(raw),
            None => self.reader.report(
                Diagnostic::error("unknown-keyword", format!("`Edit` has no field `{key}`"))
                    .at(self.reader.place(key))
                    .suggest(nearest(key, EDIT_FIELDS.into_iter()))
                    .note("fields of Edit: prepend, append, delete"),
            ),
        }
        Ok(())
    }
}

struct AssetSink<'a, 'b, 'r, 'de> {
    reader: &'a Reader<'b, 'r>,
    seen: Seen<'de>,
    to: Option<Spanned<String>>,
    offset: Option<f64>,
    scale: Option<f64>,
}

impl<'de> FieldSink<'de> for AssetSink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let raw = raw_value(map)?;
        let reader = self.reader;
        self.seen.is_new(reader, key, "duplicate-field");
        let number = |fine: fn(f64) -> bool, message: &str| {
            let number: f64 = reader.leaf(raw, key, "a number")?;
            if fine(number) {
                return Some(number);
            }
            reader.report(Diagnostic::error("bad-layer-offset", message).at(reader.place(raw)));
            None
        };
        match key {
            "to" => self.to = reader.quoted(raw, "`to`"),
            "offset" => self.offset = number(f64::is_finite, "`offset` must be finite"),
            "scale" => {
                let fine = |scale: f64| scale.is_finite() && scale > 0.0;
                self.scale = number(fine, "`scale` must be finite and above 0");
            }
            _ => reader.report(
                Diagnostic::error("unknown-keyword", format!("a file has no field `{key}`"))
                    .at(reader.place(key))
                    .suggest(nearest(key, ["to", "offset", "scale"].into_iter()))
                    .note("fields: to, offset, scale"),
            ),
        }
        Ok(())
    }
}

/// Reads `{"set": "variant", ..}`.
pub(super) fn read_select(reader: &Reader<'_, '_>, raw: &str) -> Option<Vec<Selection>> {
    let mut sink = SelectSink {
        reader,
        seen: Seen::default(),
        chosen: Vec::new(),
    };
    let message = "`select` must be `{\"set\": \"variant\", ..}`";
    reader
        .leaf_into(raw, MapInto(&mut sink), message)
        .then_some(sink.chosen)
}

struct SelectSink<'a, 'b, 'r, 'de> {
    reader: &'a Reader<'b, 'r>,
    seen: Seen<'de>,
    chosen: Vec<Selection>,
}

impl<'de> FieldSink<'de> for SelectSink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let raw = raw_value(map)?;
        self.seen.is_new(self.reader, key, "duplicate-field");
        let set = Spanned {
            value: key.to_owned(),
            place: self.reader.place(key),
        };
        if let Some(variant) = self.reader.quoted(raw, "a variant") {
            self.chosen.push((set, variant));
        }
        Ok(())
    }
}

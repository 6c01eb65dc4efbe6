//! Prims, their children and variants, and the components on them.

use std::fmt;

use serde::de::{self, DeserializeSeed, Deserializer, EnumAccess, MapAccess, VariantAccess, Visitor};

use super::Reader;
use super::component::{ComponentSink, unknown_component};
use super::fields::{FieldSink, Fields, MapInto, Seen, StructInto, raw_value};
use super::leaf::read_select;
use crate::diagnostic::{Diagnostic, nearest};
use crate::layer::{Body, ComponentSpec, PrimSpec, Spanned, Specifier, VariantSet};
use crate::options::DEEPEST;
use crate::path;

/// Reads `{"Name": Def(..), ..}`; at depth 0 the keys are paths.
pub(super) struct ChildrenSeed<'a, 'b, 'r> {
    pub(super) reader: &'a Reader<'b, 'r>,
    pub(super) depth: usize,
}

impl<'de> DeserializeSeed<'de> for ChildrenSeed<'_, '_, '_> {
    type Value = Vec<PrimSpec>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        let mut sink = ChildrenSink {
            reader: self.reader,
            depth: self.depth,
            seen: Seen::default(),
            prims: Vec::new(),
        };
        deserializer.deserialize_map(Fields(&mut sink))?;
        Ok(sink.prims)
    }
}

struct ChildrenSink<'a, 'b, 'r, 'de> {
    reader: &'a Reader<'b, 'r>,
    depth: usize,
    seen: Seen<'de>,
    prims: Vec<PrimSpec>,
}

impl<'de> FieldSink<'de> for ChildrenSink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let reader = self.reader;
        let longest = reader.limits.name_bytes;
        let (problem, depth) = if self.depth == 0 {
            let depth = key.matches('/').count().max(1);
            (path::absolute_path_problem(key, longest), depth)
        } else {
            (path::name_problem(key, longest), self.depth + 1)
        };
        let deepest = reader.limits.prim_depth.min(DEEPEST);
        if depth > deepest {
            let message = format!("prims are nested more than {deepest} deep");
            let error = Diagnostic::error("too-deep", message);
            return Err(reader.stop(error.at(reader.place(key))));
        }
        let fine = problem.is_none();
        if let Some(problem) = problem {
            let error = Diagnostic::error("bad-name", problem);
            reader.report(error.at(reader.place(key)));
        }
        let is_new = self.seen.is_new(reader, key, "duplicate-prim");
        if !Reader::count(&reader.prims, reader.limits.prims) {
            let message = format!("a scene has at most {} prims", reader.limits.prims);
            let error = Diagnostic::error("too-many-prims", message);
            return Err(reader.stop(error.at(reader.place(key))));
        }
        let (specifier, body) = map.next_value_seed(PrimSeed { reader, depth })?;
        if fine && is_new {
            self.prims.push(PrimSpec {
                key: spanned(reader, key),
                specifier,
                body,
            });
        }
        Ok(())
    }
}

fn spanned(reader: &Reader<'_, '_>, key: &str) -> Spanned<String> {
    Spanned {
        value: key.to_owned(),
        place: reader.place(key),
    }
}

const SPECIFIERS: [&str; 3] = ["Def", "Over", "Class"];

/// Reads `Def(..)`, `Over(..)` or `Class(..)`.
struct PrimSeed<'a, 'b, 'r> {
    reader: &'a Reader<'b, 'r>,
    depth: usize,
}

impl<'de> DeserializeSeed<'de> for PrimSeed<'_, '_, '_> {
    type Value = (Specifier, Body);

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_enum("Prim", &SPECIFIERS, self)
    }
}

impl<'de> Visitor<'de> for PrimSeed<'_, '_, '_> {
    type Value = (Specifier, Body);

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("`Def(..)`, `Over(..)` or `Class(..)`")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<Self::Value, A::Error> {
        let (word, access) = access.variant_seed(WordSeed)?;
        let specifier = match word {
            "Def" => Specifier::Def,
            "Over" => Specifier::Over,
            "Class" => Specifier::Class,
            _ => {
                let message = format!("`{word}` is not a kind of prim");
                let error = Diagnostic::error("unknown-keyword", message)
                    .at(self.reader.place(word))
                    .suggest(nearest(word, SPECIFIERS.into_iter()))
                    .note("kinds of prims: Def, Over, Class");
                return Err(self.reader.stop(error));
            }
        };
        let mut sink = BodySink::new(self.reader, self.depth);
        access.struct_variant(&[], Fields(&mut sink))?;
        Ok((specifier, sink.body))
    }
}

/// Reads a bare word.
struct WordSeed;

impl<'de> DeserializeSeed<'de> for WordSeed {
    type Value = &'de str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'de str, D::Error> {
        struct WordVisitor;
        impl<'de> Visitor<'de> for WordVisitor {
            type Value = &'de str;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a word")
            }

            fn visit_borrowed_str<E: de::Error>(self, word: &'de str) -> Result<&'de str, E> {
                Ok(word)
            }
        }
        deserializer.deserialize_identifier(WordVisitor)
    }
}

const PRIM_FIELDS: [&str; 12] = [
    "type",
    "doc",
    "active",
    "references",
    "payloads",
    "inherits",
    "specializes",
    "select",
    "variants",
    "without",
    "order",
    "children",
];

/// Takes what stands between the brackets of a prim or of a variant.
struct BodySink<'a, 'b, 'r, 'de> {
    reader: &'a Reader<'b, 'r>,
    depth: usize,
    seen: Seen<'de>,
    body: Body,
}

impl<'a, 'b, 'r> BodySink<'a, 'b, 'r, '_> {
    fn new(reader: &'a Reader<'b, 'r>, depth: usize) -> Self {
        Self {
            reader,
            depth,
            seen: Seen::default(),
            body: Body::default(),
        }
    }
}

impl<'de> FieldSink<'de> for BodySink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let reader = self.reader;
        let is_new = self.seen.is_new(reader, key, "duplicate-field");
        match key {
            "children" => {
                let children = map.next_value_seed(ChildrenSeed {
                    reader,
                    depth: self.depth,
                })?;
                if is_new {
                    self.body.children = children;
                }
                Ok(())
            }
            "variants" => {
                let mut sets = VariantsSink {
                    reader,
                    depth: self.depth,
                    seen: Seen::default(),
                    sets: Vec::new(),
                };
                map.next_value_seed(MapInto(&mut sets))?;
                self.body.variants = Some(Spanned {
                    value: sets.sets,
                    place: reader.place(key),
                });
                Ok(())
            }
            _ if key.starts_with(|first: char| first.is_ascii_uppercase()) => match reader.schema.index_of(key) {
                Some(index) => self.component(index, key, is_new, map),
                None => {
                    raw_value(map)?;
                    reader.report(unknown_component(reader.schema, key).at(reader.place(key)));
                    Ok(())
                }
            },
            _ => {
                let raw = raw_value(map)?;
                self.keyword(key, raw);
                Ok(())
            }
        }
    }
}

impl<'de> BodySink<'_, '_, '_, 'de> {
    fn component<A: MapAccess<'de>>(
        &mut self,
        index: usize,
        key: &'de str,
        is_new: bool,
        map: &mut A,
    ) -> Result<(), A::Error> {
        let reader = self.reader;
        let component = &reader.schema.components()[index];
        let mut sink = ComponentSink {
            reader,
            component,
            seen: Seen::default(),
            fields: Vec::new(),
        };
        map.next_value_seed(StructInto {
            name: component.name,
            sink: &mut sink,
        })?;
        if is_new {
            self.body.components.push(ComponentSpec {
                index,
                place: reader.place(key),
                fields: sink.fields,
            });
        }
        Ok(())
    }

    /// Takes a lower-case field whose value does not hold prims.
    fn keyword(&mut self, key: &'de str, raw: &'de str) {
        let reader = self.reader;
        let body = &mut self.body;
        let place = reader.place(key);
        match key {
            "type" => body.type_label = reader.leaf(raw, key, "a text in quotes"),
            "doc" => body.doc = reader.leaf(raw, key, "a text in quotes"),
            "active" => body.active = reader.leaf(raw, key, "`true` or `false`"),
            "references" => {
                body.references = reader.asset_edit(raw).map(|value| Spanned { value, place });
            }
            "payloads" => {
                body.payloads = reader.asset_edit(raw).map(|value| Spanned { value, place });
            }
            "inherits" => {
                body.inherits = reader.path_edit(raw).map(|value| Spanned { value, place });
            }
            "specializes" => {
                body.specializes = reader.path_edit(raw).map(|value| Spanned { value, place });
            }
            "select" => {
                body.select = read_select(reader, raw).map(|value| Spanned { value, place });
            }
            "without" => {
                body.without = reader.names(raw);
                for name in &body.without {
                    if reader.schema.index_of(&name.value).is_none() {
                        let error = unknown_component(reader.schema, &name.value);
                        reader.report(error.at(name.place));
                    }
                }
            }
            "order" => body.order = reader.names(raw),
            _ => reader.report(unknown_keyword(reader, key)),
        }
    }
}

fn unknown_keyword(reader: &Reader<'_, '_>, key: &str) -> Diagnostic {
    let error = Diagnostic::error("unknown-keyword", format!("a prim has no field `{key}`")).at(reader.place(key));
    if let Some(name) = nearest(key, PRIM_FIELDS.into_iter()) {
        return error.suggest(Some(name));
    }
    if let Some(name) = reader.schema.nearest_component(key) {
        return error.suggest(Some(name));
    }
    error.note(format!(
        "fields of a prim: {}; components begin with a capital letter",
        PRIM_FIELDS.join(", ")
    ))
}

/// Takes the sets of `variants: {"set": {"variant": (..), ..}, ..}`.
struct VariantsSink<'a, 'b, 'r, 'de> {
    reader: &'a Reader<'b, 'r>,
    depth: usize,
    seen: Seen<'de>,
    sets: Vec<VariantSet>,
}

impl<'de> FieldSink<'de> for VariantsSink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let reader = self.reader;
        check_name(reader, key);
        self.seen.is_new(reader, key, "duplicate-field");
        let mut sink = VariantSink {
            reader,
            depth: self.depth,
            seen: Seen::default(),
            variants: Vec::new(),
        };
        map.next_value_seed(MapInto(&mut sink))?;
        if sink.variants.len() > reader.limits.variants {
            let message = format!("a set has at most {} variants", reader.limits.variants);
            reader.report(Diagnostic::error("too-long", message).at(reader.place(key)));
        }
        self.sets.push(VariantSet {
            name: spanned(reader, key),
            variants: sink.variants,
        });
        Ok(())
    }
}

struct VariantSink<'a, 'b, 'r, 'de> {
    reader: &'a Reader<'b, 'r>,
    depth: usize,
    seen: Seen<'de>,
    variants: Vec<(Spanned<String>, Body)>,
}

impl<'de> FieldSink<'de> for VariantSink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let reader = self.reader;
        check_name(reader, key);
        self.seen.is_new(reader, key, "duplicate-field");
        let mut sink = BodySink::new(reader, self.depth);
        map.next_value_seed(StructInto {
            name: "Variant",
            sink: &mut sink,
        })?;
        self.variants.push((spanned(reader, key), sink.body));
        Ok(())
    }
}

fn check_name(reader: &Reader<'_, '_>, key: &str) {
    if let Some(problem) = path::name_problem(key, reader.limits.name_bytes) {
        reader.report(Diagnostic::error("bad-name", problem).at(reader.place(key)));
    }
}

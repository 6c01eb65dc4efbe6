//! Visitors for a file, for anything with named fields, and for maps with quoted names.

use std::fmt;

use serde::de::{self, DeserializeSeed, Deserializer, MapAccess, Visitor};

use super::Reader;
use super::prim::ChildrenSeed;
use crate::diagnostic::{Diagnostic, nearest};
use crate::layer::{Layer, Spanned, TimeSettings};
use crate::lex;

/// Reads a key as a slice of the text.
struct KeySeed;

impl<'de> DeserializeSeed<'de> for KeySeed {
    type Value = &'de str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'de str, D::Error> {
        struct KeyVisitor;
        impl<'de> Visitor<'de> for KeyVisitor {
            type Value = &'de str;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a name")
            }

            fn visit_borrowed_str<E: de::Error>(self, key: &'de str) -> Result<&'de str, E> {
                Ok(key)
            }

            fn visit_str<E: de::Error>(self, _: &str) -> Result<&'de str, E> {
                Err(E::custom("a name cannot contain `\\`"))
            }
        }
        // Between brackets ron reads this as a bare name, between braces as a quoted one.
        deserializer.deserialize_str(KeyVisitor)
    }
}

/// Reads a value as a slice of the text, without the blanks and comments around it.
pub(super) fn raw_value<'de, A: MapAccess<'de>>(map: &mut A) -> Result<&'de str, A::Error> {
    let raw: &'de ron::value::RawValue = map.next_value()?;
    let text = raw.get_ron();
    Ok(&text[lex::trim(text)])
}

/// Takes the fields of something one by one.
pub(super) trait FieldSink<'de> {
    /// Must read the value.
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error>;
}

/// Hands the fields of a struct or the entries of a map to a sink.
pub(super) struct Fields<'s, S>(pub(super) &'s mut S);

impl<'de, S: FieldSink<'de>> Visitor<'de> for Fields<'_, S> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("named things")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key_seed(KeySeed)? {
            self.0.field(key, &mut map)?;
        }
        Ok(())
    }
}

/// Reads `{"name": .., ..}` into a sink.
pub(super) struct MapInto<'s, S>(pub(super) &'s mut S);

impl<'de, S: FieldSink<'de>> DeserializeSeed<'de> for MapInto<'_, S> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(Fields(self.0))
    }
}

/// Reads `(field: .., ..)` or `Name(field: .., ..)` into a sink.
pub(super) struct StructInto<'s, S> {
    pub(super) name: &'static str,
    pub(super) sink: &'s mut S,
}

impl<'de, S: FieldSink<'de>> DeserializeSeed<'de> for StructInto<'_, S> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_struct(self.name, &[], Fields(self.sink))
    }
}

/// Remembers the keys of one struct or map, and reports the second of two equal ones.
#[derive(Default)]
pub(super) struct Seen<'de> {
    keys: std::collections::BTreeMap<&'de str, ()>,
}

impl<'de> Seen<'de> {
    /// Whether the key is new; else it is an error with code `code`.
    pub(super) fn is_new(&mut self, reader: &Reader<'_, '_>, key: &'de str, code: &'static str) -> bool {
        match self.keys.entry(key) {
            std::collections::btree_map::Entry::Vacant(free) => {
                free.insert(());
                true
            }
            std::collections::btree_map::Entry::Occupied(first) => {
                let message = format!("`{key}` is written twice");
                reader.report(
                    Diagnostic::error(code, message)
                        .at(reader.place(key))
                        .also(reader.place(first.key()), "first written"),
                );
                false
            }
        }
    }
}

const LAYER_FIELDS: [&str; 7] = ["version", "doc", "default_prim", "time", "sublayers", "order", "prims"];

/// Reads a whole file.
pub(super) struct LayerSeed<'a, 'b, 'r>(pub(super) &'a Reader<'b, 'r>);

impl<'de> DeserializeSeed<'de> for LayerSeed<'_, '_, '_> {
    type Value = Layer;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Layer, D::Error> {
        let mut sink = LayerSink {
            reader: self.0,
            seen: Seen::default(),
            layer: Layer {
                default_prim: None,
                time: None,
                sublayers: None,
                order: Vec::new(),
                prims: Vec::new(),
            },
        };
        deserializer.deserialize_struct("Layer", &[], Fields(&mut sink))?;
        Ok(sink.layer)
    }
}

struct LayerSink<'a, 'b, 'r, 'de> {
    reader: &'a Reader<'b, 'r>,
    seen: Seen<'de>,
    layer: Layer,
}

impl<'de> FieldSink<'de> for LayerSink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let reader = self.reader;
        self.seen.is_new(reader, key, "duplicate-field");
        match key {
            "prims" => {
                self.layer.prims = map.next_value_seed(ChildrenSeed { reader, depth: 0 })?;
                return Ok(());
            }
            "version" => {
                let raw = raw_value(map)?;
                if let Some(version) = reader.leaf::<u64>(raw, key, "a whole number")
                    && version != 1
                {
                    reader.report(
                        Diagnostic::error(
                            "unknown-version",
                            format!("this is a scene of version {version}; 1 can be read"),
                        )
                        .at(reader.place(raw)),
                    );
                }
            }
            "doc" => {
                reader.leaf::<String>(raw_value(map)?, key, "a text in quotes");
            }
            "default_prim" => self.layer.default_prim = reader.default_prim(raw_value(map)?),
            "time" => self.layer.time = reader.time(raw_value(map)?),
            "sublayers" => {
                let raw = raw_value(map)?;
                self.layer.sublayers = reader.assets(raw).map(|value| Spanned {
                    value,
                    place: reader.place(key),
                });
            }
            "order" => self.layer.order = reader.names(raw_value(map)?),
            _ => {
                raw_value(map)?;
                let message = format!("a layer has no field `{key}`");
                let mut error = Diagnostic::error("unknown-keyword", message)
                    .at(reader.place(key))
                    .suggest(nearest(key, LAYER_FIELDS.into_iter()));
                if error.suggestion.is_none() {
                    error = error.note(format!("fields of a layer: {}", LAYER_FIELDS.join(", ")));
                }
                reader.report(error);
            }
        }
        Ok(())
    }
}

impl Reader<'_, '_> {
    /// Reads `(start: 1, end: 48, fps: 24)`.
    fn time(&self, raw: &str) -> Option<TimeSettings> {
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Written {
            start: Option<f64>,
            end: Option<f64>,
            fps: Option<f64>,
        }
        let written: Written = self.leaf(raw, "time", "`(start: .., end: .., fps: ..)`")?;
        let start = written.start.unwrap_or(0.0);
        let time = TimeSettings {
            start,
            end: written.end.unwrap_or(start),
            fps: written.fps.unwrap_or(TimeSettings::default().fps),
        };
        let problem = if !(time.start.is_finite() && time.end.is_finite() && time.fps.is_finite()) {
            ("not-finite", "times must be finite")
        } else if time.end < time.start {
            ("out-of-range", "the scene ends before it starts")
        } else if time.fps <= 0.0 {
            ("out-of-range", "`fps` must be above 0")
        } else {
            return Some(time);
        };
        self.report(Diagnostic::error(problem.0, problem.1).at(self.place(raw)));
        None
    }
}

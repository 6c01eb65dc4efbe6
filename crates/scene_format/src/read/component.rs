//! The fields of a component.

use serde::de::MapAccess;

use super::Reader;
use super::fields::{FieldSink, Seen, raw_value};
use crate::diagnostic::{Diagnostic, nearest};
use crate::layer::FieldSpec;
use crate::schema::{ComponentInfo, Schema};

/// Takes the fields of a component.
pub(super) struct ComponentSink<'a, 'b, 'r, 'de> {
    pub(super) reader: &'a Reader<'b, 'r>,
    pub(super) component: &'a ComponentInfo,
    pub(super) seen: Seen<'de>,
    pub(super) fields: Vec<FieldSpec>,
}

impl<'de> FieldSink<'de> for ComponentSink<'_, '_, '_, 'de> {
    fn field<A: MapAccess<'de>>(&mut self, key: &'de str, map: &mut A) -> Result<(), A::Error> {
        let raw = raw_value(map)?;
        let reader = self.reader;
        let is_new = self.seen.is_new(reader, key, "duplicate-field");
        if !Reader::count(&reader.opinions, reader.limits.opinions) {
            let message = format!("a scene has at most {} fields", reader.limits.opinions);
            let error = Diagnostic::error("too-many-opinions", message);
            return Err(reader.stop(error.at(reader.place(key))));
        }
        let Some(field) = self.component.field(key) else {
            reader.report(unknown_field(self.component, key).at(reader.place(key)));
            return Ok(());
        };
        if let Some(opinion) = reader.field_value(self.component.name, field, raw)
            && is_new
        {
            self.fields.push(FieldSpec {
                index: field.index,
                place: reader.place(raw),
                opinion,
            });
        }
        Ok(())
    }
}

/// Says that a component has no such field.
pub(crate) fn unknown_field(component: &ComponentInfo, key: &str) -> Diagnostic {
    let name = component.name;
    let fields = component.fields.iter().map(|field| field.name);
    let note = if component.fields.is_empty() {
        format!("{name} has no fields (pipeline schema {name})")
    } else {
        format!("fields of {name}: {} (pipeline schema {name})", component.field_names())
    };
    Diagnostic::error("unknown-field", format!("`{name}` has no field `{key}`"))
        .suggest(nearest(key, fields))
        .note(note)
}

/// Says that there is no such component.
pub(crate) fn unknown_component(schema: &Schema<'_>, key: &str) -> Diagnostic {
    let mut error = Diagnostic::error("unknown-component", format!("there is no component `{key}`"))
        .suggest(schema.nearest_component(key));
    if error.suggestion.is_none() {
        error = error.note("`pipeline schema` lists the components");
    }
    error
}

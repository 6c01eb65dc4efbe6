//! What a scene may say: the registered components, by their short names.

use std::any::TypeId;

use bevy_reflect::std_traits::ReflectDefault;
use bevy_reflect::structs::StructInfo;
use bevy_reflect::{NamedField, ReflectFromReflect, TypeInfo, TypeRegistration, TypeRegistry};

use crate::attributes::{Exclusive, Range, Required, Unit};
use crate::diagnostic::nearest;
use crate::relation::{Target, Targets};

/// Words that begin a field's value and mean something else.
const RESERVED: [&str; 3] = ["Samples", "Block", "Edit"];

/// How a field's value is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FieldKind {
    /// The RON of its type.
    Value,
    /// One path.
    Target { optional: bool },
    /// Paths, as a list or as an edit.
    Targets { optional: bool },
}

/// A field of a component.
#[derive(Clone, Debug)]
pub struct FieldInfo {
    /// Its name in Rust and in a scene.
    pub name: &'static str,
    /// Its position in the struct.
    pub index: usize,
    /// Its type.
    pub type_id: TypeId,
    /// Its doc comment.
    pub docs: Option<&'static str>,
    /// The values it may have.
    pub range: Option<Range>,
    /// The unit of its numbers.
    pub unit: Option<&'static str>,
    /// Whether a scene must write it.
    pub required: bool,
    /// What it excludes.
    pub exclusive: Option<Exclusive>,
    pub(crate) kind: FieldKind,
    pub(crate) type_info: &'static TypeInfo,
}

/// A component: a named group of fields.
#[derive(Clone, Debug)]
pub struct ComponentInfo {
    /// Its short name in Rust, which is its name in a scene.
    pub name: &'static str,
    /// Its type.
    pub type_id: TypeId,
    /// Its doc comment.
    pub docs: Option<&'static str>,
    /// Its fields in the order of the struct.
    pub fields: Vec<FieldInfo>,
}

impl ComponentInfo {
    /// Finds a field by name.
    pub fn field(&self, name: &str) -> Option<&FieldInfo> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Lists the fields for a message.
    pub(crate) fn field_names(&self) -> String {
        let names: Vec<&str> = self.fields.iter().map(|field| field.name).collect();
        names.join(", ")
    }
}

/// Why a set of registered types cannot be a scene's vocabulary. These are mistakes of a program,
/// found when it starts.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SchemaError {
    /// Two components would have the same name in a scene.
    #[error("two components are called `{name}`: `{first}` and `{second}`; rename one of them")]
    Clash {
        /// The short name.
        name: String,
        /// Path of one type.
        first: String,
        /// Path of the other.
        second: String,
    },
    /// A component is not a struct with named fields.
    #[error("component `{path}` is not a struct with named fields, which a scene could write")]
    NotAStruct {
        /// Path of the type.
        path: String,
    },
    /// A component's name cannot be written, because a small letter begins a keyword.
    #[error("component `{path}` must begin with a capital letter")]
    SmallLetter {
        /// Path of the type.
        path: String,
    },
    /// A component has no default.
    #[error("component `{path}` has no default; add `Default` to its derives and `#[reflect(Default)]`")]
    NoDefault {
        /// Path of the type.
        path: String,
    },
    /// A field's type is not registered, so that its values cannot be read.
    #[error("the type of `{component}.{field}`, `{path}`, is not registered")]
    NotRegistered {
        /// The component.
        component: String,
        /// The field.
        field: String,
        /// Path of the field's type.
        path: String,
    },
    /// A field is an enum with a variant that means something else in a scene.
    #[error("`{component}.{field}` has a variant `{variant}`, a word that scenes reserve; rename it")]
    ReservedVariant {
        /// The component.
        component: String,
        /// The field.
        field: String,
        /// The variant.
        variant: String,
    },
}

/// The components that a scene may use, with the registry that reads their values.
pub struct Schema<'r> {
    registry: &'r TypeRegistry,
    components: Vec<ComponentInfo>,
}

impl<'r> Schema<'r> {
    /// Collects the registered types for which `is_component` holds.
    ///
    /// With `bevy_ecs` that is `|registration| registration.contains::<ReflectComponent>()`.
    ///
    /// # Errors
    ///
    /// See [`SchemaError`].
    pub fn new(
        registry: &'r TypeRegistry,
        is_component: impl Fn(&TypeRegistration) -> bool,
    ) -> Result<Self, SchemaError> {
        let mut registrations: Vec<&TypeRegistration> = registry.iter().filter(|found| is_component(found)).collect();
        registrations.sort_by_key(|found| {
            let table = found.type_info().type_path_table();
            (table.short_path(), table.path())
        });
        for pair in registrations.windows(2) {
            let tables = [pair[0], pair[1]].map(|one| one.type_info().type_path_table());
            if tables[0].short_path() == tables[1].short_path() {
                return Err(SchemaError::Clash {
                    name: tables[0].short_path().to_owned(),
                    first: tables[0].path().to_owned(),
                    second: tables[1].path().to_owned(),
                });
            }
        }
        let components = registrations
            .into_iter()
            .map(|registration| describe_component(registration, registry))
            .collect::<Result<_, _>>()?;
        Ok(Self { registry, components })
    }

    /// All components, by name.
    pub fn components(&self) -> &[ComponentInfo] {
        &self.components
    }

    /// Finds a component by its short name.
    pub fn component(&self, name: &str) -> Option<&ComponentInfo> {
        self.index_of(name).map(|index| &self.components[index])
    }

    /// The registry that the components came from.
    pub fn registry(&self) -> &'r TypeRegistry {
        self.registry
    }

    pub(crate) fn index_of(&self, name: &str) -> Option<usize> {
        self.components
            .binary_search_by(|component| component.name.cmp(name))
            .ok()
    }

    pub(crate) fn nearest_component(&self, word: &str) -> Option<&'static str> {
        nearest(word, self.components.iter().map(|component| component.name))
    }
}

fn describe_component(registration: &TypeRegistration, registry: &TypeRegistry) -> Result<ComponentInfo, SchemaError> {
    let table = registration.type_info().type_path_table();
    let path = || table.path().to_owned();
    let TypeInfo::Struct(info) = registration.type_info() else {
        return Err(SchemaError::NotAStruct { path: path() });
    };
    let name = table.short_path();
    if !name.starts_with(|first: char| first.is_ascii_uppercase()) {
        return Err(SchemaError::SmallLetter { path: path() });
    }
    if !registration.contains::<ReflectDefault>() {
        return Err(SchemaError::NoDefault { path: path() });
    }
    Ok(ComponentInfo {
        name,
        type_id: registration.type_id(),
        docs: info.docs(),
        fields: describe_fields(name, info, registry)?,
    })
}

fn describe_fields(
    component: &str,
    info: &'static StructInfo,
    registry: &TypeRegistry,
) -> Result<Vec<FieldInfo>, SchemaError> {
    let mut fields = Vec::with_capacity(info.field_len());
    for (index, field) in info.iter().enumerate() {
        let Some(registration) = registry.get(field.type_id()) else {
            return Err(SchemaError::NotRegistered {
                component: component.to_owned(),
                field: field.name().to_owned(),
                path: field.type_path().to_owned(),
            });
        };
        let type_info = registration.type_info();
        if let Some(variant) = reserved_variant(type_info, registry) {
            return Err(SchemaError::ReservedVariant {
                component: component.to_owned(),
                field: field.name().to_owned(),
                variant: variant.to_owned(),
            });
        }
        fields.push(describe_field(index, field, type_info));
    }
    Ok(fields)
}

fn describe_field(index: usize, field: &'static NamedField, type_info: &'static TypeInfo) -> FieldInfo {
    FieldInfo {
        name: field.name(),
        index,
        type_id: field.type_id(),
        docs: field.docs(),
        range: field.get_attribute::<Range>().copied(),
        unit: field.get_attribute::<Unit>().map(|unit| unit.0),
        required: field.has_attribute::<Required>(),
        exclusive: field.get_attribute::<Exclusive>().copied(),
        kind: kind_of(field.type_id()),
        type_info,
    }
}

fn kind_of(type_id: TypeId) -> FieldKind {
    let is = |candidate: TypeId| candidate == type_id;
    if is(TypeId::of::<Target>()) {
        FieldKind::Target { optional: false }
    } else if is(TypeId::of::<Option<Target>>()) {
        FieldKind::Target { optional: true }
    } else if is(TypeId::of::<Targets>()) {
        FieldKind::Targets { optional: false }
    } else if is(TypeId::of::<Option<Targets>>()) {
        FieldKind::Targets { optional: true }
    } else {
        FieldKind::Value
    }
}

/// Looks for a reserved word among the variants of an enum, or of the enum that an option holds.
fn reserved_variant(info: &'static TypeInfo, registry: &TypeRegistry) -> Option<&'static str> {
    let TypeInfo::Enum(variants) = info else {
        return None;
    };
    if let Some(held) = held_by_option(info) {
        return registry
            .get(held)
            .and_then(|held| reserved_variant(held.type_info(), registry));
    }
    variants
        .variant_names()
        .iter()
        .copied()
        .find(|name| RESERVED.contains(name))
}

/// Gives the type that an `Option` holds.
pub(crate) fn held_by_option(info: &'static TypeInfo) -> Option<TypeId> {
    let TypeInfo::Enum(variants) = info else {
        return None;
    };
    if variants.type_path_table().ident() != Some("Option") {
        return None;
    }
    let some = variants.variant("Some")?.as_tuple_variant().ok()?;
    Some(some.field_at(0)?.type_id())
}

/// Turns a value that the reader made into one of the registered type, if the type knows how.
pub(crate) fn make_concrete(
    value: Box<dyn bevy_reflect::PartialReflect>,
    registration: &TypeRegistration,
) -> Box<dyn bevy_reflect::PartialReflect> {
    match registration
        .data::<ReflectFromReflect>()
        .and_then(|maker| maker.from_reflect(&*value))
    {
        Some(concrete) => concrete.into_partial_reflect(),
        None => value,
    }
}

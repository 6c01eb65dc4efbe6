//! One file as it was written: opinions with places, nothing composed yet.

use std::fmt;

use bevy_reflect::PartialReflect;

use crate::source::Place;

/// Something that was written, and where.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spanned<T> {
    pub(crate) value: T,
    pub(crate) place: Place,
}

/// How a prim is mentioned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Specifier {
    /// The prim is there.
    Def,
    /// Something is said about a prim that is defined elsewhere.
    Over,
    /// A prim to inherit from, which is not rendered itself.
    Class,
}

/// A list of things in a layer, or a change of the list that weaker opinions make.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ListEdit<T> {
    Explicit(Vec<T>),
    Edit {
        prepend: Vec<T>,
        append: Vec<T>,
        delete: Vec<T>,
    },
}

impl<T: Clone> ListEdit<T> {
    /// Applies this opinion to the list that the weaker ones made; `same` says which items are one.
    pub(crate) fn apply(&self, list: &mut Vec<T>, same: impl Fn(&T, &T) -> bool) {
        match self {
            Self::Explicit(items) => {
                list.clear();
                for item in items {
                    if !list.iter().any(|other| same(other, item)) {
                        list.push(item.clone());
                    }
                }
            }
            Self::Edit {
                prepend,
                append,
                delete,
            } => {
                list.retain(|item| !delete.iter().any(|other| same(other, item)));
                for item in prepend.iter().rev() {
                    list.retain(|other| !same(other, item));
                    list.insert(0, item.clone());
                }
                for item in append {
                    list.retain(|other| !same(other, item));
                    list.push(item.clone());
                }
            }
        }
    }
}

/// What a reference, payload or sublayer names, with the offset in time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AssetArc {
    /// As written: `file`, `file#/Prim` or `#/Prim`.
    pub(crate) to: Spanned<String>,
    pub(crate) offset: f64,
    pub(crate) scale: f64,
}

/// One opinion about one field.
pub(crate) enum FieldOpinion {
    Constant(Box<dyn PartialReflect>),
    /// In the order of time.
    Samples(Vec<(f64, Box<dyn PartialReflect>)>),
    Block,
    /// Of a field that points to prims.
    Targets(ListEdit<Spanned<String>>),
}

impl fmt::Debug for FieldOpinion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(value) => value.debug(f),
            Self::Samples(samples) => write!(f, "{} samples", samples.len()),
            Self::Block => f.write_str("Block"),
            Self::Targets(edit) => edit.fmt(f),
        }
    }
}

/// A field that a layer mentions.
#[derive(Debug)]
pub(crate) struct FieldSpec {
    /// Position in the component.
    pub(crate) index: usize,
    /// The value.
    pub(crate) place: Place,
    pub(crate) opinion: FieldOpinion,
}

/// A component that a layer mentions.
#[derive(Debug)]
pub(crate) struct ComponentSpec {
    /// Position in the schema.
    pub(crate) index: usize,
    /// The name.
    pub(crate) place: Place,
    pub(crate) fields: Vec<FieldSpec>,
}

/// A set of variants with its bodies.
#[derive(Debug)]
pub(crate) struct VariantSet {
    pub(crate) name: Spanned<String>,
    pub(crate) variants: Vec<(Spanned<String>, Body)>,
}

/// The name of a set and the variant chosen in it.
pub(crate) type Selection = (Spanned<String>, Spanned<String>);

/// What a layer, or a variant, says about one prim.
#[derive(Debug, Default)]
pub(crate) struct Body {
    pub(crate) type_label: Option<String>,
    pub(crate) doc: Option<String>,
    pub(crate) active: Option<bool>,
    pub(crate) references: Option<Spanned<ListEdit<AssetArc>>>,
    pub(crate) payloads: Option<Spanned<ListEdit<AssetArc>>>,
    pub(crate) inherits: Option<Spanned<ListEdit<Spanned<String>>>>,
    pub(crate) specializes: Option<Spanned<ListEdit<Spanned<String>>>>,
    pub(crate) select: Option<Spanned<Vec<Selection>>>,
    pub(crate) variants: Option<Spanned<Vec<VariantSet>>>,
    pub(crate) without: Vec<Spanned<String>>,
    pub(crate) order: Vec<Spanned<String>>,
    pub(crate) components: Vec<ComponentSpec>,
    pub(crate) children: Vec<PrimSpec>,
}

/// A prim that a layer mentions.
#[derive(Debug)]
pub(crate) struct PrimSpec {
    /// A path at the top of a layer, else a name.
    pub(crate) key: Spanned<String>,
    pub(crate) specifier: Specifier,
    pub(crate) body: Body,
}

/// The first and last frame of a scene, and how fast they follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeSettings {
    /// First frame.
    pub start: f64,
    /// Last frame.
    pub end: f64,
    /// Frames a second.
    pub fps: f64,
}

impl Default for TimeSettings {
    fn default() -> Self {
        Self {
            start: 0.0,
            end: 0.0,
            fps: 24.0,
        }
    }
}

/// One file.
#[derive(Debug)]
pub(crate) struct Layer {
    pub(crate) default_prim: Option<Spanned<String>>,
    pub(crate) time: Option<TimeSettings>,
    pub(crate) sublayers: Option<Spanned<Vec<AssetArc>>>,
    pub(crate) order: Vec<Spanned<String>>,
    pub(crate) prims: Vec<PrimSpec>,
}

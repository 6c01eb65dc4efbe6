//! One file as it was written: opinions with places, nothing composed yet.

use std::collections::HashSet;
use std::fmt;
use std::hash::Hash;

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

impl<T> ListEdit<T> {
    /// Counts the items that it names.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Explicit(items) => items.len(),
            Self::Edit {
                prepend,
                append,
                delete,
            } => prepend.len() + append.len() + delete.len(),
        }
    }

    /// Makes a list of other things of it; items without one are left out.
    pub(crate) fn filter_map<U>(&self, mut f: impl FnMut(&T) -> Option<U>) -> ListEdit<U> {
        let mut each = |items: &[T]| items.iter().filter_map(&mut f).collect();
        match self {
            Self::Explicit(items) => ListEdit::Explicit(each(items)),
            Self::Edit {
                prepend,
                append,
                delete,
            } => ListEdit::Edit {
                prepend: each(prepend),
                append: each(append),
                delete: each(delete),
            },
        }
    }
}

impl<T: Clone> ListEdit<T> {
    /// Applies this opinion to the list that the weaker ones made; items with one `key` are one.
    pub(crate) fn apply<K: Eq + Hash>(&self, list: &mut Vec<T>, key: impl Fn(&T) -> K) {
        let keys = |items: &[T]| -> HashSet<K> { items.iter().map(&key).collect() };
        match self {
            Self::Explicit(items) => {
                let mut seen = HashSet::new();
                *list = items.iter().filter(|item| seen.insert(key(item))).cloned().collect();
            }
            Self::Edit {
                prepend,
                append,
                delete,
            } => {
                let deleted = keys(delete);
                list.retain(|item| !deleted.contains(&key(item)));
                let mut front = HashSet::new();
                let mut all: Vec<T> = prepend.iter().filter(|item| front.insert(key(item))).cloned().collect();
                all.extend(list.drain(..).filter(|item| !front.contains(&key(item))));
                let mut back = HashSet::new();
                // Of an item that is appended twice the last mention counts.
                let mut last: Vec<&T> = append.iter().rev().filter(|item| back.insert(key(item))).collect();
                last.reverse();
                all.retain(|item| !back.contains(&key(item)));
                all.extend(last.into_iter().cloned());
                *list = all;
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

//! A composed scene: prims with components, each field with its winning value.

use std::any::TypeId;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use bevy_reflect::std_traits::ReflectDefault;
use bevy_reflect::{FromReflect, PartialReflect, Reflect, ReflectFromReflect, ReflectMut};

use crate::asset::{self, Folders};
use crate::compose::{ArcKind, PathId, PathTable};
use crate::diagnostic::Diagnostic;
use crate::layer::{Specifier, TimeSettings};
use crate::sample;
use crate::schema::Schema;
use crate::source::{Place, Sources};

/// A composed scene.
#[derive(Debug)]
pub struct Scene {
    /// All prims, depth first, children in their order; what is below an inactive prim is left out.
    pub prims: Vec<Prim>,
    /// The prim that a reference to this file means, as a path.
    pub default_prim: Option<String>,
    /// The scene's frames.
    pub time: TimeSettings,
    /// The frame to show: the one asked for, else the first.
    pub frame: f64,
    /// What is odd but no error.
    pub warnings: Vec<Diagnostic>,
    /// SHA-256 of the composed result: the same for the same prims, components and values however
    /// they are written. Independent of where the scene lies.
    pub hash: [u8; 32],
    /// Of the files that were mixed in alone.
    pub(crate) files: [u8; 32],
    /// The files that fields of rendered prims name, in the order of the prims.
    pub assets: Vec<AssetUse>,
    /// What it took to compose.
    pub cost: LoadCost,
    /// The texts that places refer to.
    pub sources: Sources,
    pub(crate) index: BTreeMap<String, usize>,
    pub(crate) paths: PathTable,
    pub(crate) folders: Folders,
}

/// What it took to compose a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadCost {
    /// Layers, each read once; the command line is one.
    pub layers: usize,
    /// Fields that the layers write.
    pub opinions: usize,
    /// Time to read and parse the files.
    pub reading: Duration,
    /// Time for all else: composition and checks.
    pub composing: Duration,
}

/// A file that a field names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssetUse {
    /// The file, absolute and canonical.
    pub path: PathBuf,
    /// The value that names it.
    pub place: Place,
}

/// A named node of a scene.
#[derive(Debug)]
pub struct Prim {
    /// Its path: `/World/Ring`.
    pub path: String,
    /// Its name.
    pub name: String,
    /// Its parent, as an index of [`Scene::prims`]; always before itself.
    pub parent: Option<usize>,
    /// How it is mentioned.
    pub specifier: Specifier,
    /// Whether it is active itself.
    pub active: bool,
    /// Whether it takes part in the picture: it and all above it are `Def` and active.
    pub rendered: bool,
    /// The label that `type` gives; nothing depends on it.
    pub type_label: Option<String>,
    /// The comment that `doc` gives.
    pub doc: Option<String>,
    /// Its strongest mention; none for one that only a path below it implies.
    pub place: Option<Place>,
    /// Its components, by name.
    pub components: Vec<ComponentValue>,
    /// Components that have opinions but were removed by `without`.
    pub removed: Vec<ComponentValue>,
    /// Its sets of variants.
    pub variants: Vec<VariantChoice>,
    /// The places that have opinions about it, and those through which they are reached, strong to
    /// weak.
    pub contributors: Vec<Contributor>,
}

/// A set of variants of a prim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VariantChoice {
    /// Its name.
    pub set: String,
    /// The variant that is in force, if one is selected.
    pub chosen: Option<String>,
    /// All that can be selected.
    pub variants: Vec<String>,
}

/// A place that may have opinions about a prim, with the arc that brings them: a node of the prim's
/// tree of arcs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contributor {
    /// The prim there; see [`Scene::path_of`].
    pub(crate) path: PathId,
    /// What brings its opinions.
    pub arc: ArcKind,
    /// Where the arc is written; for a variant where it is selected. None for the prim itself.
    pub arc_place: Option<Place>,
    /// The place that the arc starts from, as a position in [`Prim::contributors`].
    pub parent: Option<u32>,
    /// Names in the path of the prim that the arc is written on.
    pub(crate) depth: u16,
}

impl Prim {
    /// Finds a component that is present.
    pub fn component(&self, name: &str) -> Option<&ComponentValue> {
        self.components.iter().find(|found| found.name == name)
    }
}

/// A component of a prim: the fields that the scene writes.
#[derive(Debug)]
pub struct ComponentValue {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub type_id: TypeId,
    /// Its strongest mention.
    pub place: Place,
    /// The fields that have opinions, in the order of the struct.
    pub fields: Vec<FieldValue>,
}

impl ComponentValue {
    /// Finds a field that has opinions.
    pub fn field(&self, name: &str) -> Option<&FieldValue> {
        self.fields.iter().find(|found| found.name == name)
    }

    /// Makes the component as it is at `time`, in frames: the default with the winning fields.
    ///
    /// # Panics
    ///
    /// If `schema` is not the one that the scene was loaded with.
    pub fn build(&self, schema: &Schema<'_>, time: f64) -> Box<dyn Reflect> {
        let registry = schema.registry();
        let mut built = registry
            .get_type_data::<ReflectDefault>(self.type_id)
            .expect("the scene was loaded with a schema, which requires defaults")
            .default();
        let ReflectMut::Struct(parts) = built.reflect_mut() else {
            unreachable!("a schema holds structs only");
        };
        for field in &self.fields {
            let (Some(value), Some(part)) = (field.at(time), parts.field_at_mut(field.index)) else {
                continue;
            };
            let concrete = registry
                .get_type_data::<ReflectFromReflect>(field.type_id)
                .and_then(|maker| maker.from_reflect(value.get()));
            match (concrete, part.try_as_reflect_mut()) {
                // Lists would be merged by `apply`, and a value is replaced as a whole.
                (Some(concrete), Some(part)) => {
                    let set = part.set(concrete);
                    debug_assert!(set.is_ok(), "the reader made a value of the field's type");
                }
                (_, _) => part.apply(value.get()),
            }
        }
        built
    }
}

/// A field that has opinions.
#[derive(Debug)]
pub struct FieldValue {
    /// Its name.
    pub name: &'static str,
    /// Its position in the struct.
    pub index: usize,
    /// Its type.
    pub type_id: TypeId,
    /// The strongest opinion.
    pub place: Place,
    /// What holds.
    pub state: FieldState,
    /// Who says something, strongest first; of values the first one holds, relationships are
    /// combined from all.
    pub opinions: Vec<Opinion>,
}

/// What holds for a field.
#[derive(Debug)]
pub enum FieldState {
    /// A value.
    Constant(Box<dyn PartialReflect>),
    /// Values at times, in frames, ascending, at least one.
    Samples(Vec<(f64, Box<dyn PartialReflect>)>),
    /// The default.
    Blocked,
}

/// Where an opinion about a field is written; the text there is the opinion itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opinion {
    /// The value.
    pub place: Place,
    /// Whose opinion it is, as a position in [`Prim::contributors`].
    pub contributor: u32,
}

/// A value that is there already or was made between two samples.
#[derive(Debug)]
pub enum ValueAt<'v> {
    /// One that the scene writes.
    Written(&'v dyn PartialReflect),
    /// One between two that it writes.
    Between(Box<dyn PartialReflect>),
}

impl ValueAt<'_> {
    /// The value.
    pub fn get(&self) -> &dyn PartialReflect {
        match self {
            Self::Written(value) => *value,
            Self::Between(value) => &**value,
        }
    }
}

impl FieldValue {
    /// Gives the value at `time`, in frames; none if the default holds.
    ///
    /// Between two samples: linear for numbers with a fraction and vectors of them, along the arc
    /// for rotations, else the earlier; before the first and after the last, the nearest.
    pub fn at(&self, time: f64) -> Option<ValueAt<'_>> {
        match &self.state {
            FieldState::Constant(value) => Some(ValueAt::Written(&**value)),
            FieldState::Samples(samples) => sample::at(samples, time),
            FieldState::Blocked => None,
        }
    }

    /// Gives the value at `time` as a `T`; none if the default holds, or if it is no `T`.
    pub fn get_at<T: FromReflect>(&self, time: f64) -> Option<T> {
        T::from_reflect(self.at(time)?.get())
    }

    /// Whether the field points to prims, so that lists of targets are combined from all opinions.
    pub fn is_relationship(&self) -> bool {
        use crate::relation::{Target, Targets};
        [
            TypeId::of::<Target>(),
            TypeId::of::<Option<Target>>(),
            TypeId::of::<Targets>(),
            TypeId::of::<Option<Targets>>(),
        ]
        .contains(&self.type_id)
    }

    /// Gives the samples; none if the value does not change.
    pub fn samples(&self) -> Option<&[(f64, Box<dyn PartialReflect>)]> {
        match &self.state {
            FieldState::Samples(samples) => Some(samples),
            _ => None,
        }
    }
}

impl Scene {
    /// Gives the path of a place as it is in its own file; in the body of a variant
    /// `/World/Ring{metal=gold}Stone`.
    pub fn path_of(&self, contributor: &Contributor) -> String {
        self.paths.text(contributor.path)
    }

    /// Finds a prim by its path.
    pub fn prim(&self, path: &str) -> Option<&Prim> {
        self.index_of(path).map(|index| &self.prims[index])
    }

    /// Finds the index of a prim by its path.
    pub fn index_of(&self, path: &str) -> Option<usize> {
        self.index.get(path).copied()
    }

    /// The prims that take part in the picture, with their indices.
    pub fn rendered(&self) -> impl Iterator<Item = (usize, &Prim)> {
        self.prims.iter().enumerate().filter(|(_, prim)| prim.rendered)
    }

    /// Finds the file that `text`, written at `place`, names.
    ///
    /// # Errors
    ///
    /// `path-escape` for one that leaves the root, `missing-file` for one that is not there.
    pub fn resolve_asset(&self, place: Place, text: &str) -> Result<PathBuf, Diagnostic> {
        asset::resolve(text, place, &self.sources, &self.folders)
    }

    /// Writes a message about this scene.
    pub fn report(&self, diagnostic: &Diagnostic, colour: bool) -> String {
        diagnostic.render(&self.sources, colour)
    }
}

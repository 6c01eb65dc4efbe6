//! Layered scenes in RON: from files to prims with components.
//!
//! A scene is a tree of named *prims*, each with *components*, each a group of *fields*. What a
//! file writes about a field is an *opinion*; several files may have opinions about one field, and
//! the strongest wins. That is how USD composes scenes, and a scene here reads like one:
//!
//! ```ron
//! Layer(
//!     prims: {
//!         "/World/Camera": Def(Camera: (fov: 35)),
//!         "/World/Ball": Def(Transform: (translate: Samples({0: (0, 1, 0), 24: (0, 2, 0)}))),
//!     },
//! )
//! ```
//!
//! # Why it is this way
//!
//! *The registered types are the schema.* A component is a struct that derives `Reflect`; nothing
//! else is written to make it appear in scenes, in messages and in [`schema_text`]. Its fields may
//! carry a [`Range`], a [`Unit`], [`Required`] and [`Exclusive`]. This crate reads them through
//! `bevy_reflect` alone and knows nothing of an ECS.
//!
//! *Every opinion has a place.* The structure is read by visitors that are handed slices of the
//! text; where a slice lies in the text is where its opinion was written. So a message can underline
//! what is meant even where everything parses, and an explanation can name the line of each rival.
//!
//! *Opinions are read field by field, and checked even if they lose.* A component that is read as a
//! whole comes back filled with defaults, which would then beat weaker opinions.
//!
//! *A wrong scene is refused.* A misspelt name, a file that is not there, a number out of range: up
//! to twenty messages at once, each with its place and, where there is one, the remedy.
//!
//! *A model is a layer.* [`translate_model`] writes glTF and OBJ files in the same syntax, and [`Model`] reads the
//! triangles that the prims of such a layer name.
//!
//! *Composition is USD's.* Sublayers, references, payloads, inherits, variants and specializes are
//! combined in the order in which OpenUSD combines them, ties included; `compose/mod.rs` says how.
//! [`explain`] tells for a value who said it and why the others lose, [`flatten_ron`] and
//! [`flatten_json`] write what came out.
//!
//! # What it does not do
//!
//! Of USD it leaves out relocates, value clips, instancing in the scene graph, variant fallbacks,
//! and list edits by `add` and `reorder`. A faulty arc is an error, where USD warns and goes on.
//! Formatting with comments kept, and more than one mistake of syntax in a file, are left out.
//!
//! # Example
//!
//! ```
//! use bevy_reflect::{Reflect, TypeRegistry, std_traits::ReflectDefault};
//! use scene_format::{Options, Range, Schema, Unit, load_str};
//!
//! /// A pinhole camera.
//! #[derive(Reflect, Default)]
//! #[reflect(Default)]
//! struct Camera {
//!     /// Vertical angle of view.
//!     #[reflect(@Range::open(0.0, 180.0), @Unit("degrees"))]
//!     fov: f32,
//! }
//!
//! let mut registry = TypeRegistry::new();
//! registry.register::<Camera>();
//! // A program with an ECS asks for its own mark: `|found| found.contains::<ReflectComponent>()`.
//! let schema = Schema::new(&registry, |found| found.type_info().is::<Camera>())?;
//!
//! let text = r#"Layer(prims: {"/Camera": Def(Camera: (fov: Samples({0: 30, 10: 40})))})"#;
//! let scene = load_str("scene.ron", text, &schema, &Options::default())?;
//! let camera = scene.prims[0].components[0].build(&schema, 5.0).take::<Camera>().unwrap();
//! assert_eq!(camera.fov, 35.0);
//!
//! let wrong = text.replace("fov", "fvo");
//! let errors = load_str("scene.ron", &wrong, &schema, &Options::default()).unwrap_err();
//! assert_eq!(errors.list[0].suggestion.as_deref(), Some("fov"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![allow(
    clippy::result_large_err,
    reason = "an error ends the load, so its size costs nothing"
)]

mod asset;
mod attributes;
mod compose;
mod diagnostic;
mod explain;
mod flatten;
mod hash;
mod layer;
mod lex;
mod load;
mod mesh;
mod model;
mod options;
mod path;
mod read;
mod relation;
mod render;
mod sample;
mod scene;
mod schema;
mod schema_text;
mod session;
mod source;
mod validate;

pub use attributes::{Exclusive, Range, Required, Shorthand, Unit};
pub use compose::ArcKind;
pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use explain::explain;
pub use flatten::{errors_json, flatten_json, flatten_ron};
pub use hash::mix_hash;
pub use layer::{Specifier, TimeSettings};
pub use load::{load, load_str};
pub use mesh::{MeshData, MeshError, MeshLimits, MeshPlace, MeshWarning, Oddity, load_obj, parse_obj};
pub use model::{
    MeshPart, Model, ModelError, ModelFile, ModelLimits, ModelWarning, TranslatedModel, is_model, translate_model,
};
pub use options::{Limits, Options};
pub use relation::{AssetPath, Target, Targets};
pub use scene::{
    AssetUse, ComponentValue, Contributor, FieldState, FieldValue, LoadCost, Opinion, Prim, Scene, ValueAt,
    VariantChoice,
};
pub use schema::{ComponentInfo, FieldInfo, Schema, SchemaError};
pub use schema_text::schema_text;
pub use source::{Place, SourceId, Sources};

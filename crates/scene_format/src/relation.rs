//! Fields that point to prims and files.

use bevy_reflect::{Reflect, ReflectDeserialize, ReflectSerialize, std_traits::ReflectDefault};
use serde::{Deserialize, Serialize};

/// A field that names one prim: written as a path, absolute or relative to the prim that owns the
/// field; absolute after loading. Empty only in a default.
#[derive(Reflect, Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[reflect(Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Target(pub String);

/// A field that names any number of prims: written as a list of paths, as one path, or as
/// `Edit(prepend: .., append: .., delete: ..)`; absolute after loading, each once.
#[derive(Reflect, Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[reflect(Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Targets(pub Vec<String>);

/// A field that names a file: written relative to the file that writes it, with `/` on every
/// system; absolute and canonical after loading. Empty only in a default.
#[derive(Reflect, Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[reflect(Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct AssetPath(pub String);

//! Model files as layers: glTF 2.0 (`.gltf`, `.glb`) and Wavefront OBJ (`.obj` with `.mtl`).
//!
//! A model becomes a layer by translation: [`translate_model`] writes its nodes, materials, lights and cameras as prims
//! in the syntax of any other layer, and the ordinary reader reads that. So a model is overridden, explained and
//! flattened like everything else, and nothing behind the reader knows that models exist. The layer has one root prim,
//! named after the file; below it lie the nodes as they are nested in the file, and the scope `Materials`.
//!
//! Triangles and images stay in the file. A prim names triangles with its `Mesh` component by file, mesh and primitive,
//! and images with a texture by file and number. [`Model`] reads them; it parses the file once, however many are asked
//! for.
//!
//! Everything that a file says is checked before it is used: each index, each length, each number. What is wrong is a
//! [`ModelError`] that names the file, the place in it, the reason and a remedy; what is well-formed but not rendered
//! is a [`ModelWarning`]. Memory is bounded by a constant times the size of the files, whatever they claim.
//!
//! Photometric numbers are taken as radiometric ones: 1 cd becomes 1 W·sr⁻¹, 1 lx 1 W·m⁻², 1 nt 1 W·m⁻²·sr⁻¹. All
//! lights of a file share the factor, so only the exposure depends on it.
//!
//! Left out, with a warning: animation, skins, morph targets, orthographic cameras, points and lines.

mod error;
mod files;
mod gltf;
mod meshes;
mod names;
mod obj;
mod write;

use std::path::{Path, PathBuf};

pub use error::{ModelError, ModelWarning};
pub use meshes::{MeshPart, Model};

use crate::asset::spelling_problem;
use crate::schema::Schema;
use error::Fault;

/// What a model may need at most.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelLimits {
    /// Bytes of the file, or of a file that it names; 1 GiB.
    pub bytes: u64,
    /// Bytes of the JSON text of a glTF file, of an `.mtl` file, and of the layer that is written; 64 MiB.
    pub text_bytes: usize,
    /// Objects of the JSON text, in curly brackets; 2,000,000.
    pub objects: usize,
    /// Prims; 1,000,000.
    pub prims: usize,
    /// Length of a prim's path in names; 64, and never more.
    pub prim_depth: usize,
    /// Bytes of one name; 128.
    pub name_bytes: usize,
}

impl Default for ModelLimits {
    fn default() -> Self {
        Self::of(&crate::Limits::default())
    }
}

impl ModelLimits {
    /// Takes the limits of a scene.
    #[must_use]
    pub fn of(limits: &crate::Limits) -> Self {
        Self {
            bytes: 1 << 30,
            text_bytes: limits.file_bytes,
            objects: 2_000_000,
            prims: limits.prims,
            prim_depth: limits.prim_depth.min(crate::options::DEEPEST),
            // Shorter ones could not be kept apart by a number at their end.
            name_bytes: limits.name_bytes.max(32),
        }
    }
}

/// A model file in memory.
#[derive(Clone, Copy, Debug)]
pub struct ModelFile<'a> {
    /// What to call it in messages.
    pub name: &'a str,
    /// Where it is, absolute and canonical; files that it names lie relative to it.
    pub path: &'a Path,
    /// The folder that no file may lie outside of, canonical.
    pub root: &'a Path,
    /// What it holds.
    pub bytes: &'a [u8],
}

/// A model as a layer.
#[derive(Clone, Debug)]
pub struct TranslatedModel {
    /// The layer, as a file would hold it. Files in it are named relative to the model's folder.
    pub text: String,
    /// What is odd about the model, or left out.
    pub warnings: Vec<ModelWarning>,
    /// Other files that the text was made from, canonical. Meshes name theirs when they are read.
    pub files: Vec<PathBuf>,
}

/// The kinds of model files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ModelKind {
    Gltf,
    Obj,
}

impl ModelKind {
    fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?;
        let is = |name: &str| ending.eq_ignore_ascii_case(name);
        if is("gltf") || is("glb") {
            return Some(Self::Gltf);
        }
        is("obj").then_some(Self::Obj)
    }
}

/// Tells whether a file is a model, by the ending of its name: `.gltf`, `.glb` or `.obj`.
#[must_use]
pub fn is_model(path: &Path) -> bool {
    ModelKind::of(path).is_some()
}

/// Writes a model as a layer.
///
/// - `schema`: components that it does not have are left out, with a warning.
///
/// # Errors
///
/// For whatever is broken in the structure of the file: what a mesh is made of is described soundly, but the numbers
/// in it are looked at when it is read. The error names the place in the file and a remedy.
///
/// Cost: linear in the file's JSON or OBJ text. Deterministic.
pub fn translate_model(
    file: &ModelFile<'_>,
    schema: &Schema<'_>,
    limits: &ModelLimits,
) -> Result<TranslatedModel, ModelError> {
    let translated = file_name(file).and_then(|name| match ModelKind::of(file.path) {
        Some(ModelKind::Gltf) => gltf::translate(file, name, schema, limits),
        Some(ModelKind::Obj) => obj::translate(file, name, schema, limits),
        None => Err(not_a_model()),
    });
    translated.map_err(|fault| fault.in_file(file.name))
}

fn not_a_model() -> Fault {
    Fault::unsupported("", "its name does not end in `.gltf`, `.glb` or `.obj`")
        .remedy("convert it, for example with Blender")
}

/// The name by which prims of the layer call the file itself.
fn file_name<'a>(file: &ModelFile<'a>) -> Result<&'a str, Fault> {
    let name = file.path.file_name().and_then(|name| name.to_str());
    match name {
        Some(name) if spelling_problem(name).is_none() && !name.contains('/') => Ok(name),
        _ => Err(Fault::invalid("", "its name cannot be written in a scene").remedy("rename the file")),
    }
}

#[cfg(test)]
mod tests;

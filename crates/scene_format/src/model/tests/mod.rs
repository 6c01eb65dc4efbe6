//! Models that are right, odd and wrong.

mod broken;
mod document;
mod gltf;
mod images;
mod materials;
mod meshes;
mod mutate;
mod obj;
mod vocabulary;

use std::path::{Path, PathBuf};

use super::*;
use crate::mesh::{MeshData, MeshLimits};
use vocabulary::with_schema;

/// Translates bytes as if they were in a file of the folder of test data.
fn translate(name: &str, bytes: &[u8]) -> Result<TranslatedModel, ModelError> {
    let root = data_folder();
    let path = root.join(name);
    with_schema(|schema| translate_model(&file(&path, &root, bytes), schema, &ModelLimits::default()))
}

/// Reads a mesh of bytes as if they were in a file of the folder of test data.
fn mesh(name: &str, bytes: &[u8], mesh: Option<&str>, primitive: Option<u32>) -> Result<MeshData, ModelError> {
    let root = data_folder();
    let path = root.join(name);
    let part = MeshPart {
        mesh: mesh.map(str::to_owned),
        primitive,
    };
    Model::open(file(&path, &root, bytes), &MeshLimits::default())?.mesh(&part)
}

fn file<'a>(path: &'a Path, root: &'a Path, bytes: &'a [u8]) -> ModelFile<'a> {
    ModelFile {
        name: path.file_name().and_then(|name| name.to_str()).unwrap_or("?"),
        path,
        root,
        bytes,
    }
}

fn data_folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/gltf");
    folder.canonicalize().unwrap()
}

fn data(name: &str) -> Vec<u8> {
    std::fs::read(data_folder().join(name)).unwrap()
}

fn warnings(translated: &TranslatedModel) -> Vec<String> {
    translated.warnings.iter().map(ToString::to_string).collect()
}

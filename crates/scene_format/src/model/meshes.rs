//! The meshes and images of a model file, read one by one from a file that is parsed once.

use std::path::PathBuf;

use super::error::Fault;
use super::gltf::GltfMeshes;
use super::obj::ObjMeshes;
use super::{ModelError, ModelFile, ModelKind, not_a_model};
use crate::mesh::{MeshData, MeshLimits};

/// Which triangles of a model file.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MeshPart {
    /// A mesh of a glTF file, or an object or group of an OBJ file: by its name, or `#3` by its number, from 0. None:
    /// the only mesh of a glTF file; everything in an OBJ file.
    pub mesh: Option<String>,
    /// One primitive of the mesh, from 0; in an OBJ file what has one material, in the order of the faces. None: all.
    pub primitive: Option<u32>,
}

/// A model file whose meshes and images can be read.
#[derive(Debug)]
pub struct Model<'a> {
    file: ModelFile<'a>,
    meshes: Meshes,
}

#[derive(Debug)]
enum Meshes {
    Gltf(Box<GltfMeshes>),
    Obj(Box<ObjMeshes>),
}

impl<'a> Model<'a> {
    /// Parses a file.
    ///
    /// # Errors
    ///
    /// For a file that is broken as a whole. The name of the file, the place in it and a remedy are in the message.
    pub fn open(file: ModelFile<'a>, limits: &MeshLimits) -> Result<Self, ModelError> {
        let opened = match ModelKind::of(file.path) {
            Some(ModelKind::Gltf) => GltfMeshes::open(&file, limits).map(|meshes| Meshes::Gltf(Box::new(meshes))),
            Some(ModelKind::Obj) => ObjMeshes::open(&file, limits).map(|meshes| Meshes::Obj(Box::new(meshes))),
            None => Err(not_a_model()),
        };
        match opened {
            Ok(meshes) => Ok(Self { file, meshes }),
            Err(fault) => Err(fault.in_file(file.name)),
        }
    }

    /// Reads some of its triangles.
    ///
    /// Normals are those of the file, or none. Triangles without an area are left out, with a warning.
    ///
    /// # Errors
    ///
    /// For a part that does not exist, for data that is broken, for files that cannot be read, for a mesh without a
    /// triangle that has an area.
    ///
    /// Cost: linear in the part; what the model reads from other files is read once.
    pub fn mesh(&mut self, part: &MeshPart) -> Result<MeshData, ModelError> {
        let read = match &mut self.meshes {
            Meshes::Gltf(meshes) => meshes.read(part, &self.file),
            Meshes::Obj(meshes) => meshes.read(part, &self.file),
        };
        read.map_err(|fault| fault.in_file(self.file.name))
    }

    /// Reads an image of a glTF file, encoded as it is there: PNG or JPEG, if the file keeps to its format.
    ///
    /// - `number`: index in the file's `images`.
    ///
    /// # Errors
    ///
    /// For an image that does not exist, for a file that cannot be read or lies outside of the root, for data that is
    /// not where it should be, for files that together pass the limit of bytes, for an OBJ file.
    ///
    /// Cost: a copy of the bytes; files are read once.
    pub fn image(&mut self, number: u32) -> Result<Vec<u8>, ModelError> {
        let read = match &mut self.meshes {
            Meshes::Gltf(meshes) => meshes.image(number, &self.file),
            Meshes::Obj(_) => {
                Err(Fault::unsupported("", "an OBJ file holds no images").remedy("name the image's own file"))
            }
        };
        read.map_err(|fault| fault.in_file(self.file.name))
    }

    /// Other files that were read so far, canonical, with what they hold, in the order of reading.
    #[must_use]
    pub fn other_files(&self) -> &[(PathBuf, Vec<u8>)] {
        match &self.meshes {
            Meshes::Gltf(meshes) => meshes.files(),
            Meshes::Obj(_) => &[],
        }
    }
}

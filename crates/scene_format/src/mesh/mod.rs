//! Meshes in memory, and those in Wavefront OBJ files.
//!
//! An OBJ file is read in one pass that checks every line, so that an error has a line; meshes are then built from its
//! arrays: one of the whole file, or one for each of its parts. A part is what one object or group has of one
//! material. What the materials are is said by the scene.
//!
//! Positions are kept relative to the middle of the mesh. A mesh far from its origin so loses
//! nothing when it is stored in single precision.

mod data;
mod error;
mod obj_build;
mod obj_lines;
mod obj_parts;
mod obj_scan;

use std::fs::File;
use std::io::Read;
use std::path::Path;

pub use data::MeshData;
pub use error::{MeshError, MeshPlace, MeshWarning, Oddity};

pub(crate) use data::{RawMesh, Unusable, unit};
pub(crate) use obj_lines::{Lines, keyword_and_rest, words};
pub(crate) use obj_parts::ObjParts;
pub(crate) use obj_scan::{ObjFile, Tally, numbers};

/// What a mesh may need at most.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshLimits {
    /// Bytes of the file, together with the files that it names; 1 GiB.
    pub bytes: u64,
    /// Positions, and as many normals and texture coordinates; 100,000,000.
    pub vertices: usize,
    /// Triangles; 200,000,000.
    pub triangles: usize,
}

impl Default for MeshLimits {
    fn default() -> Self {
        Self {
            bytes: 1 << 30,
            vertices: 100_000_000,
            triangles: 200_000_000,
        }
    }
}

/// Loads a mesh from an OBJ file: all of its groups and objects.
///
/// # Errors
///
/// Names the file and, where there is one, the line. Whatever could be taken for something else, or would silently be
/// left out, is an error.
pub fn load_obj(path: &Path, limits: &MeshLimits) -> Result<MeshData, MeshError> {
    let file = path.display().to_string();
    let unreadable = |source| MeshError::Unreadable {
        file: file.clone(),
        source,
    };
    if !path.metadata().map_err(unreadable)?.is_file() {
        return Err(MeshError::NotAFile { file });
    }
    let mut bytes = Vec::new();
    File::open(path)
        .map_err(unreadable)?
        .take(limits.bytes.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    parse_obj(&file, &bytes, limits)
}

/// Reads a mesh from the bytes of an OBJ file called `file`.
///
/// # Errors
///
/// As [`load_obj`].
pub fn parse_obj(file: &str, bytes: &[u8], limits: &MeshLimits) -> Result<MeshData, MeshError> {
    ObjFile::parse(file, bytes, limits)?.whole(file)
}

/// Gives the text of an OBJ file.
pub(crate) fn obj_text<'b>(file: &str, bytes: &'b [u8], limit: u64) -> Result<&'b str, MeshError> {
    if bytes.len() as u64 > limit {
        return Err(MeshError::TooLarge {
            file: file.to_owned(),
            limit,
        });
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| MeshError::NotText {
        file: file.to_owned(),
        line: 1 + bytes[..error.valid_up_to()]
            .iter()
            .filter(|&&byte| byte == b'\n')
            .count(),
    })
}

#[cfg(test)]
mod tests;

//! Meshes in Wavefront OBJ files.
//!
//! `tobj` reads them; before it does, every line is checked here, so that an error has a line and
//! `tobj` sees nothing but numbers, triangles and polygons. Groups, objects and materials are left
//! out: a file is one mesh, and what it is made of is said by the scene.
//!
//! Positions are kept relative to the middle of the mesh. A mesh far from its origin so loses
//! nothing when it is stored in single precision.

mod build;
mod error;
mod lines;
mod scan;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

pub use error::{MeshError, MeshWarning, Oddity};

/// What a mesh may need at most.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshLimits {
    /// Bytes of the file; 1 GiB.
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

/// A mesh of triangles: all groups and objects of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjMesh {
    /// The middle of the bounding box, in the units of the file.
    pub origin: DVec3,
    /// Relative to `origin`.
    pub positions: Vec<Vec3>,
    /// One for each position, unit length; only if every face of the file has them.
    pub normals: Option<Vec<Vec3>>,
    /// One for each position; only if every face of the file has them. (0, 0) is the lower left.
    pub uvs: Option<Vec<Vec2>>,
    /// Indices into the positions, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// What is odd about the file.
    pub warnings: Vec<MeshWarning>,
}

/// Loads a mesh from a file.
///
/// # Errors
///
/// Names the file and, where there is one, the line. Everything that `tobj` would take for
/// something else, or silently leave out, is an error.
pub fn load_obj(path: &Path, limits: &MeshLimits) -> Result<ObjMesh, MeshError> {
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
        .take(limits.bytes + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    parse_obj(&file, &bytes, limits)
}

/// Reads a mesh from the bytes of a file called `file`.
///
/// # Errors
///
/// As [`load_obj`].
pub fn parse_obj(file: &str, bytes: &[u8], limits: &MeshLimits) -> Result<ObjMesh, MeshError> {
    if bytes.len() as u64 > limits.bytes {
        return Err(MeshError::TooLarge {
            file: file.to_owned(),
            limit: limits.bytes,
        });
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| MeshError::NotText {
        file: file.to_owned(),
        line: 1 + bytes[..error.valid_up_to()]
            .iter()
            .filter(|&&byte| byte == b'\n')
            .count(),
    })?;
    let contents = scan::scan(text, limits).map_err(|problem| problem.in_file(file))?;
    if contents.faces == 0 {
        return Err(MeshError::NoFaces { file: file.to_owned() });
    }
    build::build(file, text, &contents)
}

#[cfg(test)]
mod tests;

//! What can be wrong with a mesh.

use std::fmt;

/// Why a mesh cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file cannot be opened or read.
    #[error("{file} cannot be read: {source}")]
    Unreadable {
        /// The file.
        file: String,
        /// The reason.
        source: std::io::Error,
    },
    /// A folder, a device, a pipe.
    #[error("{file} is not a regular file")]
    NotAFile {
        /// The file.
        file: String,
    },
    /// More bytes than the limit.
    #[error("{file} has more than {limit} bytes")]
    TooLarge {
        /// The file.
        file: String,
        /// The limit.
        limit: u64,
    },
    /// Bytes that are not UTF-8.
    #[error("{file}:{line}: this is not UTF-8 text; OBJ files are text, ASCII or UTF-8")]
    NotText {
        /// The file.
        file: String,
        /// From 1.
        line: usize,
    },
    /// A file without a single triangle or polygon.
    #[error("{file} has no faces; a mesh needs lines such as `f 1 2 3`")]
    NoFaces {
        /// The file.
        file: String,
    },
    /// Nothing but faces without area.
    #[error("{file} has no face with an area; the first {first}")]
    OnlyDegenerate {
        /// The file.
        file: String,
        /// The first of them.
        first: MeshPlace,
    },
    /// A line that cannot be read.
    #[error("{file}:{line}: {problem}")]
    Line {
        /// The file.
        file: String,
        /// From 1.
        line: usize,
        /// What is wrong with the line.
        problem: String,
    },
    /// Positions that single precision cannot hold.
    #[error("{file} is too large: its positions are more than {limit:e} apart")]
    TooWide {
        /// The file.
        file: String,
        /// In the units of the file.
        limit: f64,
    },
}

/// What is wrong with a line.
#[derive(Debug)]
pub(super) struct Problem {
    pub(super) line: usize,
    pub(super) problem: String,
}

impl Problem {
    pub(super) fn in_file(self, file: &str) -> MeshError {
        MeshError::Line {
            file: file.to_owned(),
            line: self.line,
            problem: self.problem,
        }
    }
}

/// A kind of oddity of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Oddity {
    /// A triangle with no area was left out.
    DegenerateTriangle,
    /// A face with fewer than three corners was left out.
    FewCorners,
    /// A normal has no length, so the normals of the file are not used.
    ZeroNormal,
    /// A face has no normals while others do, so the normals of the file are not used.
    PartialNormals,
    /// A face has no texture coordinates while others do, so those of the file are not used.
    PartialUvs,
}

/// How often something is odd, and where first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshWarning {
    /// What.
    pub oddity: Oddity,
    /// How often.
    pub count: usize,
    /// Where first.
    pub first: MeshPlace,
}

/// A place in the file of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshPlace {
    /// A line of a text, from 1.
    Line(usize),
    /// A triangle of a primitive, from 0.
    Triangle(usize),
    /// A vertex of a primitive, from 0.
    Vertex(usize),
    /// A primitive of a mesh, from 0.
    Primitive(usize),
}

impl fmt::Display for MeshPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "on line {line}"),
            Self::Triangle(triangle) => write!(f, "is triangle {triangle}"),
            Self::Vertex(vertex) => write!(f, "is vertex {vertex}"),
            Self::Primitive(primitive) => write!(f, "is primitive {primitive}"),
        }
    }
}

impl fmt::Display for MeshWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, first, .. } = self;
        let (one, many, effect) = match self.oddity {
            Oddity::DegenerateTriangle => ("triangle has", "triangles have", "no area, left out"),
            Oddity::FewCorners => ("face has", "faces have", "fewer than three corners, left out"),
            Oddity::ZeroNormal => ("normal has", "normals have", "no length, so none is used"),
            Oddity::PartialNormals => ("face has", "faces have", "no normals, so none are used"),
            Oddity::PartialUvs => ("face has", "faces have", "no texture coordinates, so none are used"),
        };
        let what = if *count == 1 { one } else { many };
        write!(f, "{count} {what} {effect}; the first {first}")
    }
}

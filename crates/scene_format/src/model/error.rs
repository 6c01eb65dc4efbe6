//! What can be wrong with a model.

use std::fmt;

use crate::mesh::MeshError;

/// Why a model cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The file contradicts its format.
    #[error("{file}: {problem}; {remedy}")]
    Invalid {
        /// The file.
        file: String,
        /// The place, such as `accessors[3].bufferView` or a line, and what is wrong there.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// The file needs what is not supported.
    #[error("{file}: {problem}; {remedy}")]
    Unsupported {
        /// The file.
        file: String,
        /// The place, and what is not supported.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// The file passes a limit.
    #[error("{file}: {problem}; {remedy}")]
    Limit {
        /// The file.
        file: String,
        /// The place, and the limit.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// A file that it names cannot be read.
    #[error("{file}: {problem}; {remedy}")]
    File {
        /// The file.
        file: String,
        /// The place, and what is wrong with the other file.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// A mesh whose triangles have no area: nothing of it can be seen, but nothing is wrong with the rest of the file.
    #[error("{file}: {problem}; {remedy}")]
    Flat {
        /// The file.
        file: String,
        /// The mesh.
        problem: String,
        /// What to do about it.
        remedy: String,
    },
    /// The file is an OBJ file that is wrong.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl ModelError {
    /// A stable name for the kind of trouble, in `kebab-case`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Invalid { .. } => "bad-model",
            Self::Unsupported { .. } => "unsupported-model",
            Self::Limit { .. } => "too-large",
            Self::File { .. } => "bad-model-file",
            Self::Flat { .. } => "flat-mesh",
            Self::Mesh(_) => "bad-mesh",
        }
    }
}

/// Something about a model that is odd, or left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelWarning {
    /// Where: `nodes[3].scale`, `line 5`; empty for the whole file.
    pub at: String,
    /// What.
    pub message: String,
}

impl fmt::Display for ModelWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.at.is_empty() {
            write!(f, "{}: ", self.at)?;
        }
        f.write_str(&self.message)
    }
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Invalid,
    Unsupported,
    Limit,
    File,
    Flat,
}

/// Characters of a message at most: it may quote a file that is full of nonsense.
const LONGEST_PROBLEM: usize = 500;

/// Quotes some names that a file gives, shortened, for a message.
pub(super) fn quote_some<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let short = |name: &str| format!("{:?}", name.chars().take(40).collect::<String>());
    let some: Vec<String> = names.take(10).map(short).collect();
    some.join(", ")
}

/// An error that does not know its file yet.
#[derive(Debug)]
pub(super) struct Fault(Box<Inner>);

#[derive(Debug)]
enum Inner {
    Own {
        kind: Kind,
        problem: String,
        remedy: String,
    },
    Mesh(MeshError),
}

impl From<MeshError> for Fault {
    fn from(error: MeshError) -> Self {
        Self(Box::new(Inner::Mesh(error)))
    }
}

impl Fault {
    fn new(kind: Kind, at: &str, problem: impl fmt::Display, remedy: &str) -> Self {
        let mut problem = if at.is_empty() {
            problem.to_string()
        } else {
            format!("{at}: {problem}")
        };
        if let Some((end, _)) = problem.char_indices().nth(LONGEST_PROBLEM) {
            problem.truncate(end);
            problem.push('…');
        }
        Self(Box::new(Inner::Own {
            kind,
            problem,
            remedy: remedy.to_owned(),
        }))
    }

    /// The file contradicts its format at `at`.
    pub(super) fn invalid(at: &str, problem: impl fmt::Display) -> Self {
        Self::new(
            Kind::Invalid,
            at,
            problem,
            "export the model again, or check it with a validator",
        )
    }

    /// The file needs what is not supported.
    pub(super) fn unsupported(at: &str, problem: impl fmt::Display) -> Self {
        Self::new(Kind::Unsupported, at, problem, "export the model without it")
    }

    /// The file passes a limit.
    pub(super) fn limit(at: &str, problem: impl fmt::Display) -> Self {
        Self::new(Kind::Limit, at, problem, "divide the model into several files")
    }

    /// A file that is named at `at` cannot be read.
    pub(super) fn file(at: &str, problem: impl fmt::Display) -> Self {
        Self::new(
            Kind::File,
            at,
            problem,
            "put the file beside the model, or export the model as one `.glb` file",
        )
    }

    /// Nothing of what is at `at` can be seen.
    pub(super) fn flat(at: &str, problem: impl fmt::Display) -> Self {
        Self::new(
            Kind::Flat,
            at,
            problem,
            "delete the mesh from the model, or switch its prims off",
        )
    }

    /// Replaces the advice that goes with the kind.
    pub(super) fn remedy(mut self, advice: &str) -> Self {
        if let Inner::Own { remedy, .. } = &mut *self.0 {
            advice.clone_into(remedy);
        }
        self
    }

    /// Names the file.
    pub(super) fn in_file(self, file: &str) -> ModelError {
        let file = file.to_owned();
        match *self.0 {
            Inner::Mesh(error) => ModelError::Mesh(error),
            Inner::Own { kind, problem, remedy } => match kind {
                Kind::Invalid => ModelError::Invalid { file, problem, remedy },
                Kind::Unsupported => ModelError::Unsupported { file, problem, remedy },
                Kind::Limit => ModelError::Limit { file, problem, remedy },
                Kind::File => ModelError::File { file, problem, remedy },
                Kind::Flat => ModelError::Flat { file, problem, remedy },
            },
        }
    }
}

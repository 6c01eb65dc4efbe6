//! Files that a model names, and data that it holds as text.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::{STANDARD, STANDARD_NO_PAD};
use percent_encoding::percent_decode_str;

use super::ModelFile;
use super::error::Fault;
use crate::asset::resolve_below;
use crate::diagnostic::Diagnostic;

/// Where the bytes of a URI are.
#[derive(Debug, PartialEq)]
pub(super) enum Located {
    /// In the URI itself.
    Data(Vec<u8>),
    /// In a file below the root, canonical.
    File(PathBuf),
}

/// Finds what a URI of a glTF file means.
pub(super) fn locate(uri: &str, at: &str, model: &ModelFile<'_>) -> Result<Located, Fault> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decode_data(data, at).map(Located::Data);
    }
    let name = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| Fault::invalid(at, "this is not UTF-8"))?;
    resolve_beside(&name, model)
        .map(Located::File)
        .map_err(|problem| Fault::file(at, in_words(&problem)))
}

/// Finds a file that is named relative to the model.
pub(super) fn resolve_beside(name: &str, model: &ModelFile<'_>) -> Result<PathBuf, Diagnostic> {
    let folder = model.path.parent().unwrap_or(model.root);
    resolve_below(name, folder, model.root)
}

/// Puts what is wrong with a name into one line.
pub(super) fn in_words(problem: &Diagnostic) -> String {
    match &problem.suggestion {
        Some(name) => format!("{}, did you mean `{name}`?", problem.message),
        None => problem.message.clone(),
    }
}

fn decode_data(data: &str, at: &str) -> Result<Vec<u8>, Fault> {
    let Some((kind, encoded)) = data.split_once(',') else {
        return Err(Fault::invalid(at, "this data URI has no comma"));
    };
    if !kind.ends_with(";base64") {
        return Err(Fault::unsupported(at, "this data URI is not in base64")
            .remedy("write `data:application/octet-stream;base64,` and base64 data"));
    }
    let engine = if encoded.ends_with('=') {
        STANDARD
    } else {
        STANDARD_NO_PAD
    };
    engine
        .decode(encoded)
        .map_err(|error| Fault::invalid(at, format!("this is not base64: {error}")))
}

/// Reads a file of at most `limit` bytes.
pub(super) fn read_bytes(path: &Path, limit: u64, at: &str) -> Result<Vec<u8>, Fault> {
    let unreadable = |error: std::io::Error| Fault::file(at, format!("{} cannot be read: {error}", path.display()));
    let mut bytes = Vec::new();
    File::open(path)
        .map_err(unreadable)?
        .take(limit.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > limit {
        let message = format!("with {} the model has more than its limit of bytes", path.display());
        return Err(Fault::limit(at, message));
    }
    Ok(bytes)
}

//! Files that a scene names: where they are, and that they stay below the root.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::diagnostic::{Diagnostic, nearest};
use crate::options::Limits;
use crate::scene::Scene;
use crate::source::{Origin, Place, Sources};

/// The folders that decide where files may lie; both canonical if they exist.
#[derive(Clone, Debug, Default)]
pub(crate) struct Folders {
    /// No file may lie outside of it.
    pub(crate) root: PathBuf,
    /// Where the scene's file is; names on the command line are relative to it.
    pub(crate) scene: PathBuf,
}

impl Folders {
    /// Finds the root of a scene that lies in `folder`.
    pub(crate) fn of(folder: &Path, root: Option<&Path>) -> Self {
        let canonical = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        let scene = canonical(folder);
        let root = match root {
            Some(root) => canonical(root),
            None => scene
                .ancestors()
                .find(|above| above.join("pipeline.toml").is_file())
                .unwrap_or(&scene)
                .to_path_buf(),
        };
        Self { root, scene }
    }
}

impl Scene {
    /// The folder that no file of the scene may lie outside of, canonical.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.folders.root
    }
}

/// Finds the file that `text`, written at `place`, names.
pub(crate) fn resolve(text: &str, place: Place, sources: &Sources, folders: &Folders) -> Result<PathBuf, Diagnostic> {
    let folder = match sources.get(place.source).map(|source| &source.origin) {
        Some(Origin::File { folder } | Origin::Model { folder }) => folder,
        _ => &folders.scene,
    };
    resolve_below(text, folder, &folders.root).map_err(|error| error.at(place))
}

fn escape(message: String) -> Diagnostic {
    Diagnostic::error("path-escape", message).note("files are named relative to the file that names them, with `/`")
}

/// Joins and canonicalises; the result is a regular file below `root`.
pub(crate) fn resolve_below(text: &str, folder: &Path, root: &Path) -> Result<PathBuf, Diagnostic> {
    if let Some(problem) = spelling_problem(text) {
        return Err(escape(problem));
    }
    let mut joined = folder.to_path_buf();
    for part in text.split('/') {
        match part {
            "." => {}
            ".." => {
                joined.pop();
                if !joined.starts_with(root) {
                    return Err(outside(text, root));
                }
            }
            name => joined.push(name),
        }
    }
    if !joined.starts_with(root) {
        return Err(outside(text, root));
    }
    let canonical = joined.canonicalize().map_err(|error| {
        if error.kind() != std::io::ErrorKind::NotFound {
            let message = format!("`{text}` cannot be read: {error}");
            return Diagnostic::error("unreadable-file", message);
        }
        missing_file(text, &joined)
    })?;
    if !canonical.starts_with(root) {
        return Err(escape(format!(
            "`{text}` is a link that leads out of {}",
            root.display()
        )));
    }
    if !canonical.is_file() {
        let message = format!("`{text}` is not a regular file");
        return Err(Diagnostic::error("not-a-file", message));
    }
    Ok(canonical)
}

fn outside(text: &str, root: &Path) -> Diagnostic {
    escape(format!("`{text}` lies outside of {}", root.display()))
        .note("`--root` or a `pipeline.toml` in a folder above widens what may be read")
}

fn missing_file(text: &str, joined: &Path) -> Diagnostic {
    let mut names: Vec<String> = joined
        .parent()
        .and_then(|folder| folder.read_dir().ok())
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    let wanted = joined
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    Diagnostic::error("missing-file", format!("there is no file `{text}`"))
        .suggest(nearest(&wanted, names.iter().map(String::as_str)))
        .note(format!("looked for {}", joined.display()))
}

/// Why a text is not a relative path that means the same on every system.
pub(crate) fn spelling_problem(text: &str) -> Option<String> {
    if text.is_empty() {
        return Some("the name of a file is empty".to_owned());
    }
    if text.starts_with('/') {
        return Some(format!("`{text}` is absolute"));
    }
    if text.contains('\\') {
        return Some(format!("`{text}` contains `\\`"));
    }
    if text.contains(':') {
        return Some(format!("`{text}` is a URL or names a drive"));
    }
    if text.contains(|c: char| c.is_control()) {
        return Some("the name of a file contains a control character".to_owned());
    }
    if text.split('/').any(str::is_empty) {
        return Some(format!("`{text}` contains an empty part"));
    }
    None
}

/// Reads a file of limited size.
///
/// - `name`: what people know it by.
///
/// # Errors
///
/// Without a place.
pub(crate) fn read_bytes(path: &Path, name: &str, limit: u64) -> Result<Vec<u8>, Diagnostic> {
    let unreadable = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => missing_file(name, path),
        _ => Diagnostic::error("unreadable-file", format!("{name} cannot be read: {error}")),
    };
    let status = path.metadata().map_err(unreadable)?;
    if !status.is_file() {
        let message = format!("{name} is not a regular file");
        return Err(Diagnostic::error("not-a-file", message));
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path)
        .map_err(unreadable)?
        .take(limit.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > limit {
        let message = format!("{name} has more than {limit} bytes");
        return Err(Diagnostic::error("too-large", message));
    }
    Ok(bytes)
}

/// Reads a text file of limited size.
///
/// # Errors
///
/// Without a place. For bytes that are not UTF-8 with the text up to there, whose end is the place.
pub(crate) fn read_text(path: &Path, name: &str, limits: &Limits) -> Result<String, (Diagnostic, String)> {
    let limit = limits.file_bytes.min(u32::MAX as usize) as u64;
    let mut bytes = read_bytes(path, name, limit).map_err(|error| (error, String::new()))?;
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(&error.as_bytes()[..valid]).into_owned();
        let message = "the file is not UTF-8 text from here on".to_owned();
        (Diagnostic::error("not-utf-8", message), text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_to_the_root() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let inner = root.join("inner");
        std::fs::create_dir(&inner).unwrap();
        std::fs::write(inner.join("ring.obj"), "v").unwrap();
        std::fs::write(root.join("up.obj"), "v").unwrap();
        let code = |text: &str, root: &Path| match resolve_below(text, &inner, root) {
            Ok(_) => "",
            Err(error) => error.code,
        };
        assert_eq!(code("ring.obj", &inner), "");
        assert_eq!(code("./ring.obj", &inner), "");
        assert_eq!(code("../up.obj", &root), "");
        assert_eq!(code("../up.obj", &inner), "path-escape");
        assert_eq!(code("../inner/ring.obj", &inner), "path-escape");
        for bad in ["/etc/passwd", "C:/x", "a\\b", "file:///x", "a//b", "a/", "", "a\nb"] {
            assert_eq!(code(bad, &root), "path-escape", "{bad}");
        }
        assert_eq!(code("rang.obj", &inner), "missing-file");
        assert_eq!(code("../inner", &root), "not-a-file");
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(root.join("up.obj"), inner.join("link.obj")).unwrap();
            assert_eq!(code("link.obj", &inner), "path-escape");
            assert_eq!(code("link.obj", &root), "");
        }
    }
}

//! Finding and reading the material libraries of an OBJ file.

use std::path::PathBuf;

use super::super::error::{ModelWarning, quote_some};
use super::super::files::{in_words, read_bytes, resolve_beside};
use super::super::{ModelFile, ModelLimits};
use super::mtl::Library;

/// A file with more libraries than this is no model.
const MOST_LIBRARIES: usize = 100;

/// The material libraries that a file names. What cannot be read is a warning: the shapes are there all the same.
#[derive(Default)]
pub(super) struct Libraries {
    pub(super) library: Library,
    pub(super) files: Vec<PathBuf>,
    pub(super) warnings: Vec<ModelWarning>,
    /// How many were looked for.
    count: usize,
}

impl Libraries {
    /// Reads the libraries of one line: a name that may hold blanks, else several names.
    pub(super) fn read(&mut self, names: &str, line: usize, file: &ModelFile<'_>, limits: &ModelLimits) {
        let at = format!("line {line}");
        if self.count < MOST_LIBRARIES && resolve_beside(names, file).is_ok() {
            return self.read_one(names, &at, file, limits);
        }
        for name in names.split_whitespace() {
            self.read_one(name, &at, file, limits);
        }
    }

    fn read_one(&mut self, name: &str, at: &str, file: &ModelFile<'_>, limits: &ModelLimits) {
        self.count += 1;
        if self.count == MOST_LIBRARIES {
            self.warn(
                at,
                format!("more than {MOST_LIBRARIES} libraries, so this and later ones are left out"),
            );
        }
        if self.count >= MOST_LIBRARIES {
            return;
        }
        let path = match resolve_beside(name, file) {
            Ok(path) => path,
            Err(problem) => return self.warn(at, format!("no materials: {}", in_words(&problem))),
        };
        if self.files.contains(&path) {
            return;
        }
        let bytes = read_bytes(&path, limits.text_bytes as u64, at);
        self.files.push(path);
        match bytes.as_deref().map(std::str::from_utf8) {
            Ok(Ok(text)) => {
                for (line, problem) in self.library.read(text, &|texture| find_texture(texture, name, file)) {
                    self.warn(&format!("{name}:{line}"), problem);
                }
            }
            Ok(Err(_)) => self.warn(at, format!("no materials: `{name}` is not UTF-8 text")),
            Err(_) => self.warn(at, format!("no materials: `{name}` cannot be read, or is too large")),
        }
    }

    fn warn(&mut self, at: &str, message: String) {
        self.warnings.push(ModelWarning {
            at: at.to_owned(),
            message,
        });
    }
}

/// Endings of pictures that can be read.
const PICTURES: [&str; 5] = ["png", "jpg", "jpeg", "exr", "hdr"];

/// Finds a texture that a library names relative to itself; gives its name relative to the model.
///
/// Backslashes are taken for slashes, since many programs write them.
fn find_texture(texture: &str, library: &str, file: &ModelFile<'_>) -> Result<String, String> {
    if texture.starts_with('-') {
        return Err("options of textures are not supported".to_owned());
    }
    let texture = texture.replace('\\', "/");
    let is_picture = |ending: &str| PICTURES.iter().any(|known| ending.eq_ignore_ascii_case(known));
    if !texture.rsplit_once('.').is_some_and(|(_, ending)| is_picture(ending)) {
        return Err(format!(
            "{} is no PNG, JPEG, EXR or HDR file",
            quote_some([&texture[..]].into_iter())
        ));
    }
    let name = match library.rsplit_once('/') {
        Some((folder, _)) if !texture.starts_with('/') => format!("{folder}/{texture}"),
        _ => texture,
    };
    resolve_beside(&name, file).map_err(|problem| in_words(&problem))?;
    Ok(name)
}

//! Scenes of several files, in a folder that is gone afterwards.

use std::path::Path;

use scene_format::{Diagnostics, Options, Scene, load};
use tempfile::TempDir;

use crate::vocabulary::{options, registry, schema};

/// Writes files; a name may contain folders.
pub(crate) fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

/// Loads `root.ron` of a folder.
pub(crate) fn load_in(folder: &Path, options: &Options) -> Result<Scene, Diagnostics> {
    let registry = registry();
    load(&folder.join("root.ron"), &schema(&registry), options)
}

/// Loads files of which the first is `root.ron`.
pub(crate) fn load_files(files: &[(&str, &str)], options: &Options) -> Result<Scene, Diagnostics> {
    load_in(folder(files).path(), options)
}

/// Takes the folder out of a message, so that it is the same wherever the test runs.
pub(crate) fn without_folder(text: &str, folder: &Path) -> String {
    let canonical = folder.canonicalize().unwrap();
    text.replace(&format!("{}/", folder.display()), "")
        .replace(&format!("{}/", canonical.display()), "")
        .replace(&canonical.display().to_string(), "FOLDER")
}

/// Gives all errors about files of which the first is `root.ron`, as people read them; of a scene
/// that loads the warnings.
pub(crate) fn messages_with(files: &[(&str, &str)], options: &Options) -> String {
    let folder = folder(files);
    let text = match load_in(folder.path(), options) {
        Ok(scene) => {
            let warnings: Vec<String> = scene
                .warnings
                .iter()
                .map(|warning| scene.report(warning, false))
                .collect();
            warnings.join("\n")
        }
        Err(errors) => errors.to_string(),
    };
    without_folder(&text, folder.path())
}

pub(crate) fn messages(files: &[(&str, &str)]) -> String {
    messages_with(files, &options())
}

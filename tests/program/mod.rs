//! Running the program on a scene and reading what it wrote.

use film::{ExrImage, read_exr};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A file of the project.
pub(crate) fn project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Runs a command on a scene, with options and fields that are set, and says how that ended.
pub(crate) fn attempt(command: &str, scene: &Path, options: &[&str], fields: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_pipeline"));
    program.arg(command).arg(scene).arg("--quiet").args(options);
    program.args(fields.iter().flat_map(|field| ["--set", field]));
    program.output().expect("the program starts")
}

/// The same, which has to succeed.
pub(crate) fn run(command: &str, scene: &Path, options: &[&str], fields: &[&str]) {
    let ran = attempt(command, scene, options, fields);
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{options:?} {fields:?}: {}\n{said}", ran.status);
}

/// The path of a file in a folder, as an option.
pub(crate) fn file(folder: &TempDir, name: &str) -> String {
    folder.path().join(name).to_str().expect("a path of letters").into()
}

/// Renders a scene and reads the image back.
pub(crate) fn render(scene: &Path, options: &[&str], fields: &[&str]) -> ExrImage {
    let folder = tempfile::tempdir().expect("a folder for the image");
    let output = file(&folder, "image.exr");
    run("run", scene, &[options, &["-o", &output]].concat(), fields);
    read_exr(Path::new(&output)).expect("a valid image")
}

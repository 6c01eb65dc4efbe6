//! Renders the sample models of glTF, and lays the pictures out on one sheet, `target/tmp/contact_sheet.png`.
//!
//! What each should look like is in the sample assets of Khronos; here every one must render, and show something.

#![allow(clippy::unwrap_used, reason = "a test that meets an error should fail")]

mod framing;

use framing::{View, view};
use image::imageops::replace;
use image::{Rgb, RgbImage};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Pixels of one picture, in each direction.
const SIZE: u32 = 160;

/// Pictures in a row.
const COLUMNS: u32 = 6;

/// Pixels between pictures.
const GAP: u32 = 4;

/// The largest difference of two pixels, of 255, below which a picture is of one colour. Noise stays below it.
const LEAST_CONTRAST: u8 = 24;

/// Finds the models, by name.
fn models() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/assets/gltf");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let folders = files.filter(|path| path.is_dir() && !path.ends_with("LICENSES"));
    let mut models: Vec<PathBuf> = folders.map(|folder| model_in(&folder)).collect();
    models.sort();
    models
}

fn model_in(folder: &Path) -> PathBuf {
    let name = folder.file_name().unwrap().to_str().unwrap();
    let model = |ending: &str| folder.join(format!("{name}.{ending}"));
    if model("glb").exists() {
        model("glb")
    } else {
        model("gltf")
    }
}

/// Describes a scene with the model, a lamp, and a camera unless the model has one.
fn scene(model: &Path) -> String {
    let file = model.file_name().unwrap().to_str().unwrap();
    let view = view(&fs::read(model).unwrap(), file.ends_with(".glb"));
    let (camera, path) = match view {
        View::Camera(path) => (String::new(), format!("/Model{path}")),
        View::Looking { from, at } => {
            let [from, at] = [from, at].map(|point| format!("({:?}, {:?}, {:?})", point.x, point.y, point.z));
            let transform = format!("Transform: (translate: {from}), LookAt: (target: {at})");
            let fov = framing::FOV;
            let camera = format!("    \"/Camera\": Def(Camera: (fov: {fov:?}), {transform}),\n");
            (camera, "/Camera".to_owned())
        }
    };
    format!(
        "#![enable(implicit_some)]\nLayer(prims: {{\n    \"/Model\": Def(references: [\"{file}\"]),\n{camera}    \
         \"/Sky\": Def(EnvironmentLight: (radiance: (1, 1, 1))),\n    \
         \"/Sun\": Def(DistantLight: (irradiance: (2, 2, 2)), Transform: (rotate: (-35, -25, 0))),\n    \
         \"/Render\": Def(\n        Render: (camera: \"{path}\", samples: 16),\n        \
         Film: (resolution: ({SIZE}, {SIZE}), exposure: -1),\n        \
         LightTransport: (caustic: Trace, indirect: PathTrace),\n    ),\n}})\n"
    )
}

/// Renders a model in a copy of its folder.
fn render(model: &Path) -> RgbImage {
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(model.parent().unwrap()).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    fs::write(folder.path().join("scene.ron"), scene(model)).unwrap();
    let ran = Command::new(env!("CARGO_BIN_EXE_pipeline"))
        .args(["run", "scene.ron", "-o", "out.png"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{}: {said}", model.display());
    image::open(folder.path().join("out.png")).unwrap().to_rgb8()
}

/// Panics if nothing can be seen on a picture.
fn check(picture: &RgbImage, model: &Path) {
    let values = || picture.pixels().flat_map(|pixel| pixel.0);
    let [least, most] = [values().min().unwrap(), values().max().unwrap()];
    assert!(most > LEAST_CONTRAST, "{} is black", model.display());
    assert!(most - least > LEAST_CONTRAST, "{} is of one colour", model.display());
}

#[test]
fn every_sample_shows_something() {
    let models = models();
    assert!(!models.is_empty());
    let rows = (models.len() as u32).div_ceil(COLUMNS);
    let step = SIZE + GAP;
    let mut sheet = RgbImage::from_pixel(COLUMNS * step - GAP, rows * step - GAP, Rgb([255; 3]));
    for (model, number) in models.iter().zip(0_u32..) {
        let picture = render(model);
        let [x, y] = [number % COLUMNS, number / COLUMNS].map(|cell| i64::from(cell * step));
        replace(&mut sheet, &picture, x, y);
        check(&picture, model);
    }
    sheet
        .save(Path::new(env!("CARGO_TARGET_TMPDIR")).join("contact_sheet.png"))
        .unwrap();
}

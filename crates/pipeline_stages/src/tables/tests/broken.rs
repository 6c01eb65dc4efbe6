//! Files that are broken, whole programs of them: an error that names the file and says why, or a picture of numbers.

use super::{CAMERA, RENDER, SKY, errors};
use crate::DefaultStages;
use bevy_app::App;
use pipeline_core::{CorePlugin, Counters, Outcome, render};
use pipeline_data::RenderRequest;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What becomes of a scene with a model.
#[derive(Debug, PartialEq, Eq)]
enum Verdict {
    Refused,
    Rendered,
}

fn assets() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/assets");
    folder.canonicalize().unwrap()
}

/// Every file below a folder, sorted.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                all.push(path);
            }
        }
    }
    all.sort();
    all
}

/// Renders a model of `folder` under a sky; what is wrong must be said with its name.
fn look_at(folder: &Path, name: &str) -> Verdict {
    let scene = folder.join("with a model.ron");
    let model = format!("\"/Model\": Def(references: [\"{name}\"]),\n");
    std::fs::write(
        &scene,
        format!("Layer(prims: {{\n{}}})", [&model, SKY, CAMERA, RENDER].concat()),
    )
    .unwrap();
    let output = folder.join("picture.exr");
    let mut app = App::empty();
    app.add_plugins((CorePlugin, DefaultStages));
    app.insert_resource(RenderRequest {
        scene,
        samples: Some(1),
        outputs: vec![output.clone()],
        ..RenderRequest::default()
    });
    match render(&mut app) {
        Outcome::BadScene => {
            let said = errors(&app);
            let has_name = said.contains(name);
            assert!(said.starts_with("error[") && has_name, "{name}: {said}");
            Verdict::Refused
        }
        Outcome::Finished => {
            let picture = film::read_exr(&output).unwrap().rgb("").unwrap();
            assert!(picture.pixels.iter().flatten().all(|value| value.is_finite()), "{name}");
            let counters = app.world().resource::<Counters>();
            assert_eq!(counters.get("image/rejected samples"), 0, "{name}");
            Verdict::Rendered
        }
        outcome => panic!("{name}: {outcome:?}: {}", errors(&app)),
    }
}

fn copy_folder(from: &Path) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in files_below(from) {
        let to = folder.path().join(file.strip_prefix(from).unwrap());
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(&file, to).unwrap();
    }
    folder
}

fn is_model(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ["gltf", "glb", "obj"].iter().any(|model| ending == *model))
}

#[test]
fn broken_files_are_refused_or_rendered() {
    let broken = copy_folder(&assets().join("broken"));
    let mut count = BTreeMap::new();
    for file in files_below(broken.path()).iter().filter(|file| is_model(file)) {
        let name = file.file_name().unwrap().to_str().unwrap();
        let verdict = look_at(file.parent().unwrap(), name);
        *count.entry(format!("{verdict:?}")).or_insert(0) += 1;
    }
    assert!(count["Refused"] >= 74 && count["Rendered"] >= 100, "{count:?}");
}

/// A file that was cut off anywhere: nothing of it may be taken for what is not there.
#[test]
fn cut_files_are_refused_or_rendered() {
    for (folder, name) in [
        ("gltf/BoxVertexColors", "BoxVertexColors.glb"),
        ("gltf/SimpleSparseAccessor", "SimpleSparseAccessor.gltf"),
        ("broken/obj/tinyobjloader", "cube.obj"),
    ] {
        let whole = std::fs::read(assets().join(folder).join(name)).unwrap();
        let copy = tempfile::tempdir().unwrap();
        let mut refused = 0;
        let lengths = (0..whole.len()).filter(|length| length.is_multiple_of(STEP) || length + LAST > whole.len());
        for length in lengths.clone() {
            std::fs::write(copy.path().join(name), &whole[..length]).unwrap();
            refused += usize::from(look_at(copy.path(), name) == Verdict::Refused);
        }
        // A text of lines is good wherever a line ends.
        let least = if name.ends_with("obj") { 2 } else { lengths.count() - 1 };
        assert!(refused >= least, "{name}: {refused} refused");
    }
}

/// One length in so many is tried, and the last few all.
const STEP: usize = 13;
const LAST: usize = 16;

//! What must not change a picture, and what must not shine.
//!
//! The Cornell box in other sizes and places, the layers of the film against their sum, walls that are thin, and methods
//! that are switched off. Every test runs the real binary on small images with the same seed.

use film::{ExrImage, RgbImage, compare, read_exr};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Size and place round positions and directions differently, so that a few paths take another turn; the mean of a
/// picture may move by half a percent for it.
const SAME_MEAN: f64 = 0.005;

/// The same few paths may add this much relMSE. Pictures with unlike noise would differ by more than 0.1 at these samples,
/// and so would a picture with shadows where none belong.
const SAME_PIXELS: f64 = 0.001;

/// Caustics that are met by chance leave the mean of a layer with a standard error of 3 % at the samples taken here; three
/// of these may lie between two methods.
const SAME_MEAN_OTHER_NOISE: f64 = 0.1;

/// Each layer is rounded to 24 bits on its own, and the sum of five is not associative; they permit no more than this.
const SAME_SUM: f64 = 1e-5;

/// The layers whose sum is the beauty image.
const LAYERS: [&str; 5] = ["emission", "direct", "specular", "caustic", "indirect"];

fn reference_scene(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references");
    folder.join(name).join("scene.ron")
}

/// Renders a scene with some fields set, and reads the image back.
fn render(scene: &Path, options: &str, fields: &[&str]) -> ExrImage {
    let folder = tempfile::tempdir().expect("a folder for the image");
    let output = folder.path().join("image.exr");
    let mut command = Command::new(env!("CARGO_BIN_EXE_pipeline"));
    command.arg("run").arg(scene).arg("--quiet").arg("-o").arg(&output);
    command.args(options.split_whitespace());
    for field in fields {
        command.arg("--set").arg(field);
    }
    let ran = command.output().expect("the program starts");
    let messages = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{fields:?}: {}\n{messages}", ran.status);
    read_exr(&output).expect("a valid image")
}

fn layer(image: &ExrImage, name: &str) -> RgbImage {
    image.rgb(name).expect("three channels")
}

fn is_black(image: &RgbImage) -> bool {
    image.pixels.iter().flatten().all(|value| *value == 0.0)
}

/// Renders the Cornell box as it stands, or another one that has to look like it.
fn cornell(scene: &Path, fields: &[&str]) -> ExrImage {
    render(scene, "--resolution 64x64 --samples 16", fields)
}

/// Fails unless the image is that of the Cornell box as it stands; its depths are to be `scale` times as large.
fn assert_same_picture(image: &ExrImage, scale: f64) {
    let plain = cornell(&reference_scene("cornell"), &[]);
    let found = compare(&layer(image, ""), &layer(&plain, ""), 3).expect("same size");
    assert!(found.mean_reference.iter().all(|mean| *mean > 0.01), "{found:?}");
    assert!(
        found.relative_difference.iter().all(|d| d.abs() < SAME_MEAN),
        "{found:?}"
    );
    assert!(found.rel_mse < SAME_PIXELS, "{found:?}");
    let depth = |image: &ExrImage| {
        let depths = image.channel("depth.Z").expect("a depth");
        depths.iter().map(|z| f64::from(*z)).sum::<f64>()
    };
    let ratio = depth(image) / (scale * depth(&plain));
    assert!((ratio - 1.0).abs() < SAME_MEAN, "depths are off by {ratio}");
}

#[test]
fn size_does_not_matter() {
    for scale in [0.001, 1000.0] {
        let image = cornell(
            &reference_scene("cornell"),
            &[
                &format!("/Scene.Transform.scale=({scale},{scale},{scale})"),
                &format!("/Scene/Camera.LookAt.target=(0,{scale},0)"),
            ],
        );
        assert_same_picture(&image, scale);
    }
}

#[test]
fn place_does_not_matter() {
    let image = cornell(
        &reference_scene("cornell"),
        &[
            "/Scene.Transform.translate=(7000,3000,-7000)",
            "/Scene/Camera.LookAt.target=(7000,3001,-7000)",
        ],
    );
    assert_same_picture(&image, 1.0);
}

/// Copies the Cornell box to a folder, all vertices moved.
fn move_vertices(by: [f64; 3]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let scene = reference_scene("cornell");
    fs::copy(&scene, folder.path().join("scene.ron")).expect("a copy of the scene");
    let files = fs::read_dir(scene.parent().expect("a folder")).expect("a readable folder");
    for file in files.map(|file| file.expect("a readable folder").path()) {
        if file.extension().is_none_or(|extension| extension != "obj") {
            continue;
        }
        let text = fs::read_to_string(&file).expect("a readable mesh");
        let lines: Vec<String> = text.lines().map(|line| move_vertex(line, by)).collect();
        let name = file.file_name().expect("a file has a name");
        fs::write(folder.path().join(name), lines.join("\n")).expect("room for a copy of the mesh");
    }
    folder
}

fn move_vertex(line: &str, by: [f64; 3]) -> String {
    let Some(vertex) = line.strip_prefix("v ") else {
        return line.to_owned();
    };
    let numbers = vertex
        .split_whitespace()
        .map(|word| word.parse::<f64>().expect("a number"));
    let moved: Vec<String> = numbers.zip(by).map(|(v, by)| (v + by).to_string()).collect();
    format!("v {}", moved.join(" "))
}

#[test]
fn place_of_vertices_does_not_matter() {
    assert_eq!(
        move_vertex("v -1 0 2.5", [7000.0, 3000.0, -7000.0]),
        "v 6999 3000 -6997.5"
    );
    let folder = move_vertices([7000.0, 3000.0, -7000.0]);
    let image = cornell(
        &folder.path().join("scene.ron"),
        &[
            "/Scene/Camera.Transform.translate=(7000,3001,-6996.1)",
            "/Scene/Camera.LookAt.target=(7000,3001,-7000)",
        ],
    );
    assert_same_picture(&image, 1.0);
}

/// Renders mirror and glass ball in the Cornell box, with these methods.
fn cornell_glass(methods: &[String]) -> ExrImage {
    let fields: Vec<&str> = methods.iter().map(String::as_str).collect();
    render(
        &reference_scene("cornell_glass"),
        "--resolution 48x48 --samples 16",
        &fields,
    )
}

fn method(term: &str, name: &str) -> String {
    format!("/Render.LightTransport.{term}={name}")
}

#[test]
fn layers_add_up_to_the_beauty_image() {
    for caustic in ["Trace", "PhotonMap"] {
        let image = cornell_glass(&[method("caustic", caustic)]);
        let layers = LAYERS.map(|name| layer(&image, name));
        for (name, layer) in LAYERS.iter().zip(&layers) {
            assert!(!is_black(layer), "{name} has no part in it");
        }
        for (i, beauty) in layer(&image, "").pixels.iter().enumerate() {
            for (c, whole) in beauty.iter().copied().map(f64::from).enumerate() {
                let sum: f64 = layers.iter().map(|layer| f64::from(layer.pixels[i][c])).sum();
                assert!(
                    (sum - whole).abs() <= SAME_SUM * whole,
                    "{caustic}, pixel {i}, channel {c}: layers add up to {sum}, beauty is {whole}"
                );
            }
        }
    }
}

/// Fails unless one layer is black and the others are as they were.
fn assert_only_off(image: &ExrImage, all: &ExrImage, off: &str, is_same: impl Fn(&RgbImage, &RgbImage) -> bool) {
    for name in LAYERS {
        let (with, without) = (layer(all, name), layer(image, name));
        assert!(!is_black(&with), "`{name}` has no part in it");
        if name == off {
            assert!(is_black(&without), "{off}: Off leaves light in its layer");
        } else {
            let found = compare(&without, &with, 3).expect("same size");
            assert!(is_same(&without, &with), "{off}: Off changes `{name}`: {found:?}");
        }
    }
}

#[test]
fn off_blackens_its_own_layer_alone() {
    for caustic in ["Trace", "PhotonMap"] {
        let all = cornell_glass(&[method("caustic", caustic)]);
        for off in ["direct", "specular", "caustic", "indirect"] {
            let image = cornell_glass(&[method("caustic", caustic), method(off, "Off")]);
            // Without its photons the map's later readings, behind a mirror or another wall, are traced instead.
            if (caustic, off) == ("PhotonMap", "caustic") {
                assert_only_off(&image, &all, off, has_same_mean);
            } else {
                assert_only_off(&image, &all, off, |without, with| without == with);
            }
        }
    }
}

fn has_same_mean(image: &RgbImage, other: &RgbImage) -> bool {
    let found = compare(image, other, 0).expect("same size");
    found
        .relative_difference
        .iter()
        .all(|d| d.abs() < SAME_MEAN_OTHER_NOISE)
}

/// A closed box with walls of a tenth of a millimetre and a camera and a glass ball inside; light and a mirror outside.
const CLOSED_BOX: &str = r#"#![enable(implicit_some)]
Layer(prims: {
    "/Camera": Def(Camera: (fov: 90), Transform: (translate: (0, 0, 0.45))),
    "/Render": Def(
        Render: (camera: "/Camera", samples: 32),
        Film: (resolution: (32, 32)),
        LightTransport: (caustic: Trace),
    ),
    "/Box": Def(Diffuse: (albedo: (0.9, 0.9, 0.9)), children: {
        "Right": Def(Cuboid: (size: (0.0001, 1, 1)), Transform: (translate: (0.5, 0, 0))),
        "Left": Def(Cuboid: (size: (0.0001, 1, 1)), Transform: (translate: (-0.5, 0, 0))),
        "Top": Def(Cuboid: (size: (1, 0.0001, 1)), Transform: (translate: (0, 0.5, 0))),
        "Bottom": Def(Cuboid: (size: (1, 0.0001, 1)), Transform: (translate: (0, -0.5, 0))),
        "Front": Def(Cuboid: (size: (1, 1, 0.0001)), Transform: (translate: (0, 0, 0.5))),
        "Back": Def(Cuboid: (size: (1, 1, 0.0001)), Transform: (translate: (0, 0, -0.5))),
    }),
    "/Glass": Def(Sphere: (radius: 0.2), Transform: (translate: (0.1, -0.1, -0.2)), Dielectric: ()),
    "/Mirror": Def(
        Quad: (size: (2, 2)),
        Transform: (translate: (1.5, 0, 0), rotate: (0, -90, 0)),
        Conductor: (),
    ),
    "/Lamp": Def(Sphere: (radius: 0.5), Transform: (translate: (0.5, 2, 0)), Emission: (radiance: (1000, 1000, 1000))),
    "/Sky": Def(EnvironmentLight: (radiance: (100, 100, 100))),
})
"#;

#[test]
fn no_light_comes_through_a_thin_wall() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    fs::write(&scene, CLOSED_BOX).unwrap();
    let photons = [
        "/Render.LightTransport.caustic=PhotonMap",
        "/Render.CausticPhotonMap.photons=20000",
    ];
    let traced: [&str; 0] = [];
    for methods in [&traced[..], &photons[..]] {
        let closed = render(&scene, "", methods);
        for name in [""].iter().chain(&LAYERS) {
            assert!(is_black(&layer(&closed, name)), "{methods:?}: light in layer `{name}`");
        }
        // With half of the right wall gone there is light of every kind, so that black meant something.
        let ajar = ["/Box/Right.Cuboid.size=(0.0001,1,0.5)"];
        let open = render(&scene, "", &[methods, &ajar].concat());
        for name in LAYERS {
            assert!(!is_black(&layer(&open, name)), "{methods:?}: no `{name}` to keep out");
        }
        // The mirror's light lies on the outside of the wall, a tenth of a millimetre from where it was looked for.
        let outside = [
            "/Camera.Transform.translate=(0.8,0,0)",
            "/Camera.Transform.rotate=(0,90,0)",
        ];
        let lit = render(&scene, "", &[methods, &outside].concat());
        assert!(
            !is_black(&layer(&lit, "caustic")),
            "{methods:?}: no caustic on the wall"
        );
    }
}

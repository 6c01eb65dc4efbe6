//! Scenes with a mistake: each is refused with its place and a remedy, or rendered with a warning.

use crate::program::{BALLS, Folder};

/// Replaces a part of the good scene, which must be there.
fn with(from: &str, to: &str) -> String {
    assert!(BALLS.contains(from), "{from}");
    BALLS.replacen(from, to, 1)
}

/// Checks a scene that has to be refused, with all of `expected` in the message.
fn refuse(name: &str, text: &str, expected: &[&str]) {
    let folder = Folder::with_scene(text);
    let ran = folder.run("check scene.ron");
    assert_eq!(ran.code, Some(2), "{name}\n{}", ran.stderr);
    assert_eq!(ran.stdout, "", "{name}");
    for part in expected {
        assert!(ran.stderr.contains(part), "{name}: no {part:?} in\n{}", ran.stderr);
    }
    let rendered = folder.run("run scene.ron --quiet");
    assert_eq!((rendered.code, &rendered.stderr), (Some(2), &ran.stderr), "{name}");
    assert_eq!(folder.names(), ["scene.ron"], "{name}");
}

/// Checks a scene that has to be rendered with a warning, unless `--strict`.
fn warn(name: &str, text: &str, expected: &[&str]) {
    let folder = Folder::with_scene(text);
    let ran = folder.run("check scene.ron");
    assert_eq!(ran.code, Some(0), "{name}\n{}", ran.stderr);
    for part in ["warning"].iter().chain(expected) {
        assert!(ran.stderr.contains(part), "{name}: no {part:?} in\n{}", ran.stderr);
    }
    let strict = folder.run("run scene.ron --strict");
    assert_eq!(strict.code, Some(2), "{name}\n{}", strict.stderr);
    assert!(strict.stderr.contains("--strict"), "{name}\n{}", strict.stderr);
    assert!(!strict.stderr.contains("rendering"), "{name}\n{}", strict.stderr);
    assert_eq!(folder.names(), ["scene.ron"], "{name}");
    let relaxed = folder.run("run scene.ron -o image.png");
    assert_eq!(relaxed.code, Some(0), "{name}\n{}", relaxed.stderr);
    assert_eq!(
        relaxed.stderr.matches(expected[0]).count(),
        1,
        "told once: {name}\n{}",
        relaxed.stderr
    );
}

#[test]
fn structure() {
    refuse("empty file", "", &["scene.ron"]);
    refuse("no prims", "Layer(prims: {})", &["Render"]);
    refuse("not RON", "{{{", &["scene.ron:1:"]);
    refuse("cut off", &BALLS[..BALLS.len() / 2], &["scene.ron:"]);
    refuse(
        "unknown component",
        &with("Dielectric:", "Dielectic:"),
        &["scene.ron:12:82", "`Dielectic`", "`Dielectric`"],
    );
    refuse(
        "unknown field",
        &with("ior:", "oir:"),
        &["scene.ron:12:95", "`oir`", "`ior`", "pipeline schema Dielectric"],
    );
    refuse(
        "wrong type",
        &with("radius: 0.5", "radius: \"big\""),
        &["scene.ron:12:", "a number"],
    );
    refuse(
        "two materials",
        &with("Dielectric: (ior: 1.5)", "Dielectric: (), Diffuse: ()"),
        &["/Glass", "Dielectric", "Diffuse"],
    );
    refuse(
        "two shapes",
        &with("Sphere: (radius: 0.5)", "Sphere: (), Disc: ()"),
        &["/Glass", "Sphere", "Disc"],
    );
}

#[test]
fn numbers() {
    refuse(
        "out of range",
        &with("fov: 45", "fov: 180"),
        &["scene.ron:3:", "fov", "0.01 to 179"],
    );
    refuse(
        "negative radius",
        &with("radius: 0.5", "radius: -0.5"),
        &["scene.ron:12:", "radius"],
    );
    refuse("not a number", &with("fov: 45", "fov: NaN"), &["scene.ron:3:", "fov"]);
    refuse(
        "infinite",
        &with("(8, 8, 8)", "(8, inf, 8)"),
        &["scene.ron:14:", "radiance"],
    );
    refuse(
        "singular",
        &with("rotate: (-90, 0, 0)", "scale: (1, 1, 0)"),
        &["scene.ron:10:", "/Floor"],
    );
    refuse(
        "resolution",
        &with("(32, 32)", "(1000000, 32)"),
        &["scene.ron:6:", "resolution", "65536"],
    );
    refuse(
        "no pixels",
        &with("(32, 32)", "(0, 32)"),
        &["scene.ron:6:", "resolution"],
    );
    refuse(
        "memory",
        &with("(32, 32)", "(65536, 65536)"),
        &["scene.ron:6:", "GiB", "--crop"],
    );
    refuse(
        "photons",
        &with("photons: 2000", "photons: 4000000000"),
        &["scene.ron:8:", "photons"],
    );
    refuse(
        "no photons",
        &with("photons: 2000", "photons: -1"),
        &["scene.ron:8:", "photons"],
    );
    refuse(
        "samples",
        &with("samples: 4", "samples: 0"),
        &["scene.ron:5:", "samples"],
    );
}

#[test]
fn distances() {
    let far = "reaches further than 1e15 m";
    refuse(
        "huge radius",
        &with("radius: 0.5", "radius: 1e30"),
        &["scene.ron:12:", far],
    );
    refuse(
        "huge scale",
        &with("rotate: (-90, 0, 0)", "scale: (1e25, 1e25, 1e25)"),
        &["scene.ron:10:", far],
    );
    refuse(
        "far camera",
        &with("(0, 1, 4)", "(0, 1, 4e30)"),
        &["scene.ron:3:", "/Camera", "too far"],
    );
    warn(
        "far ball",
        &with("(0.7, 0.5, -0.4)", "(1e12, 0, 0)"),
        &["lost-in-rounding", "scene.ron:10:", "rounding distorts"],
    );
}

/// Renders a scene whose image is black, which only rendering shows.
fn find_black(name: &str, text: &str, expected: &str) {
    let folder = Folder::with_scene(text);
    let ran = folder.run("run scene.ron -o image.png --quiet");
    assert_eq!(ran.code, Some(0), "{name}\n{}", ran.stderr);
    for part in ["warning[black-image]", "scene.ron:5:", expected] {
        assert!(ran.stderr.contains(part), "{name}: no {part:?} in\n{}", ran.stderr);
    }
    let strict = folder.run("run scene.ron -o image.png --strict");
    assert_eq!(strict.code, Some(2), "{name}\n{}", strict.stderr);
}

#[test]
fn a_black_image_never_comes_without_a_word() {
    find_black(
        "the camera looks away",
        &with("translate: (0, 1, 4)", "translate: (0, 1, 4), rotate: (0, 180, 0)"),
        "sees neither geometry nor an environment",
    );
    find_black(
        "the lamp lies above everything and shines up",
        &with("(0, 2.5, 0), rotate: (90, 0, 0)", "(0, 3.5, 0), rotate: (-90, 0, 0)"),
        "no light comes from it",
    );
}

#[test]
fn camera_and_lights() {
    let camera = r#""/Camera": Def(Camera: (fov: 45), Transform: (translate: (0, 1, 4))),"#;
    refuse("no camera prim", &with(camera, ""), &["scene.ron:5:", "/Camera"]);
    refuse(
        "no camera component",
        &with("Camera: (fov: 45), ", ""),
        &["/Camera", "Camera"],
    );
    refuse(
        "no camera named",
        &with("camera: \"/Camera\", ", ""),
        &["scene.ron:5:", "camera"],
    );
    refuse(
        "no render prim",
        &with("Render: (camera: \"/Camera\", samples: 4),", ""),
        &["Render"],
    );
    let twice = with(
        "\"/Floor\"",
        "\"/Other\": Def(Render: (camera: \"/Camera\")),\n    \"/Floor\"",
    );
    refuse("two render prims", &twice, &["/Other", "Render"]);
    refuse(
        "no light",
        &with("Emission: (radiance: (8, 8, 8))", "Diffuse: ()"),
        &["scene.ron has no light", "PointLight"],
    );
    refuse(
        "dark emitter without area",
        &with("Quad: (size: (1, 1))", "Quad: (size: (0, 1))"),
        &["scene.ron:14:", "size"],
    );
    let aimed = with("Camera: (fov: 45)", "Camera: (), LookAt: (target: (0, 9, 4))");
    refuse("view along up", &aimed, &["scene.ron:3:", "up"]);
}

#[test]
fn methods() {
    warn(
        "settings of a method that is not chosen",
        &with("caustic: PhotonMap", "caustic: Trace"),
        &["`CausticPhotonMap` has no effect", "scene.ron:8:"],
    );
    refuse(
        "unknown method",
        &with("indirect: PathTrace", "indirect: Magic"),
        &["scene.ron:7:", "PathTrace"],
    );
}

#[test]
fn files() {
    let folder = Folder::new();
    let ran = folder.run("check none.ron");
    assert_eq!(ran.code, Some(2));
    insta::assert_snapshot!(ran.stderr, @"
    error[missing-file]: there is no file `none.ron`
       = looked for none.ron
    ");
    std::fs::create_dir(folder.path("folder.ron")).unwrap();
    folder.write("bytes.ron", [0xff, 0xfe, 0]);
    for name in ["folder.ron", "bytes.ron"] {
        let ran = folder.run(&format!("check {name}"));
        assert_eq!(ran.code, Some(2), "{}", ran.stderr);
        assert!(ran.stderr.contains(name), "{}", ran.stderr);
    }
}

#[cfg(unix)]
#[test]
fn an_unreadable_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::with_scene(BALLS);
    let path = folder.path("scene.ron");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o0)).unwrap();
    if std::fs::read(&path).is_ok() {
        return; // The super-user reads everything.
    }
    let ran = folder.run("check scene.ron");
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("scene.ron"), "{}", ran.stderr);
}

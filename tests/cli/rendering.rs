//! `run` and `profile`: files, reports, options.

use crate::program::{BALLS, Folder, assert_whole_png};

#[test]
fn default_outputs_are_named_after_the_scene() {
    let folder = Folder::with_scene(BALLS);
    let ran = folder.succeed("run scene.ron");
    assert_eq!(folder.names(), ["scene.exr", "scene.png", "scene.ron"]);
    assert_eq!(ran.stdout, "");
    assert!(ran.stderr.contains("4 samples a pixel in "), "{}", ran.stderr);
    assert!(
        ran.stderr.contains("wrote scene.exr\nwrote scene.png"),
        "{}",
        ran.stderr
    );
    assert!(
        !ran.stderr.contains('\x1b'),
        "no colour and no bar in a log: {}",
        ran.stderr
    );
    assert_whole_png(&folder.bytes("scene.png"));
    let image = film::read_exr(&folder.path("scene.exr")).unwrap();
    assert_eq!((image.width, image.height), (32, 32));
    let beauty = image.rgb("").unwrap();
    assert!(
        beauty
            .pixels
            .iter()
            .flatten()
            .all(|value| value.is_finite() && *value >= 0.0)
    );
    assert!(beauty.pixels.iter().flatten().any(|value| *value > 0.0));
    for layer in ["direct", "specular", "caustic", "indirect", "emission"] {
        assert!(image.rgb(layer).is_some(), "{layer}");
    }
    assert_eq!(image.attribute("pipeline.samples"), Some("4"));
}

/// White surfaces of several layers under a white sky, which reflect each other too.
const FURNACE: &str = r#"#![enable(implicit_some)]
Layer(prims: {
    "/Floor": Def(Quad: (size: (9, 9)), Transform: (translate: (0, -1, 0), rotate: (-90, 0, 0)),
        Plastic: (albedo: (1, 1, 1), roughness: 0.4)),
    "/Lacquer": Def(Sphere: (radius: 0.5), Transform: (translate: (-0.6, 0.4, 0)), Plastic: (albedo: (1, 1, 1))),
    "/Metal": Def(Sphere: (radius: 0.5), Transform: (translate: (0.6, 0.4, 0)),
        Principled: (base_color: (1, 1, 1), metallic: 1, roughness: 0.6, clearcoat: 1)),
    "/Glass": Def(Sphere: (radius: 0.5), Transform: (translate: (-0.6, -0.6, 0)),
        Principled: (base_color: (1, 1, 1), transmission: 1, thickness: 1, roughness: 0, clearcoat: 0.5)),
    "/Mixture": Def(Sphere: (radius: 0.5), Transform: (translate: (0.6, -0.6, 0)),
        Principled: (base_color: (1, 1, 1), metallic: 0.3, transmission: 0.3, roughness: 0.3, clearcoat: 0.5,
            clearcoat_roughness: 0.2)),
    "/Sky": Def(EnvironmentLight: (radiance: (1, 1, 1))),
    "/Camera": Def(Camera: (fov: 40), Transform: (translate: (0, 0, 3.5))),
    "/Render": Def(Render: (camera: "/Camera", samples: 64), Film: (resolution: (24, 24)),
        LightTransport: (caustic: Trace, indirect: PathTrace)),
})
"#;

#[test]
fn layered_materials_disappear_in_a_furnace() {
    /// What a lossless surface may lose or gain, of the mean of all pixels.
    const OF_THE_MEAN: f32 = 0.005;
    let folder = Folder::with_scene(FURNACE);
    folder.succeed("run scene.ron --quiet -o image.exr");
    let image = film::read_exr(&folder.path("image.exr")).unwrap();
    let beauty = image.rgb("").unwrap();
    for channel in 0..3 {
        let sum: f32 = beauty.pixels.iter().map(|pixel| pixel[channel]).sum();
        let mean = sum / beauty.pixels.len() as f32;
        assert!((mean - 1.0).abs() < OF_THE_MEAN, "channel {channel}: {mean}");
    }
    for layer in ["direct", "specular", "indirect"] {
        let pixels = image.rgb(layer).unwrap().pixels;
        assert!(pixels.iter().flatten().any(|value| *value > 0.1), "{layer}");
    }
}

#[test]
fn a_quiet_run_says_nothing() {
    let folder = Folder::with_scene(BALLS);
    let ran = folder.succeed("run scene.ron --quiet -o image.png");
    assert_eq!((ran.stdout.as_str(), ran.stderr.as_str()), ("", ""));
    assert_eq!(folder.names(), ["image.png", "scene.ron"]);
}

#[test]
fn options_reach_the_image() {
    let folder = Folder::with_scene(BALLS);
    let image = |options: &str| {
        folder.succeed(&format!("run scene.ron -o image.exr {options}"));
        film::read_exr(&folder.path("image.exr")).unwrap()
    };
    let plain = image("");
    assert_eq!(
        image("").channels,
        plain.channels,
        "the same command gives the same image"
    );
    assert_ne!(image("--seed 7").channels, plain.channels);
    assert_ne!(image("--samples 5").channels, plain.channels);
    let mean = |image: &film::ExrImage| {
        let red = image.channel("R").unwrap();
        red.iter().sum::<f32>() / red.len() as f32
    };
    let bright = image("--set /Lamp.Emission.radiance=(16,16,16)");
    assert!(mean(&bright) > 1.5 * mean(&plain), "{} {}", mean(&bright), mean(&plain));
    let small = image("--resolution 20x10");
    assert_eq!((small.width, small.height), (20, 10));
}

#[test]
fn a_crop_has_the_pixels_of_the_whole_image() {
    let folder = Folder::with_scene(BALLS);
    folder.succeed("run scene.ron -o whole.exr");
    folder.succeed("run scene.ron -o part.exr --crop 5,7,21,30");
    let whole = film::read_exr(&folder.path("whole.exr")).unwrap();
    let part = film::read_exr(&folder.path("part.exr")).unwrap();
    assert_eq!((part.width, part.height), (16, 23));
    assert_eq!((part.window.0.x, part.window.0.y), (5, 7));
    let (whole, part) = (whole.rgb("").unwrap(), part.rgb("").unwrap());
    for y in 0..23 {
        for x in 0..16 {
            let (here, there) = (part.pixels[y * 16 + x], whole.pixels[(y + 7) * 32 + x + 5]);
            assert_eq!(here, there, "{x},{y}");
        }
    }
}

#[test]
fn a_time_limit_ends_on_a_whole_pass() {
    let folder = Folder::with_scene(BALLS);
    let ran = folder.succeed("run scene.ron -o image.exr --samples 4000000 --time-limit 200ms");
    assert!(ran.stderr.contains("samples a pixel in "), "{}", ran.stderr);
    assert!(ran.stderr.contains("--time-limit 200ms --resume"), "{}", ran.stderr);
    let image = film::read_exr(&folder.path("image.exr")).unwrap();
    let samples: u32 = image.attribute("pipeline.samples").unwrap().parse().unwrap();
    assert!((1..4_000_000).contains(&samples), "{samples}");
    folder.succeed(&format!("run scene.ron -o same.exr --samples {samples}"));
    let same = film::read_exr(&folder.path("same.exr")).unwrap();
    assert_eq!(image.channels, same.channels);
}

#[test]
fn profiles_name_systems_and_counters() {
    let folder = Folder::with_scene(BALLS);
    let ran = folder.succeed("profile scene.ron --profile table.json --trace trace.json");
    for word in [
        "system",
        "per item",
        "all systems",
        "image/samples",
        "image/rejected samples",
    ] {
        assert!(ran.stdout.contains(word), "{word}\n{}", ran.stdout);
    }
    assert_eq!(ran.stdout.contains("peak memory"), cfg!(target_os = "linux"));
    assert_eq!(folder.names(), ["scene.ron", "table.json", "trace.json"]);
    let json = |name: &str| serde_json::from_slice::<serde_json::Value>(&folder.bytes(name)).unwrap();
    let rows = json("table.json");
    let names: Vec<&str> = rows
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["system"].as_str().unwrap())
        .collect();
    assert!(names.iter().any(|name| name.ends_with("trace_paths")), "{names:?}");
    assert!(!json("trace.json")["traceEvents"].as_array().unwrap().is_empty());
}

#[test]
fn profiling_changes_no_bit() {
    let folder = Folder::with_scene(BALLS);
    folder.succeed("run scene.ron -o plain.exr");
    folder.succeed("run scene.ron -o profiled.exr --trace trace.json");
    assert!(folder.bytes("plain.exr") == folder.bytes("profiled.exr"));
}

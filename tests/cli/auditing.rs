//! `audit`: bias that is planted is found, and where there is none, none is.

use crate::program::{Folder, assert_whole_png};

/// A room of two halves with a wall between them, one lit and one not but through a gap: where a map with too large a
/// radius leaks.
const ROOM: &str = r#"#![enable(implicit_some)]
Layer(prims: {
    "/Camera": Def(Camera: (fov: 60), Transform: (translate: (0, 1.4, 2.9)), LookAt: (target: (0, 0.6, 0))),
    "/Render": Def(
        Render: (camera: "/Camera", samples: 32),
        Film: (resolution: (64, 48)),
        LightTransport: (indirect: PathTrace, caustic: Trace),
    ),
    "/Floor": Def(Quad: (size: (4, 4)), Transform: (rotate: (-90, 0, 0)), Diffuse: (albedo: (0.7, 0.6, 0.5))),
    "/Back": Def(Quad: (size: (4, 4)), Transform: (translate: (0, 1, -2)), Diffuse: (albedo: (0.5, 0.5, 0.6))),
    "/Between": Def(Cuboid: (size: (0.02, 1.2, 2)), Transform: (translate: (0, 0.6, -1)), Diffuse: (albedo: (0.6, 0.6, 0.6))),
    "/Lamp": Def(Sphere: (radius: 0.2), Transform: (translate: (-1.2, 0.6, -0.5)), Emission: (radiance: (4, 4, 4))),
})
"#;

/// Enough to find what is planted, few enough for a test.
const QUICK: &str = "audit scene.ron --traced-samples 64 --blocks 24 --budget 1h --quiet";

#[test]
fn methods_without_bias_pass() {
    let folder = Folder::with_scene(ROOM);
    for trial in 0..4 {
        let ran = folder.succeed(&format!("{QUICK} --trial {trial}"));
        assert!(ran.stdout.contains("no bias of more than 1 % found"), "{}", ran.stdout);
        assert!(ran.stdout.starts_with("24 blocks"), "{}", ran.stdout);
    }
    // Guided paths have none either.
    let guided = "--set /Render.PathGuiding.photons=20000";
    folder.succeed(&format!("{QUICK} {guided}"));
}

#[test]
fn photons_that_leak_through_a_wall_are_found() {
    let folder = Folder::with_scene(ROOM);
    let leaking = "--set /Render.LightTransport.direct=PhotonMap --set /Render.DirectPhotonMap.nearest=2000 \
                   --set /Render.DirectPhotonMap.max_radius=0.6 --set /Render.DirectPhotonMap.photons=20000";
    let ran = folder.run(&format!("{QUICK} {leaking} -o map.exr -o map.png"));
    assert_eq!(ran.code, Some(1), "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stdout.contains("biased: "), "{}", ran.stdout);
    assert!(
        ran.stderr.contains("error: the image is biased by more than 1 %"),
        "{}",
        ran.stderr
    );
    assert_whole_png(&folder.bytes("map.png"));
    let map = film::read_exr(&folder.path("map.exr")).unwrap();
    for channel in ["R", "ours.G", "traced.B", "error.R", "chance.G"] {
        let values = map.channel(channel).unwrap();
        assert!(values.iter().any(|value| *value != 0.0), "{channel}");
        // 24 of 48 blocks.
        assert!(
            values.iter().filter(|value| **value == 0.0).count() >= 64 * 48 / 2,
            "{channel}"
        );
    }
    // Nothing is wrong with what nobody can see.
    let blind = folder.succeed(&format!("{QUICK} {leaking} --tolerance 99%"));
    assert!(blind.stdout.contains("no bias"), "{}", blind.stdout);
}

#[test]
fn layers_that_are_off_stay_off() {
    let folder = Folder::with_scene(ROOM);
    let ran = folder.succeed(&format!("{QUICK} --set /Render.LightTransport.indirect=Off"));
    assert!(!ran.stdout.contains("indirect"), "{}", ran.stdout);
}

#[test]
fn audits_are_the_same_on_any_number_of_threads() {
    let folder = Folder::with_scene(ROOM);
    let printed = |threads: u32| folder.succeed(&format!("{QUICK} --json --threads {threads}")).stdout;
    let first = printed(1);
    assert_eq!(printed(3), first);
    let value: serde_json::Value = serde_json::from_str(&first).unwrap();
    assert_eq!(value["biased"], false);
    assert_eq!(value["traced_samples"], 64);
    assert!(value["blocks"].as_array().unwrap().len() > 24);
}

#[test]
fn what_cannot_be_audited_is_refused() {
    let folder = Folder::with_scene(ROOM);
    let ran = folder.run(&format!("{QUICK} --set /Render.Render.camera=\"/None\""));
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    for bad in [
        "--tolerance 2",
        "--confidence 10%",
        "--blocks 0",
        "--traced-samples 4",
        "-o a.jpg",
    ] {
        assert_eq!(folder.run(&format!("audit scene.ron {bad}")).code, Some(2), "{bad}");
    }
    // Many pixels and no time: the first pass takes too few samples.
    let hurried = folder.run("audit scene.ron --quiet --resolution 512x512 --blocks 100000 --samples 1 --budget 1ms");
    assert_eq!(hurried.code, Some(1), "{}", hurried.stderr);
    assert!(hurried.stderr.contains("the budget was spent"), "{}", hurried.stderr);
}

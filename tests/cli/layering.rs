//! Scenes of several layers: `flatten`, `explain`, variants, models.

use crate::program::{BALLS, Folder};

/// A shot over a layout; the ball's material is a variant.
const SHOT: &str = r#"#![enable(implicit_some)]
Layer(
    sublayers: ["layout.ron"],
    prims: {"/Mirror": Over(
        select: {"metal": "gold"},
        variants: {"metal": {"gold": (Conductor: (metal: "gold")), "copper": (Conductor: (metal: "copper"))}},
        Conductor: (reflectance: Block),
    )},
)
"#;

fn shot() -> Folder {
    let folder = Folder::with_scene(SHOT);
    folder.write("layout.ron", BALLS);
    folder
}

/// Whether two pictures are not the same; the files differ by the hash of the scene anyway.
fn differ(folder: &Folder, a: &str, b: &str) -> bool {
    match folder.run(&format!("compare {a} {b} --max-relmse 0.001")).code {
        Some(0) => false,
        Some(1) => true,
        other => panic!("compare ended with {other:?}"),
    }
}

#[test]
fn a_flat_scene_renders_the_same_picture() {
    let folder = shot();
    let flat = folder.succeed("flatten scene.ron");
    assert!(
        flat.stdout.starts_with("#![enable(implicit_some)]\nLayer(\n"),
        "{}",
        flat.stdout
    );
    folder.write("flat.ron", &flat.stdout);
    assert_eq!(folder.succeed("flatten flat.ron").stdout, flat.stdout);
    folder.succeed("run scene.ron -q -o a.exr");
    folder.succeed("run flat.ron -q -o b.exr");
    // Not the scene's name, only its hash is in the file.
    assert!(
        folder.bytes("a.exr") == folder.bytes("b.exr"),
        "the same scene, the same bits"
    );
}

#[test]
fn a_variant_changes_the_picture_and_a_camera_can_be_set() {
    let folder = shot();
    folder.succeed("run scene.ron -q -o gold.exr");
    folder.succeed("run scene.ron -q -o copper.exr --variant /Mirror{metal=copper}");
    folder.succeed("run scene.ron -q -o near.exr --set /Camera.Camera.fov=20");
    assert!(differ(&folder, "gold.exr", "copper.exr") && differ(&folder, "gold.exr", "near.exr"));
    assert!(!differ(&folder, "gold.exr", "gold.exr"));
    let ran = folder.run("check scene.ron --variant /Mirror{metal=cooper}");
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("did you mean `copper`?"), "{}", ran.stderr);
}

#[test]
fn explain_tells_who_wins() {
    let folder = shot();
    let ran = folder.succeed("explain scene.ron /Mirror.reflectance");
    insta::assert_snapshot!(ran.stdout, @r"
    /Mirror.Conductor.reflectance = the default (blocked)
      1  scene.ron:7    Block            local  <- wins
      2  layout.ron:13  (0.9, 0.9, 0.9)  local  weaker: scene.ron is above layout.ron in the sublayers
    ");
    let ran = folder.run("explain scene.ron /Mirror.Conductor.reflectanse");
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("did you mean `reflectance`?"), "{}", ran.stderr);
}

#[test]
fn flatten_writes_json_for_tools() {
    let folder = shot();
    let json = folder.succeed("flatten --json scene.ron").stdout;
    let answer: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(answer["status"], "ok");
    assert_eq!(answer["prims"].as_array().unwrap().len(), 7);
    let ran = folder.run("flatten --json scene.ron --set /Camera.fvo=3");
    assert_eq!(ran.code, Some(2));
    let answer: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(answer["errors"][0]["code"], "unknown-field");
}

#[test]
fn limits_can_be_changed() {
    let folder = shot();
    let ran = folder.run("check scene.ron --limit layers=1");
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("too-many-layers"), "{}", ran.stderr);
    let ran = folder.run("check scene.ron --limit layer=1");
    assert!(ran.stderr.contains("index_nodes"), "{}", ran.stderr);
}

#[test]
fn a_node_of_a_model_takes_another_material() {
    let folder = Folder::with_scene(
        r#"#![enable(implicit_some)]
Layer(prims: {
    "/Camera": Def(Camera: (fov: 45), Transform: (translate: (0, 0, 4))),
    "/Render": Def(Render: (camera: "/Camera", samples: 1), Film: (resolution: (16, 16)), LightTransport: (caustic: Trace)),
    "/Sky": Def(EnvironmentLight: ()),
    "/Blue": Def(Diffuse: (albedo: (0.1, 0.2, 0.8))),
    "/Model": Def(references: ["model.glb"]),
})
"#,
    );
    folder.write(
        "model.glb",
        include_bytes!("../../crates/scene_format/tests/data/gltf/Box.glb"),
    );
    let node = "/Model/Node0/Node1";
    folder.succeed("run scene.ron -q -o a.exr");
    folder.succeed(&format!(
        "run scene.ron -q -o b.exr --set {node}.MaterialBinding.target=\"/Blue\""
    ));
    assert!(differ(&folder, "a.exr", "b.exr"));
}

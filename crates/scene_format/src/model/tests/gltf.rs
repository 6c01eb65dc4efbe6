//! From glTF files to prims.

use glam::{DQuat, DVec3, Vec3};
use serde_json::json;

use super::document::{changed, square};
use super::vocabulary::{
    Camera, MaterialBinding, Mesh, PointLight, Principled, SpotLight, Transform, component, compose, paths,
};
use super::*;

fn composed(changes: &[(&str, serde_json::Value)]) -> (crate::Scene, Vec<String>) {
    let translated = translate("square.gltf", &changed(changes)).unwrap();
    (compose(&translated.text), warnings(&translated))
}

#[test]
fn the_layer_reads_like_one_that_a_person_wrote() {
    let translated = translate("my square.gltf", square().to_string().as_bytes()).unwrap();
    insta::assert_snapshot!(translated.text, @r#"
    Layer(
        default_prim: "my_square",
        prims: {
            "/my_square": Def(
                children: {
                    "Materials": Def(
                        children: {
                            "Gold": Def(
                                Principled: (base_color: (1.0, 0.75, 0.25), metallic: 1.0, roughness: 0.25),
                            ),
                        },
                    ),
                    "Top": Def(
                        children: {
                            "Square": Def(
                                Mesh: (file: "my square.gltf"),
                                MaterialBinding: (target: "/my_square/Materials/Gold"),
                            ),
                        },
                    ),
                },
            ),
        },
    )
    "#);
    assert!(translated.warnings.is_empty() && translated.files.is_empty());
    let scene = compose(&translated.text);
    assert_eq!(scene.default_prim.as_deref(), Some("/my_square"));
}

#[test]
fn placements_keep_every_digit() {
    let (scene, _) = composed(&[
        ("/nodes/0/translation", json!([0.1, 1e-7, -12345678.9])),
        ("/nodes/0/rotation", json!([0.0, 0.6, 0.0, 0.8])),
        ("/nodes/0/scale", json!([-1.0, 2.0, 0.3])),
        (
            "/nodes/1/matrix",
            json!([0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7.000000001, 1]),
        ),
    ]);
    let top: Transform = component(&scene, "/square/Top", "Transform");
    assert_eq!(top.translate, DVec3::new(0.1, 1e-7, -12345678.9));
    assert_eq!(top.scale, DVec3::new(-1.0, 2.0, 0.3), "a negative scale mirrors");
    assert_eq!(top.quaternion, Some(DQuat::from_xyzw(0.0, 0.6, 0.0, 0.8)));
    let inner: Transform = component(&scene, "/square/Top/Square", "Transform");
    assert_eq!(inner.matrix.unwrap().w_axis.to_array(), [5.0, 6.0, 7.000000001, 1.0]);
}

#[test]
fn what_is_scaled_to_nothing_is_switched_off() {
    let (scene, warnings) = composed(&[("/nodes/0/scale", json!([0, 1, 1]))]);
    assert_eq!(warnings, ["nodes[0]: it is scaled to nothing, so it is switched off"]);
    let top = scene.prims.iter().find(|prim| prim.name == "Top").unwrap();
    assert!(!top.active);
}

#[test]
fn names_become_legal_and_unlike() {
    let (scene, _) = composed(&[
        ("/nodes/0/name", json!("Würfel \"1\"")),
        ("/nodes/0/children", json!([1, 2, 3, 4, 5, 6])),
        ("/nodes/1/name", json!("a_2")),
        ("/nodes/-", json!({"name": "a"})),
        ("/nodes/-", json!({"name": "a"})),
        ("/nodes/-", json!({"name": "a"})),
        ("/nodes/-", json!({"name": "9/\u{1}"})),
        ("/nodes/-", json!({})),
        ("/scenes/0/nodes", json!([0, 7])),
        ("/nodes/-", json!({"name": "Materials"})),
    ]);
    assert_eq!(
        paths(&scene)[3..],
        [
            "/square/W_rfel__1_",
            "/square/W_rfel__1_/a_2",
            "/square/W_rfel__1_/a",
            "/square/W_rfel__1_/a_3",
            "/square/W_rfel__1_/a_4",
            "/square/W_rfel__1_/_9__",
            "/square/W_rfel__1_/Node6",
            "/square/Materials_2",
        ]
    );
    assert_eq!(scene.prims[3].doc.as_deref(), Some("Würfel \"1\""));
    assert_eq!(scene.prims[5].doc, None);
    assert_eq!(scene.prims[6].doc.as_deref(), Some("a"));
    assert_eq!(scene.prims[8].doc.as_deref(), Some("9/ "));
}

#[test]
fn names_are_not_too_long_and_many_alike_are_quick() {
    let long = "x".repeat(300);
    let mut nodes = vec![json!({"name": long}); 5_000];
    nodes.push(json!({"name": "y"}));
    let all: Vec<usize> = (0..nodes.len()).collect();
    let (scene, _) = composed(&[("/nodes", json!(nodes)), ("/scenes/0/nodes", json!(all))]);
    assert_eq!(scene.prims.len(), 5_004);
    assert!(scene.prims.iter().all(|prim| prim.name.len() <= 128));
}

#[test]
fn each_primitive_has_its_own_prim_and_material() {
    let plain = json!({"attributes": {"POSITION": 0}, "indices": 3});
    let (scene, warnings) = composed(&[
        ("/meshes/0/primitives/-", plain.clone()),
        (
            "/meshes/0/primitives/-",
            json!({"attributes": {"POSITION": 0}, "mode": 0}),
        ),
        ("/meshes/-", json!({"name": "Flat", "primitives": [plain]})),
        ("/nodes/1/children", json!([2])),
        ("/nodes/-", json!({"name": "Primitive1", "mesh": 1})),
    ]);
    assert_eq!(
        warnings,
        ["not supported yet, so left out: points, lines and primitives without positions"]
    );
    let first: Mesh = component(&scene, "/square/Top/Square/Primitive0", "Mesh");
    assert_eq!((first.mesh.as_deref(), first.primitive), (Some("#0"), Some(0)));
    assert_eq!(first.file.0, "square.gltf");
    let bound = |path: &str| component::<MaterialBinding>(&scene, path, "MaterialBinding").target.0;
    assert_eq!(bound("/square/Top/Square/Primitive0"), "/square/Materials/Gold");
    assert_eq!(bound("/square/Top/Square/Primitive1"), "/square/Materials/Default");
    let child: Mesh = component(&scene, "/square/Top/Square/Primitive1_2", "Mesh");
    assert_eq!((child.mesh.as_deref(), child.primitive), (Some("#1"), None));
    let default: Principled = component(&scene, "/square/Materials/Default", "Principled");
    assert_eq!(
        (default.base_color, default.metallic, default.roughness),
        (Vec3::ONE, 1.0, 1.0)
    );
}

#[test]
fn lights_and_cameras() {
    let (scene, warnings) = composed(&[
        (
            "/extensions",
            json!({"KHR_lights_punctual": {"lights": [
                {"type": "point", "color": [1.0, 0.5, 0.25], "intensity": 4},
                {"type": "spot", "intensity": 2, "spot": {"outerConeAngle": 0.5}},
                {"type": "directional"},
            ]}}),
        ),
        (
            "/cameras",
            json!([
                {"type": "perspective", "perspective": {"yfov": std::f64::consts::FRAC_PI_3, "znear": 0.1}},
                {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 2, "znear": 1}},
            ]),
        ),
        ("/nodes/0/extensions", json!({"KHR_lights_punctual": {"light": 0}})),
        ("/nodes/0/children", json!([1, 2, 3])),
        ("/nodes/1/camera", json!(0)),
        (
            "/nodes/-",
            json!({"extensions": {"KHR_lights_punctual": {"light": 1}}, "camera": 1}),
        ),
        ("/nodes/-", json!({"extensions": {"KHR_lights_punctual": {"light": 2}}})),
    ]);
    let point: PointLight = component(&scene, "/square/Top", "PointLight");
    assert_eq!(point.intensity, Some(Vec3::new(4.0, 2.0, 1.0)));
    let spot: SpotLight = component(&scene, "/square/Top/Node2", "SpotLight");
    assert_eq!((spot.inner_angle, spot.outer_angle), (0.0, 28.647_89));
    let camera: Camera = component(&scene, "/square/Top/Square", "Camera");
    assert!((camera.fov - 60.0).abs() < 1e-5);
    // The vocabulary of the tests has no `DistantLight`.
    assert_eq!(
        warnings,
        ["not supported yet, so left out: directional lights, orthographic cameras"]
    );
}

#[test]
fn a_file_without_a_scene_shows_its_roots() {
    let (scene, _) = composed(&[("/scene", json!(null)), ("/scenes", json!(null))]);
    assert_eq!(paths(&scene)[3..], ["/square/Top", "/square/Top/Square"]);
    let (_, warnings) = composed(&[("/scenes/0/nodes", json!([]))]);
    assert_eq!(
        warnings,
        ["the scene of the file has no nodes, so there is nothing to see"]
    );
}

#[test]
fn samples_become_layers() {
    for (name, prims) in [
        ("Box.glb", 5),
        ("BoxInterleaved.glb", 5),
        ("BoxVertexColors.glb", 4),
        ("Cameras.gltf", 6),
        ("EmissiveStrengthTest.glb", 14),
        ("SimpleMeshes.gltf", 5),
        ("SimpleSparseAccessor.gltf", 4),
    ] {
        let bytes = data(name);
        let translated = translate(name, &bytes).unwrap();
        let scene = compose(&translated.text);
        assert_eq!(scene.prims.len(), prims, "{name}: {:?}", paths(&scene));
        assert_eq!(
            translated.text,
            translate(name, &bytes).unwrap().text,
            "the same text again"
        );
    }
}

//! Mesh files with a mistake.

use crate::program::{BALLS, Folder, Ran};
use std::path::Path;

/// Checks the good scene with a mesh of this text in it.
fn check(mesh: &str) -> Ran {
    let scene = BALLS
        .replace("Sphere: (radius: 0.5)", "Mesh: (file: \"mesh.obj\")")
        .replace("Dielectric: (ior: 1.5)", "Diffuse: ()");
    let folder = Folder::with_scene(&scene);
    folder.write("mesh.obj", mesh);
    folder.run("check scene.ron")
}

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn a_good_mesh_is_taken() {
    let ran = check(&format!("{CORNERS}f 1 2 3\n"));
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
}

#[test]
fn bad_meshes_are_refused_with_their_line() {
    for (name, mesh, expected) in [
        (
            "position not a number",
            "v 0 0 0\nv NaN 0 0\nv 0 1 0\nf 1 2 3\n",
            "mesh.obj:2",
        ),
        (
            "position infinite",
            "v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n",
            "mesh.obj:3",
        ),
        ("index too large", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", "mesh.obj:4"),
        ("index zero", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "mesh.obj:4"),
        ("no triangles", "v 0 0 0\n", "mesh.obj"),
        ("empty", "", "mesh.obj"),
        ("not a mesh", "\u{0}\u{1}\u{2}", "mesh.obj"),
    ] {
        let ran = check(mesh);
        assert_eq!(ran.code, Some(2), "{name}\n{}", ran.stderr);
        assert!(ran.stderr.contains(expected), "{name}\n{}", ran.stderr);
    }
}

#[test]
fn degenerate_triangles_are_a_warning() {
    let ran = check(&format!("{CORNERS}f 1 2 3\nf 1 1 2\n"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stderr.contains("warning"), "{}", ran.stderr);
    assert!(ran.stderr.contains("mesh.obj"), "{}", ran.stderr);
}

/// A model that is not whole or does not fit together: the message names it, the part of it and the line that brings it.
#[test]
fn broken_models_are_refused_with_their_part() {
    let broken = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/assets/broken/gltf");
    for (file, expected) in [
        (
            "khronos-validator/node/node_loop.gltf",
            "nodes[0]: the node is its own ancestor",
        ),
        ("assimp/wrongTypes/badNumber.gltf", "materials[0].normalTexture.scale"),
        ("magnum/scene-default-oob.gltf", "there is no scene 0"),
        ("magnum/mesh-invalid-primitive.gltf", "missing field `attributes`"),
        (
            "tinygltf/BoundsChecking/invalid-primitive-indices.gltf",
            "there is no buffer 0",
        ),
    ] {
        let name = file.rsplit('/').next().unwrap();
        let folder = Folder::with_scene(&BALLS.replace("Sphere: (radius: 0.5)", &format!("references: [\"{name}\"]")));
        folder.write(name, std::fs::read(broken.join(file)).unwrap());
        let ran = folder.run("check scene.ron");
        assert_eq!(ran.code, Some(2), "{file}\n{}", ran.stderr);
        assert!(
            ran.stderr.contains(name) && ran.stderr.contains(expected),
            "{file}\n{}",
            ran.stderr
        );
    }
}

#[test]
fn a_missing_mesh_is_named() {
    let scene = BALLS.replace("Sphere: (radius: 0.5)", "Mesh: (file: \"none.obj\")");
    let ran = Folder::with_scene(&scene).run("check scene.ron");
    assert_eq!(ran.code, Some(2));
    assert!(
        ran.stderr.contains("none.obj") && ran.stderr.contains("scene.ron:12:"),
        "{}",
        ran.stderr
    );
}

#[test]
fn an_emitter_without_area_is_refused() {
    let scene = BALLS.replace("Quad: (size: (1, 1))", "Mesh: (file: \"mesh.obj\")");
    let folder = Folder::with_scene(&scene);
    folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    let ran = folder.run("check scene.ron");
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    assert!(
        ran.stderr.contains("mesh.obj") || ran.stderr.contains("/Lamp"),
        "{}",
        ran.stderr
    );
}

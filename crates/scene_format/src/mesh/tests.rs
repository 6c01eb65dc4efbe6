//! Meshes that are right, odd and wrong.

use super::*;
use glam::{DVec3, Vec2, Vec3};
use proptest::prelude::*;

fn parse(text: &str) -> Result<MeshData, MeshError> {
    parse_obj("a.obj", text.as_bytes(), &MeshLimits::default())
}

fn mesh(text: &str) -> MeshData {
    parse(text).unwrap()
}

fn error(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

fn warnings(mesh: &MeshData) -> Vec<String> {
    mesh.warnings.iter().map(ToString::to_string).collect()
}

const SQUARE: &str = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n";

#[test]
fn groups_become_one_mesh_that_shares_vertices() {
    let found = mesh(&format!("{SQUARE}g a\nusemtl x\nf 1 2 3\no b\nusemtl y\nf 1 -2 -1\n"));
    assert_eq!(found.origin, DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(found.positions.len(), 4);
    assert_eq!(found.positions[0], Vec3::new(-1.0, -1.0, 0.0));
    assert_eq!(found.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!((found.normals, found.uvs), (None, None));
    assert!(found.warnings.is_empty());
}

#[test]
fn polygons_become_fans() {
    let found = mesh(&format!("{SQUARE}v -1 1 0 # a fifth\nf 1 2 \\\n3 4 5\n"));
    assert_eq!(found.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
}

#[test]
fn keeps_what_every_face_has() {
    let text = format!("{SQUARE}vt 0 0\nvt 1\nvn 0 0 3\nf 1/1/1 2/2/1 3/1/1\n");
    let found = mesh(&text);
    assert_eq!(found.normals.unwrap(), [Vec3::Z; 3]);
    assert_eq!(found.uvs.unwrap(), [Vec2::ZERO, Vec2::X, Vec2::ZERO]);
    let found = mesh(&format!("{text}f 1//1 3//1 4//1\nf 1 2 4\n"));
    assert_eq!((&found.normals, &found.uvs), (&None, &None));
    assert_eq!(
        warnings(&found),
        [
            "1 face has no normals, so none are used; the first on line 10",
            "2 faces have no texture coordinates, so none are used; the first on line 9",
        ]
    );
}

#[test]
fn a_vertex_with_two_normals_becomes_two() {
    let found = mesh(&format!(
        "{SQUARE}vn 0 0 1\nvn 0 1 1\nf 1//1 2//1 3//1\nf 1//2 3//1 4//1\n"
    ));
    assert_eq!(found.positions.len(), 5);
    assert_eq!(found.triangles, [[0, 1, 2], [3, 2, 4]]);
    assert!((found.normals.unwrap()[3].length() - 1.0).abs() < 1e-6);
}

#[test]
fn far_meshes_keep_their_precision() {
    let found = mesh("v 1e8 0 0\nv 100000001 0 0\nv 1e8 1.5 0\nf 1 2 3\n");
    assert_eq!(found.origin, DVec3::new(1e8 + 0.5, 0.75, 0.0));
    assert_eq!(found.positions[1] - found.positions[0], Vec3::X);
}

#[test]
fn triangles_without_area_are_left_out() {
    let found = mesh(&format!(
        "{SQUARE}v 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 5 2\nf 1 1 3\nf 1 6 3 4\nf 1 2\n"
    ));
    assert_eq!(found.triangles.len(), 2);
    assert_eq!(
        warnings(&found),
        [
            "1 face has fewer than three corners, left out; the first on line 11",
            "3 triangles have no area, left out; the first on line 8",
        ]
    );
    assert_eq!(
        error(&format!("{SQUARE}f 1 1 2\n")),
        "a.obj has no face with an area; the first on line 5"
    );
    // Small is not flat.
    assert_eq!(mesh("v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nf 1 2 3\n").triangles.len(), 1);
}

#[test]
fn errors_have_lines() {
    for (text, message) in [
        ("v 1 2\n", "a.obj:1: expected 3 numbers, found 2"),
        ("\nv 1 2 x\n", "a.obj:2: `x` is not a number"),
        ("v 1 2 nan\n", "a.obj:1: `nan` is not a finite number"),
        ("v 1 inf 2\n", "a.obj:1: `inf` is not a finite number"),
        ("v 1 1 1e999\n", "a.obj:1: `1e999` is not a finite number"),
        ("v 1 1 1 0\n", "a.obj:1: the weight 0 of this position is too small"),
        ("vt\n", "a.obj:1: expected 1 number, found 0"),
        ("vt 0 1e39\n", "a.obj:1: a texture coordinate is at most 3.4e38"),
        ("vn 1 2\n", "a.obj:1: expected 3 numbers, found 2"),
        ("v 0 0 0\nf 1 2 3\n", "a.obj:2: there is no position 2, the file has 1"),
        (
            "v 0 0 0\nf 1 -2 1\n",
            "a.obj:2: there is no position -2: before this line there are 1",
        ),
        ("v 0 0 0\nf 0 1 1\n", "a.obj:2: numbers of vertices begin with 1, not 0"),
        (
            "v 0 0 0\nf 1 1 1/2/3/4\n",
            "a.obj:2: `1/2/3/4` has more than three parts",
        ),
        (
            "v 0 0 0\nf 1 1 1/2\n",
            "a.obj:2: there is no texture coordinate 2, the file has 0",
        ),
        ("v 0 0 0\nf 1 1 1///4\n", "a.obj:2: `1///4` has more than three parts"),
        ("v 0 0 0\nf 1 1 a\n", "a.obj:2: `a` is not the number of a position"),
        ("v 0 0 0\nf 1 1 /1\n", "a.obj:2: `` is not the number of a position"),
        (
            "v 0 0 0\nf 1 1 -9223372036854775808\n",
            "a.obj:2: there is no position -9223372036854775808: before this line there are 1",
        ),
        (
            "v 0 0 0\nf 1 1 9223372036854775808\n",
            "a.obj:2: `9223372036854775808` is not the number of a position",
        ),
        ("v 0 0 0\n", "a.obj has no faces; a mesh needs lines such as `f 1 2 3`"),
        ("", "a.obj has no faces; a mesh needs lines such as `f 1 2 3`"),
        (
            "v 1e300 0 0\nv -1e300 0 0\nv 0 1 0\nf 1 2 3\n",
            "a.obj is too large: its positions are more than 3.4028234663852886e38 apart",
        ),
    ] {
        assert_eq!(error(text), message, "{text:?}");
    }
    let error = parse_obj("a.obj", b"v 0 0 0\n\xff", &MeshLimits::default()).unwrap_err();
    assert!(matches!(error, MeshError::NotText { line: 2, .. }));
}

#[test]
fn limits_are_errors() {
    let limits = MeshLimits {
        bytes: 60,
        vertices: 4,
        triangles: 2,
    };
    let code = |text: &str| parse_obj("a.obj", text.as_bytes(), &limits).map(|_| ());
    assert!(code(&format!("{SQUARE}f 1 2 3 4\n")).is_ok());
    assert!(matches!(code(&" ".repeat(61)), Err(MeshError::TooLarge { .. })));
    assert!(matches!(
        code(&format!("{SQUARE}v 0 0 0\n")),
        Err(MeshError::Line { line: 5, .. })
    ));
    assert!(matches!(
        code(&format!("{SQUARE}f 1 2 3 4 1\n")),
        Err(MeshError::Line { line: 5, .. })
    ));
}

#[test]
fn files_from_the_wild() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let load = |name: &str| match load_obj(&folder.join(name), &MeshLimits::default()) {
        Ok(mesh) => format!("{} triangles, {:?}", mesh.triangles.len(), warnings(&mesh)),
        Err(error) => error.to_string().replace(&folder.display().to_string(), ""),
    };
    let names = [
        "invalid-face-definition.obj",
        "invalid-relative-vertex-index.obj",
        "invalid_index.obj",
        "issue-161-inconsistent-f.obj",
        "lines.obj",
        "quad.obj",
    ];
    insta::assert_snapshot!(names.map(load).join("\n"), @r#"
    /invalid-face-definition.obj has no faces; a mesh needs lines such as `f 1 2 3`
    /invalid-relative-vertex-index.obj:1: there is no position -4: before this line there are 0
    /invalid_index.obj:12: there is no position 7, the file has 6
    12 triangles, ["1 face has no texture coordinates, so none are used; the first on line 37"]
    /lines.obj has no faces; a mesh needs lines such as `f 1 2 3`
    5 triangles, ["2 faces have no normals, so none are used; the first on line 17", "1 face has no texture coordinates, so none are used; the first on line 24"]
    "#);
    let missing = load_obj(&folder.join("none.obj"), &MeshLimits::default());
    assert!(matches!(missing, Err(MeshError::Unreadable { .. })));
    let folder = load_obj(&folder, &MeshLimits::default());
    assert!(matches!(folder, Err(MeshError::NotAFile { .. })));
}

/// Every index points to something, everything is finite.
fn check(found: &MeshData) {
    let count = found.positions.len();
    assert!(
        found
            .triangles
            .iter()
            .flatten()
            .all(|&corner| (corner as usize) < count)
    );
    assert!(found.positions.iter().all(|position| position.is_finite()));
    if let Some(normals) = &found.normals {
        assert_eq!(normals.len(), count);
        assert!(normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5));
    }
    assert!(found.uvs.as_ref().is_none_or(|uvs| uvs.len() == count));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = parse_obj("a.obj", &bytes, &MeshLimits::default());
    }

    #[test]
    fn any_lines(lines in prop::collection::vec((
        prop::sample::select(vec!["v", "vn", "vt", "f", "f", "f", "l", "p", "g", "o", "usemtl", "mtllib", "#", "s"]),
        prop::collection::vec(prop::sample::select(vec![
            "0", "1", "2", "3", "-1", "-2", "1e38", "1e-320", "0.5", "1/1", "1//1", "2/1/1", "-1/-1/-1", "\\", "nan",
        ]), 0..6),
    ), 0..30)) {
        let mut text = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n");
        for (keyword, words) in lines {
            text.push_str(&format!("{keyword} {}\n", words.join(" ")));
        }
        if let Ok(found) = parse(&text) {
            check(&found);
        }
    }

    #[test]
    fn cut_meshes(at in 0..400_usize) {
        let text = include_str!("../../tests/data/quad.obj");
        if let Ok(found) = parse(&text[..at.min(text.len())]) {
            check(&found);
        }
    }
}

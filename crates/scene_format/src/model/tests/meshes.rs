//! From glTF files to triangles.

use glam::{DVec3, Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use super::document::{changed, container, data_uri, square, square_bytes};
use super::*;

fn square_mesh(changes: &[(&str, Value)]) -> MeshData {
    mesh("square.gltf", &changed(changes), None, None).unwrap()
}

/// Changes the buffer of the square.
fn buffer(change: impl FnOnce(&mut Vec<u8>)) -> Value {
    let mut bytes = square_bytes();
    change(&mut bytes);
    json!([{"byteLength": bytes.len(), "uri": data_uri(&bytes)}])
}

#[test]
fn a_square_is_two_triangles() {
    let found = square_mesh(&[]);
    assert_eq!(found.origin, DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(found.positions[0], Vec3::new(-1.0, -1.0, 0.0));
    assert_eq!(found.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(found.normals.unwrap(), [Vec3::Z; 4]);
    // The lower left of a picture is (0, 0), not as in the file.
    assert_eq!(found.uvs.unwrap(), [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]);
    assert!(found.warnings.is_empty());
}

#[test]
fn strips_and_fans_keep_their_winding() {
    let mode = ("/meshes/0/primitives/0/mode", json!(5));
    let indices = ("/meshes/0/primitives/0/indices", json!(null));
    let strip = square_mesh(&[mode, indices.clone()]);
    assert_eq!(strip.triangles, [[0, 1, 2], [1, 3, 2]]);
    let fan = square_mesh(&[("/meshes/0/primitives/0/mode", json!(6)), indices]);
    assert_eq!(fan.triangles, [[1, 2, 0], [2, 3, 0]]);
}

#[test]
fn vertices_that_nothing_uses_are_left_out() {
    let few = square_mesh(&[("/accessors/3/count", json!(3)), ("/accessors/3/byteOffset", json!(6))]);
    assert_eq!(few.triangles, [[0, 1, 2]]);
    assert_eq!(few.uvs.unwrap(), [Vec2::ZERO, Vec2::ONE, Vec2::Y]);
    // So few corners among so many vertices that another way is taken.
    let many = square_mesh(&[
        ("/meshes/0/primitives/0/attributes", json!({"POSITION": 0})),
        (
            "/accessors/0/sparse",
            json!({
                "count": 3,
                "indices": {"bufferView": 4, "componentType": 5125},
                "values": {"bufferView": 0},
            }),
        ),
        ("/accessors/0/bufferView", json!(null)),
        ("/accessors/0/count", json!(900_000)),
        (
            "/accessors/3",
            json!({"bufferView": 4, "componentType": 5125, "count": 3, "type": "SCALAR"}),
        ),
        (
            "/bufferViews/-",
            json!({"buffer": 0, "byteOffset": 140, "byteLength": 12}),
        ),
        (
            "/buffers",
            buffer(|bytes| bytes.extend([5_u32, 7, 800_000].iter().flat_map(|n| n.to_le_bytes()))),
        ),
    ]);
    assert_eq!(many.triangles, [[0, 1, 2]]);
    assert_eq!(many.positions.len(), 3);
    assert_eq!(many.origin, DVec3::new(1.0, 1.0, 0.0));
}

#[test]
fn sparse_and_interleaved_samples() {
    let sparse = mesh(
        "SimpleSparseAccessor.gltf",
        &data("SimpleSparseAccessor.gltf"),
        None,
        None,
    )
    .unwrap();
    assert_eq!((sparse.triangles.len(), sparse.positions.len()), (12, 14));
    let highest = sparse.positions.iter().map(|p| f64::from(p.y) + sparse.origin.y);
    assert_eq!(highest.fold(0.0, f64::max), 4.0, "a sparse value replaces 1");
    let plain = mesh("Box.glb", &data("Box.glb"), None, None).unwrap();
    let interleaved = mesh("BoxInterleaved.glb", &data("BoxInterleaved.glb"), None, None).unwrap();
    assert_eq!(plain.triangles.len(), 12);
    assert_eq!(interleaved.triangles.len(), 12);
    assert!(
        interleaved
            .normals
            .unwrap()
            .iter()
            .all(|normal| normal.abs().max_element() == 1.0)
    );
    let coloured = mesh("BoxVertexColors.glb", &data("BoxVertexColors.glb"), None, None).unwrap();
    let colours = coloured.colours.unwrap();
    assert_eq!(colours.len(), coloured.positions.len());
    assert!(colours.contains(&Vec4::ONE));
}

#[test]
fn whole_numbers_are_scaled_if_they_say_so() {
    // Positions of 16 bits at a stride of 8, normals of 8 bits at a stride of 4.
    let mut bytes: Vec<u8> = [[0_i16, 0], [-300, 0], [-300, 300]]
        .iter()
        .flat_map(|[x, y]| [*x, *y, 0, 0])
        .flat_map(i16::to_le_bytes)
        .collect();
    bytes.extend([0_i8, 0, -128, 0].repeat(3).iter().map(|byte| *byte as u8));
    bytes.extend(
        [0_u16, 65535, 65535, 0, 0, 0]
            .iter()
            .flat_map(|number| number.to_le_bytes()),
    );
    let changes = [
        ("/buffers", json!([{"byteLength": 48, "uri": data_uri(&bytes)}])),
        (
            "/bufferViews",
            json!([
                {"buffer": 0, "byteLength": 24, "byteStride": 8},
                {"buffer": 0, "byteOffset": 24, "byteLength": 12, "byteStride": 4},
                {"buffer": 0, "byteOffset": 36, "byteLength": 12},
            ]),
        ),
        (
            "/accessors",
            json!([
                {"bufferView": 0, "componentType": 5122, "count": 3, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3"},
                {"bufferView": 2, "componentType": 5123, "normalized": true, "count": 3, "type": "VEC2"},
            ]),
        ),
        ("/meshes/0/primitives/0/indices", json!(null)),
        ("/extensionsRequired", json!(["KHR_mesh_quantization"])),
    ];
    let found = square_mesh(&changes);
    assert_eq!(found.origin, DVec3::new(-150.0, 150.0, 0.0));
    assert_eq!(found.normals.unwrap(), [Vec3::NEG_Z; 3]);
    assert_eq!(found.uvs.unwrap(), [Vec2::ZERO, Vec2::new(1.0, 1.0), Vec2::Y]);
}

#[test]
fn primitives_are_read_alone_or_together() {
    let changes = [
        (
            "/meshes/0/primitives/-",
            json!({"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 3}),
        ),
        (
            "/meshes/0/primitives/-",
            json!({"attributes": {"POSITION": 0}, "mode": 1}),
        ),
    ];
    let bytes = changed(&changes);
    let first = mesh("square.gltf", &bytes, Some("Flat"), Some(0)).unwrap();
    assert!(first.normals.is_some() && first.triangles.len() == 2);
    let both = mesh("square.gltf", &bytes, Some("#0"), None).unwrap();
    assert_eq!(both.triangles, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
    assert!(both.normals.is_none() && both.uvs.is_some());
    assert_eq!(
        both.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        ["2 faces have no normals, so none are used; the first is primitive 1"]
    );
    let line = mesh("square.gltf", &bytes, None, Some(2)).unwrap_err();
    assert!(
        line.to_string()
            .contains("meshes[0].primitives[2]: it has no triangles"),
        "{line}"
    );
}

#[test]
fn several_sets_of_texture_coordinates_are_kept() {
    let found = square_mesh(&[("/meshes/0/primitives/0/attributes/TEXCOORD_1", json!(2))]);
    assert_eq!(found.more_uvs, [found.uvs.unwrap()]);
}

#[test]
fn normals_without_length_and_triangles_without_area_are_warnings() {
    let found = square_mesh(&[(
        "/buffers",
        buffer(|bytes| {
            bytes[56..60].fill(0);
            bytes[138] = 0;
        }),
    )]);
    assert!(found.normals.is_none());
    assert_eq!(found.triangles, [[0, 1, 2]]);
    assert_eq!(
        found.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [
            "1 normal has no length, so none is used; the first is vertex 0",
            "1 triangle has no area, left out; the first is triangle 1",
        ]
    );
    let flat = mesh(
        "square.gltf",
        &changed(&[("/buffers", buffer(|bytes| bytes[..48].fill(0)))]),
        None,
        None,
    );
    assert!(matches!(flat, Err(ModelError::Flat { .. })));
}

#[test]
fn data_is_in_the_container_or_in_files_below_the_root() {
    let mut document = square();
    document["buffers"][0] = json!({"byteLength": 140});
    let bin = container(document.to_string().as_bytes(), Some(&square_bytes()));
    assert_eq!(mesh("a.glb", &bin, None, None).unwrap(), square_mesh(&[]));

    let folder = tempfile::tempdir().unwrap();
    let outer = folder.path().canonicalize().unwrap();
    let root = outer.join("root");
    std::fs::create_dir_all(root.join("a b")).unwrap();
    std::fs::write(root.join("a b/x.bin"), square_bytes()).unwrap();
    std::fs::write(outer.join("out.bin"), square_bytes()).unwrap();
    std::fs::write(root.join("short.bin"), &square_bytes()[..139]).unwrap();
    let path = root.join("m.gltf");
    let read = |uri: &str| {
        let bytes = changed(&[("/buffers/0/uri", json!(uri))]);
        let mut model = Model::open(file(&path, &root, &bytes), &MeshLimits::default()).unwrap();
        let found = model.mesh(&MeshPart::default()).map_err(|error| error.to_string());
        (found, model.other_files().len())
    };
    let (found, files) = read("a%20b/x.bin");
    assert_eq!((found.unwrap(), files), (square_mesh(&[]), 1));
    for (uri, problem) in [
        ("../out.bin", "lies outside of"),
        ("%2E%2E/out.bin", "lies outside of"),
        ("/etc/passwd", "is absolute"),
        ("file:///etc/passwd", "is a URL"),
        ("a%20b", "is not a regular file"),
        ("sort.bin", "did you mean `short.bin`?"),
        ("short.bin", "140 bytes are declared, but there are 139"),
        ("%ff", "not UTF-8"),
        ("data:,x", "not in base64"),
        ("data:;base64,*", "not base64"),
        ("data:x", "no comma"),
    ] {
        let error = read(uri).0.unwrap_err();
        assert!(
            error.starts_with("m.gltf: buffers[0].") && error.contains(problem),
            "{uri}: {error}"
        );
    }
}

#[test]
fn a_few_bytes_do_not_become_many_triangles() {
    let primitive = json!({"attributes": {"POSITION": 0}});
    let bytes = changed(&[
        ("/meshes/0/primitives", json!(vec![primitive; 200])),
        (
            "/accessors/0",
            json!({"componentType": 5126, "count": 30_000, "type": "VEC3"}),
        ),
    ]);
    let error = mesh("square.gltf", &bytes, None, None).unwrap_err();
    assert!(matches!(error, ModelError::Limit { .. }), "{error}");
}

//! glTF files that are wrong: each kind of error with its whole message.

use serde_json::{Value, json};

use super::document::{changed, container, data_uri, square, square_bytes};
use super::*;

/// What is said about the square with changes, by translation or else by the reader of its mesh.
fn error(changes: &[(&str, Value)]) -> String {
    let bytes = changed(changes);
    if let Err(error) = translate("a.gltf", &bytes) {
        return error.to_string();
    }
    match mesh("a.gltf", &bytes, None, None) {
        Ok(_) => "no error".to_owned(),
        Err(error) => format!("mesh: {error}"),
    }
}

/// Errors about one change each, one a line.
fn errors(changes: &[(&str, Value)]) -> String {
    let all: Vec<String> = changes
        .iter()
        .map(|change| error(std::slice::from_ref(change)))
        .collect();
    all.join("\n")
}

#[test]
fn structure() {
    insta::assert_snapshot!(errors(&[
        ("/asset/version", json!("1.0")),
        ("/asset/version", json!(2)),
        ("/asset", json!(null)),
        ("/asset/minVersion", json!("2.1")),
        ("/scene", json!(1)),
        ("/scenes/0/nodes", json!([0, 9])),
        ("/scenes/0/nodes", json!([0, 1])),
        ("/scenes/0/nodes", json!([0, 0])),
        ("/nodes/0/children", json!([2])),
        ("/nodes/0/children", json!([1, 1])),
        ("/nodes/0/children", json!({})),
        ("/nodes/1/children", json!([0])),
        ("/nodes/1/children", json!([1])),
        ("/nodes/1/mesh", json!(1)),
        ("/nodes/1/mesh", json!(-1)),
        ("/nodes/1/camera", json!(0)),
        ("/nodes/1/skin", json!(0)),
        ("/nodes/1/extensions", json!({"KHR_lights_punctual": {"light": 0}})),
        ("/nodes/1/translation", json!([0, 0])),
        ("/nodes/1/translation", json!([1e200, 0, 0])),
        ("/nodes/1/rotation", json!([0, 0, 0, 0])),
        ("/nodes/1/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])),
        ("/extensionsRequired", json!(["KHR_draco_mesh_compression"])),
        ("/extensionsRequired", json!(["EXT_invented"])),
        ("/meshes/0/primitives", json!([])),
        ("/meshes/0/primitives/0/material", json!(1)),
        ("/materials/0/normalTexture", json!({"index": 0})),
        ("/cameras", json!([{"type": "perspective", "perspective": {"yfov": 0}}])),
    ]), @r#"
    a.gltf: asset.version: version "1.0" of glTF; convert the model to glTF 2.0
    a.gltf: asset.version: invalid type: integer `2`, expected a string at line 1 column 285; export the model again, or check it with a validator
    a.gltf: asset.version: it is missing; this is not a glTF file, or one that is incomplete
    a.gltf: asset.minVersion: version "2.1" of glTF; convert the model to glTF 2.0
    a.gltf: scene: there is no scene 1, the file has 1; export the model again, or check it with a validator
    a.gltf: scenes[0].nodes[1]: there is no node 9, the file has 2; export the model again, or check it with a validator
    a.gltf: scenes[0].nodes[1]: node 1 is a child of node 0, so no root of a scene; export the model again, or check it with a validator
    a.gltf: scenes[0].nodes: node 0 is named twice; export the model again, or check it with a validator
    a.gltf: nodes[0].children[0]: there is no node 2, the file has 2; export the model again, or check it with a validator
    a.gltf: nodes[0].children[1]: node 1 is a child of node 0 already; give each parent a node of its own
    a.gltf: nodes[0].children: invalid type: map, expected a sequence at line 1 column 997; export the model again, or check it with a validator
    a.gltf: nodes[0]: the node is its own ancestor; break the loop of children
    a.gltf: nodes[1].children[0]: node 1 is a child of node 0 already; give each parent a node of its own
    a.gltf: nodes[1].mesh: there is no mesh 1, the file has 1; export the model again, or check it with a validator
    a.gltf: nodes[1].mesh: invalid value: integer `-1`, expected u32 at line 1 column 1025; export the model again, or check it with a validator
    a.gltf: nodes[1].camera: there is no camera 0, the file has 0; export the model again, or check it with a validator
    a.gltf: nodes[1].skin: there is no skin 0, the file has 0; export the model again, or check it with a validator
    a.gltf: nodes[1].extensions.KHR_lights_punctual.light: there is no light 0, the file has 0; export the model again, or check it with a validator
    a.gltf: nodes[1].translation: invalid length 2, expected an array of length 3 at line 1 column 1060; export the model again, or check it with a validator
    a.gltf: nodes[1].translation: it is too large to be computed with; export the model again, or check it with a validator
    a.gltf: nodes[1].rotation: a quaternion of length 0 is no rotation; export the model again, or check it with a validator
    a.gltf: nodes[1].matrix: its last row is not (0, 0, 0, 1), so it is no placement; export the model again, or check it with a validator
    a.gltf: extensionsRequired[0]: the extension "KHR_draco_mesh_compression" is not supported; export the model without compression
    a.gltf: extensionsRequired[0]: the extension "EXT_invented" is not supported; export the model without this extension
    a.gltf: meshes[0].primitives: it is empty; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0].material: there is no material 1, the file has 1; export the model again, or check it with a validator
    a.gltf: materials[0].normalTexture.index: there is no texture 0, the file has 0; export the model again, or check it with a validator
    no error
    "#);
}

#[test]
fn meshes() {
    let attributes = "/meshes/0/primitives/0/attributes";
    insta::assert_snapshot!(errors(&[
        ("/meshes/0/primitives/0/mode", json!(7)),
        ("/meshes/0/primitives/0/indices", json!(4)),
        ("/meshes/0/primitives/0/indices", json!(0)),
        ("/meshes/0/primitives/0/indices", json!(null)),
        (attributes, json!({"POSITION": 2})),
        (attributes, json!({"POSITION": 3})),
        (attributes, json!({"POSITION": 0, "NORMAL": 9})),
        ("/accessors/0/count", json!(0)),
        ("/accessors/0/count", json!(3)),
        ("/accessors/0/count", json!(5)),
        ("/accessors/0/count", json!(u64::MAX)),
        ("/accessors/0/byteOffset", json!(u64::MAX)),
        ("/accessors/0/bufferView", json!(4)),
        ("/accessors/0/componentType", json!(5124)),
        ("/accessors/0/type", json!("MAT3")),
        ("/accessors/0/normalized", json!(true)),
        ("/accessors/3/count", json!(5)),
        ("/accessors/3/count", json!(2)),
        ("/bufferViews/0/buffer", json!(1)),
        ("/bufferViews/0/byteOffset", json!(93)),
        ("/bufferViews/0/byteLength", json!(u64::MAX)),
        ("/bufferViews/0/byteStride", json!(8)),
        ("/bufferViews/0/byteStride", json!(0)),
        ("/bufferViews/0/byteStride", json!(14)),
        ("/bufferViews/0/byteStride", json!(256)),
        ("/bufferViews/3/byteStride", json!(4)),
        ("/buffers/0/byteLength", json!(141)),
        ("/buffers/0/uri", json!(null)),
    ]), @r#"
    a.gltf: meshes[0].primitives[0].mode: 7 is not a mode; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0].indices: there is no accessor 4, the file has 4; export the model again, or check it with a validator
    a.gltf: accessors[0]: indices must be SCALAR, of unsigned whole numbers, not normalized; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0]: 4 vertices do not make triangles: that is no multiple of 3; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0].attributes.POSITION: accessor 2 has 2 numbers of type F32 in an element, which POSITION cannot have; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0].attributes.POSITION: accessor 3 has 1 numbers of type U16 in an element, which POSITION cannot have; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0].attributes.NORMAL: there is no accessor 9, the file has 4; export the model again, or check it with a validator
    a.gltf: accessors[0].count: it is 0; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0].attributes: accessor 1 has 4 elements, but there are 3 positions; export the model again, or check it with a validator
    a.gltf: accessors[0]: 5 elements need 60 bytes, but buffer view 0 has 48; export the model again, or check it with a validator
    a.gltf: accessors[0].count: 18446744073709551615 elements are more than the limit of 4294967295; divide the model into several files
    a.gltf: accessors[0]: 4 elements need 18446744073709551615 bytes, but buffer view 0 has 48; export the model again, or check it with a validator
    a.gltf: accessors[0].bufferView: there is no buffer view 4, the file has 4; export the model again, or check it with a validator
    a.gltf: accessors[0].componentType: 5124 is not a type of number; export the model again, or check it with a validator
    a.gltf: accessors[0].type: elements of type "MAT3" are not part of a mesh; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0].attributes.POSITION: accessor 0 has 3 numbers of type F32, normalized, in an element, which POSITION cannot have; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0]: 5 indices do not make triangles: that is no multiple of 3; export the model again, or check it with a validator
    a.gltf: meshes[0].primitives[0]: 2 indices make no triangle; export the model again, or check it with a validator
    a.gltf: bufferViews[0].buffer: there is no buffer 1, the file has 1; export the model again, or check it with a validator
    a.gltf: bufferViews[0].byteLength: 48 bytes from byte 93 on are not in buffer 0, which has 140; export the model again, or check it with a validator
    a.gltf: bufferViews[0].byteLength: 18446744073709551615 bytes from byte 0 on are not in buffer 0, which has 140; export the model again, or check it with a validator
    a.gltf: bufferViews[0].byteStride: elements of 12 bytes overlap at a distance of 8; export the model again, or check it with a validator
    a.gltf: bufferViews[0].byteStride: 0 is not a multiple of 4 from 4 to 252; export the model again, or check it with a validator
    a.gltf: bufferViews[0].byteStride: 14 is not a multiple of 4 from 4 to 252; export the model again, or check it with a validator
    a.gltf: bufferViews[0].byteStride: 256 is not a multiple of 4 from 4 to 252; export the model again, or check it with a validator
    a.gltf: accessors[3]: 6 elements need 22 bytes, but buffer view 3 has 12; export the model again, or check it with a validator
    mesh: a.gltf: buffers[0].byteLength: 141 bytes are declared, but there are 140; the data is cut off or damaged: copy or export it again
    mesh: a.gltf: buffers[0]: it has no `uri`, and the file has no chunk of data for it; export the model again, or check it with a validator
    "#);
}

#[test]
fn data_of_meshes() {
    let with = |change: fn(&mut Vec<u8>)| {
        let mut bytes = square_bytes();
        change(&mut bytes);
        ("/buffers/0/uri", json!(data_uri(&bytes)))
    };
    let sparse = |count: u32, view: u32, kind: u32| {
        let value = json!({
            "count": count,
            "indices": {"bufferView": view, "componentType": kind},
            "values": {"bufferView": 0},
        });
        ("/accessors/0/sparse", value)
    };
    insta::assert_snapshot!(errors(&[
        with(|bytes| bytes[0..4].copy_from_slice(&f32::NAN.to_le_bytes())),
        with(|bytes| bytes[60..64].copy_from_slice(&f32::INFINITY.to_le_bytes())),
        with(|bytes| bytes[128] = 4),
        with(|bytes| bytes[128..140].fill(0xff)),
        with(|bytes| bytes[0..48].fill(0)),
        sparse(5, 3, 5123),
        sparse(0, 3, 5123),
        sparse(2, 3, 5126),
        sparse(4, 3, 5123),
        sparse(3, 0, 5125),
        sparse(2, 9, 5123),
    ]), @r#"
    mesh: a.gltf: accessors[0]: element 0 is not finite; export the model again, or check it with a validator
    mesh: a.gltf: accessors[1]: element 1 is not finite; export the model again, or check it with a validator
    mesh: a.gltf: accessors[3]: index 0 is 4, but there are 4 vertices; export the model again, or check it with a validator
    mesh: a.gltf: accessors[3]: index 0 is 65535, but there are 4 vertices; export the model again, or check it with a validator
    mesh: a.gltf: meshes[0]: no triangle has an area; the first is triangle 0; delete the mesh from the model, or switch its prims off
    a.gltf: accessors[0].sparse.count: 5 of 4 elements cannot be replaced; export the model again, or check it with a validator
    a.gltf: accessors[0].sparse.count: 0 of 4 elements cannot be replaced; export the model again, or check it with a validator
    a.gltf: accessors[0].sparse.indices.componentType: indices must be unsigned whole numbers; export the model again, or check it with a validator
    mesh: a.gltf: accessors[0].sparse.indices: number 3 is 0, not greater than the one before it; export the model again, or check it with a validator
    mesh: a.gltf: accessors[0].sparse.indices: number 1 is 0, not greater than the one before it; export the model again, or check it with a validator
    a.gltf: accessors[0].sparse.indices.bufferView: there is no buffer view 9, the file has 4; export the model again, or check it with a validator
    "#);
}

#[test]
fn containers() {
    let json = square().to_string().into_bytes();
    let good = container(&json, Some(&[0; 4]));
    let patched = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        bytes
    };
    let doubled = [&good[..], &good[12..]].concat();
    let doubled = [&doubled[..8], &(doubled.len() as u32).to_le_bytes(), &doubled[12..]].concat();
    let wrong: [Vec<u8>; 9] = [
        Vec::new(),
        b"{".to_vec(),
        b"glTF\x02\0\0\0".to_vec(),
        good[..40].to_vec(),
        [&good[..], b"x"].concat(),
        patched(4, 1),
        patched(15, 0x7f),
        patched(16, b'X'),
        doubled,
    ];
    let said: Vec<String> = wrong
        .iter()
        .map(|bytes| translate("a.glb", bytes).unwrap_err().to_string())
        .collect();
    insta::assert_snapshot!(said.join("\n"), @r#"
    a.glb: EOF while parsing a value at line 1 column 0; export the model again, or check it with a validator
    a.glb: EOF while parsing an object at line 1 column 1; export the model again, or check it with a validator
    a.glb: header: 12 bytes are needed, but there are 8; the file is cut off or damaged: copy or export it again
    a.glb: header: 1112 bytes are needed, but there are 40; the file is cut off or damaged: copy or export it again
    a.glb: header: the file says that it has 1112 bytes, but there are 1113; export the model again, or check it with a validator
    a.glb: header: binary glTF of version 1; convert the model to glTF 2.0
    a.glb: chunk at byte 12: 2130707532 bytes are needed, but there are 1112; the file is cut off or damaged: copy or export it again
    a.glb: chunk at byte 1100: there must be one chunk of JSON and behind it at most one of data; export the model again, or check it with a validator
    a.glb: chunk at byte 1112: there must be one chunk of JSON and behind it at most one of data; export the model again, or check it with a validator
    "#);
}

#[test]
fn limits() {
    let root = data_folder();
    let path = root.join("a.gltf");
    let bytes = square().to_string().into_bytes();
    let limited = |change: fn(&mut ModelLimits)| {
        let mut limits = ModelLimits::default();
        change(&mut limits);
        match with_schema(|schema| translate_model(&file(&path, &root, &bytes), schema, &limits)) {
            Ok(_) => "no error".to_owned(),
            Err(error) => error.to_string(),
        }
    };
    let said = [
        limited(|limits| limits.bytes = 100),
        limited(|limits| limits.text_bytes = 100),
        limited(|limits| limits.objects = 5),
        limited(|limits| limits.prims = 2),
        limited(|limits| limits.prim_depth = 2),
    ];
    insta::assert_snapshot!(said.join("\n"), @r#"
    a.gltf: the file has more than 100 bytes; divide the model into several files
    a.gltf: the JSON has more than 100 bytes; move data from the JSON to a `.bin` or `.glb` file
    a.gltf: the JSON has more than 5 objects; divide the model into several files
    a.gltf: materials[0]: this makes more than 2 prims; divide the model into several files
    a.gltf: materials[0]: prims would be nested more than 2 deep; flatten the hierarchy of the model
    "#);
}

#[test]
fn nodes_are_at_most_64_deep_with_their_root() {
    let chain = |nodes: usize| {
        let mut all: Vec<Value> = (1..nodes).map(|child| json!({"children": [child]})).collect();
        all.push(json!({}));
        changed(&[("/nodes", json!(all))])
    };
    assert!(translate("a.gltf", &chain(63)).is_ok());
    let error = translate("a.gltf", &chain(64)).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("nodes[63]: prims would be nested more than 64 deep"),
        "{error}"
    );
    assert!(translate("a.gltf", &chain(200_000)).is_err());
}

#[test]
fn many_prims_of_few_bytes_are_refused() {
    let primitive = json!({"attributes": {"POSITION": 0}, "indices": 3});
    let nodes = vec![json!({"mesh": 0}); 2_000];
    let all: Vec<usize> = (0..nodes.len()).collect();
    let bytes = changed(&[
        ("/meshes/0/primitives", json!(vec![primitive; 2_000])),
        ("/nodes", json!(nodes)),
        ("/scenes/0/nodes", json!(all)),
    ]);
    assert!(matches!(translate("a.gltf", &bytes), Err(ModelError::Limit { .. })));
}

#[test]
fn meshes_that_are_not_there() {
    let wrong = |name: Option<&str>, primitive| {
        let second = json!({"name": "Round", "primitives": [{"attributes": {"POSITION": 0}, "indices": 3}]});
        let bytes = changed(&[("/meshes/-", second)]);
        mesh("a.gltf", &bytes, name, primitive).unwrap_err().to_string()
    };
    let said = [
        wrong(None, None),
        wrong(Some("Rund"), None),
        wrong(Some("Elsewhere"), None),
        wrong(Some("#2"), None),
        wrong(Some("Flat"), Some(1)),
    ];
    insta::assert_snapshot!(said.join("\n"), @r##"
    a.gltf: meshes: there are 2, and none is named; write `mesh: "Flat"`, or one of the others
    a.gltf: meshes: there is no mesh "Rund"; did you mean "Round"?
    a.gltf: meshes: there is no mesh "Elsewhere"; meshes in the file: "Flat", "Round"
    a.gltf: meshes: there is no mesh "#2"; meshes in the file: "Flat", "Round"
    a.gltf: meshes[0]: there is no primitive 1, the file has 1; export the model again, or check it with a validator
    "##);
}

//! A small glTF file that is right, and ways to change it.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// Bytes of the buffer of [`square`]: four positions, normals and texture coordinates, and six indices.
pub(super) fn square_bytes() -> Vec<u8> {
    let mut bytes = Vec::new();
    let corners = [[0.0_f32, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    for [x, y] in corners {
        push(&mut bytes, &[x, y, 0.0]);
    }
    for _ in corners {
        push(&mut bytes, &[0.0, 0.0, 1.0]);
    }
    for [x, y] in corners {
        push(&mut bytes, &[x / 2.0, 1.0 - y / 2.0]);
    }
    for index in [0_u16, 1, 2, 0, 2, 3] {
        bytes.extend(index.to_le_bytes());
    }
    bytes
}

pub(super) fn push(bytes: &mut Vec<u8>, numbers: &[f32]) {
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}

pub(super) fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes))
}

/// A square of gold on a node below another.
pub(super) fn square() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "Top", "children": [1]}, {"name": "Square", "mesh": 0}],
        "meshes": [{"name": "Flat", "primitives": [
            {"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0},
        ]}],
        "materials": [{"name": "Gold", "pbrMetallicRoughness": {
            "baseColorFactor": [1.0, 0.75, 0.25, 1.0], "roughnessFactor": 0.25,
        }}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 48},
            {"buffer": 0, "byteOffset": 96, "byteLength": 32},
            {"buffer": 0, "byteOffset": 128, "byteLength": 12},
        ],
        "buffers": [{"byteLength": 140, "uri": data_uri(&square_bytes())}],
    })
}

/// Replaces or adds the value that a JSON pointer names; `null` removes it.
pub(super) fn set(document: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match document.pointer_mut(parent).unwrap() {
        Value::Object(fields) if value.is_null() => {
            fields.remove(key);
        }
        Value::Object(fields) => {
            fields.insert(key.to_owned(), value);
        }
        Value::Array(items) if key == "-" => items.push(value),
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        other => panic!("{pointer} leads into {other}"),
    }
}

/// The square with changes.
pub(super) fn changed(changes: &[(&str, Value)]) -> Vec<u8> {
    let mut document = square();
    for (pointer, value) in changes {
        set(&mut document, pointer, value.clone());
    }
    document.to_string().into_bytes()
}

/// Puts JSON and data into the binary container.
pub(super) fn container(json: &[u8], bin: Option<&[u8]>) -> Vec<u8> {
    let chunk = |bytes: &[u8], kind: &[u8; 4], fill: u8| {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4), fill);
        let mut chunk = (padded.len() as u32).to_le_bytes().to_vec();
        chunk.extend(kind);
        chunk.extend(padded);
        chunk
    };
    let mut chunks = chunk(json, b"JSON", b' ');
    if let Some(bin) = bin {
        chunks.extend(chunk(bin, b"BIN\0", 0));
    }
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((chunks.len() as u32 + 12).to_le_bytes());
    file.extend(chunks);
    file
}

//! Whatever the bytes: an error, or a layer that can be read and meshes that are sound.

use proptest::prelude::*;
use serde_json::json;

use super::document::{changed, container, square, square_bytes};
use super::vocabulary::{self, compose};
use super::*;

/// Translates, reads the layer, and reads every mesh that it names, and a few meshes and images that it may not.
fn use_all(name: &str, bytes: &[u8]) {
    let mut parts = vec![MeshPart::default()];
    if let Ok(translated) = translate(name, bytes) {
        let scene = compose(&translated.text);
        for prim in scene.prims.iter().filter(|prim| prim.component("Mesh").is_some()) {
            let named: vocabulary::Mesh = vocabulary::component(&scene, &prim.path, "Mesh");
            parts.push(MeshPart {
                mesh: named.mesh,
                primitive: named.primitive,
            });
        }
    }
    for number in 0..3 {
        parts.push(MeshPart {
            mesh: Some(format!("#{number}")),
            primitive: None,
        });
    }
    parts.dedup();
    let root = data_folder();
    let path = root.join(name);
    let Ok(mut model) = Model::open(file(&path, &root, bytes), &MeshLimits::default()) else {
        return;
    };
    for part in parts {
        if let Ok(found) = model.mesh(&part) {
            check(&found);
        }
    }
    for number in 0..3 {
        drop(model.image(number));
    }
}

/// Every index points to something, everything is finite.
fn check(found: &MeshData) {
    let count = found.positions.len();
    let corners = found.triangles.iter().flatten();
    assert!(corners.clone().all(|&corner| (corner as usize) < count));
    assert!(found.positions.iter().all(|position| position.is_finite()));
    if let Some(normals) = &found.normals {
        assert_eq!(normals.len(), count);
        assert!(normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5));
    }
    for uvs in found.uvs.iter().chain(&found.more_uvs) {
        assert!(uvs.len() == count && uvs.iter().all(|uv| uv.is_finite()));
    }
    assert!(found.colours.as_ref().is_none_or(|colours| colours.len() == count));
}

/// Good files to start from.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let mut bin = square();
    bin["buffers"][0] = json!({"byteLength": 140});
    let sparse = json!({
        "count": 2, "indices": {"bufferView": 3, "componentType": 5123}, "values": {"bufferView": 1},
    });
    let names = [
        "BoxInterleaved.glb",
        "BoxVertexColors.glb",
        "SimpleSparseAccessor.gltf",
        "Cameras.gltf",
    ];
    let mut seeds: Vec<_> = names.into_iter().map(|name| (name, data(name))).collect();
    seeds.push(("a.gltf", square().to_string().into_bytes()));
    let textured = [
        (
            "/images",
            json!([{"bufferView": 3}, {"uri": "data:image/png;base64,AAAA"}]),
        ),
        ("/textures", json!([{"source": 1}])),
        (
            "/materials/0/normalTexture",
            json!({"index": 0, "texCoord": 1, "scale": 2}),
        ),
    ];
    seeds.push(("a.gltf", changed(&textured)));
    seeds.push(("a.glb", container(bin.to_string().as_bytes(), Some(&square_bytes()))));
    seeds.push(("a.gltf", changed(&[("/accessors/0/sparse", sparse)])));
    let obj = "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\no a\nusemtl x\nf 1/1/1 2/1/1 3/1/1\n\
               g b\nusemtl y\nf -1 -2 -3\n";
    seeds.push(("a.obj", obj.as_bytes().to_vec()));
    seeds
}

#[test]
fn seeds_are_good() {
    for (name, bytes) in seeds() {
        assert!(translate(name, &bytes).is_ok(), "{name}");
    }
}

/// Lengths to cut a file at.
const CUTS: usize = 200;

#[test]
fn cut_at_many_lengths() {
    for (name, bytes) in seeds() {
        for cut in 0..CUTS {
            let cut = bytes[..bytes.len() * cut / CUTS].to_vec();
            use_all(name, &cut);
            use_all(name, &repair(cut));
        }
    }
}

/// Numbers that are near an edge.
const EDGES: [&str; 14] = [
    "0",
    "1",
    "2",
    "3",
    "4",
    "5",
    "255",
    "5126",
    "65536",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "-1",
    "1e39",
];

/// Replaces the number that begins at or behind a byte.
fn replace_number(bytes: &[u8], at: usize, number: &str) -> Vec<u8> {
    let is_digit = |byte: &u8| byte.is_ascii_digit();
    let start = at + bytes[at..].iter().position(is_digit).unwrap_or(bytes.len() - at);
    let end = start + bytes[start..].iter().take_while(|byte| is_digit(byte)).count();
    [&bytes[..start], number.as_bytes(), &bytes[end..]].concat()
}

/// Makes the lengths in a container right again, so that what is behind them is read.
fn repair(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.starts_with(b"glTF") && bytes.len() >= 20 {
        let total = bytes.len() as u32;
        bytes[8..12].copy_from_slice(&total.to_le_bytes());
        if let Some(bin) = bytes
            .windows(4)
            .rposition(|window| window == b"BIN\0")
            .filter(|bin| *bin > 24)
        {
            let json = (bin - 4 - 20) as u32;
            bytes[12..16].copy_from_slice(&json.to_le_bytes());
            let rest = (bytes.len() - bin - 4) as u32;
            bytes[bin - 4..bin].copy_from_slice(&rest.to_le_bytes());
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300), name in prop::sample::select(vec!["a.gltf", "a.glb", "a.obj"])) {
        use_all(name, &bytes);
        use_all(name, &[b"glTF\x02\0\0\0", &bytes[..]].concat());
    }

    #[test]
    fn cut_and_flipped(
        (name, bytes) in prop::sample::select(seeds()),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
        cut in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
    ) {
        let mut bytes = bytes;
        for (at, byte) in flips {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        use_all(name, &bytes);
        use_all(name, &repair(bytes));
    }

    #[test]
    fn numbers_at_the_edge(
        (name, bytes) in prop::sample::select(seeds()),
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(EDGES.to_vec())), 1..4),
    ) {
        let mut bytes = bytes;
        for (at, number) in changes {
            bytes = replace_number(&bytes, at.index(bytes.len()), number);
        }
        use_all(name, &repair(bytes));
    }
}

//! The images of glTF files: bytes as they are there.

use serde_json::{Value, json};

use super::document::{changed, container, data_uri, square, square_bytes};
use super::*;

/// Reads an image as if the file were in `root`; gives the other files that were read.
fn image_in(root: &Path, bytes: &[u8], number: u32, limit: u64) -> Result<(Vec<u8>, usize), ModelError> {
    let path = root.join("a.gltf");
    let limits = MeshLimits {
        bytes: limit,
        ..MeshLimits::default()
    };
    let mut model = Model::open(file(&path, root, bytes), &limits)?;
    let image = model.image(number)?;
    assert_eq!(image, model.image(number)?, "the same again");
    Ok((image, model.other_files().len()))
}

fn image(images: &Value) -> Result<(Vec<u8>, usize), ModelError> {
    image_in(&data_folder(), &changed(&[("/images", images.clone())]), 0, 1 << 20)
}

#[test]
fn images_lie_in_views_texts_and_files() {
    let view = image(&json!([{"bufferView": 3, "mimeType": "image/png"}])).unwrap();
    assert_eq!(view, (square_bytes()[128..].to_vec(), 0));
    let text = image(&json!([{"uri": data_uri(b"picture").replace("octet-stream", "x")}])).unwrap();
    assert_eq!(text, (b"picture".to_vec(), 0));
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    std::fs::write(root.join("a b.png"), b"file").unwrap();
    let bytes = changed(&[("/images", json!([{}, {"uri": "a%20b.png"}]))]);
    assert_eq!(image_in(&root, &bytes, 1, 1 << 20).unwrap(), (b"file".to_vec(), 1));
    let error = image_in(&root, &bytes, 1, bytes.len() as u64 + 3).unwrap_err();
    assert!(matches!(error, ModelError::Limit { .. }), "{error}");
}

#[test]
fn images_lie_in_the_binary_container() {
    let mut document = square();
    document["buffers"] = json!([{"byteLength": 140}]);
    document["images"] = json!([{"bufferView": 3}]);
    let bytes = container(document.to_string().as_bytes(), Some(&square_bytes()));
    let (read, _) = image_in(&data_folder(), &bytes, 0, 1 << 20).unwrap();
    assert_eq!(read, square_bytes()[128..]);
}

#[test]
fn wrong_images_are_errors() {
    let wrong = [
        json!([]),
        json!([{}]),
        json!([{"uri": "a.png", "bufferView": 0}]),
        json!([{"uri": "missing.png"}]),
        json!([{"uri": "../up.png"}]),
        json!([{"uri": "https://example.org/a.png"}]),
        json!([{"uri": "data:image/png,raw"}]),
        json!([{"bufferView": 4}]),
    ];
    let said: Vec<String> = wrong
        .iter()
        .map(|images| image(images).unwrap_err().to_string())
        .collect();
    let said = said.join("\n").replace(&data_folder().display().to_string(), "FOLDER");
    insta::assert_snapshot!(said, @r#"
    a.gltf: images: there is no image 0, the file has 0; export the model again, or check it with a validator
    a.gltf: images[0]: it has neither a `uri` nor a `bufferView`; export the model again, or check it with a validator
    a.gltf: images[0]: it has a `uri` and a `bufferView`; export the model again, or check it with a validator
    a.gltf: images[0].uri: there is no file `missing.png`; put the file beside the model, or export the model as one `.glb` file
    a.gltf: images[0].uri: `../up.png` lies outside of FOLDER; put the file beside the model, or export the model as one `.glb` file
    a.gltf: images[0].uri: `https://example.org/a.png` is a URL or names a drive; put the file beside the model, or export the model as one `.glb` file
    a.gltf: images[0].uri: this data URI is not in base64; write `data:application/octet-stream;base64,` and base64 data
    a.gltf: images[0].bufferView: there is no buffer view 4, the file has 4; export the model again, or check it with a validator
    "#);
    let triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let root = data_folder();
    let path = root.join("a.obj");
    let mut model = Model::open(file(&path, &root, triangle), &MeshLimits::default()).unwrap();
    assert!(matches!(model.image(0), Err(ModelError::Unsupported { .. })));
}

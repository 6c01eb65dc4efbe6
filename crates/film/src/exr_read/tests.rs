use exr::image::Blocks;
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image as AnyImage, Layer, LayerAttributes, LineOrder,
    WritableImage, attribute,
};
use proptest::prelude::*;

use super::*;

const SIZE: (usize, usize) = (37, 29);

/// A file by the library's own writer: half, float and unsigned channels in any encoding.
fn file(compression: Compression, blocks: Blocks) -> Vec<u8> {
    let count = SIZE.0 * SIZE.1;
    let channels = AnyChannels::sort(
        [
            ("id", FlatSamples::U32((0..count as u32).collect())),
            (
                "G",
                FlatSamples::F16((0..count).map(|i| f16::from_f32(i as f32 * 0.5)).collect()),
            ),
            ("R", FlatSamples::F32((0..count).map(|i| i as f32 * 0.1).collect())),
        ]
        .into_iter()
        .map(|(name, samples)| AnyChannel::new(attribute::Text::from(name), samples))
        .collect(),
    );
    let encoding = Encoding {
        compression,
        blocks,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(SIZE, LayerAttributes::default(), encoding, channels);
    let mut bytes = io::Cursor::new(Vec::new());
    AnyImage::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .unwrap();
    bytes.into_inner()
}

fn scan_lines() -> Vec<u8> {
    file(Compression::ZIP16, Blocks::ScanLines)
}

#[test]
fn all_encodings_and_types_are_read() {
    let tiles = Blocks::Tiles(Vec2(16, 8));
    let encodings = [
        (Compression::Uncompressed, Blocks::ScanLines),
        (Compression::RLE, Blocks::ScanLines),
        (Compression::ZIP1, tiles),
        (Compression::ZIP16, Blocks::ScanLines),
        (Compression::PIZ, tiles),
        (Compression::PIZ, Blocks::ScanLines),
    ];
    for (compression, blocks) in encodings {
        let image = decode_exr(&file(compression, blocks)).unwrap();
        assert_eq!((image.width, image.height), (37, 29));
        let names: Vec<_> = image.channels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["G", "R", "id"]);
        for i in [0, 36, 37, 1072] {
            assert_eq!(image.channel("G").unwrap()[i], i as f32 * 0.5, "{compression:?}");
            assert_eq!(image.channel("R").unwrap()[i], i as f32 * 0.1, "{compression:?}");
            assert_eq!(image.channel("id").unwrap()[i], i as f32, "{compression:?}");
        }
        assert_eq!(image.rgb(""), None);
    }
}

/// Replaces the value of an attribute; finds it by its name, type and size.
fn with_attribute(name_and_type: &str, value: &[u8]) -> Vec<u8> {
    let mut bytes = scan_lines();
    let at = bytes
        .windows(name_and_type.len())
        .position(|w| w == name_and_type.as_bytes());
    let start = at.unwrap() + name_and_type.len() + 4;
    bytes[start..start + value.len()].copy_from_slice(value);
    bytes
}

#[test]
fn hostile_claims_are_refused_cheaply() {
    let window = |numbers: [i32; 4]| {
        let value: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        decode_exr(&with_attribute("dataWindow\0box2i\0", &value)).unwrap_err()
    };
    assert!(matches!(
        window([0, 0, 99_999, 99_999]),
        ExrDecodeError::TooLarge { .. }
    ));
    assert!(matches!(
        window([0, 0, i32::MAX, i32::MAX]),
        ExrDecodeError::Malformed { .. }
    ));
    assert!(matches!(window([i32::MIN, 0, 0, 0]), ExrDecodeError::Malformed { .. }));
    assert!(matches!(window([9, 9, 8, 8]), ExrDecodeError::Malformed { .. }));
    assert!(matches!(window([0, 0, 36, 100_000]), ExrDecodeError::Malformed { .. }));
    let sampling = with_attribute("G\0", &[0, 0, 0, 0, 9, 0, 0, 0]);
    assert!(decode_exr(&sampling).is_err());
    let mut parts = scan_lines();
    parts[5] |= 0x10;
    assert!(matches!(decode_exr(&parts), Err(ExrDecodeError::Unsupported { .. })));
    assert!(matches!(decode_exr(b""), Err(ExrDecodeError::NotExr)));
    assert!(matches!(decode_exr(b"\x89PNG"), Err(ExrDecodeError::NotExr)));
}

#[test]
fn missing_files_are_named() {
    let error = read_exr(Path::new("/nowhere/a.exr")).unwrap_err().to_string();
    assert!(
        error.contains("/nowhere/a.exr") && error.contains("check the path"),
        "{error}"
    );
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(read_exr(folder.path()), Err(ExrReadError::Open { .. })));
    let path = folder.path().join("a.exr");
    fs::write(&path, "hello").unwrap();
    assert!(matches!(read_exr(&path), Err(ExrReadError::Decode { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn cut_off_files_are_errors(end in any::<prop::sample::Index>()) {
        let bytes = scan_lines();
        prop_assert!(decode_exr(&bytes[..end.index(bytes.len())]).is_err());
    }

    #[test]
    fn damaged_files_never_panic(
        tiled in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        in_header in any::<bool>(),
    ) {
        let mut bytes = if tiled {
            file(Compression::PIZ, Blocks::Tiles(Vec2(16, 8)))
        } else {
            scan_lines()
        };
        let range = if in_header { 500.min(bytes.len()) } else { bytes.len() };
        for (at, value) in changes {
            bytes[at.index(range)] = value;
        }
        // Errors and images are both fine; pixels are not protected by the format.
        if let Ok(image) = decode_exr(&bytes) {
            prop_assert!(u64::from(image.width) * u64::from(image.height) <= MAX_VALUES);
        }
    }
}

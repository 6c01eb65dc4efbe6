use std::fs;

use super::*;
use crate::exr_read::{decode_exr, read_exr};
use crate::pixels::Channel;
use crate::window::FilmWindow;

fn image() -> Image {
    let window = FilmWindow {
        resolution: UVec2::new(70, 50),
        crop_min: UVec2::new(5, 7),
        crop_max: UVec2::new(68, 47),
    };
    let names = ["R", "G", "B", "A", "direct.R", "normal.X", "depth.Z"];
    let sample = |c: usize, i: usize| ((i * 37 + c * 101) % 977) as f32 * 0.37 - 20.0 * c as f32;
    let channel = |(c, name): (usize, &&str)| Channel {
        name: (*name).to_owned(),
        samples: (0..window.pixel_count()).map(|i| sample(c, i)).collect(),
    };
    Image {
        window,
        channels: names.iter().enumerate().map(channel).collect(),
    }
}

fn metadata() -> Metadata {
    Metadata {
        scene_hash: "c0ffee".into(),
        seed: u64::MAX,
        samples: 64,
        version: "0.1.0".into(),
        extra: (0..20)
            .map(|i| (format!("note{i}"), format!("\u{e9}\u{4e16} {i}")))
            .collect(),
    }
}

fn bytes() -> Vec<u8> {
    let mut cursor = io::Cursor::new(Vec::new());
    encode(&image(), &metadata(), &mut cursor).unwrap();
    cursor.into_inner()
}

#[test]
fn comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(&path, &image(), &metadata()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), bytes());
    let read = read_exr(&path).unwrap();
    assert_eq!((read.width, read.height), (63, 40));
    assert_eq!(read.window, (glam::IVec2::new(5, 7), UVec2::new(70, 50)));
    assert_eq!(read.channels.len(), 7);
    for channel in &image().channels {
        assert_eq!(read.channel(&channel.name), Some(channel.samples.as_slice()));
    }
    assert_eq!(read.rgb(""), image().rgb(""));
    assert_eq!(read.attribute("pipeline.seed"), Some("18446744073709551615"));
    assert_eq!(read.attribute("pipeline.sceneHash"), Some("c0ffee"));
    assert_eq!(read.attribute("note7"), Some("\u{e9}\u{4e16} 7"));
    // The full-featured reader of the library, which checks strictly, agrees.
    let meta = MetaData::read_from_file(&path, true).unwrap();
    assert_eq!(meta.headers[0].compression, Compression::ZIP16);
    assert!(meta.headers[0].shared_attributes.chromaticities.is_some());
    assert!(meta.headers[0].own_attributes.capture_date.is_none());
}

#[test]
fn bytes_depend_on_the_image_alone() {
    let expected = bytes();
    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        // Each call makes new hash maps, with another order of the twenty-four attributes.
        for _ in 0..4 {
            assert!(pool.install(bytes) == expected, "{threads} threads");
        }
    }
    let mut shuffled = image();
    shuffled.channels.reverse();
    let mut cursor = io::Cursor::new(Vec::new());
    encode(&shuffled, &metadata(), &mut cursor).unwrap();
    assert!(cursor.into_inner() == expected, "the order of channels in memory shows");
}

#[test]
fn attributes_are_sorted() {
    let bytes = bytes();
    let position = |name: &str| {
        let found = bytes.windows(name.len()).position(|w| w == name.as_bytes());
        found.unwrap_or_else(|| panic!("{name} is missing"))
    };
    let names = [
        "channels\0",
        "dataWindow\0",
        "note0\0",
        "note10\0",
        "note9\0",
        "pipeline.seed\0",
    ];
    let positions: Vec<_> = names.iter().map(|name| position(name)).collect();
    assert!(positions.is_sorted(), "{positions:?}");
}

#[test]
fn bad_names_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let with_name = |name: &str| {
        let mut image = image();
        image.channels[0].name = name.to_owned();
        write_exr(&path, &image, &metadata())
    };
    for name in ["", "G", "has space", "far-too-long-a-name-for-a-channel.R"] {
        assert!(matches!(with_name(name), Err(ExrWriteError::Channel { .. })), "{name}");
    }
    let with_attribute = |name: &str| {
        let extra = vec![(name.to_owned(), String::new())];
        write_exr(&path, &image(), &Metadata { extra, ..metadata() })
    };
    for name in ["", "owner", "compression", "pipeline.seed", "\u{e9}"] {
        assert!(
            matches!(with_attribute(name), Err(ExrWriteError::Attribute { .. })),
            "{name}"
        );
    }
    let mut short = image();
    short.channels[2].samples.pop();
    assert!(write_exr(&path, &short, &metadata()).is_err());
    assert!(!path.exists());
    with_attribute("empty").unwrap();
    assert_eq!(read_exr(&path).unwrap().attribute("empty"), Some(""));
}

#[test]
fn missing_folder_is_an_error_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let error = write_exr(&folder.path().join("no/a.exr"), &image(), &metadata()).unwrap_err();
    assert!(error.to_string().contains("create its folder"), "{error}");
    #[cfg(target_os = "linux")]
    {
        let error = write_exr(Path::new("/dev/full"), &image(), &metadata()).unwrap_err();
        assert!(error.to_string().contains("free some space"), "{error}");
    }
}

#[test]
fn one_pixel_is_enough() {
    let tiny = Image {
        window: FilmWindow::full(UVec2::ONE),
        channels: vec![Channel {
            name: "Y".into(),
            samples: vec![f32::MIN_POSITIVE],
        }],
    };
    let mut cursor = io::Cursor::new(Vec::new());
    encode(&tiny, &Metadata::default(), &mut cursor).unwrap();
    let read = decode_exr(cursor.get_ref()).unwrap();
    assert_eq!(read.channels, [("Y".to_owned(), vec![f32::MIN_POSITIVE])]);
}

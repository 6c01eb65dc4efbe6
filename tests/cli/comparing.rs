//! `compare`: figures, difference images, limits.

use crate::program::{Folder, assert_whole_png};
use film::{Image, Metadata, RgbImage, write_exr};

/// A folder with `a.exr`, and `b.exr` that is 10 % brighter and has one firefly.
fn folder() -> Folder {
    let folder = Folder::new();
    let pixels = (0..64).map(|i| [1.0 + i as f32 * 0.01, 0.5, 0.25]).collect();
    let mut image = RgbImage {
        width: 8,
        height: 8,
        pixels,
    };
    let write = |name: &str, image: &RgbImage| {
        write_exr(&folder.path(name), &Image::from_rgb(image), &Metadata::default()).unwrap();
    };
    write("a.exr", &image);
    image.pixels.iter_mut().flatten().for_each(|value| *value *= 1.1);
    image.pixels[13] = [50.0; 3];
    write("b.exr", &image);
    image.pixels[20][1] = f32::NAN;
    write("nan.exr", &image);
    folder
}

#[test]
fn equal_images_have_no_error() {
    let ran = folder().succeed("compare a.exr a.exr --max-relmse 0");
    assert_eq!(ran.stderr, "");
    insta::assert_snapshot!(ran.stdout, @"
                              R            G            B
    mean                1.31500      0.50000      0.25000
    mean reference      1.31500      0.50000      0.25000
    difference         +0.000 %     +0.000 %     +0.000 %
    relMSE                    0
      trimmed                 0
    ");
}

#[test]
fn different_images_are_measured() {
    let folder = folder();
    let ran = folder.succeed("compare b.exr a.exr --worst 2 --diff diff.png");
    insta::assert_snapshot!(ran.stdout, @"
                              R            G            B
    mean                2.20833      1.32266      1.05195
    mean reference      1.31500      0.50000      0.25000
    difference        +67.934 %   +164.531 %   +320.781 %
    relMSE            251.53360
      trimmed         251.53360
    worst pixels
      5,1           16097.53949  (50.00000, 50.00000, 50.00000) for (1.13000, 0.50000, 0.25000)
      7,7               0.00970  (1.79300, 0.55000, 0.27500) for (1.63000, 0.50000, 0.25000)
    ");
    assert_whole_png(&folder.bytes("diff.png"));
    folder.succeed("compare b.exr a.exr --diff diff.exr");
    let difference = film::read_exr(&folder.path("diff.exr")).unwrap();
    assert!((difference.channel("G").unwrap()[0] - 0.05).abs() < 1e-6);
    let json = folder.succeed("compare b.exr a.exr --json --worst 1").stdout;
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(
        (&value["worst"][0]["x"], &value["worst"][0]["y"]),
        (&5.into(), &1.into())
    );
    assert!(value["relmse"].as_f64().unwrap() > value["relmse_trimmed"].as_f64().unwrap() - 1e-12);
}

#[test]
fn a_limit_decides_the_exit_code() {
    let folder = folder();
    assert_eq!(folder.run("compare b.exr a.exr --max-relmse 1000").code, Some(0));
    let ran = folder.run("compare b.exr a.exr --max-relmse 0.1");
    assert_eq!(ran.code, Some(1));
    assert!(ran.stderr.contains("is over the limit"), "{}", ran.stderr);
    assert!(ran.stdout.contains("relMSE"), "{}", ran.stdout);
    let ran = folder.run("compare nan.exr a.exr --max-relmse 1000");
    assert_eq!(ran.code, Some(1));
    assert!(
        ran.stderr.contains("1 pixels of nan.exr are not finite"),
        "{}",
        ran.stderr
    );
}

#[test]
fn bad_inputs_are_named() {
    let folder = folder();
    folder.write("text.exr", "no image");
    let small = RgbImage {
        width: 1,
        height: 1,
        pixels: vec![[0.0; 3]],
    };
    write_exr(
        &folder.path("small.exr"),
        &Image::from_rgb(&small),
        &Metadata::default(),
    )
    .unwrap();
    for (line, expected) in [
        ("compare none.exr a.exr", "none.exr"),
        ("compare a.exr text.exr", "not an OpenEXR file"),
        ("compare a.exr small.exr", "same resolution"),
        ("compare a.exr b.exr --layer caustic", "no layer `caustic`"),
    ] {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(2), "{line}\n{}", ran.stderr);
        assert!(ran.stderr.contains(expected), "{line}\n{}", ran.stderr);
    }
    let ran = folder.run("compare a.exr b.exr --diff none/diff.png");
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
}

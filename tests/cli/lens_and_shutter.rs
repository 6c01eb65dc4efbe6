//! Depth of field and motion blur, as pictures show them.

use crate::program::Folder;
use film::{RgbImage, read_exr};

fn beauty(folder: &Folder, name: &str) -> RgbImage {
    read_exr(&folder.path(name)).unwrap().rgb("").unwrap()
}

/// A small lamp before a lens.
fn lamp_behind_lens(lens: &str, distance: f64, lamp_radius: f64) -> String {
    format!(
        r#"Layer(prims: {{
    "/Camera": Def(Camera: (fov: 20), DepthOfField: ({lens})),
    "/Lamp": Def(Sphere: (radius: {lamp_radius}), Transform: (translate: (0, 0, -{distance})), Emission: (radiance: (1, 1, 1))),
    "/Render": Def(Render: (camera: "/Camera", samples: 512), Film: (resolution: (64, 64), filter: Box, filter_radius: 0.5)),
}})"#
    )
}

/// Root of the mean squared distance from the middle, in pixels, weighted by radiance.
fn spread(image: &RgbImage) -> f64 {
    let (mut sum, mut squares) = (0.0, 0.0);
    for (i, pixel) in image.pixels.iter().enumerate() {
        let offset = |at: u32, side: u32| f64::from(at) + 0.5 - 0.5 * f64::from(side);
        let (x, y) = (
            offset(i as u32 % image.width, image.width),
            offset(i as u32 / image.width, image.height),
        );
        sum += f64::from(pixel[1]);
        squares += f64::from(pixel[1]) * (x * x + y * y);
    }
    (squares / sum).sqrt()
}

#[test]
fn a_point_out_of_focus_becomes_a_disc_of_the_diameter_of_the_thin_lens_equation() {
    let (focus, lens_radius, lamp_radius) = (2.0_f64, 0.1_f64, 0.02_f64);
    for distance in [1.0, 1.4, 4.0] {
        let lens = format!("lens_radius: {lens_radius}, focus_distance: {focus}");
        let folder = Folder::with_scene(&lamp_behind_lens(&lens, distance, lamp_radius));
        folder.succeed("run scene.ron -o out.exr");
        // On the plane of focus; the lamp itself is a disc there, and so are pixels squares.
        let pixel = 2.0 * focus * radiometry::math::tan_f64(10_f64.to_radians()) / 64.0;
        let lamp = lamp_radius * focus / distance / pixel;
        let diameter = 2.0 * lens_radius * (distance - focus).abs() / distance / pixel;
        // A disc of radius R has a mean squared radius of R²/2, and that of independent offsets adds up.
        let own = 0.5 * lamp * lamp + 1.0 / 6.0;
        let found = 2.0 * (2.0 * (spread(&beauty(&folder, "out.exr")).powi(2) - own)).sqrt();
        assert!(
            (found / diameter - 1.0).abs() < 0.02,
            "at {distance}: a disc of {found} pixels instead of {diameter}"
        );
    }
}

#[test]
fn an_fstop_is_a_radius_and_a_pinhole_has_none() {
    let folder = Folder::new();
    let bytes = |lens: &str| {
        folder.write("scene.ron", lamp_behind_lens(lens, 1.4, 0.1));
        folder.succeed("run scene.ron -o out.exr --samples 8");
        beauty(&folder, "out.exr").pixels
    };
    let radius = bytes("lens_radius: 0.0125, focus_distance: 2");
    let fstop = bytes("fstop: 2, focus_distance: 2");
    let longer = bytes("fstop: 4, focal_length: 100, focus_distance: 2");
    assert!(radius == fstop && fstop == longer);
    let pinhole = bytes("focus_distance: 2");
    let six = bytes("lens_radius: 0.0125, focus_distance: 2, blades: 6");
    assert!(pinhole != radius && six != radius);
}

#[test]
fn lenses_and_shutters_that_make_no_sense_are_refused() {
    for (camera, expected) in [
        (
            "DepthOfField: (lens_radius: 0.1)",
            "error[missing-field]: `DepthOfField` needs the field `focus_distance`",
        ),
        ("DepthOfField: (focus_distance: 0)", "error[out-of-range]"),
        (
            "DepthOfField: (focus_distance: 1, lens_radius: 0.1, fstop: 2)",
            "error[exclusive-fields]",
        ),
        (
            "DepthOfField: (focus_distance: 1, blades: 2)",
            "error[out-of-range]: an aperture cannot have 2 corners",
        ),
        (
            "MotionBlur: (shutter: (1, 0))",
            "error[out-of-range]: the shutter of `/Camera` closes before it opens",
        ),
    ] {
        let folder = Folder::with_scene(&MOVING.replace("MotionBlur: (shutter: (0, 1))", camera));
        let ran = folder.run("check scene.ron");
        assert!(
            ran.code == Some(2) && ran.stderr.contains(expected),
            "{camera}\n{}",
            ran.stderr
        );
    }
    let stray = MOVING.replace(
        "\"/Floor\": Def(",
        "\"/Floor\": Def(MotionBlur: (), DepthOfField: (focus_distance: 1), ",
    );
    let ran = Folder::with_scene(&stray).run("check scene.ron");
    assert!(ran.code == Some(0), "{}", ran.stderr);
    for component in ["MotionBlur", "DepthOfField"] {
        let expected = format!("`{component}` of `/Floor` has no effect: the prim has no `Camera`");
        assert!(ran.stderr.contains(&expected), "{}", ran.stderr);
    }
    // Inside out on the way from one sample to the next.
    let flipped = MOVING.replace(
        "Samples({0: (0, 0, 0), 1: (0, 150, 40)})",
        "(0, 0, 0), scale: Samples({0: (1, 1, 1), 1: (-1, 1, 1)})",
    );
    let ran = Folder::with_scene(&flipped).run("check scene.ron");
    assert!(
        ran.code == Some(2) && ran.stderr.contains("error[singular-transform]"),
        "{}",
        ran.stderr
    );
}

/// Everything that can move does: the camera, geometry by its own transform and by its parent's, an emitter, a lamp.
const MOVING: &str = r#"#![enable(implicit_some)]
Layer(prims: {
    "/Camera": Def(
        Camera: (fov: 45),
        MotionBlur: (shutter: (0, 1)),
        Transform: (translate: Samples({0: (-0.2, 1, 4), 1: (0.2, 1.1, 4)})),
        LookAt: (target: (0, 0.5, 0)),
    ),
    "/Floor": Def(Quad: (size: (6, 6)), Transform: (rotate: (-90, 0, 0)), Diffuse: (albedo: (0.7, 0.6, 0.5))),
    "/Turn": Def(Transform: (rotate: Samples({0: (0, 0, 0), 1: (0, 150, 40)}), translate: (-0.6, 0.6, 0)), children: {
        "Box": Def(Cuboid: (size: (0.8, 0.5, 0.3)), Diffuse: (albedo: (0.8, 0.2, 0.2))),
    }),
    "/Ball": Def(Sphere: (radius: 0.4), Diffuse: (albedo: (0.2, 0.7, 0.3)),
        Transform: (translate: Samples({0: (0.5, 0.4, 0), 0.5: (0.9, 0.9, 0), 1: (1.3, 0.4, 0)}))),
    "/Panel": Def(Quad: (size: (0.6, 0.6)), Emission: (radiance: (9, 8, 7)),
        Transform: (translate: Samples({0: (-1, 2, 0), 1: (1, 2.4, 0)}), rotate: Samples({0: (60, 0, 0), 1: (120, 0, 0)}))),
    "/Spot": Def(SpotLight: (intensity: (6, 6, 9)),
        Transform: (translate: Samples({0: (2, 2, 1), 1: (1, 3, 1)})), LookAt: (target: (0, 0.3, 0))),
    "/Render": Def(
        Render: (camera: "/Camera", samples: 8192),
        Film: (resolution: (16, 16), filter: Box, filter_radius: 0.5),
        LightTransport: (direct: SampleLights, specular: Trace, caustic: Trace, indirect: PathTrace),
    ),
})
"#;

#[test]
fn motion_blur_is_the_mean_of_many_stills() {
    const STILLS: usize = 64;
    let folder = Folder::with_scene(MOVING);
    folder.write("still.ron", MOVING.replace("MotionBlur: (shutter: (0, 1)),", ""));
    folder.succeed("run scene.ron -o blurred.exr");
    let blurred = beauty(&folder, "blurred.exr");
    let mut mean = vec![[0.0_f64; 3]; blurred.pixels.len()];
    for still in 0..STILLS {
        let frame = (still as f64 + 0.5) / STILLS as f64;
        folder.succeed(&format!(
            "run still.ron -o still.exr --frame {frame} --samples 128 --seed {still}"
        ));
        for (sum, pixel) in mean.iter_mut().zip(&beauty(&folder, "still.exr").pixels) {
            for (sum, value) in sum.iter_mut().zip(pixel) {
                *sum += f64::from(*value) / STILLS as f64;
            }
        }
    }
    // Blocks of 4 × 4 pixels: their noise is about a per cent.
    let block = |value: &dyn Fn(usize) -> f64, x: usize, y: usize| {
        let inside = (0..16).map(|i| value((4 * y + i / 4) * 16 + 4 * x + i % 4));
        inside.sum::<f64>() / 16.0
    };
    for channel in 0..3 {
        let (ours, stills) = (
            |i: usize| f64::from(blurred.pixels[i][channel]),
            |i: usize| mean[i][channel],
        );
        let total = |value: &dyn Fn(usize) -> f64| (0..mean.len()).map(value).sum::<f64>();
        let off = total(&ours) / total(&stills) - 1.0;
        assert!(off.abs() < 0.006, "channel {channel} is off by {off}");
        for (x, y) in (0..16).map(|i| (i % 4, i / 4)) {
            let (a, b) = (block(&ours, x, y), block(&stills, x, y));
            assert!(
                (a - b).abs() < 0.04 * (a + b) * 0.5 + 1e-3,
                "block {x}, {y}: {a} and {b}"
            );
        }
    }
}

#[test]
fn an_open_shutter_changes_no_bit_of_what_stands_still() {
    let still = |text: &str| {
        let mut text = text.to_owned();
        while let Some(start) = text.find("Samples({0: ") {
            let end = start + text[start..].find("})").unwrap();
            let first = text[start + "Samples({0: ".len()..end]
                .split_inclusive(')')
                .next()
                .unwrap()
                .to_owned();
            text.replace_range(start..end + 2, &first);
        }
        text
    };
    let folder = Folder::with_scene(&still(MOVING));
    folder.succeed("run scene.ron -o open.exr --samples 8");
    folder.write("scene.ron", still(MOVING).replace("MotionBlur: (shutter: (0, 1)),", ""));
    folder.succeed("run scene.ron -o shut.exr --samples 8");
    assert!(beauty(&folder, "open.exr").pixels == beauty(&folder, "shut.exr").pixels);
}

#[test]
fn lens_and_shutter_change_no_bit_with_the_threads() {
    let text = MOVING.replace(
        "Camera: (fov: 45),",
        "Camera: (fov: 45), DepthOfField: (focus_distance: 4, lens_radius: 0.1, blades: 5),",
    );
    let folder = Folder::with_scene(&text);
    folder.succeed("run scene.ron -o first.exr --samples 8 --threads 1");
    for threads in 2..=3 {
        folder.succeed(&format!(
            "run scene.ron -o other.exr --samples 8 --threads {threads} --tile-size 7"
        ));
        assert!(
            folder.bytes("other.exr") == folder.bytes("first.exr"),
            "{threads} threads"
        );
    }
}

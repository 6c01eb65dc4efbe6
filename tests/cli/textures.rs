//! Textures from the file to the picture.

use crate::program::Folder;
use film::{Image, Metadata, RgbImage};

/// Dark and bright squares; the mean is 0.5.
const DARK: f32 = 0.2;
const BRIGHT: f32 = 0.8;

fn write_exr(folder: &Folder, name: &str, width: u32, pixels: &[[f32; 3]]) {
    let image = Image::from_rgb(&RgbImage {
        width,
        height: pixels.len() as u32 / width,
        pixels: pixels.to_vec(),
    });
    film::write_exr(&folder.path(name), &image, &Metadata::default()).unwrap();
}

/// A camera before a quad that fills the film, under a white sky.
fn before_quad(material: &str, rest: &str) -> Folder {
    let folder = Folder::with_scene(&format!(
        r#"#![enable(implicit_some)]
        Layer(prims: {{
            "/Wall": Def(Quad: (size: (2, 2)), {material}),
            "/Camera": Def(Camera: (fov: 90), Transform: (translate: (0, 0, 1))),
            "/Render": Def(Render: (camera: "/Camera", samples: 16), Film: (resolution: (32, 32), filter: Box, filter_radius: 0.5),
                LightTransport: (caustic: Trace, indirect: PathTrace)),
            {rest}
        }})"#
    ));
    write_exr(
        &folder,
        "checker.exr",
        2,
        &[[DARK; 3], [BRIGHT; 3], [BRIGHT; 3], [DARK; 3]],
    );
    write_exr(&folder, "tilted.exr", 1, &[[0.8, 0.5, 0.9]]);
    folder
}

const SKY: &str = r#""/Sky": Def(EnvironmentLight: (radiance: (1, 1, 1))),"#;

fn beauty(folder: &Folder) -> RgbImage {
    folder.succeed("run scene.ron -o image.exr");
    film::read_exr(&folder.path("image.exr")).unwrap().rgb("").unwrap()
}

fn mean(image: &RgbImage, keep: impl Fn(u32, u32) -> bool) -> f32 {
    let places = (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y)));
    let kept: Vec<f32> = places
        .filter(|(x, y)| keep(*x, *y))
        .map(|(x, y)| image.pixels[(y * image.width + x) as usize][1])
        .collect();
    kept.iter().sum::<f32>() / kept.len() as f32
}

/// Four standard deviations of a mean over 256 pixels of 16 samples, and a little.
const NOISE: f32 = 0.01;

#[test]
fn a_checker_reflects_the_sky_by_its_squares() {
    let folder = before_quad(
        r#"Diffuse: (albedo_texture: (file: "checker.exr", filter: Nearest, scale: (2, 2)))"#,
        SKY,
    );
    let image = beauty(&folder);
    // A convex surface under a sky of radiance 1 has the radiance of its albedo: squares are 8 pixels wide.
    let is_dark = |x: u32, y: u32| (x / 8 + y / 8).is_multiple_of(2);
    assert!((mean(&image, is_dark) - DARK).abs() < NOISE);
    assert!((mean(&image, |x, y| !is_dark(x, y)) - BRIGHT).abs() < NOISE);
    assert!((mean(&image, |_, _| true) - 0.5 * (DARK + BRIGHT)).abs() < NOISE);
    let read = film::read_exr(&folder.path("image.exr")).unwrap();
    let albedo = read.rgb("albedo").unwrap();
    assert!((mean(&albedo, is_dark) - DARK).abs() < 1e-6);
}

#[test]
fn threads_change_no_bit_of_textures() {
    let folder = before_quad(
        r#"Principled: (base_color_texture: "checker.exr", metallic_texture: "checker.exr", roughness_texture: "checker.exr",
            normal_texture: "tilted.exr", emission_texture: (file: "checker.exr", factor: (0.1, 0.2, 0.3)))"#,
        SKY,
    );
    folder.succeed("run scene.ron -o first.exr --threads 1");
    for threads in 1..=3 {
        folder.succeed(&format!("run scene.ron -o other.exr --threads {threads}"));
        assert!(folder.bytes("other.exr") == folder.bytes("first.exr"), "{threads}");
    }
}

/// Under light from one direction, n · l is all that counts: a tilted map is a tilted plane. The light stands high enough
/// for the factor that softens terminators to be 1.
#[test]
fn a_tilted_normal_is_lit_like_a_tilted_plane() {
    let sun = r#""/Sun": Def(DistantLight: (irradiance: (3, 3, 3), angle: 0), Transform: (rotate: (0, 20, 0))),"#;
    let lit = |material: &str| mean(&beauty(&before_quad(material, sun)), |_, _| true);
    let rough = "base_color: (0.6, 0.6, 0.6), specular: 0, roughness: 1";
    let (sin, cos) = radiometry::math::sin_cos_f64(20.0_f64.to_radians());
    let expected = |normal: [f64; 2]| (3.0 * 0.6 / std::f64::consts::PI * (sin * normal[0] + cos * normal[1])) as f32;
    let flat = lit(&format!("Principled: ({rough})"));
    assert!((flat - expected([0.0, 1.0])).abs() < 1e-3 * flat, "{flat}");
    let tilted = lit(&format!("Principled: ({rough}, normal_texture: \"tilted.exr\")"));
    assert!((tilted - expected([0.6, 0.8])).abs() < 1e-3 * tilted, "{tilted}");
}

#[test]
fn a_lamp_shines_by_its_picture() {
    let material = r#"Principled: (base_color: (0, 0, 0), specular: 0,
        emission_texture: (file: "checker.exr", filter: Nearest))"#;
    // A wall that the camera does not see; it gets the same light as from a lamp of the mean, a long way off.
    let image = beauty(&before_quad(material, ""));
    let is_dark = |x: u32, y: u32| (x / 16 + y / 16).is_multiple_of(2);
    assert!((mean(&image, is_dark) - DARK).abs() < 1e-5);
    assert!((mean(&image, |x, y| !is_dark(x, y)) - BRIGHT).abs() < 1e-5);
}

/// The same light whether paths find the lamp or lamps are sampled, in the sum over the squares.
#[test]
fn light_of_a_picture_arrives() {
    let lit = |emission: &str| {
        let lamp = format!(
            r#""/Lamp": Def(Quad: (size: (1, 1)), Transform: (translate: (0, 0, 4), rotate: (180, 0, 0)),
                Principled: (base_color: (0, 0, 0), specular: 0, {emission})),"#
        );
        mean(
            &beauty(&before_quad("Diffuse: (albedo: (0.5, 0.5, 0.5))", &lamp)),
            |_, _| true,
        )
    };
    let even = lit("emission: (5, 5, 5)");
    let checkered = lit(r#"emission_texture: (file: "checker.exr", factor: (10, 10, 10))"#);
    assert!((checkered - even).abs() < 0.02 * even, "{checkered} {even}");
}

#[test]
fn a_bomb_is_an_error_of_the_scene() {
    let folder = before_quad(r#"Diffuse: (albedo_texture: "bomb.png")"#, SKY);
    // The head of a PNG of 65,535 by 65,535 pixels.
    let mut bomb = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    bomb.extend([0, 0, 255, 255, 0, 0, 255, 255, 8, 2, 0, 0, 0, 0, 0, 0, 0]);
    folder.write("bomb.png", &bomb);
    let ran = folder.run("run scene.ron");
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    assert!(
        ran.stderr
            .contains("error[bad-texture]: bomb.png: 65535x65535 pixels are more than 134217728 in all"),
        "{}",
        ran.stderr
    );
    let ran = folder.run("run scene.ron --limit texture_pixels=5000000000");
    assert!(ran.stderr.contains("the file is damaged or cut off"), "{}", ran.stderr);
    assert_eq!(ran.code, Some(2));
}

#[test]
fn textures_are_explained_and_flattened() {
    let folder = before_quad(
        r#"Diffuse: (albedo_texture: (file: "checker.exr", wrap_u: Mirror))"#,
        SKY,
    );
    let explained = folder.succeed("explain scene.ron /Wall.albedo_texture");
    assert!(explained.stdout.contains("checker.exr"), "{}", explained.stdout);
    let flat = folder.succeed("flatten scene.ron");
    folder.write("flat.ron", &flat.stdout);
    folder.succeed("run scene.ron -o first.exr");
    folder.succeed("run flat.ron -o other.exr");
    let pixels = |name: &str| film::read_exr(&folder.path(name)).unwrap().rgb("").unwrap().pixels;
    assert!(pixels("first.exr") == pixels("other.exr"));
    let schema = folder.succeed("schema Diffuse");
    assert!(
        schema
            .stdout
            .contains("albedo_texture: a file, or (file: .., image: .., "),
        "{}",
        schema.stdout
    );
}

#[test]
fn a_surface_that_is_not_whole_lets_the_rest_through() {
    let black = "Principled: (base_color: (0, 0, 0), specular: 0, alpha: 0.4)";
    let image = beauty(&before_quad(black, SKY));
    assert!((mean(&image, |_, _| true) - 0.6).abs() < NOISE);
    // Below a cut-off there is nothing, above it all.
    for (cutoff, expected) in [(0.5, 1.0), (0.3, 0.0)] {
        let cut = black.replace("alpha: 0.4", &format!("alpha: 0.4, alpha_cutoff: {cutoff}"));
        let image = beauty(&before_quad(&cut, SKY));
        assert_eq!(mean(&image, |_, _| true), expected);
    }
    // A hole for each bright square.
    let holes = black.replace(
        "alpha: 0.4",
        r#"alpha_texture: (file: "checker.exr", filter: Nearest), alpha_cutoff: 0.5"#,
    );
    let image = beauty(&before_quad(&holes, SKY));
    assert!((mean(&image, |_, _| true) - 0.5).abs() < 1e-6);
}

#[test]
fn a_screen_that_is_not_whole_dims_lamps_of_every_kind_alike() {
    let screen = |alpha: f32| {
        format!(
            r#""/Screen": Def(Quad: (size: (40, 40)), Transform: (translate: (0, 0, 2)),
                Principled: (base_color: (0, 0, 0), specular: 0, alpha: {alpha})),"#
        )
    };
    for lamp in [
        r#""/Lamp": Def(PointLight: (power: (100, 100, 100)), Transform: (translate: (0, 0, 3))),"#,
        r#""/Lamp": Def(DistantLight: (irradiance: (3, 3, 3), angle: 3)),"#,
        r#""/Lamp": Def(Quad: (size: (30, 30)), Emission: (radiance: (1, 1, 1)), Transform: (translate: (0, 0, 4), rotate: (180, 0, 0))),"#,
    ] {
        let wall = "Diffuse: (albedo: (0.5, 0.5, 0.5))";
        let lit = |alpha: f32| {
            mean(
                &beauty(&before_quad(wall, &format!("{lamp}{}", screen(alpha)))),
                |_, _| true,
            )
        };
        let (whole, dimmed) = (lit(0.0), lit(0.75));
        assert!((dimmed / whole - 0.25).abs() < 0.01, "{lamp}: {dimmed} of {whole}");
    }
}

//! The three photon maps and final gathering in whole pictures: closed furnaces, threads, files, passes.

#![expect(clippy::print_stdout, reason = "furnaces report their figures")]

mod cloud;
mod program;

use cloud::read_cloud;
use film::{ExrImage, RgbImage, block_means};
use glam::Vec3;
use program::{attempt, file, project, render, run};
use std::path::PathBuf;

const DIRECT: &str = "/Render.LightTransport.direct=PhotonMap";
const CAUSTIC: &str = "/Render.LightTransport.caustic=PhotonMap";
const INDIRECT: &str = "/Render.LightTransport.indirect=PhotonMap";
const GATHER: &str = "/Render.LightTransport.indirect=FinalGather";

fn scene(name: &str) -> PathBuf {
    project(&format!("tests/references/{name}/scene.ron"))
}

fn beauty(image: &ExrImage) -> RgbImage {
    image.rgb("").expect("R, G, B")
}

fn mean(values: impl Iterator<Item = f32>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + f64::from(value), count + 1));
    sum / f64::from(count)
}

/// Where each pixel of the furnace is seen: from its camera, by the distance of the image.
fn places(image: &ExrImage) -> Vec<Vec3> {
    let (eye, target) = (Vec3::new(0.2, 0.1, 0.3), Vec3::new(-1.0, -0.4, -0.9));
    let ahead = (target - eye).normalize();
    let right = ahead.cross(Vec3::Y).normalize();
    let up = right.cross(ahead);
    let side = SIDE as f32;
    let scale = 2.0 * radiometry::math::tan(35_f32.to_radians()) / side;
    let depths = image.channel("depth.Z").expect("a depth");
    let place = |(i, depth): (usize, &f32)| {
        let (x, y) = ((i as u32 % SIDE) as f32 + 0.5, (i as u32 / SIDE) as f32 + 0.5);
        let direction = ahead + right * ((x - 0.5 * side) * scale) + up * ((0.5 * side - y) * scale);
        eye + direction.normalize() * *depth
    };
    depths.iter().enumerate().map(place).collect()
}

/// Side of the images of furnaces, in pixels.
const SIDE: u32 = 64;

/// Furnaces and the radiance of every point of them: 1, whatever the albedo.
const FURNACES: [&str; 2] = ["furnace", "furnace80"];

/// What a mean may be off by: noise of the photons and of the rays. Edges are looked at apart.
const MEAN: f64 = 0.01;
/// What a block of 8×8 pixels may be off by, where rays are gathered.
const BLOCK: f32 = 0.03;

#[test]
fn furnaces_seen_in_the_maps_shine_alike_but_for_their_edges() {
    const RADIUS: f32 = 0.12;
    let radius = |map: &str| format!("/Render.{map}.max_radius={RADIUS}");
    for name in FURNACES {
        let fields = [
            DIRECT,
            INDIRECT,
            &radius("DirectPhotonMap"),
            &radius("IndirectPhotonMap"),
        ];
        let image = render(&scene(name), &["--resolution", "64x64", "--samples", "4"], &fields);
        let pixels = beauty(&image).pixels;
        // On a face of the box from −1 to 1, the two other coordinates tell how far the next edge is.
        let from_edge = |place: &Vec3| {
            let mut distances = place.abs().to_array().map(|coordinate| 1.0 - coordinate);
            distances.sort_by(f32::total_cmp);
            distances[1]
        };
        let inside = places(&image);
        let clear = || {
            inside
                .iter()
                .zip(&pixels)
                .filter(|(place, _)| from_edge(place) > RADIUS)
        };
        assert!(
            clear().count() > pixels.len() / 2,
            "most of a furnace is not at its edges"
        );
        let (far, all) = (mean(clear().map(|(_, p)| p[1])), mean(pixels.iter().map(|p| p[1])));
        println!("{name}: {far:.4} far from edges, {all:.4} in all");
        assert!((far - 1.0).abs() < MEAN, "{name}: {far}");
        // A disc that hangs over an edge loses up to half of its photons.
        assert!(all < far && all > 0.9, "{name}: {all} in all, {far} far from edges");
    }
}

#[test]
fn gathered_furnaces_shine_alike_everywhere() {
    for name in FURNACES {
        for precomputed in ["true", "false"] {
            let fields = [
                GATHER,
                "/Render.FinalGather.rays=64",
                // Discs that hang over an edge lose photons; with these many they are small.
                "/Render.DirectPhotonMap.photons=400000",
                "/Render.IndirectPhotonMap.photons=400000",
                &format!("/Render.FinalGather.precomputed={precomputed}"),
            ];
            let image = beauty(&render(
                &scene(name),
                &["--resolution", "64x64", "--samples", "4"],
                &fields,
            ));
            let all = mean(image.pixels.iter().map(|p| p[1]));
            let blocks = block_means(&image, 8);
            let worst = blocks.pixels.iter().map(|p| (p[1] - 1.0).abs()).fold(0.0, f32::max);
            println!("{name}, precomputed {precomputed}: {all:.4}, worst block off by {worst:.4}");
            assert!((all - 1.0).abs() < MEAN && worst < BLOCK, "{name}: {all}, {worst}");
        }
    }
}

/// The room behind the wall is black to the last pixel, whatever is read and however thin the wall.
#[test]
fn no_light_leaks_through_a_wall() {
    const SIDE: usize = 96;
    let path = project("scenes/thin_wall.ron");
    let methods: [(&str, &[&str]); 3] = [
        ("maps that are seen", &[DIRECT, CAUSTIC, INDIRECT]),
        ("gathering", &[GATHER, "/Render.FinalGather.precomputed=false"]),
        ("gathering of irradiance", &[GATHER]),
    ];
    let resolution = format!("{SIDE}x{SIDE}");
    for thickness in [0.2, 0.02, 0.002, 0.000_2, 0.000_02] {
        let size = format!("/World/Wall.Cuboid.size=({thickness},2,2)");
        // The edge of the wall is nearest to the camera, 2.9 m away, where the picture is 1.94 m wide.
        let edge = SIDE / 2 + 2 + (0.5 * thickness / 1.94 * SIDE as f64) as usize;
        for (label, fields) in methods {
            let image = beauty(&render(
                &path,
                &["--resolution", &resolution, "--samples", "4"],
                &[fields, &[size.as_str()]].concat(),
            ));
            let side = |is_dark: bool| {
                let pixels = image.pixels.iter().enumerate();
                let chosen = pixels.filter(move |(i, _)| is_dark == (i % SIDE >= edge));
                chosen.flat_map(|(_, pixel)| *pixel)
            };
            let leaked: f32 = side(true).sum();
            assert!(leaked == 0.0, "{label}, {thickness} m: {leaked}");
            assert!(mean(side(false)) > 0.1, "{label}, {thickness} m: dark on the lit side");
        }
    }
}

/// A picture with all three maps, gathered and seen, mirrors and glass.
const SMALL: [&str; 5] = [
    "/Render.DirectPhotonMap.photons=3000",
    "/Render.CausticPhotonMap.photons=3000",
    "/Render.IndirectPhotonMap.photons=3000",
    DIRECT,
    CAUSTIC,
];
const SMALL_OPTIONS: [&str; 4] = ["--resolution", "40x40", "--samples", "4"];

fn bytes(path: &str) -> Vec<u8> {
    std::fs::read(path).expect("a file that was written")
}

#[test]
fn threads_and_reloaded_photons_change_no_bit() {
    let glass = scene("cornell_glass");
    let progressive = [
        INDIRECT,
        "/Render.DirectPhotonMap.progressive=true",
        "/Render.CausticPhotonMap.progressive=true",
        "/Render.IndirectPhotonMap.progressive=true",
    ];
    let progressive_thinned = [&progressive[..], &["/Render.PhotonThinning.density=0.5"]].concat();
    for (label, more) in [
        ("seen", &[INDIRECT] as &[&str]),
        ("thinned", &[INDIRECT, "/Render.PhotonThinning.density=0.5"]),
        ("gathered", &[GATHER, "/Render.FinalGather.rays=8"]),
        ("progressive", &progressive),
        ("progressive, thinned", &progressive_thinned),
    ] {
        let folder = tempfile::tempdir().expect("a folder for images");
        let fields = [&SMALL, more].concat();
        let picture = |name: &str, options: &[&str]| {
            let output = file(&folder, name);
            run(
                "run",
                &glass,
                &[&SMALL_OPTIONS, options, &["-o", &output]].concat(),
                &fields,
            );
            bytes(&output)
        };
        let first = picture("first.exr", &["--threads", "1"]);
        for threads in ["2", "3"] {
            let other = picture("other.exr", &["--threads", threads, "--tile-size", "7"]);
            assert!(other == first, "{label} on {threads} threads");
        }
        if label.starts_with("progressive") {
            continue;
        }
        let photons = file(&folder, "maps.photons");
        run("photons", &glass, &["--resolution", "40x40", "-o", &photons], &fields);
        let reloaded = picture("reloaded.exr", &["--photons", &photons]);
        assert!(reloaded == first, "{label} with photons from a file");
    }
}

/// The header of a point cloud says how many photons it has.
fn count_in(cloud: &str) -> usize {
    let written = bytes(cloud);
    let header = String::from_utf8_lossy(&written[..written.len().min(1000)]).into_owned();
    let count = header.lines().find_map(|line| line.strip_prefix("element vertex "));
    count.expect("a count").parse().expect("a number")
}

#[test]
fn thinned_photons_are_fewer_and_shine_alike() {
    /// What the mean of an image may be off by: wider discs lose more light over the edges of the floor and of caustics,
    /// and each misses some of the flux that the photon on its rim stands for, 0.7 % where there are 50.
    const MEAN: f64 = 0.05;
    let glass = scene("cornell_glass");
    let folder = tempfile::tempdir().expect("a folder for photons");
    let fields = [&SMALL[..2], &[CAUSTIC, "/Render.CausticPhotonMap.photons=30000"]].concat();
    let measured = [None, Some("/Render.PhotonThinning.density=2")].map(|thinning| {
        let fields = [&fields[..], thinning.as_slice()].concat();
        let cloud = file(&folder, "photons.ply");
        let options = ["--resolution", "40x40", "--map", "caustic", "-o", &cloud];
        run("photons", &glass, &options, &fields);
        let image = render(&glass, &SMALL_OPTIONS, &fields);
        let caustic = image.rgb("caustic").expect("a layer").pixels;
        (count_in(&cloud), mean(caustic.into_iter().map(|p| p[1])))
    });
    let [(all, before), (kept, after)] = measured;
    println!("{kept} photons of {all}, caustic {after} instead of {before}");
    assert!(kept < all / 2 && kept > 0, "{kept} of {all}");
    assert!((after / before - 1.0).abs() < MEAN, "{after} instead of {before}");
}

#[test]
fn photons_of_another_scene_are_refused() {
    let folder = tempfile::tempdir().expect("a folder for photons");
    let photons = file(&folder, "maps.photons");
    run(
        "photons",
        &scene("cornell_glass"),
        &["--resolution", "40x40", "-o", &photons],
        &SMALL,
    );
    let refused = |bytes: &[u8], expected: &str| {
        std::fs::write(&photons, bytes).expect("a writable folder");
        let image = file(&folder, "image.exr");
        let seed = if expected.contains("seed") { "8" } else { "0" };
        let options = ["--photons", &photons, "-o", &image, "--seed", seed];
        let ran = attempt(
            "run",
            &scene("cornell_glass"),
            &[&options[..], &SMALL_OPTIONS].concat(),
            &SMALL,
        );
        let said = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(2), "{said}");
        assert!(said.contains("bad-photons") && said.contains(expected), "{said}");
        assert!(!folder.path().join("image.exr").exists());
    };
    let good = bytes(&photons);
    refused(&good, "another scene, seed");
    refused(&good[..good.len() / 2], "cut off");
    refused(b"ply\nformat", "no photon file");
    let mut damaged = good;
    let end = damaged.len() - 20;
    damaged[end] ^= 1;
    refused(&damaged, "damaged");
}

#[test]
fn photons_are_drawn_and_written_down() {
    let folder = tempfile::tempdir().expect("a folder for photons");
    let (picture, cloud) = (file(&folder, "photons.png"), file(&folder, "photons.ply"));
    for colour in ["flux", "map", "bounce"] {
        let options = [
            "--resolution",
            "40x40",
            "--colour",
            colour,
            "-o",
            &picture,
            "-o",
            &cloud,
        ];
        run("photons", &scene("cornell_glass"), &options, &SMALL);
        let drawn = bytes(&picture);
        assert!(drawn.starts_with(b"\x89PNG"), "{colour}");
        let (header, count, body) = read_cloud(&cloud);
        assert!(count >= 9000, "{header}");
        // Three doubles, nine floats, four bytes, two counts.
        assert_eq!(body.len(), count * (3 * 8 + 9 * 4 + 4 + 2 * 4), "{header}");
    }
}

/// Every figure of the lecture is a scene, and none is black.
#[test]
fn the_figures_of_the_lecture_render() {
    let folder = project("scenes/lecture");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the lecture's scenes") {
        let path = entry.expect("a readable folder").path();
        let image = render(&path, &["--resolution", "16x16", "--samples", "1"], &[]);
        let light = mean(beauty(&image).pixels.into_iter().flatten());
        assert!(light > 0.001, "{}: {light}", path.display());
        count += 1;
    }
    assert_eq!(
        count, 14,
        "two scenes that are traced, eight figures of photons, and four of records"
    );
}

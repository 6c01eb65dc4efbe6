//! Radiosity in whole pictures: closed furnaces, the Cornell box against its reference, threads, refusals.

#![expect(clippy::print_stdout, reason = "comparisons report their figures")]

mod blocks;
mod program;

use blocks::Quantiles;
use film::{RgbImage, block_means, read_exr};
use program::{attempt, file, project, render, run};
use std::path::PathBuf;

/// Read where the eye looks.
const SEEN: &[&str] = &["/Render.LightTransport.indirect=Radiosity"];
/// Read at the ends of gather rays.
const GATHERED: &[&str] = &[
    "/Render.LightTransport.indirect=FinalGather",
    "/Render.FinalGather.incoming=Radiosity",
    "/Render.FinalGather.rays=64",
];

fn scene(name: &str) -> PathBuf {
    project(&format!("tests/references/{name}/scene.ron"))
}

fn beauty(name: &str, options: &[&str], fields: &[&str]) -> RgbImage {
    render(&scene(name), options, fields).rgb("").expect("R, G, B")
}

fn means(image: &RgbImage) -> [f64; 3] {
    [0, 1, 2].map(|c| image.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / image.pixels.len() as f64)
}

#[test]
fn furnaces_shine_alike() {
    /// What the mean of the image may be off by.
    const MEAN: f64 = 0.005;
    for name in ["furnace", "furnace80"] {
        for (label, fields) in [("seen", SEEN), ("gathered", GATHERED)] {
            let image = beauty(name, &["--resolution", "64x64", "--samples", "16"], fields);
            let mean = means(&image)[1];
            let blocks = block_means(&image, 8);
            let worst = blocks.pixels.iter().map(|p| (p[1] - 1.0).abs()).fold(0.0, f32::max);
            println!("{name}, {label}: {mean:.4}, worst block off by {worst:.4}");
            assert!(
                (mean - 1.0).abs() < MEAN && worst < 0.03,
                "{name}, {label}: {mean}, {worst}"
            );
        }
    }
}

/// A furnace whose light is reflected a limited number of times: `L_e (1 + ρ + … + ρⁿ)`.
#[test]
fn light_is_reflected_no_more_often_than_it_may() {
    /// What the mean of the image may be off by.
    const MEAN: f64 = 0.005;
    let (albedo, emitted) = (0.8_f64, 0.2);
    for (label, fields) in [("seen", SEEN), ("gathered", GATHERED)] {
        for depth in 1..=5 {
            let limit = format!("/Render.Render.max_depth={depth}");
            let options = ["--resolution", "32x32", "--samples", "16"];
            let mean = means(&beauty("furnace80", &options, &[fields, &[limit.as_str()]].concat()))[1];
            let expected: f64 = (0..=depth).map(|n| emitted * albedo.powi(n)).sum();
            println!("{label}, {depth} reflections: {mean:.4}, expected {expected:.4}");
            assert!(
                (mean / expected - 1.0).abs() < MEAN,
                "{label}, {depth}: {mean}, not {expected}"
            );
        }
    }
}

/// How far the Cornell box is from its reference: the means of the image, and blocks at the median and 95th percentile.
fn assert_cornell(label: &str, side: u32, samples: &str, fields: &[&str], [most_mean, median, high]: [f64; 3]) {
    let resolution = format!("{side}x{side}");
    let image = beauty("cornell", &["--resolution", &resolution, "--samples", samples], fields);
    let reference = read_exr(&project("tests/references/cornell/reference.exr")).expect("a valid image");
    let reference = reference.rgb("").expect("R, G, B");
    let off = |c: usize| means(&image)[c] / means(&reference)[c] - 1.0;
    let off = [off(0), off(1), off(2)];
    let (blocks, expected) = (
        block_means(&image, 8),
        block_means(&reference, 8 * reference.width / side),
    );
    let found = Quantiles::of(&blocks, &expected);
    println!("cornell, {label}, {resolution}: means off by {off:.4?}, {found}");
    assert!(off.iter().all(|off| off.abs() < most_mean), "{label}: {off:?}");
    assert!(found.within([median, high]), "{label}: {found}");
}

#[test]
fn cornell_meets_its_reference() {
    assert_cornell("seen", 64, "64", SEEN, [0.01, 0.02, 0.06]);
    assert_cornell("gathered", 64, "64", GATHERED, [0.01, 0.015, 0.04]);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn cornell_at_full_size_meets_its_reference() {
    assert_cornell("seen", 256, "64", SEEN, [0.005, 0.03, 0.08]);
    assert_cornell("gathered", 256, "64", GATHERED, [0.005, 0.02, 0.05]);
}

#[test]
fn threads_change_no_bit() {
    let options = ["--resolution", "24x24", "--samples", "2"];
    let coarse = "/Render.Radiosity.patch_size=0.3";
    for fields in [SEEN, GATHERED] {
        let fields = [fields, &[coarse]].concat();
        let picture = |threads: &str| {
            let folder = tempfile::tempdir().expect("a folder for the image");
            let output = file(&folder, "image.exr");
            let more = ["--threads", threads, "--tile-size", "7", "-o", &output];
            run("run", &scene("cornell_glass"), &[&options[..], &more].concat(), &fields);
            std::fs::read(output).expect("a file that was written")
        };
        let first = picture("1");
        assert!(["2", "3"].iter().all(|threads| picture(threads) == first), "{fields:?}");
    }
}

#[test]
fn surfaces_that_move_are_told_of() {
    let folder = tempfile::tempdir().expect("a folder for the image");
    let output = file(&folder, "image.exr");
    let options = ["--resolution", "8x8", "--samples", "1", "-o", &output];
    for (name, moves) in [("dof_motion", true), ("cornell", false)] {
        let ran = attempt("run", &scene(name), &options, SEEN);
        let said = String::from_utf8_lossy(&ran.stderr);
        assert!(ran.status.success(), "{said}");
        assert_eq!(said.contains("warning[moving-surfaces]"), moves, "{said}");
    }
}

#[test]
fn what_is_too_much_is_refused_with_a_remedy() {
    let tiny = [SEEN, &["/Render.Radiosity.patch_size=0.0001"]].concat();
    let ran = attempt("run", &scene("cornell"), &["-o", "none.exr"], &tiny);
    let said = String::from_utf8_lossy(&ran.stderr);
    assert_eq!(ran.status.code(), Some(2), "{said}");
    assert!(
        said.contains("too-large") && said.contains("`Radiosity.patch_size`"),
        "{said}"
    );
    let folder = tempfile::tempdir().expect("a folder for the image");
    let output = file(&folder, "image.exr");
    let options = ["--resolution", "8x8", "--samples", "1", "-o", &output];
    let ran = attempt("run", &scene("cornell"), &options, &["/Render.Radiosity.rays=8"]);
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(
        said.contains("unused-settings") && said.contains("`Radiosity` has no effect"),
        "{said}"
    );
}

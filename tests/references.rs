//! Full-size comparisons with the images of an independent renderer, and of methods with each other.
//!
//! These take minutes, so the suite leaves them out; `.ci/full` runs them, in release mode.

#![expect(clippy::print_stdout, reason = "a full comparison reports its figures")]

use film::{ExrImage, RgbImage, block_means, compare, read_exr};
use std::path::{Path, PathBuf};
use std::process::Command;

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/references")
        .join(name)
}

/// Renders a reference scene and reads the image back.
fn render(name: &str, label: &str, arguments: &[&str]) -> ExrImage {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let output = folder.join(format!("{name}-{label}.exr"));
    let status = Command::new(env!("CARGO_BIN_EXE_pipeline"))
        .arg("run")
        .arg(scene(name).join("scene.ron"))
        .args(["--quiet", "-o"])
        .arg(&output)
        .args(arguments)
        .status()
        .expect("the program starts");
    assert!(status.success(), "{name}: {status}");
    read_exr(&output).expect("a valid image")
}

/// The reference image of a scene, in a file of its folder.
fn stored(name: &str, file: &str) -> RgbImage {
    beauty(&read_exr(&scene(name).join(file)).expect("a valid image"))
}

fn reference(name: &str) -> RgbImage {
    stored(name, "reference.exr")
}

fn beauty(image: &ExrImage) -> RgbImage {
    image.rgb("").expect("R, G, B")
}

/// A path tracer with independent samples has relMSE `k`/samples; ours may have 1.2 times that, plus the reference's own.
fn assert_equal_samples(name: &str, k: f64, own: f64) {
    let image = render(name, "traced", &["--samples", "256"]);
    let found = compare(&beauty(&image), &reference(name), 0).expect("same size");
    println!(
        "{name}: means off by {:?}, relMSE {}",
        found.relative_difference, found.rel_mse
    );
    assert!(
        found.relative_difference.iter().all(|d| d.abs() < 0.005),
        "{name}: {found:?}"
    );
    let limit = 1.2 * k / 256.0 + own;
    assert!(
        found.rel_mse <= limit,
        "{name}: relMSE {} exceeds {limit}",
        found.rel_mse
    );
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn env_spheres_meets_the_reference_at_equal_samples() {
    assert_equal_samples("env_spheres", 1.35, 0.000_26);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn dof_motion_meets_the_reference_at_equal_samples() {
    assert_equal_samples("dof_motion", 0.3, 0.000_06);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn cornell_meets_the_reference_at_equal_samples() {
    assert_equal_samples("cornell", 1.0, 0.000_07);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn cornell_glass_meets_the_reference_at_equal_samples() {
    assert_equal_samples("cornell_glass", 8.8, 0.000_13);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn furnaces_shine_alike_everywhere() {
    for name in ["furnace", "furnace80"] {
        let image = render(name, "traced", &["--samples", "256"]);
        let found = compare(&beauty(&image), &reference(name), 0).expect("same size");
        println!("{name}: means {:?}", found.mean_image);
        assert!(
            found.mean_image.iter().all(|mean| (mean - 1.0).abs() < 0.001),
            "{name}: {found:?}"
        );
    }
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn traced_ring_has_the_mean_of_the_reference() {
    // The run's own standard error, from eight independent renders of an eighth of the samples each.
    let seeds: Vec<[f64; 3]> = (0..8)
        .map(|seed| {
            let seed_text = seed.to_string();
            let image = render(
                "ring",
                &format!("seed{seed}"),
                &["--samples", "32", "--seed", &seed_text],
            );
            compare(&beauty(&image), &reference("ring"), 0)
                .expect("same size")
                .mean_image
        })
        .collect();
    let expected = compare(&reference("ring"), &reference("ring"), 0)
        .expect("same size")
        .mean_image;
    for channel in 0..3 {
        let mean = seeds.iter().map(|s| s[channel]).sum::<f64>() / 8.0;
        let variance = seeds
            .iter()
            .map(|s| (s[channel] - mean) * (s[channel] - mean))
            .sum::<f64>()
            / 7.0;
        let standard_error = (variance / 8.0).sqrt();
        println!(
            "ring, channel {channel}: {mean} ± {standard_error} against {}",
            expected[channel]
        );
        assert!((mean - expected[channel]).abs() < 0.01 * expected[channel] + 3.0 * standard_error);
    }
}

/// Relative difference of each block from that of the reference, the largest of the channels, in rising order.
fn block_errors(blocks: &RgbImage, reference: &RgbImage) -> Vec<f64> {
    let relative = |ours: f32, theirs: f32| match f64::from(ours) - f64::from(theirs) {
        0.0 => 0.0,
        difference => difference.abs() / f64::from(theirs),
    };
    let error = |(ours, theirs): (&[f32; 3], &[f32; 3])| {
        let channel = |c: usize| relative(ours[c], theirs[c]);
        (0..3).map(channel).fold(0.0, f64::max)
    };
    let mut errors: Vec<f64> = blocks.pixels.iter().zip(&reference.pixels).map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// Of blocks of 8×8 pixels, every other one may be off by more than 2 %, and every twentieth by more than 4 %, of its own
/// mean in the reference.
fn assert_blocks_meet_reference(name: &str, samples: &str) {
    let image = render(name, "blocks", &["--samples", samples]);
    let (blocks, reference) = (block_means(&beauty(&image), 8), stored(name, "blocks.exr"));
    let found = compare(&blocks, &reference, 0).expect("same size");
    let errors = block_errors(&blocks, &reference);
    let quantile = |share: f64| errors[(share * (errors.len() - 1) as f64).round() as usize];
    let (median, high) = (quantile(0.5), quantile(0.95));
    println!(
        "{name}: {} blocks off by {:.2} % at the median, {:.2} % at the 95th percentile, {:.1} % at most; means off by {:?}",
        errors.len(),
        100.0 * median,
        100.0 * high,
        100.0 * quantile(1.0),
        found.relative_difference,
    );
    assert!(median < 0.02 && high < 0.04, "{name}: {median}, {high}");
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn cornell_box_meets_the_blocks_of_its_reference() {
    assert_blocks_meet_reference("cornell_box", "128");
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn veach_mis_meets_the_blocks_of_its_reference() {
    assert_blocks_meet_reference("veach_mis", "64");
}

/// Side of the blocks in which the caustic is looked for, and by how much its region is grown.
const BLOCK: usize = 8;

/// Pixels of all blocks whose mean caustic is above a quarter of the largest, grown by one block to all sides.
fn caustic_region(caustic: &RgbImage) -> Vec<bool> {
    let (width, height) = (caustic.width as usize, caustic.height as usize);
    let (columns, rows) = (width / BLOCK, height / BLOCK);
    let mut blocks = vec![0.0_f64; columns * rows];
    for (i, pixel) in caustic.pixels.iter().enumerate() {
        let (x, y) = (i % width / BLOCK, i / width / BLOCK);
        blocks[y * columns + x] += pixel.iter().map(|v| f64::from(*v)).sum::<f64>();
    }
    let largest = blocks.iter().copied().fold(0.0, f64::max);
    let bright = |x: usize, y: usize| blocks[y * columns + x] > 0.25 * largest;
    (0..width * height)
        .map(|i| {
            let (x, y) = (i % width / BLOCK, i / width / BLOCK);
            let near = |c: usize, n: usize| c.saturating_sub(1)..(c + 2).min(n);
            near(y, rows).any(|y| near(x, columns).any(|x| bright(x, y)))
        })
        .collect()
}

/// The photon map's beauty against the reference over the caustic region: relative difference of the means, of every
/// channel, so that no colour makes up for another.
fn assert_photon_map_meets_reference(name: &str, region_samples: &str, tolerance: f64) {
    let traced = render(name, "region", &["--samples", region_samples]);
    let region = caustic_region(&traced.rgb("caustic").expect("a caustic layer"));
    let image = render(
        name,
        "photons",
        &["--samples", "256", "--set", "/Render.LightTransport.caustic=PhotonMap"],
    );
    let mean = |image: &RgbImage, channel: usize| {
        let inside = image.pixels.iter().zip(&region).filter(|(_, inside)| **inside);
        inside.map(|(pixel, _)| f64::from(pixel[channel])).sum::<f64>()
    };
    let (ours, theirs) = (beauty(&image), reference(name));
    let differences = [0, 1, 2].map(|channel| mean(&ours, channel) / mean(&theirs, channel) - 1.0);
    println!(
        "{name}: caustic region of {} pixels, off by {differences:?}",
        region.iter().filter(|r| **r).count()
    );
    assert!(
        region.iter().any(|inside| *inside) && differences.iter().all(|d| d.abs() < tolerance),
        "{name}: off by {differences:?}"
    );
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn photon_map_meets_the_reference_on_cornell_glass() {
    assert_photon_map_meets_reference("cornell_glass", "256", 0.02);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn photon_map_meets_the_reference_on_the_ring() {
    assert_photon_map_meets_reference("ring", "256", 0.03);
}

//! Comparisons with the images of an independent renderer, and of methods with each other.
//!
//! Those at full size take minutes, so the suite leaves them out; `.ci/full` runs them, in release mode.

#![expect(clippy::print_stdout, reason = "a full comparison reports its figures")]

mod blocks;
mod significance;

use blocks::Quantiles;
use film::{BATCHES, ExrImage, Image, Metadata, RgbImage, block_means, compare, difference, read_exr, write_exr};
use significance::{Measured, RUNS, SIDES, Verdict, test_blocks};
use std::path::{Path, PathBuf};
use std::process::Command;

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/references")
        .join(name)
}

/// Renders a reference scene and reads the image back.
fn render(name: &str, label: &str, arguments: &[&str]) -> ExrImage {
    render_file(&scene(name).join("scene.ron"), name, label, arguments)
}

/// The same of any scene file.
fn render_file(scene: &Path, name: &str, label: &str, arguments: &[&str]) -> ExrImage {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let output = folder.join(format!("{name}-{label}.exr"));
    let status = Command::new(env!("CARGO_BIN_EXE_pipeline"))
        .arg("run")
        .arg(scene)
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

/// Asserts what `passes` says; a failure leaves image, reference and difference (image − reference) side by side.
fn assert_alike(name: &str, passes: bool, image: &RgbImage, reference: &RgbImage, found: &str) {
    if passes {
        return;
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("failures");
    std::fs::create_dir_all(&folder).expect("a folder for images");
    let off = difference(image, reference).expect("same size");
    for (label, image) in [("image", image), ("reference", reference), ("difference", &off)] {
        let path = folder.join(format!("{name}-{label}.exr"));
        write_exr(&path, &Image::from_rgb(image), &Metadata::default()).expect("a writable folder");
    }
    panic!("{name}: {found}; see {}", folder.display());
}

/// The bias that means of whole images may have.
const MEANS: f64 = 0.005;

/// What relMSE may exceed that of a path tracer with independent samples by.
const EXCESS: f64 = 1.2;

/// What every other block, and every twentieth, may be off by, relative to its own mean in the reference.
const BLOCKS: [f64; 2] = [0.02, 0.05];

/// Compares means, blocks of 8×8 pixels and the relMSE with the reference's.
///
/// - `samples`: enough for the noise of a block to be below what it may be off by.
/// - `k`: a path tracer with independent samples has relMSE `k`/samples.
/// - `own`: relMSE of the reference.
fn assert_meets_reference(name: &str, samples: u32, k: f64, own: f64) {
    let image = beauty(&render(name, "traced", &["--samples", &samples.to_string()]));
    let reference = reference(name);
    let found = compare(&image, &reference, 0).expect("same size");
    let off = Quantiles::of(&block_means(&image, 8), &block_means(&reference, 8));
    let limit = EXCESS * k / f64::from(samples) + own;
    let found_text = format!(
        "means off by {:?}, relMSE {:.3e} of {limit:.3e}, {off}",
        found.relative_difference, found.rel_mse
    );
    println!("{name}: {found_text}");
    let means = found.relative_difference.iter().all(|d| d.abs() < MEANS);
    let passes = means && found.rel_mse <= limit && off.within(BLOCKS);
    assert_alike(name, passes, &image, &reference, &found_text);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn env_spheres_meets_the_reference() {
    assert_meets_reference("env_spheres", 256, 1.35, 0.000_26);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn dof_motion_meets_the_reference() {
    assert_meets_reference("dof_motion", 256, 0.3, 0.000_06);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn cornell_meets_the_reference() {
    assert_meets_reference("cornell", 256, 1.0, 0.000_07);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn cornell_glass_meets_the_reference() {
    assert_meets_reference("cornell_glass", 1024, 8.8, 0.000_13);
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

/// What every other block, and every twentieth, may be off by where indirect light is interpolated.
const CACHED_BLOCKS: [f64; 2] = [0.015, 0.04];

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn irradiance_cache_meets_the_reference_on_cornell() {
    let method = "/Render.LightTransport.indirect=IrradianceCache";
    let image = beauty(&render("cornell", "cached", &["--samples", "64", "--set", method]));
    let reference = reference("cornell");
    let found = compare(&image, &reference, 0).expect("same size");
    println!("cornell, cached: relMSE {:.3e}", found.rel_mse);
    assert_cached_blocks("cornell", &block_means(&image, 8), &block_means(&reference, 8));
}

fn assert_cached_blocks(name: &str, blocks: &RgbImage, reference: &RgbImage) {
    let found = compare(blocks, reference, 0).expect("same size");
    let off = Quantiles::of(blocks, reference);
    let found_text = format!("{off}; means off by {:?}", found.relative_difference);
    println!("{name}, cached: {found_text}");
    let means = found.relative_difference.iter().all(|d| d.abs() < MEANS);
    let passes = means && off.within(CACHED_BLOCKS);
    assert_alike(&format!("{name}-cached"), passes, blocks, reference, &found_text);
}

/// The room of the README, with its own settings, against path tracing.
#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn irradiance_cache_meets_the_reference_on_the_interior() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/interior.ron");
    let image = render_file(
        &path,
        "interior",
        "cached",
        &["--resolution", "320x200", "--samples", "64"],
    );
    let blocks = block_means(&beauty(&image), 8);
    assert_cached_blocks("interior", &blocks, &stored("interior", "blocks.exr"));
}

/// The same for blocks of the references of others.
const BLOCKS_OF_OTHERS: [f64; 2] = [0.02, 0.04];

fn assert_blocks_meet_reference(name: &str, samples: &str) {
    let image = render(name, "blocks", &["--samples", samples]);
    let (blocks, reference) = (block_means(&beauty(&image), 8), stored(name, "blocks.exr"));
    let found = compare(&blocks, &reference, 0).expect("same size");
    let off = Quantiles::of(&blocks, &reference);
    let found_text = format!("{off}; means off by {:?}", found.relative_difference);
    println!("{name}: {found_text}");
    assert_alike(name, off.within(BLOCKS_OF_OTHERS), &blocks, &reference, &found_text);
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

/// Every term by what is fast for it: lights sampled, caustics from their map, indirect light gathered over the maps.
const GATHERED: [&str; 6] = [
    "--set",
    "/Render.LightTransport.caustic=PhotonMap",
    "--set",
    "/Render.LightTransport.indirect=FinalGather",
    "--set",
    "/Render.FinalGather.rays=16",
];

/// Compares blocks of 8×8 pixels with the reference's where light is gathered over photon maps.
///
/// - `floor`: as in [`Quantiles::with_floor`].
fn assert_gathering_meets_reference(name: &str, options: &[&str], floor: f64) {
    let options = [&["--samples", "64"], &GATHERED[..], options].concat();
    let image = beauty(&render(name, "gathered", &options));
    let reference = reference(name);
    let found = compare(&image, &reference, 0).expect("same size");
    let off = Quantiles::with_floor(&block_means(&image, 8), &block_means(&reference, 8), floor);
    let found_text = format!(
        "gathered, {off}; means off by {:?}, relMSE {:.3e}, trimmed {:.3e}",
        found.relative_difference, found.rel_mse, found.rel_mse_trimmed
    );
    println!("{name}: {found_text}");
    assert_alike(name, off.within(BLOCKS), &image, &reference, &found_text);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn gathering_meets_the_reference_on_cornell() {
    assert_gathering_meets_reference("cornell", &[], 0.0);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn gathering_meets_the_reference_on_cornell_glass() {
    assert_gathering_meets_reference("cornell_glass", &[], 0.0);
}

#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn gathering_meets_the_reference_on_the_ring() {
    // The caustic is all there is to see, and its cusps are fine; what lies in the shadow is black.
    let photons = ["--set", "/Render.CausticPhotonMap.photons=2000000"];
    assert_gathering_meets_reference("ring", &photons, 0.1);
}

/// Pixels in whose neighbourhood all normals are alike: no edge is near, where discs lose photons.
fn away_from_edges(image: &ExrImage, margin: usize) -> Vec<bool> {
    let normals = ["normal.X", "normal.Y", "normal.Z"].map(|name| image.channel(name).expect("normals"));
    let (width, height) = (image.width as usize, image.height as usize);
    let near = |c: usize, n: usize| c.saturating_sub(margin)..(c + margin + 1).min(n);
    let is_even = |i: usize| {
        let (x, y) = (i % width, i / width);
        let inside = x >= margin && y >= margin && x + margin < width && y + margin < height;
        let alike = |x: usize, y: usize| normals.iter().all(|axis| (axis[i] - axis[y * width + x]).abs() < 0.05);
        inside && near(y, height).all(|y| near(x, width).all(|x| alike(x, y)))
    };
    (0..width * height).map(is_even).collect()
}

/// The mean square error of progressive photon maps falls as passes^(−2/3), which α = 2/3 is chosen for
/// (Knaus and Zwicker 2011). At edges discs lose photons, and there it falls more slowly, so these are left out.
#[test]
#[ignore = "takes minutes; .ci/full runs it"]
fn progressive_maps_converge_as_the_theory_says() {
    /// Wider than the discs of the first pass, which are 0.088 m or 11 pixels wide in the middle of the room.
    const MARGIN: usize = 14;
    let reference = reference("cornell");
    let fields: Vec<String> = ["Direct", "Indirect"]
        .iter()
        .flat_map(|kind| {
            [
                format!("/Render.LightTransport.{}=PhotonMap", kind.to_lowercase()),
                format!("/Render.{kind}PhotonMap.progressive=true"),
                format!("/Render.{kind}PhotonMap.photons=50000"),
            ]
        })
        .collect();
    let options: Vec<&str> = fields.iter().flat_map(|field| ["--set", field.as_str()]).collect();
    let errors = [4, 16, 64, 256].map(|passes: u32| {
        let passes_text = passes.to_string();
        let rendered = render(
            "cornell",
            "progressive",
            &[&["--samples", &passes_text], &options[..]].concat(),
        );
        let image = beauty(&rendered);
        let chosen = away_from_edges(&rendered, MARGIN);
        let of_pixel = |(ours, theirs): (&[f32; 3], &[f32; 3])| {
            let square = |c: usize| f64::from((ours[c] - theirs[c]) / theirs[c]).powi(2);
            (square(0) + square(1) + square(2)) / 3.0
        };
        let pairs = image.pixels.iter().zip(&reference.pixels).zip(&chosen);
        let errors: Vec<f64> = pairs
            .filter(|(_, chosen)| **chosen)
            .map(|(pair, _)| of_pixel(pair))
            .collect();
        let all = compare(&image, &reference, 0).expect("same size").rel_mse;
        let error = errors.iter().sum::<f64>() / errors.len() as f64;
        println!("{passes} passes: relative mean square error {error:.3e} away from edges, relMSE {all:.3e} in all");
        error
    });
    // 16 times as many passes: the error has to be 16^(−2/3) = 0.157 of what it was, the exponent within 0.1. Before, it falls
    // faster: the noise of what passes share nothing of goes with 1/passes.
    let left = errors[3] / errors[1];
    println!("{left:.3} of the error is left after 16 times as many passes");
    assert!(left > 0.119 && left < 0.208, "{errors:?}: {left} is left");
}

/// Renders a small scene and tests its values against those of the reference, block by block.
fn significance_of(name: &str, label: &str, samples: u32, arguments: &[&str]) -> (Vec<Verdict>, ExrImage) {
    let image = render(name, label, &[&["--samples", &samples.to_string()], arguments].concat());
    let ours = Measured::new(&image, f64::from(BATCHES));
    let theirs = Measured::new(
        &read_exr(&scene(name).join("reference.exr")).expect("a valid image"),
        RUNS,
    );
    let verdicts = SIDES.map(|side| test_blocks(&ours, &theirs, side)).into();
    (verdicts, image)
}

/// Asserts that a small scene differs from its reference by noise alone, and that the noise is no more than allowed.
///
/// - `samples`: enough for the batches of a pixel to be about normal.
/// - `k`: a path tracer with independent samples has relMSE `k`/samples.
fn assert_differs_by_noise(name: &str, samples: u32, k: f64) {
    let (verdicts, image) = significance_of(name, "noise", samples, &[]);
    let (image, stored) = (
        beauty(&image),
        read_exr(&scene(name).join("reference.exr")).expect("a valid image"),
    );
    let reference = beauty(&stored);
    let found = compare(&image, &reference, 0).expect("same size");
    let limit = EXCESS * k / f64::from(samples) + Measured::new(&stored, RUNS).own_rel_mse();
    let verdicts_text = verdicts.iter().map(Verdict::to_string).collect::<Vec<_>>().join("; ");
    let found_text = format!(
        "means off by {:?}, relMSE {:.3e} of {limit:.3e}, {verdicts_text}",
        found.relative_difference, found.rel_mse
    );
    println!("{name}: {found_text}");
    let passes = found.rel_mse <= limit && verdicts.iter().all(Verdict::passes);
    assert_alike(name, passes, &image, &reference, &found_text);
}

#[test]
fn small_interior_differs_from_its_reference_by_noise() {
    assert_differs_by_noise("small_interior", 256, 0.42);
}

#[test]
fn small_materials_differ_from_their_reference_by_noise() {
    assert_differs_by_noise("small_materials", 256, 0.31);
}

#[test]
fn small_lens_differs_from_its_reference_by_noise() {
    // Edges that move out of focus are met by few samples.
    assert_differs_by_noise("small_lens", 1024, 0.19);
}

/// What the tests above are worth: three hundredths more albedo of one thing must not pass for noise.
#[test]
fn an_albedo_wrong_by_three_percent_is_more_than_noise() {
    let (verdicts, _) = significance_of(
        "small_lens",
        "wrong",
        256,
        &["--set", "/Scene/floor.Diffuse.albedo=(0.515, 0.4635, 0.412)"],
    );
    println!("{verdicts:#?}");
    assert!(!verdicts.iter().all(Verdict::passes), "{verdicts:#?}");
}

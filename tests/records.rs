//! Irradiance records that are drawn, written down, and taken up again.

#![expect(clippy::print_stdout, reason = "comparisons report their figures")]

mod cloud;
mod program;

use cloud::read_cloud;
use film::{ExrImage, RgbImage, block_means};
use program::{attempt, file, project, render, run};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

const CACHE: &str = "/Render.LightTransport.indirect=IrradianceCache";
const RAYS: &str = "/Render.IrradianceCache.rays=64";
const TRACE: &str = "/Render.LightTransport.caustic=Trace";
const FIELDS: [&str; 3] = [CACHE, RAYS, TRACE];
const SIZE: [&str; 2] = ["--resolution", "40x40"];

fn scene(name: &str) -> PathBuf {
    project(&format!("tests/references/{name}/scene.ron"))
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder for files")
}

fn bytes(path: &str) -> Vec<u8> {
    std::fs::read(path).expect("a file that was written")
}

/// Writes the records of a scene to a file of that name.
fn keep(folder: &TempDir, name: &str, scene: &Path, options: &[&str], fields: &[&str]) -> String {
    let kept = file(folder, name);
    run("records", scene, &[&SIZE, options, &["-o", &kept]].concat(), fields);
    kept
}

/// What the program says of a scene.
fn tell(command: &str, scene: &Path, options: &[&str], fields: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_pipeline"));
    program.arg(command).arg(scene).args(options);
    program.args(fields.iter().flat_map(|field| ["--set", field]));
    program.output().expect("the program starts")
}

/// Counts of records that a profile tells: reused, made.
fn counted(scene: &Path, options: &[&str], fields: &[&str]) -> [u64; 2] {
    let ran = tell("profile", scene, options, fields);
    let said = String::from_utf8_lossy(&ran.stdout);
    let count = |name: &str| {
        let line = said.lines().find_map(|line| line.strip_prefix(name));
        line.map_or(0, |rest| rest.trim().parse().expect("a number"))
    };
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    [count("irradiance_cache/reused "), count("irradiance_cache/records ")]
}

#[test]
fn reloaded_records_change_no_bit() {
    let glass = scene("cornell_glass");
    let photons = [
        "/Render.DirectPhotonMap.photons=3000",
        "/Render.IndirectPhotonMap.photons=3000",
        "/Render.IrradianceCache.incoming=PhotonGather",
    ];
    let caustics = [
        "/Render.CausticPhotonMap.photons=3000",
        "/Render.LightTransport.caustic=PhotonMap",
    ];
    for (label, more) in [
        ("traced", &[TRACE] as &[&str]),
        ("plain", &[TRACE, "/Render.IrradianceCache.gradients=false"]),
        ("caustics from a map", &caustics),
        ("photons", &[&photons[..], &caustics].concat()),
    ] {
        let folder = folder();
        let fields = [&[CACHE, RAYS], more].concat();
        let picture = |options: &[&str]| {
            let output = file(&folder, "image.exr");
            let samples = ["--samples", "4", "-o", &output];
            run("run", &glass, &[&SIZE, options, &samples].concat(), &fields);
            bytes(&output)
        };
        let first = picture(&["--threads", "2"]);
        let kept = keep(&folder, "one.records", &glass, &["--threads", "1"], &fields);
        assert!(
            bytes(&kept) == bytes(&keep(&folder, "three.records", &glass, &["--threads", "3"], &fields)),
            "{label}: other records on other threads"
        );
        for threads in ["1", "3"] {
            let again = picture(&["--threads", threads, "--records", &kept]);
            assert!(again == first, "{label}: on {threads} threads with records from a file");
        }
        let options = [&SIZE[..], &["--samples", "1", "--records", &kept]].concat();
        let [reused, made] = counted(&glass, &options, &fields);
        println!("{label}: {reused} records");
        assert!(reused > 300 && made == 0, "{label}: {reused} {made}");
    }
}

/// Means of blocks of 8×8 pixels of the indirect light, and its mean.
fn indirect(image: &ExrImage) -> (RgbImage, f64) {
    let light = image.rgb("indirect").expect("the layer");
    let sum: f64 = light.pixels.iter().map(|pixel| f64::from(pixel[1])).sum();
    let mean = sum / light.pixels.len() as f64;
    (block_means(&light, 8), mean)
}

#[test]
fn a_camera_that_moves_takes_records_along() {
    /// What a mean may be off by between records of two views: the noise of a few hundred records of 256 rays.
    const MEAN: f64 = 0.02;
    /// The same of half of the blocks.
    const BLOCK: f64 = 0.04;
    let cornell = scene("cornell");
    let folder = folder();
    let fields = [CACHE, "/Render.IrradianceCache.rays=256", TRACE];
    let kept = keep(&folder, "here.records", &cornell, &[], &fields);
    let moved = [&fields[..], &["/Scene/Camera.Transform.translate=(0.3, 1.2, 3.6)"]].concat();
    let samples = ["--samples", "16"];
    let options = [&SIZE[..], &samples].concat();
    let reusing = [&options[..], &["--records", &kept]].concat();
    let [reused, added] = counted(&cornell, &reusing, &moved);
    let [none, anew] = counted(&cornell, &options, &moved);
    println!("{reused} records reused and {added} added, {anew} from nothing");
    assert!(none == 0 && reused > 0 && added > 0, "{none} {reused} {added}");
    assert!(added * 2 < anew, "{added} of {anew}");
    let (blocks, mean) = indirect(&render(&cornell, &reusing, &moved));
    let (blocks_anew, mean_anew) = indirect(&render(&cornell, &options, &moved));
    let pairs = blocks.pixels.iter().zip(&blocks_anew.pixels);
    let mut off: Vec<f64> = pairs.map(|(a, b)| f64::from((a[1] / b[1] - 1.0).abs())).collect();
    off.sort_by(f64::total_cmp);
    let (median, mean_off) = (off[off.len() / 2], mean / mean_anew - 1.0);
    println!("mean off by {mean_off:.4}, blocks by {median:.4} at the median");
    assert!(mean_off.abs() < MEAN && median < BLOCK, "{mean_off} {median}");
    // Kept again, they are whole for the new view; and what decides no light may differ.
    let there = keep(&folder, "there.records", &cornell, &["--records", &kept], &moved);
    let exposed = [&moved[..], &["/Render.Film.exposure=1"]].concat();
    let [reused_there, added_there] = counted(&cornell, &[&options[..], &["--records", &there]].concat(), &exposed);
    assert_eq!([reused_there, added_there], [reused + added, 0]);
    let output = file(&folder, "image.exr");
    let ran = tell("run", &cornell, &[&reusing[..], &["-o", &output]].concat(), &moved);
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(
        said.contains(&format!("{reused} records reused, {added} added")),
        "{said}"
    );
}

#[test]
fn records_that_do_not_belong_here_are_refused() {
    let cornell = scene("cornell");
    let folder = folder();
    let kept = keep(&folder, "one.records", &cornell, &[], &FIELDS);
    let image = file(&folder, "image.exr");
    let refused = |options: &[&str], fields: &[&str], code: &str, expected: &str| {
        std::fs::write(&image, "what was there").expect("a writable folder");
        let options = [
            &SIZE[..],
            &["--samples", "1", "--records", &kept, "-o", &image],
            options,
        ]
        .concat();
        let ran = attempt("run", &cornell, &options, fields);
        let said = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(2), "{said}");
        assert!(said.contains(code) && said.contains(expected), "{said}");
        assert_eq!(bytes(&image), b"what was there");
    };
    refused(&["--seed", "8"], &FIELDS, "bad-records", "another scene, light or seed");
    for field in [
        "/Render.IrradianceCache.rays=65",
        "/Render.LightTransport.specular_alpha=0.06",
        "/Render.Render.max_depth=5",
    ] {
        let fields = [&FIELDS[..], &[field]].concat();
        refused(&[], &fields, "bad-records", "another scene, light or seed");
    }
    let none = "add `--set /Render.LightTransport.indirect=IrradianceCache`";
    refused(&[], &[TRACE], "no-records", none);
    let progressive = [
        CACHE,
        "/Render.IrradianceCache.incoming=PhotonGather",
        "/Render.IndirectPhotonMap.progressive=true",
    ];
    refused(&[], &progressive, "bad-records", "new in every pass");
    let good = bytes(&kept);
    let spoiled = |bytes: &[u8], expected: &str| {
        std::fs::write(&kept, bytes).expect("a writable folder");
        refused(&[], &FIELDS, "bad-records", expected);
    };
    spoiled(&good[..good.len() / 2], "cut off");
    spoiled(b"ply\nformat", "no record file");
    let changed = |place: usize, to: &[u8]| {
        let mut bytes = good.clone();
        bytes[place..place + to.len()].copy_from_slice(to);
        bytes
    };
    let count = 8 + 4 + 2 * 32 + 8 + 24;
    let first = count + 8;
    spoiled(&changed(good.len() - 20, &[1, 2, 3]), "damaged");
    spoiled(&changed(8, &[99]), "format 99");
    spoiled(&changed(count, &u64::MAX.to_le_bytes()), "damaged");
    spoiled(
        &changed(first, &f32::NAN.to_le_bytes()),
        "position of record 0 must be finite",
    );
    // Finite, but nowhere: the checksum may be right.
    let mut outside = changed(first, &1e30_f32.to_le_bytes());
    let end = outside.len() - 8;
    let mut checksum = 0xcbf2_9ce4_8422_2325_u64;
    for byte in &outside[..end] {
        checksum = (checksum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    }
    outside[end..].copy_from_slice(&checksum.to_le_bytes());
    spoiled(&outside, "outside of the scene");
    std::fs::remove_file(&kept).expect("a file");
    refused(&[], &FIELDS, "bad-records", "cannot be read");
}

#[test]
fn a_render_is_resumed_with_the_records_that_it_began_with() {
    let cornell = scene("cornell");
    let folder = folder();
    let kept = keep(&folder, "here.records", &cornell, &[], &FIELDS);
    let moved = [&FIELDS[..], &["/Scene/Camera.Transform.translate=(0.3, 1.2, 3.6)"]].concat();
    let picture = |name: &str, options: &[&str], fields: &[&str]| {
        let output = file(&folder, name);
        let options = [&SIZE[..], &["--samples", "200", "-o", &output], options].concat();
        (attempt("run", &cornell, &options, fields), output)
    };
    let succeed = |name: &str, options: &[&str], fields: &[&str]| {
        let (ran, output) = picture(name, options, fields);
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        bytes(&output)
    };
    let stopped = ["--records", &kept, "--time-limit", "1ms"];
    // Records for another view decide bits: with them a render goes on, without them it does not.
    let with_records = succeed("whole.exr", &["--records", &kept], &moved);
    let _ = succeed("part.exr", &stopped, &moved);
    let (refused, _) = picture("part.exr", &["--resume"], &moved);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(
        refused.status.code() == Some(2) && said.contains("bad-checkpoint"),
        "{said}"
    );
    // Kept again, with those that were added, they are whole and still the same.
    let there = keep(&folder, "there.records", &cornell, &["--records", &kept], &moved);
    assert!(succeed("part.exr", &["--resume", "--records", &there], &moved) == with_records);
    // Those for this view only save time.
    let _ = succeed("part.exr", &stopped, &FIELDS);
    assert!(succeed("part.exr", &["--resume"], &FIELDS) == succeed("whole.exr", &[], &FIELDS));
}

#[test]
fn records_that_change_are_not_kept() {
    let folder = folder();
    let kept = file(&folder, "one.records");
    let fields = [
        CACHE,
        "/Render.IrradianceCache.incoming=PhotonGather",
        "/Render.IndirectPhotonMap.progressive=true",
    ];
    let options = [&SIZE[..], &["-o", &kept]].concat();
    let ran = attempt("records", &scene("cornell"), &options, &fields);
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(
        ran.status.code() == Some(2) && said.contains("new in every pass") && said.contains("progressive: false"),
        "{said}"
    );
    assert!(!Path::new(&kept).exists());
    // They can be looked at.
    let cloud = file(&folder, "records.ply");
    run(
        "records",
        &scene("cornell"),
        &[&SIZE[..], &["-o", &cloud]].concat(),
        &fields,
    );
}

#[test]
fn records_are_drawn_and_written_down() {
    let folder = folder();
    let (picture, cloud) = (file(&folder, "records.png"), file(&folder, "records.ply"));
    for colour in ["irradiance", "range", "number"] {
        let options = ["--colour", colour, "-o", &picture, "-o", &cloud];
        run("records", &scene("cornell"), &[&SIZE[..], &options].concat(), &FIELDS);
        let drawn = image::open(&picture).expect("a picture").to_rgb8();
        assert_eq!(drawn.dimensions(), (40, 40));
        // Surfaces are grey and dim.
        let dots = drawn.pixels().filter(|pixel| pixel.0.iter().max() > Some(&60)).count();
        println!("{colour}: {dots} pixels with records");
        assert!(dots > 100 && dots < 1500, "{colour}: {dots}");
        let (header, count, body) = read_cloud(&cloud);
        for property in ["double x", "float nx", "uchar red", "float irradiance_r", "float range"] {
            assert!(header.contains(&format!("property {property}\n")), "{header}");
        }
        // Three doubles, seven floats, three bytes, a number.
        assert_eq!(body.len(), count * (3 * 8 + 7 * 4 + 3 + 4), "{header}");
        assert!(count > 300, "{count}");
    }
}

#[test]
fn the_film_shows_how_densely_records_lie() {
    /// Pixels of a side of the film.
    const PIXELS: usize = 96;
    /// Half of what the film sees of the back wall, 4.9 m from the camera, metres: 4.9 tan(39°/2).
    const HALF: f64 = 1.7352;
    let size = format!("{PIXELS}x{PIXELS}");
    let folder = folder();
    let options = ["--resolution", &size, "--samples", "16"];
    let fields = [CACHE, RAYS, TRACE, "/Render.IrradianceCache.min_weight=30"];
    let image = render(&scene("cornell"), &options, &fields);
    let density = image
        .channel("record_density")
        .expect("a layer of an image with records");
    assert!(density.iter().all(|d| d.is_finite() && *d >= 0.0));
    let cloud = file(&folder, "records.ply");
    run(
        "records",
        &scene("cornell"),
        &[&options[..2], &["-o", &cloud]].concat(),
        &fields,
    );
    let (_, count, body) = read_cloud(&cloud);
    // Places on the back wall, away from corners and above the boxes.
    let is_on_wall = |x: f64, y: f64| x.abs() < 0.8 && (1.25..1.85).contains(&y);
    let points = body.chunks_exact(body.len() / count).filter(|point| {
        let [x, y, z] = [0, 8, 16].map(|at| f64::from_le_bytes(point[at..at + 8].try_into().expect("eight bytes")));
        (z + 1.0).abs() < 1e-3 && is_on_wall(x, y)
    });
    let written = points.count() as f64;
    let step = 2.0 * HALF / PIXELS as f64;
    let seen = (0..PIXELS * PIXELS).filter(|pixel| {
        let [x, y] = [pixel % PIXELS, pixel / PIXELS].map(|i| (i as f64 + 0.5) * step - HALF);
        is_on_wall(x, 1.0 - y)
    });
    let shown = seen.map(|pixel| f64::from(density[pixel])).sum::<f64>() * step * step;
    println!("{written} records on the wall, {shown:.1} by the film");
    assert!(
        written > 50.0 && (shown / written - 1.0).abs() < 0.1,
        "{written} {shown}"
    );
    let without = render(&scene("cornell"), &options, &[TRACE]);
    assert!(without.channel("record_density").is_none());
}

//! The irradiance cache in whole pictures: closed furnaces, threads, walls, agreement with path tracing.

#![expect(clippy::print_stdout, reason = "comparisons report their figures")]

mod cloud;
mod program;

use cloud::read_cloud;
use film::{ExrImage, RgbImage, block_means};
use program::{attempt, file, project, render, run};
use std::path::PathBuf;

const CACHE: &str = "/Render.LightTransport.indirect=IrradianceCache";
const RAYS: &str = "/Render.IrradianceCache.rays=256";
const PHOTONS: &str = "/Render.IrradianceCache.incoming=PhotonGather";

fn scene(name: &str) -> PathBuf {
    project(&format!("tests/references/{name}/scene.ron"))
}

fn layer(image: &ExrImage, name: &str) -> RgbImage {
    image.rgb(name).expect("the layer")
}

fn mean(image: &RgbImage, channel: usize) -> f64 {
    let sum: f64 = image.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum();
    sum / image.pixels.len() as f64
}

/// What the mean of a furnace may be off by: noise of a few hundred records.
const FURNACE: f64 = 0.005;

#[test]
fn furnaces_shine_alike_and_records_hold_indirect_light_alone() {
    // Radiance 1 everywhere: 1 − ρ emitted, ρ (1 − ρ) reflected once, and ρ² reflected more often, which is indirect.
    for (name, albedo) in [("furnace", 0.5_f64), ("furnace80", 0.8)] {
        for incoming in ["PathTrace", "PhotonGather"] {
            let incoming_field = format!("/Render.IrradianceCache.incoming={incoming}");
            let fields = [
                CACHE,
                RAYS,
                &incoming_field,
                // Discs that hang over an edge lose photons; with these many they are small.
                "/Render.DirectPhotonMap.photons=400000",
                "/Render.IndirectPhotonMap.photons=400000",
            ];
            let fields = if incoming == "PathTrace" { &fields[..3] } else { &fields };
            let image = render(&scene(name), &["--resolution", "64x64", "--samples", "4"], fields);
            let (beauty, indirect) = (mean(&layer(&image, ""), 1), mean(&layer(&image, "indirect"), 1));
            println!(
                "{name}, {incoming}: {beauty:.4}, indirect {indirect:.4} of {:.4}",
                albedo * albedo
            );
            // Photon maps have a bias of their own at edges.
            let allowed = if incoming == "PathTrace" {
                FURNACE
            } else {
                2.0 * FURNACE
            };
            assert!((beauty - 1.0).abs() < allowed, "{name}: {beauty}");
            assert!(
                (indirect / (albedo * albedo) - 1.0).abs() < 2.0 * allowed,
                "{name}: {indirect}"
            );
        }
    }
}

#[test]
fn threads_and_tiles_change_no_bit() {
    let glass = scene("cornell_glass");
    let few = [
        "/Render.DirectPhotonMap.photons=3000",
        "/Render.CausticPhotonMap.photons=3000",
        "/Render.IndirectPhotonMap.photons=3000",
    ];
    let progressive = [
        PHOTONS,
        "/Render.CausticPhotonMap.progressive=true",
        "/Render.IndirectPhotonMap.progressive=true",
    ];
    for (label, more) in [
        ("traced", &[] as &[&str]),
        ("plain", &["/Render.IrradianceCache.gradients=false"]),
        ("progressive photons", &progressive),
    ] {
        let folder = tempfile::tempdir().expect("a folder for images");
        let photons = if label == "traced" || label == "plain" {
            &few[1..2]
        } else {
            &few
        };
        let fields = [
            &[
                CACHE,
                "/Render.IrradianceCache.rays=64",
                "/Render.LightTransport.caustic=PhotonMap",
            ],
            photons,
            more,
        ]
        .concat();
        let picture = |name: &str, options: &[&str]| {
            let output = file(&folder, name);
            let size: &[&str] = &["--resolution", "40x40", "--samples", "4"];
            run("run", &glass, &[size, options, &["-o", &output]].concat(), &fields);
            std::fs::read(output).expect("a file that was written")
        };
        let first = picture("first.exr", &["--threads", "1"]);
        for threads in ["2", "3"] {
            let other = picture("other.exr", &["--threads", threads, "--tile-size", "7"]);
            assert!(other == first, "{label} on {threads} threads");
        }
    }
}

/// A floor cut in two by a wall of no thickness, seen from above, and a lamp lower than the wall on the left of it. Nothing that
/// shines or is lit can be seen from the floor on the right.
const WALL: &str = r#"#![enable(implicit_some)]
Layer(prims: {
    "/Camera": Def(Camera: (fov: 36), Transform: (translate: (0, 3, 0)), LookAt: (target: (0, 0, 0), up: (0, 0, -1))),
    "/Floor": Def(Quad: (size: (2, 2)), Transform: (rotate: (-90, 0, 0)), Diffuse: (albedo: (0.8, 0.8, 0.8))),
    "/Wall": Def(
        Quad: (size: (20, 1)), Transform: (rotate: (0, 90, 0)), Diffuse: (albedo: (0.8, 0.8, 0.8)),
    ),
    "/Lamp": Def(Sphere: (radius: 0.05), Transform: (translate: (-0.4, 0.2, 0)), Emission: (power: (4, 4, 4))),
    "/Render": Def(
        Render: (camera: "/Camera", samples: 4),
        Film: (resolution: (64, 64), filter: Box, filter_radius: 0.5),
        LightTransport: (caustic: Trace, indirect: IrradianceCache),
        IrradianceCache: (rays: 64),
    ),
})
"#;

#[test]
fn no_light_leaks_through_a_wall() {
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let path = folder.path().join("wall.ron");
    std::fs::write(&path, WALL).expect("a writable folder");
    // With wide least ranges, records by the wall would reach through it if nothing stopped them.
    for spacing in ["1.5", "6"] {
        let field = format!("/Render.IrradianceCache.min_spacing={spacing}");
        let indirect = layer(&render(&path, &[], &[&field]), "indirect");
        let column = |x: usize| indirect.pixels.iter().skip(x).step_by(64).map(|pixel| pixel[1]);
        // Light of the wall falls on the floor before it.
        let before = column(30).fold(0.0, f32::max);
        let behind = (33..64).flat_map(column).fold(0.0, f32::max);
        println!("least spacing {spacing}: {before} before the wall, {behind} behind it");
        assert!(before > 0.01 && behind == 0.0, "{before} {behind}");
    }
}

/// Bias is planted by using records wherever they are near, behind the wall too. An audit has to find it, and nothing where records
/// are used as they should be, as often as its confidence says.
#[test]
fn audits_find_records_that_are_used_through_a_wall() {
    /// Trials with the test of validity and without.
    const TRIALS: [u32; 2] = [12, 4];
    /// Of those without bias, at 99 % confidence; two have a chance of 0.6 %.
    const MOST_ALARMS: usize = 1;
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let path = folder.path().join("wall.ron");
    std::fs::write(&path, WALL).expect("a writable folder");
    let alarms = |validity: bool, trials: u32| -> usize {
        // The noise of few rays stays in the records, so that it is a bias of the picture.
        let fields = [
            "/Render.IrradianceCache.rays=512",
            &format!("/Render.IrradianceCache.validity={validity}"),
        ];
        let is_alarm = |trial: &u32| {
            let trial = trial.to_string();
            let options = [
                "--traced-samples",
                "64",
                "--budget",
                "1h",
                "--trial",
                &trial,
                "--seed",
                &trial,
            ];
            let ran = attempt("audit", &path, &options, &fields);
            let told = String::from_utf8_lossy(&ran.stdout);
            let is_found = ran.status.code() == Some(1);
            assert!(is_found || ran.status.success(), "{told}{}", ran.status);
            assert_eq!(told.contains("no bias of more than 1 % found"), !is_found, "{told}");
            // Behind the wall nothing but black is traced.
            let lists_leaks = told
                .lines()
                .any(|line| line.contains("over black") && line.ends_with("indirect G"));
            assert_eq!(lists_leaks, !validity, "{told}");
            is_found
        };
        (0..trials).filter(is_alarm).count()
    };
    let (false_alarms, found) = (alarms(true, TRIALS[0]), alarms(false, TRIALS[1]));
    println!("{false_alarms} false alarms and {found} leaks found in {TRIALS:?} trials");
    assert!(false_alarms <= MOST_ALARMS, "{false_alarms} false alarms");
    assert_eq!(found, TRIALS[1] as usize);
}

/// Gradients against the plain form, at as many records: both find ranges by the harmonic mean.
#[test]
fn gradients_lower_the_error_of_as_many_records() {
    /// What the numbers of records may differ by: each form decides by itself how far a record holds.
    const SAME: f64 = 0.03;
    let size = ["--resolution", "48x48"];
    let dark = "/Render.LightTransport.direct=Off";
    let traced = render(
        &scene("cornell"),
        &[&size[..], &["--samples", "1024"]].concat(),
        &[dark],
    );
    let traced = layer(&traced, "indirect");
    let measure = |gradients: bool| {
        let form = format!("/Render.IrradianceCache.gradients={gradients}");
        let fields = [
            dark,
            CACHE,
            RAYS,
            "/Render.IrradianceCache.min_weight=5",
            "/Render.IrradianceCache.metric=HarmonicMean",
            &form,
        ];
        let image = render(&scene("cornell"), &[&size[..], &["--samples", "64"]].concat(), &fields);
        let error = film::compare(&layer(&image, "indirect"), &traced, 0).expect("same size");
        (records_of(&size, &fields), error.rel_mse)
    };
    let [(records, smooth), (plain_records, plain)] = [true, false].map(measure);
    println!("relMSE {smooth:.5} of {records} records with gradients, {plain:.5} of {plain_records} without");
    assert!(
        (records / plain_records - 1.0).abs() < SAME,
        "{records} {plain_records}"
    );
    assert!(smooth < plain, "{smooth} {plain}");
}

/// How many records the eye reads.
fn records_of(options: &[&str], fields: &[&str]) -> f64 {
    let folder = tempfile::tempdir().expect("a folder for the cloud");
    let cloud = file(&folder, "records.ply");
    run(
        "records",
        &scene("cornell"),
        &[options, &["-o", &cloud]].concat(),
        fields,
    );
    read_cloud(cloud).1 as f64
}

/// What blocks of 8×8 pixels may be off by against path tracing: noise of both at these few samples.
const BLOCK: f64 = 0.04;

#[test]
fn the_cache_agrees_with_path_tracing_on_every_kind_of_surface() {
    for name in ["cornell", "small_materials", "cornell_glass"] {
        let options = ["--resolution", "48x48", "--samples", "64"];
        let fields = ["/Render.LightTransport.caustic=Trace"];
        let cached = render(&scene(name), &options, &[&fields[..], &[CACHE, RAYS]].concat());
        let traced = render(&scene(name), &["--resolution", "48x48", "--samples", "1024"], &fields);
        for part in ["indirect", "specular"] {
            let (cached, traced) = (layer(&cached, part), layer(&traced, part));
            if mean(&traced, 1) == 0.0 {
                continue;
            }
            let mean_off = mean(&cached, 1) / mean(&traced, 1) - 1.0;
            let (cached, traced) = (block_means(&cached, 8), block_means(&traced, 8));
            let floor = 0.2 * mean(&traced, 1);
            let off = |(a, b): (&[f32; 3], &[f32; 3])| f64::from((a[1] - b[1]).abs()) / (f64::from(b[1]) + floor);
            let mut blocks: Vec<f64> = cached.pixels.iter().zip(&traced.pixels).map(off).collect();
            blocks.sort_by(f64::total_cmp);
            let median = blocks[blocks.len() / 2];
            println!("{name}, {part}: mean off by {mean_off:.4}, blocks by {median:.4} at the median");
            assert!(
                mean_off.abs() < BLOCK && median < BLOCK,
                "{name}, {part}: {mean_off} {median}"
            );
        }
    }
}

#[test]
fn settings_without_effect_are_told_and_bad_ones_refused() {
    let folder = tempfile::tempdir().expect("a folder for images");
    let output = file(&folder, "image.exr");
    let options = ["--resolution", "8x8", "--samples", "1", "-o", &output];
    let ran = |fields: &[&str]| {
        let ran = attempt("run", &scene("furnace"), &options, fields);
        (ran.status.code(), String::from_utf8_lossy(&ran.stderr).into_owned())
    };
    let (code, said) = ran(&[RAYS]);
    assert!(
        code == Some(0) && said.contains("`IrradianceCache` has no effect"),
        "{said}"
    );
    let (code, said) = ran(&[
        CACHE,
        "/Render.IrradianceCache.max_spacing=1",
        "/Render.IrradianceCache.min_spacing=2",
    ]);
    assert!(
        code == Some(2) && said.contains("`max_spacing` must be at least"),
        "{said}"
    );
    let (code, said) = ran(&[CACHE, "/Render.IrradianceCache.rays=3"]);
    assert!(code == Some(2) && said.contains("rays"), "{said}");
}

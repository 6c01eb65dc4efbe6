//! The irradiance cache: reading it, adding to it, what it takes, and what pictures cost with it.
//!
//! `irradiance_cache/read` interpolates at random places, `irradiance_cache/insert` adds records in rounds, with ranges that
//! neighbours lower, beside an octree alone. Then the program renders the Cornell box: how many records `min_weight` makes, and
//! what a look-up takes after few and many rays a record. `cargo bench --bench irradiance_cache`.

#![expect(clippy::print_stdout, reason = "counts and memory are part of the result")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use radiometry::{Rgb, SampleStream, StageKey};
use spatial::{Bounds, RecordOctree};
use std::hint::black_box;
use std::path::PathBuf;
use std::process::Command;
use transport::{CacheSettings, ErrorMetric, IrradianceCache, IrradianceRecord};

const SIZES: [usize; 2] = [10_000, 100_000];
/// Rounds in which records come, as in a render.
const ROUNDS: usize = 10;
const LOOKUPS: u32 = 10_000;

const SETTINGS: CacheSettings = CacheSettings {
    min_weight: 10.0,
    cell_records: 8,
    gradients: true,
    metric: ErrorMetric::HarmonicMean,
    validity: true,
};

const BOUNDS: Bounds = Bounds {
    min: Vec3::splat(-1.0),
    max: Vec3::splat(1.0),
};

fn draw(stage: &'static str, i: u32) -> Vec3 {
    let place = SampleStream::new(1, StageKey::new(stage), 0, i).draw_2d(0, 0);
    Vec3::new(2.0 * place.x - 1.0, 0.0, 2.0 * place.y - 1.0)
}

/// Records over a floor, each of which holds about as far as to the next.
fn records(count: usize) -> Vec<IrradianceRecord> {
    let distance = 2.0 / (count as f32).sqrt();
    let record = |i: u32| IrradianceRecord {
        position: draw("records", i),
        normal: Vec3::Y,
        irradiance: Rgb::splat(1.0),
        range: SETTINGS.min_weight * distance * (1.0 + 0.5 * draw("ranges", i).x),
        nearest: f32::INFINITY,
        ..IrradianceRecord::default()
    };
    (0..count as u32).map(record).collect()
}

/// Adds records in rounds.
fn filled(records: &[IrradianceRecord]) -> IrradianceCache {
    let mut cache = IrradianceCache::new(SETTINGS, &BOUNDS);
    for round in records.chunks(records.len().div_ceil(ROUNDS)) {
        cache.insert(round).expect("records in the room");
    }
    cache
}

fn read(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("irradiance_cache/read");
    group.sample_size(20).throughput(Throughput::Elements(LOOKUPS.into()));
    for count in SIZES {
        let mut cache = filled(&records(count));
        cache.rebuild(&BOUNDS).expect("records in the room");
        let places: Vec<Vec3> = (0..LOOKUPS).map(|i| draw("places", i)).collect();
        group.bench_function(BenchmarkId::from_parameter(count), |b| {
            b.iter(|| {
                let light = |place: &Vec3| {
                    cache
                        .interpolate(*place, Vec3::Y, |_| true)
                        .map(|found| found.irradiance)
                };
                black_box(places.iter().filter_map(light).sum::<Rgb>())
            });
        });
    }
    group.finish();
}

fn insert(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("irradiance_cache/insert");
    group.sample_size(10);
    for count in SIZES {
        group.throughput(Throughput::Elements(count as u64));
        let source = records(count);
        group.bench_function(BenchmarkId::new("rounds", count), |b| {
            b.iter(|| black_box(filled(&source)))
        });
        group.bench_function(BenchmarkId::new("octree", count), |b| {
            b.iter(|| {
                let mut octree = RecordOctree::new(&BOUNDS, SETTINGS.cell_records);
                for record in &source {
                    octree
                        .insert(record.position, SETTINGS.read_radius(record))
                        .expect("records in the room");
                }
                black_box(octree)
            });
        });
    }
    group.finish();
}

/// Not a time: what a record takes, beside the 128 bytes of its entity.
fn memory(_: &mut Criterion) {
    for count in SIZES {
        let cache = filled(&records(count));
        let each = cache.memory_bytes() as f64 / count as f64;
        println!(
            "irradiance_cache/memory/{count}: {each:.0} bytes a record, {} of them itself",
            size_of::<IrradianceRecord>()
        );
    }
}

/// Renders the Cornell box with these fields of `/Render.IrradianceCache`, and returns seconds and items of a system.
fn profile(system: &str, fields: &[String]) -> (f64, f64) {
    let file = |kind: &str| PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("irradiance_cache.{kind}"));
    let status = Command::new(env!("CARGO_BIN_EXE_pipeline"))
        .arg("run")
        .arg(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/references/cornell/scene.ron"))
        .args(["--quiet", "--resolution", "128x128", "--samples", "16"])
        .args(["--set", "/Render.LightTransport.indirect=IrradianceCache"])
        .args(
            fields
                .iter()
                .flat_map(|field| ["--set".into(), format!("/Render.IrradianceCache.{field}")]),
        )
        .arg("-o")
        .arg(file("exr"))
        .arg("--profile")
        .arg(file("json"))
        .status()
        .expect("the program starts");
    assert!(status.success(), "the scene renders");
    let profile = std::fs::read_to_string(file("json")).expect("a profile that was written");
    let profile: serde_json::Value = serde_json::from_str(&profile).expect("JSON");
    let mut lines = profile.as_array().expect("a line for each system").iter();
    let line = lines
        .find(|line| line["system"].as_str().is_some_and(|name| name.contains(system)))
        .expect("the system ran");
    let number = |key: &str| line[key].as_f64().expect("a number");
    (number("seconds"), number("items"))
}

fn pictures(_: &mut Criterion) {
    for min_weight in [5, 10, 20, 40] {
        let fields = ["rays=64".into(), format!("min_weight={min_weight}")];
        let (_, records) = profile("insert_records", &fields);
        println!("irradiance_cache/records/cornell/{min_weight}: {records} records for 128x128 pixels");
    }
    for rays in [64, 1024] {
        let (seconds, lookups) = profile("look_up_irradiance", &[format!("rays={rays}")]);
        println!(
            "irradiance_cache/look_up/cornell/{rays} rays a record: {:.0} ns a look-up",
            1e9 * seconds / lookups
        );
    }
}

criterion_group!(benches, memory, read, insert, pictures);
criterion_main!(benches);

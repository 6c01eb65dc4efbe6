//! Composition of layered scenes: how its time grows with the prims, and what it is beside parsing.
//!
//! `cargo bench --bench composition` prints for each size the time to read the files, and that of composing as a
//! multiple of it.

#![allow(clippy::unwrap_used, reason = "a benchmark that meets an error should fail")]

use bevy_app::App;
use bevy_ecs::reflect::AppTypeRegistry;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pipeline_data::vocabulary::VocabularyPlugin;
use pipeline_data::vocabulary::is_scene_component;
use scene_format::{Options, Scene, Schema, load};
use std::fmt::Write;
use std::path::Path;
use tempfile::TempDir;

const LAYERS: usize = 50;
const SIZES: [usize; 3] = [1_000, 10_000, 100_000];

/// Spreads prims over 50 sublayers; each layer defines its share, and says something about as many prims of the next.
fn layered_scene(prims: usize) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let share = prims / LAYERS;
    let names: Vec<String> = (0..LAYERS).map(|layer| format!("\"layer{layer}.ron\"")).collect();
    let root = format!("Layer(sublayers: [{}])", names.join(", "));
    std::fs::write(folder.path().join("root.ron"), root).unwrap();
    for layer in 0..LAYERS {
        let mut text = String::from("Layer(prims: {\"/_Look\": Class(Diffuse: (albedo: (0.5, 0.5, 0.5))),\n");
        for prim in layer * share..(layer + 1) * share {
            let _ = writeln!(
                text,
                "\"/G{}/P{prim}\": Def(Transform: (translate: ({prim}, 1, 2)), Sphere: (radius: 0.5), inherits: [\"/_Look\"]),",
                prim % 100
            );
        }
        let next = (layer + 1) % LAYERS;
        for prim in next * share..(next + 1) * share {
            let _ = writeln!(text, "\"/G{}/P{prim}\": Over(Sphere: (radius: 0.25)),", prim % 100);
        }
        text.push_str("})");
        std::fs::write(folder.path().join(format!("layer{layer}.ron")), text).unwrap();
    }
    folder
}

/// 1,000 references to one file of 1,000 prims.
fn referenced_scene(references: usize) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut asset = String::from("Layer(prims: {\"/A\": Def(children: {\n");
    for prim in 0..999 {
        let _ = writeln!(asset, "\"P{prim}\": Def(Sphere: (radius: 0.5)),");
    }
    asset.push_str("})})");
    std::fs::write(folder.path().join("asset.ron"), asset).unwrap();
    let mut root = String::from("Layer(prims: {\n");
    for reference in 0..references {
        let _ = writeln!(root, "\"/R{reference}\": Def(references: [\"asset.ron#/A\"]),");
    }
    root.push_str("})");
    std::fs::write(folder.path().join("root.ron"), root).unwrap();
    folder
}

fn compose(folder: &Path) -> Scene {
    let mut app = App::empty();
    app.init_resource::<AppTypeRegistry>().add_plugins(VocabularyPlugin);
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let schema = Schema::new(&registry, is_scene_component).unwrap();
    load(&folder.join("root.ron"), &schema, &Options::default()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// Prints the least of three, which other work on the machine disturbs least.
fn report(name: &str, folder: &Path) {
    let costs: Vec<_> = (0..3)
        .map(|_| compose(folder))
        .map(|scene| (scene.cost, scene.prims.len()))
        .collect();
    let reading = costs.iter().map(|(cost, _)| cost.reading).min().unwrap_or_default();
    let composing = costs.iter().map(|(cost, _)| cost.composing).min().unwrap_or_default();
    let (cost, prims) = costs[0];
    eprintln!(
        "{name}: {prims} prims, {} layers, {} fields; reading {:.1} ms, composing {:.2} times that, {:.2} µs a prim",
        cost.layers,
        cost.opinions,
        reading.as_secs_f64() * 1e3,
        composing.as_secs_f64() / reading.as_secs_f64(),
        composing.as_secs_f64() * 1e6 / prims as f64,
    );
}

fn bench_composition(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("composition");
    group.sample_size(10);
    for size in SIZES {
        let folder = layered_scene(size);
        report(&format!("layers/{size}"), folder.path());
        group.throughput(Throughput::Elements(size as u64));
        group.bench_with_input(BenchmarkId::new("layers", size), &size, |bencher, _| {
            bencher.iter(|| compose(folder.path()));
        });
    }
    for references in [10, 100, 1_000] {
        let folder = referenced_scene(references);
        report(&format!("references/{references}"), folder.path());
        group.throughput(Throughput::Elements(references as u64 * 1_000));
        group.bench_with_input(BenchmarkId::new("references", references), &references, |bencher, _| {
            bencher.iter(|| compose(folder.path()));
        });
    }
    group.finish();
}

criterion_group!(benches, bench_composition);
criterion_main!(benches);

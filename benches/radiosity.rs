//! Radiosity: laying patches, finding form factors, letting light go around: `cargo bench --bench radiosity`.
//!
//! In a closed room form factors have to add up to 1; `radiosity/closure` says how far they do.

#![expect(clippy::print_stdout, reason = "closure is part of the result")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DAffine3, Vec3};
use radiometry::Rgb;
use scattering::{Bsdf, DiffuseBsdf};
use spatial::{Geometry, Instance, RayScene, Shape};
use std::hint::black_box;
use transport::{ExchangeSettings, LightSource, Material, PatchField, PlaceSettings, Scene};

const RAYS: u32 = 256;
const SETTINGS: ExchangeSettings = ExchangeSettings {
    rays: RAYS,
    seed: 0,
    most_links: 1 << 26,
};

/// A room whose walls shine on both sides, 70 % reflecting.
fn room() -> Scene {
    let shape = Shape::Cuboid {
        size: Vec3::new(4.0, 2.5, 5.0),
    };
    let rays = RayScene::build(
        vec![Geometry::Shape(shape)],
        vec![Instance::fixed(0, DAffine3::IDENTITY)],
    )
    .expect("a valid scene");
    let material = Material {
        bsdf: Bsdf::Diffuse(DiffuseBsdf::new(Rgb::splat(0.7))),
        ..Material::default()
    };
    let light = LightSource::Area {
        instance: 0,
        radiance: Rgb::splat(0.3),
        texture: None,
        two_sided: true,
    };
    Scene::new(rays, vec![material], vec![0], vec![light])
}

fn placed(scene: &Scene, points: u32) -> PatchField {
    let settings = PlaceSettings {
        size: None,
        usual: points,
        most: 1 << 21,
    };
    PatchField::place(scene, &settings).expect("a room")
}

fn solve(criterion: &mut Criterion) {
    let scene = room();
    for points in [1000, 10_000] {
        let patches = u64::from(2 * points);
        let mut group = criterion.benchmark_group("radiosity");
        group.sample_size(10).throughput(Throughput::Elements(patches));
        group.bench_function(BenchmarkId::new("place", patches), |b| {
            b.iter(|| black_box(placed(&scene, points)));
        });
        let mut field = placed(&scene, points);
        group.bench_function(BenchmarkId::new("direct", patches), |b| {
            b.iter(|| transport::find_direct(&scene, &mut field, &SETTINGS, |_| true));
        });
        let direct = field.clone();
        group.bench_function(BenchmarkId::new("form_factors", patches), |b| {
            b.iter(|| transport::find_form_factors(&scene, &mut direct.clone(), &SETTINGS, |_| true));
        });
        let mut field = direct.clone();
        let factors =
            transport::find_form_factors(&scene, &mut field, &SETTINGS, |_| true).expect("few enough form factors");
        group.throughput(Throughput::Elements(factors.len() as u64));
        group.bench_function(BenchmarkId::new("solve", factors.len()), |b| {
            b.iter(|| black_box(factors.solve(&mut field, 0.01, u32::MAX)));
        });
        group.finish();
        // Points have two sides each, of which the second is inside.
        let sum = |row: usize| factors.row(row).iter().map(|(_, factor)| factor.g).sum::<f32>();
        let inside = (0..field.patches().len()).filter(|row| row % 2 == 1);
        let worst = inside.map(|row| (sum(row) - 1.0).abs()).fold(0.0, f32::max);
        println!(
            "radiosity/closure/{patches}: {} form factors, sums of rows off by {worst:.1e} at most",
            factors.len()
        );
    }
}

criterion_group!(benches, solve);
criterion_main!(benches);

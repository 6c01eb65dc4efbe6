//! What a photon costs, as there are more of them: traced, built into a map, looked up. `cargo bench --bench photon_growth`.
//!
//! Photons are those of the Cornell box with balls of glass and metal, all kinds in one map; lookups are at what its camera sees. Tracing and lookups run
//! on one thread, building on all. After each group stands how the least time of each size compares with that of the first,
//! in units of what the logarithm of their number would permit: 1 is growth as n log n for building, as log n for a lookup.

#![expect(clippy::print_stdout, reason = "growth is what this measures")]

use bevy_app::App;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec2;
use pipeline_core::{CorePlugin, Load, Prepare, Report};
use pipeline_data::{CameraFrame, Photon, RenderRequest, RenderSettings, TransportScene};
use pipeline_stages::DefaultStages;
use pipeline_stages::photon_map::{look_for_walls, photon_map};
use radiometry::{SampleStream, math};
use rayon::prelude::*;
use spatial::{Ray, SurfacePoint};
use std::hint::black_box;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use transport::{
    DensityFilter, DensityScratch, DensitySettings, EmissionSampler, MapKind, MapKinds, PHOTON_STAGE, PathMedium,
    PhotonMap, Scene, Vertex, trace_photon,
};

const SIZES: [usize; 4] = [10_000, 100_000, 1_000_000, 10_000_000];
/// Lookups along each side of the film: one a pixel, so that neighbours share memory as they do in a render.
const SIDE: u32 = 256;
/// Paths that one task traces.
const TASK_PATHS: u32 = 4096;
const MOST_EVENTS: u32 = 64;

fn prepared() -> App {
    let mut app = App::empty();
    app.add_plugins((CorePlugin, DefaultStages));
    app.insert_resource(RenderRequest {
        scene: PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/references/cornell_glass/scene.ron"),
        ..RenderRequest::default()
    });
    app.world_mut().run_schedule(Load);
    app.world_mut().run_schedule(Prepare);
    let report = app.world().resource::<Report>();
    assert!(!report.failed(), "{:?}", report.errors());
    app
}

fn all_kinds() -> MapKinds {
    MapKind::ALL.into_iter().fold(MapKinds::default(), MapKinds::with)
}

/// Follows paths by their numbers; calls `store` for what lands.
fn trace_paths(scene: &Scene, paths: std::ops::Range<u32>, mut store: impl FnMut(Photon)) {
    let sampler = EmissionSampler::uniform(&scene.lights);
    for path in paths {
        let stream = SampleStream::new(0, PHOTON_STAGE, 0, path);
        if let Some(photon) = sampler.emit(&stream) {
            trace_photon(scene, &photon, all_kinds(), MOST_EVENTS, path, &stream, |deposit| {
                store(deposit.into());
            });
        }
    }
}

/// The first photons that land, in the order of their paths.
fn photons(scene: &Scene, count: usize) -> Vec<Photon> {
    let mut landed = Vec::new();
    let mut first = 0;
    while landed.len() < count {
        let tasks = 0..64;
        let found: Vec<Vec<Photon>> = tasks
            .into_par_iter()
            .map(|task| {
                let mut found = Vec::new();
                let start = first + task * TASK_PATHS;
                trace_paths(scene, start..start + TASK_PATHS, |photon| found.push(photon));
                found
            })
            .collect();
        first += 64 * TASK_PATHS;
        landed.extend(found.into_iter().flatten());
    }
    landed.truncate(count);
    landed
}

/// The least time of an item by size, as criterion measures.
#[derive(Default)]
struct Growth(Vec<(usize, f64)>);

impl Growth {
    /// Times `f`, which does `items` things with photons of this number.
    fn time<R>(&mut self, size: usize, items: usize, iterations: u64, mut f: impl FnMut() -> R) -> Duration {
        let mut sum = Duration::ZERO;
        for _ in 0..iterations {
            let started = Instant::now();
            black_box(f());
            let elapsed = started.elapsed();
            sum += elapsed;
            let each = elapsed.as_secs_f64() / items as f64;
            match self.0.last_mut() {
                Some((last, least)) if *last == size => *least = least.min(each),
                _ => self.0.push((size, each)),
            }
        }
        sum
    }

    fn print(&self, name: &str) {
        let Some(&(first, base)) = self.0.first() else { return };
        for &(size, each) in &self.0 {
            let permitted = math::ln(size as f32) / math::ln(first as f32);
            println!(
                "{name}/{size}: {:.1} ns each, {:.2} times the least size's, {:.2} of what the logarithm permits",
                each * 1e9,
                each / base,
                each / base / f64::from(permitted)
            );
        }
    }
}

fn trace(criterion: &mut Criterion) {
    let app = prepared();
    let scene = &app.world().resource::<TransportScene>().0;
    let mut group = criterion.benchmark_group("photon_growth/trace");
    group.sample_size(10);
    let mut growth = Growth::default();
    let mut stored = 0_usize;
    // Paths are traced one by one: ten million take ten times as long as one million.
    for size in &SIZES[..3] {
        group.throughput(Throughput::Elements(*size as u64));
        group.bench_function(BenchmarkId::from_parameter(size), |b| {
            b.iter_custom(|iterations| {
                growth.time(*size, *size, iterations, || {
                    stored = 0;
                    trace_paths(scene, 0..*size as u32, |_| stored += 1);
                })
            });
        });
        if let Some((paths, each)) = growth.0.last() {
            println!(
                "photon_growth/trace/{paths}: {:.0} paths and {:.0} stored photons a second and thread",
                1.0 / each,
                stored as f64 / (*paths as f64 * each)
            );
        }
    }
    group.finish();
}

fn density(nearest: usize, photons: usize, area: f64) -> DensitySettings {
    DensitySettings {
        nearest,
        max_radius: DensitySettings::even_radius(nearest as u32, photons as u32, area),
        filter: DensityFilter::Cone,
        shrink: 1.0,
    }
}

fn build(criterion: &mut Criterion) {
    let app = prepared();
    let scene = &app.world().resource::<TransportScene>().0;
    let photons = photons(scene, SIZES[SIZES.len() - 1]);
    let mut group = criterion.benchmark_group("photon_growth/build");
    group.sample_size(10);
    let mut growth = Growth::default();
    for size in SIZES {
        group.throughput(Throughput::Elements(size as u64));
        let (photons, density) = (&photons[..size], density(50, size, scene.diffuse_area()));
        group.bench_function(BenchmarkId::from_parameter(size), |b| {
            b.iter_custom(|iterations| growth.time(size, size, iterations, || photon_map(photons, density)));
        });
        let map = photon_map(photons, density).expect("finite photons make a map");
        let (tree, all) = (map.tree.memory_bytes(), map.memory_bytes());
        println!(
            "photon_growth/build/{size}: {:.1} bytes a photon in the tree, {:.1} in its columns",
            tree as f64 / size as f64,
            (all - tree) as f64 / size as f64
        );
    }
    growth.print("photon_growth/build");
    group.finish();
}

/// What the camera sees, row by row, and the rays there.
fn hits(app: &App) -> Vec<(Ray, SurfacePoint)> {
    let world = app.world();
    let (scene, camera) = (
        &world.resource::<TransportScene>().0,
        &world.resource::<CameraFrame>().0,
    );
    let pixels = world.resource::<RenderSettings>().resolution.as_vec2() / SIDE as f32;
    let hit = |i: u32| {
        let cell = Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5);
        let ray = camera.ray(cell * pixels, 0.5);
        let hit = scene.rays.intersect(&ray)?;
        Some((ray, scene.rays.surface(&ray, &hit)))
    };
    (0..SIDE * SIDE).filter_map(hit).collect()
}

fn gather(criterion: &mut Criterion) {
    let app = prepared();
    let scene = &app.world().resource::<TransportScene>().0;
    let hits = hits(&app);
    let vertices: Vec<Vertex<'_>> = hits
        .iter()
        .map(|(ray, point)| Vertex::new(scene, point, -ray.direction, &PathMedium::VACUUM))
        .filter(|vertex| vertex.bsdf.has_diffuse())
        .collect();
    let photons = photons(scene, SIZES[SIZES.len() - 1]);
    let maps: Vec<PhotonMap> = SIZES
        .iter()
        .map(|size| {
            let density = density(50, *size, scene.diffuse_area());
            photon_map(&photons[..*size], density).expect("finite photons make a map")
        })
        .collect();
    drop(photons);
    for nearest in [50, 500] {
        let name = format!("photon_growth/gather/k{nearest}");
        let mut group = criterion.benchmark_group(&name);
        group
            .sample_size(10)
            .throughput(Throughput::Elements(vertices.len() as u64));
        let mut growth = Growth::default();
        for map in &maps {
            let size = map.tree.len();
            let mut map = PhotonMap {
                density: density(nearest, size, scene.diffuse_area()),
                ..map.clone()
            };
            look_for_walls(&mut map, scene);
            group.bench_function(BenchmarkId::from_parameter(size), |b| {
                let mut scratch = DensityScratch::default();
                b.iter_custom(|iterations| {
                    growth.time(size, vertices.len(), iterations, || {
                        for vertex in &vertices {
                            black_box(map.estimate_radiance(scene, vertex, &mut scratch));
                        }
                    })
                });
            });
        }
        growth.print(&name);
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets = trace, build, gather
}
criterion_main!(benches);

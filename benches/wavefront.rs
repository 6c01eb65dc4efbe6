//! The wavefront, system by system over streams, against the same work in one fused loop per pixel, on cornell.
//!
//! Both call the same pure functions of `transport`, on one thread and on all, at 256×256 and 4 samples a pixel. The
//! ratio of the two is what the architecture costs: `cargo bench --bench wavefront`.

use bevy_app::App;
use bevy_ecs::world::World;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use film::{Film, FilterSampler};
use glam::Vec2;
use pipeline_core::{CorePlugin, Load, Prepare, RenderClock, RenderPass, Report};
use pipeline_data::{CameraFrame, FilmSums, RenderRequest, RenderSettings, TransportScene};
use pipeline_stages::DefaultStages;
use radiometry::{Frame, SampleStream, StageKey};
use rayon::prelude::*;
use std::hint::black_box;
use std::path::PathBuf;
use transport::{Path, arrive, emitted_light, sample_direct_light, scatter};

const SAMPLES: u32 = 4;

fn prepared(scene: &str) -> App {
    let mut app = App::empty();
    app.add_plugins((CorePlugin, DefaultStages));
    let scene = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/references")
        .join(scene)
        .join("scene.ron");
    app.insert_resource(RenderRequest {
        scene,
        samples: Some(SAMPLES),
        ..RenderRequest::default()
    });
    app.world_mut().run_schedule(Load);
    app.world_mut().run_schedule(Prepare);
    let report = app.world().resource::<Report>();
    assert!(!report.failed(), "{:?}", report.errors());
    app
}

fn empty_film(world: &World) -> Film {
    let film = &world.resource::<FilmSums>().0;
    Film::new(*film.window(), film.layout().clone(), 32).expect("the film was made before")
}

/// The whole image through the schedules.
fn wavefront(world: &mut World) {
    let film = empty_film(world);
    world.insert_resource(FilmSums(film));
    world.resource_mut::<RenderClock>().waves_done = 0;
    while {
        let clock = world.resource::<RenderClock>();
        clock.waves_done < clock.waves_total
    } {
        world.run_schedule(RenderPass);
        world.resource_mut::<RenderClock>().waves_done += 1;
    }
}

/// The whole image pixel by pixel, path by path.
fn fused(world: &World) -> Film {
    const CAMERA: StageKey = StageKey::new("camera");
    const PATH: StageKey = StageKey::new("path");
    let mut film = empty_film(world);
    let scene = &world.resource::<TransportScene>().0;
    let camera = &world.resource::<CameraFrame>().0;
    let settings = world.resource::<RenderSettings>();
    let filter = FilterSampler::new(settings.filter, settings.filter_radius);
    let (methods, seed, width) = (&settings.methods, settings.seed, u64::from(settings.resolution.x));
    let (count, sequences) = (film.pixel_count(), film.layout().sequences());
    film.spans_mut(0..count, 256).into_par_iter().for_each(|mut span| {
        for local in 0..span.len() {
            let pixel = span.pixel_of(local);
            let domain = u64::from(pixel.y) * width + u64::from(pixel.x);
            for sample in 0..SAMPLES {
                let lens = SampleStream::dealt(seed, CAMERA, domain, sample, sequences);
                let position =
                    Vec2::new(pixel.x as f32 + 0.5, pixel.y as f32 + 0.5) + filter.sample(lens.draw_2d(0, 0));
                let mut ray = camera.ray(position, 0.0);
                let mut path = Path::from_eye(0, SampleStream::dealt(seed, PATH, domain, sample, sequences));
                let mut layers = [[0.0_f32; 3]; 5];
                let (mut alpha, mut aux) = (0.0, [0.0; 7]);
                let mut add = |layer: transport::Layer, radiance: radiometry::Rgb| {
                    for (sum, value) in layers[layer as usize].iter_mut().zip(radiance.to_array()) {
                        *sum += value;
                    }
                };
                loop {
                    let hit = arrive(scene, &mut path, &ray);
                    if let Some((layer, radiance)) = emitted_light(scene, methods, &path, &ray, hit.as_ref()) {
                        add(layer, radiance);
                    }
                    let Some(hit) = hit else { break };
                    if path.depth == 0 {
                        let wo = Frame::from_normal(hit.ns).local_from_world(-ray.direction);
                        let albedo = scene.material(&hit).bsdf.albedo(wo);
                        alpha = 1.0;
                        let n = hit.ns;
                        aux = [albedo.r, albedo.g, albedo.b, n.x, n.y, n.z, hit.p.distance(ray.origin)];
                    }
                    sample_direct_light(scene, methods, &path, &ray, &hit, &mut add);
                    match scatter(scene, methods, &mut path, &ray, &hit) {
                        Some(next) => ray = next,
                        None => break,
                    }
                }
                let _ = span.add_sample(local, sample, &layers, alpha, &aux);
            }
        }
    });
    film
}

fn bench(criterion: &mut Criterion) {
    let mut app = prepared("cornell");
    let mut group = criterion.benchmark_group("render_pass/cornell/256x256x4");
    group
        .sample_size(10)
        .throughput(Throughput::Elements(256 * 256 * u64::from(SAMPLES)));
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        let world = app.world_mut();
        group.bench_function(BenchmarkId::new("wavefront", threads), |b| {
            b.iter(|| pool.install(|| wavefront(world)))
        });
        group.bench_function(BenchmarkId::new("fused", threads), |b| {
            b.iter(|| black_box(pool.install(|| fused(world)).pixel_count()))
        });
    }
    group.finish();
    // The two are the same estimator with the same numbers, so they must agree to the bit.
    let fused = fused(app.world()).resolve();
    assert!(
        app.world().resource::<FilmSums>().0.resolve().rgb("") == fused.rgb(""),
        "wavefront and fused loop differ"
    );
}

criterion_group!(benches, bench);
criterion_main!(benches);

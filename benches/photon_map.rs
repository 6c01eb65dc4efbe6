//! Photons: storing them in the world against writing a `Vec`, and emitting and tracing them.
//!
//! `photon_map/store` overwrites an existing pool of entities, which is what the second and later passes do; beside it
//! the same photons are written to a `Vec`. `photon_map/memory` says what a stored photon takes. `cargo bench --bench photon_map`.

#![expect(
    clippy::print_stdout,
    reason = "the share of photons that count is part of the result"
)]

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemState;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DAffine3, DVec3, Vec2};
use pipeline_data::{CausticPhoton, Photon};
use pipeline_stages::photon_map::{PhotonPool, photon_map, store_in_pool};
use radiometry::{Rgb, SampleStream};
use scattering::{Bsdf, ConductorBsdf, ConductorFresnel, DiffuseBsdf, Microsurface};
use spatial::{Geometry, Instance, RayScene, Shape};
use std::hint::black_box;
use transport::{
    DensityFilter, DensitySettings, EmissionSampler, LightSource, MapKinds, Material, PHOTON_STAGE, Scene, trace_photon,
};

fn photons(n: usize) -> Vec<Photon> {
    (0..n as u32)
        .map(|path| Photon {
            position: [path as f32, 1.0, 2.0],
            flux: Rgb::splat(1.0),
            direction: path,
            normal: path,
            path,
            bounce: 1,
        })
        .collect()
}

fn store(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("photon_map/store");
    group.sample_size(20);
    for n in [1_000, 100_000, 1_000_000] {
        group.throughput(Throughput::Elements(n as u64));
        let source = photons(n);
        let mut world = World::new();
        world.spawn_batch(source.iter().map(|photon| (*photon, CausticPhoton)).collect::<Vec<_>>());
        let mut state: SystemState<PhotonPool<CausticPhoton>> = SystemState::new(&mut world);
        group.bench_function(BenchmarkId::new("world", n), |b| {
            b.iter(|| {
                let mut pool = state.get_mut(&mut world).expect("the query is valid");
                black_box(store_in_pool(black_box(&source), &mut pool))
            });
        });
        let mut target = source.clone();
        group.bench_function(BenchmarkId::new("vec", n), |b| {
            b.iter(|| {
                target.copy_from_slice(black_box(&source));
                black_box(target.len())
            });
        });
    }
    group.finish();
}

/// A ring of gold on a floor under a small lamp, all analytic.
fn ring() -> Scene {
    let place = |x, y, z| DAffine3::from_translation(DVec3::new(x, y, z));
    let shapes = [
        (
            Shape::Quad { size: Vec2::splat(8.0) },
            DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2),
        ),
        (
            Shape::Band {
                inner_radius: 1.0,
                outer_radius: 1.1,
                height: 0.5,
                bevel: 0.02,
            },
            place(0.0, 0.251, 0.0),
        ),
        (Shape::Sphere { radius: 0.1 }, place(3.0, 2.0, -1.0)),
    ];
    let instances = shapes
        .iter()
        .enumerate()
        .map(|(i, (_, placed))| Instance::fixed(i as u32, *placed))
        .collect();
    let geometries = shapes.iter().map(|(shape, _)| Geometry::Shape(*shape)).collect();
    let rays = RayScene::build(geometries, instances).expect("a valid scene");
    let gold = ConductorBsdf::new(
        ConductorFresnel::Schlick(Rgb::new(1.0, 0.78, 0.34)),
        Microsurface::SMOOTH,
    );
    let bsdfs = [
        Bsdf::Diffuse(DiffuseBsdf::new(Rgb::splat(0.6))),
        Bsdf::Conductor(gold),
        Bsdf::Black,
    ];
    let materials = bsdfs.map(|bsdf| Material {
        bsdf,
        ..Material::default()
    });
    let light = LightSource::Area {
        instance: 2,
        radiance: Rgb::splat(300.0),
        texture: None,
        two_sided: false,
    };
    Scene::new(rays, materials.to_vec(), vec![0, 1, 2], vec![light])
}

fn trace(criterion: &mut Criterion) {
    const PATHS: u32 = 100_000;
    let scene = ring();
    let mut group = criterion.benchmark_group("photon_map/trace/ring");
    group.sample_size(10).throughput(Throughput::Elements(u64::from(PATHS)));
    for (name, sampler) in [
        ("uniform", EmissionSampler::uniform(&scene.lights)),
        (
            "aimed",
            EmissionSampler::aimed(&scene.lights, scene.specular_targets(), 0.1),
        ),
    ] {
        let mut stored = 0_u64;
        group.bench_function(BenchmarkId::new(name, PATHS), |b| {
            b.iter(|| {
                stored = 0;
                for path in 0..PATHS {
                    let stream = SampleStream::new(0, PHOTON_STAGE, 0, path);
                    if let Some(photon) = sampler.emit(&stream) {
                        trace_photon(&scene, &photon, MapKinds::CAUSTIC, 64, path, &stream, |_| stored += 1);
                    }
                }
                black_box(stored)
            });
        });
        println!("photon_map/trace/ring/{name}: {stored} caustic photons of {PATHS}");
    }
    group.finish();
}

/// Bytes that this process holds at present, where the system tells.
fn resident_bytes() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kibibytes: usize = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

/// So many photons may take no more than this each, in the world and in the map over them. Of ten million, lists of the world
/// that grow by doubling have more room to spare.
const MOST_BYTES: [(usize, f64); 2] = [(1_000_000, 175.0), (10_000_000, 195.0)];

/// Not a time: what a photon takes when it is stored and can be found.
fn memory(_: &mut Criterion) {
    // Fewer are lost among the pages of everything else.
    for (n, most) in MOST_BYTES {
        measure_memory(n, most);
    }
}

fn measure_memory(n: usize, most: f64) {
    let Some(before) = resident_bytes() else { return };
    let mut world = World::new();
    let mut source = photons(n);
    for (i, photon) in source.iter_mut().enumerate() {
        photon.position = [(i % 1000) as f32, (i / 1000) as f32, 0.0];
    }
    world.spawn_batch(source.iter().map(|photon| (*photon, CausticPhoton)));
    let in_world = resident_bytes()
        .unwrap_or(before)
        .saturating_sub(before + n * size_of::<Photon>());
    let density = DensitySettings {
        nearest: 50,
        max_radius: 1.0,
        filter: DensityFilter::Cone,
        shrink: 1.0,
    };
    let map = photon_map(&source, density).expect("finite photons make a tree");
    drop(source);
    let after = resident_bytes().unwrap_or(before);
    let each = |bytes: usize| bytes as f64 / n as f64;
    let tree = map.tree.memory_bytes();
    println!(
        "photon_map/memory/{n}: {:.1} bytes a photon: {:.1} in the world, {:.1} in the tree, {:.1} in its columns",
        each(after.saturating_sub(before)),
        each(in_world),
        each(tree),
        each(map.memory_bytes() - tree)
    );
    let each = each(after.saturating_sub(before));
    assert!(each <= most, "a photon takes {each} bytes");
    drop(black_box((world, map)));
}

// Memory first: afterwards the allocator holds pages that nobody uses.
criterion_group!(benches, memory, store, trace);
criterion_main!(benches);

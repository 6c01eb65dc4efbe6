//! What it costs to sample one of many lights, against one of a few: `cargo bench --bench light_sampling`.
//!
//! A room with 10,000 triangles and 1,000 points, all of which shine, against the same room where five of each do. Rounds
//! of both alternate; the median of the ratios of their times is printed, for choosing a light and a point of it alone, and
//! with the shadow ray that makes it a light sample. So is the noise of one sample: the variance of the light that it
//! brings to a point of the floor, over that of choosing a light evenly.

#![expect(clippy::print_stdout, reason = "a benchmark reports its figures")]

use glam::{Affine3A, DAffine3, Vec2, Vec3};
use radiometry::{Rgb, SampleStream, StageKey, warp};
use scattering::{Bsdf, DiffuseBsdf};
use spatial::{Geometry, Instance, RayScene, Shape, SurfacePoint, TriangleMesh};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;
use transport::{LightSource, Material, MovingFrame, Scene};

const SAMPLES: u32 = 1 << 16;
const ROUNDS: usize = 15;

fn numbers(key: &str, i: u32) -> SampleStream {
    SampleStream::new(5, StageKey::new(key), 0, i)
}

/// A place of light `i` in the room over the floor.
fn place(i: u32) -> Vec3 {
    let s = numbers("place", i);
    let across = s.draw_2d(0, 0) * 20.0 - 10.0;
    Vec3::new(across.x, 0.5 + 3.0 * s.draw_1d(0, 1), across.y)
}

const TRIANGLES: u32 = 10_000;
const POINTS: u32 = 1000;

/// Triangles that look down.
fn mesh(range: std::ops::Range<u32>) -> Geometry {
    let mut mesh = TriangleMesh::default();
    for i in range {
        let first = mesh.positions.len() as u32;
        let corners = [Vec3::ZERO, Vec3::X * 0.05, Vec3::Z * 0.05];
        mesh.positions.extend(corners.map(|corner| place(i) + corner));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Geometry::Mesh(Arc::new(mesh))
}

/// The room, where this many triangles and points shine.
fn scene(triangles: u32, points: u32) -> Scene {
    let floor = Shape::Quad {
        size: Vec2::splat(20.0),
    };
    let lying = DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let rays = RayScene::build(
        vec![Geometry::Shape(floor), mesh(0..triangles), mesh(triangles..TRIANGLES)],
        vec![
            Instance::fixed(0, lying),
            Instance::fixed(1, DAffine3::IDENTITY),
            Instance::fixed(2, DAffine3::IDENTITY),
        ],
    )
    .expect("a sound scene");
    let mut lights = vec![LightSource::Area {
        instance: 1,
        radiance: Rgb::splat(100.0),
        texture: None,
        two_sided: false,
    }];
    lights.extend((0..points).map(|i| LightSource::Point {
        frame: MovingFrame::fixed(Affine3A::from_translation(place(TRIANGLES + i))),
        intensity: Rgb::splat(0.2 + numbers("power", i).draw_1d(0, 0)),
    }));
    let matt = Material {
        bsdf: Bsdf::Diffuse(DiffuseBsdf::new(Rgb::splat(0.5))),
        ..Material::default()
    };
    Scene::new(rays, vec![matt, Material::default()], vec![0, 1, 1], lights)
}

fn floor_point(i: u32) -> SurfacePoint {
    let across = numbers("floor", i).draw_2d(0, 0) * 18.0 - 9.0;
    SurfacePoint {
        p: Vec3::new(across.x, 0.0, across.y),
        error: 1e-6,
        ng: Vec3::Y,
        ns: Vec3::Y,
        uv: Vec2::ZERO,
        instance: 0,
        primitive: 0,
        time: 0.0,
    }
}

/// Seconds for all samples, with or without their shadow rays.
fn time(scene: &Scene, points: &[SurfacePoint], shadows: bool) -> f64 {
    let start = Instant::now();
    for (i, point) in (0..).zip(points) {
        let s = numbers("sample", i);
        let light = scene.lights.sample(point.p, 0.0, s.draw_2d(0, 0), s.draw_2d(0, 1));
        let light = black_box(light);
        if let (true, Some(light)) = (shadows, light) {
            black_box(scene.rays.occluded(&light.shadow_ray(point)));
        }
    }
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Variance of the irradiance of one sample at a point, over the square of its mean.
fn noise(scene: &Scene, point: &SurfacePoint) -> f64 {
    let (mut sum, mut squares) = (0.0, 0.0);
    let n = 1 << 14;
    for i in 0..n {
        let s = numbers("noise", i);
        if let Some(light) = scene.lights.sample(point.p, 0.0, s.draw_2d(0, 0), s.draw_2d(0, 1)) {
            let value = f64::from(light.radiance.g * light.wi.y.max(0.0) / light.pdf);
            sum += value;
            squares += value * value;
        }
    }
    let mean = sum / f64::from(n);
    squares / f64::from(n) / (mean * mean) - 1.0
}

/// The same for a light chosen evenly: each triangle and each point as often as any other.
fn even_noise(point: &SurfacePoint) -> f64 {
    let (mut sum, mut squares) = (0.0, 0.0);
    let n = 1 << 18;
    let all = TRIANGLES + POINTS;
    for i in 0..n {
        let s = numbers("even", i);
        let chosen = ((s.draw_1d(0, 0) * all as f32) as u32).min(all - 1);
        let value = if chosen < TRIANGLES {
            let b = warp::sample_triangle(s.draw_2d(0, 1));
            let to = place(chosen) + Vec3::new(0.05 * b.x, 0.0, 0.05 * b.y) - point.p;
            // Seen from below, where they shine: L A cos² / d².
            let cos = to.y / to.length();
            f64::from(100.0 * 0.5 * 0.05 * 0.05 * cos * cos / to.length_squared())
        } else {
            let to = place(chosen) - point.p;
            let intensity = 0.2 + numbers("power", chosen - TRIANGLES).draw_1d(0, 0);
            f64::from(intensity * (to.y / to.length()) / to.length_squared())
        } * f64::from(all);
        sum += value;
        squares += value * value;
    }
    let mean = sum / f64::from(n);
    squares / f64::from(n) / (mean * mean) - 1.0
}

fn main() {
    let (few, many) = (scene(5, 5), scene(TRIANGLES, POINTS));
    let points: Vec<SurfacePoint> = (0..SAMPLES).map(floor_point).collect();
    for (shadows, what) in [(false, "choice alone"), (true, "light sample with its shadow ray")] {
        let mut ratios = Vec::new();
        let mut best = [f64::INFINITY; 2];
        for _ in 0..ROUNDS {
            let times = [time(&few, &points, shadows), time(&many, &points, shadows)];
            ratios.push(times[1] / times[0]);
            best = [best[0].min(times[0]), best[1].min(times[1])];
        }
        let each = best.map(|seconds| 1e9 * seconds / f64::from(SAMPLES));
        println!(
            "{what}: {:.0} ns of 10 lights, {:.0} ns of 11,000; ratio {:.2}",
            each[0],
            each[1],
            median(ratios)
        );
    }
    let ratios = (0..9).map(|i| {
        let point = floor_point(1000 + i);
        noise(&many, &point) / even_noise(&point)
    });
    println!(
        "variance of one sample over that of an even choice: {:.3}",
        median(ratios.collect())
    );
}

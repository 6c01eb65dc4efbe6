//! Compares ray queries with obvhs alone: its own triangles and traversal, over the same triangles and rays.
//!
//! `cargo run --release -p spatial --example ray_speed [triangles per side]`
//!
//! Prints the ratio of rays per second, ours over obvhs's, median of interleaved rounds on one thread.

use glam::{DAffine3, Vec2, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use radiometry::{SampleStream, StageKey, warp};
use spatial::{Geometry, Instance, Ray, RayScene, TriangleMesh};
use std::io::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

const RAYS: u32 = 1 << 18;
const ROUNDS: usize = 9;

/// A bumpy sphere, so that rays meet it at all angles.
fn bumpy_sphere(n: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for j in 0..=n {
        for i in 0..=2 * n {
            let (a, b) = (i as f32 / (2 * n) as f32, j as f32 / n as f32);
            let d = warp::sample_uniform_sphere(Vec2::new(b, a));
            let bump = 1.0 + 0.1 * radiometry::math::sin(20.0 * d.x) * radiometry::math::sin(20.0 * d.y);
            mesh.positions.push(d * bump);
        }
    }
    let row = 2 * n + 1;
    for j in 0..n {
        for i in 0..2 * n {
            let a = j * row + i;
            mesh.triangles.push([a, a + row, a + row + 1]);
            mesh.triangles.push([a, a + row + 1, a + 1]);
        }
    }
    mesh
}

fn rays(kind: &str) -> Vec<Ray> {
    (0..RAYS)
        .map(|i| {
            let s = SampleStream::new(1, StageKey::new(kind), 0, i);
            let inside = warp::sample_uniform_sphere(s.draw_2d(0, 0)) * 0.5;
            let direction = warp::sample_uniform_sphere(s.draw_2d(0, 1));
            match kind {
                "inside" => Ray::new(inside, direction),
                "camera" => {
                    let pixel = s.draw_2d(0, 2) * 2.0 - 1.0;
                    Ray::new(
                        Vec3::new(0.0, 0.5, 3.0),
                        Vec3::new(pixel.x * 0.4, pixel.y * 0.4 - 0.15, -1.0).normalize(),
                    )
                }
                _ => {
                    // A segment between two points around the object.
                    let (a, b) = (direction * 1.5, inside * 3.0);
                    let mut ray = Ray::new(a, (b - a).normalize());
                    ray.t_max = (b - a).length();
                    ray
                }
            }
        })
        .collect()
}

fn time(f: impl FnOnce() -> u32) -> (f64, u32) {
    let start = Instant::now();
    let hits = f();
    (start.elapsed().as_secs_f64(), hits)
}

fn main() -> std::io::Result<()> {
    let n = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(256);
    let mesh = Arc::new(bumpy_sphere(n));
    let corners = |t: &[u32; 3]| t.map(|v| Vec3A::from(mesh.positions[v as usize]));
    let triangles: Vec<Triangle> = mesh
        .triangles
        .iter()
        .map(|t| {
            let [v0, v1, v2] = corners(t);
            Triangle { v0, v1, v2 }
        })
        .collect();
    let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
    let ordered: Vec<RtTriangle> = bvh
        .primitive_indices
        .iter()
        .map(|i| RtTriangle::from(&triangles[*i as usize]))
        .collect();
    let instance = Instance::fixed(0, DAffine3::IDENTITY);
    let scene = RayScene::build(vec![Geometry::Mesh(mesh.clone())], vec![instance]).map_err(std::io::Error::other)?;
    let mut out = std::io::stdout();
    writeln!(
        out,
        "{} triangles, {RAYS} rays, median of {ROUNDS} rounds",
        triangles.len()
    )?;
    for kind in ["camera", "inside", "segment"] {
        let rays = rays(kind);
        let theirs = |ray: &Ray| {
            let mut hit = obvhs::ray::RayHit::none();
            let r = obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), 0.0, ray.t_max);
            bvh.ray_traverse(r, &mut hit, |r, id| ordered[id].intersect(r))
        };
        let theirs_any = |ray: &Ray| {
            let r = obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), 0.0, ray.t_max);
            !bvh.ray_traverse_miss(r, |r, id| ordered[id].intersect(r))
        };
        let count = |f: &dyn Fn() -> u32| time(f);
        let mut ratios = [Vec::new(), Vec::new()];
        let mut speed = 0.0_f64;
        for _ in 0..ROUNDS {
            let (a, ha) = count(&|| rays.iter().map(|r| u32::from(theirs(r))).sum());
            let (b, hb) = count(&|| rays.iter().map(|r| u32::from(scene.intersect(r).is_some())).sum());
            let (c, _) = count(&|| rays.iter().map(|r| u32::from(theirs_any(r))).sum());
            let (d, _) = count(&|| rays.iter().map(|r| u32::from(scene.occluded(r))).sum());
            ratios[0].push(a / b);
            ratios[1].push(c / d);
            speed = speed.max(f64::from(RAYS) / b);
            if ha.abs_diff(hb) > RAYS / 1000 {
                writeln!(out, "different hits: {ha} and {hb}")?;
            }
        }
        let [nearest, any] = ratios.map(|mut r| {
            r.sort_by(f64::total_cmp);
            r[r.len() / 2]
        });
        writeln!(
            out,
            "{kind:8} nearest {nearest:.2}  any {any:.2}   ({:.2} million nearest/s)",
            speed * 1e-6
        )?;
    }
    Ok(())
}

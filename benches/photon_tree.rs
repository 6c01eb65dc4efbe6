//! The photon tree against kiddo's immutable tree, on the same photons in the same run.
//!
//! Run as `cargo bench --bench photon_tree`. Kiddo's entries end in `/kiddo`: its default build, and its unsorted query, which is its fastest. Photons lie exactly on the walls, which suits kiddo: moved off them by a little, its queries take up to 1.8 times as long, ours the same.

use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{Vec2, Vec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use spatial::{NearestScratch, PhotonTree};

/// As many as the lecture's largest image stores.
const PHOTONS: usize = 500_000;
/// Queries in one iteration, on the same surfaces.
const QUERIES: usize = 4096;

/// A generator of uniform numbers in [0, 1): splitmix64.
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }
}

/// A point exactly on the walls of the unit cube.
fn on_wall(uniform: &mut Uniform) -> Vec3 {
    let side = (uniform.next() * 6.0) as usize;
    let (u, v) = (uniform.next(), uniform.next());
    let mut position = [u, v, (side % 2) as f32];
    position.rotate_right(side / 2);
    Vec3::from(position)
}

/// A point of a caustic on the floor: close to a cardioid, closer the brighter.
fn on_caustic(uniform: &mut Uniform) -> Vec3 {
    let direction = Vec2::from_angle(uniform.next() * std::f32::consts::TAU);
    let fall_off = uniform.next();
    let radius = 0.3 * (1.0 + direction.x) * 0.5 * (1.0 - 0.1 * fall_off * fall_off * fall_off);
    let at = direction * radius + Vec2::splat(0.4);
    Vec3::new(at.x, 0.0, at.y)
}

/// Photons as they occur: half of them spread over the walls, half in a caustic.
fn photons(count: usize, uniform: &mut Uniform) -> Vec<Vec3> {
    (0..count)
        .map(|i| match i % 2 {
            0 => on_wall(uniform),
            _ => on_caustic(uniform),
        })
        .collect()
}

type Kiddo = ImmutableKdTree<f32, 3>;

fn kiddo_of(points: &[[f32; 3]]) -> Kiddo {
    Kiddo::new_from_slice(points).expect("finite points make a tree")
}

fn build(c: &mut Criterion) {
    let positions = photons(PHOTONS, &mut Uniform(1));
    let points: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
    let mut group = c.benchmark_group("photon_tree/build");
    group.throughput(Throughput::Elements(PHOTONS as u64)).sample_size(10);
    group.bench_function("500k", |b| b.iter(|| PhotonTree::build(black_box(&positions))));
    group.bench_function("500k/kiddo", |b| b.iter(|| kiddo_of(black_box(&points))));
    group.finish();
}

fn nearest(c: &mut Criterion) {
    let positions = photons(PHOTONS, &mut Uniform(1));
    let points: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
    let tree = PhotonTree::build(&positions).expect("finite photons make a tree");
    let kiddo = kiddo_of(&points);
    let queries = photons(QUERIES, &mut Uniform(2));
    let mut scratch = NearestScratch::new();
    let mut group = c.benchmark_group("photon_tree/nearest");
    group.throughput(Throughput::Elements(QUERIES as u64)).sample_size(10);
    for k in [50, 500] {
        let count = NonZeroUsize::new(k).expect("k is not zero");
        group.bench_function(format!("k{k}"), |b| {
            b.iter(|| {
                for &p in &queries {
                    black_box(tree.nearest(p, k, f32::INFINITY, &mut scratch));
                }
            });
        });
        // A typical predicate: the photon is not far above or below the hit.
        group.bench_function(format!("k{k}/where"), |b| {
            b.iter(|| {
                for &p in &queries {
                    let flat = |_: u32, offset: Vec3, dist_sq: f32| offset.y * offset.y <= 0.9 * dist_sq;
                    black_box(tree.nearest_where(p, k, f32::INFINITY, flat, &mut scratch));
                }
            });
        });
        group.bench_function(format!("k{k}/kiddo"), |b| {
            b.iter(|| {
                for p in &queries {
                    let query = kiddo
                        .query(&p.to_array())
                        .nearest_n::<SquaredEuclidean<f32>>(count)
                        .unsorted()
                        .execute();
                    black_box(query);
                }
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets = build, nearest
}
criterion_main!(benches);

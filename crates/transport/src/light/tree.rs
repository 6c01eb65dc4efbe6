//! Chooses one of many lights by how much of it may arrive at a point.

use glam::Vec3;
use radiometry::math;
use spatial::Bounds;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// What the tree knows of a light, or of several.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightBounds {
    /// Around it, world space.
    pub(super) bounds: Bounds,
    /// W; mean of the channels.
    pub(super) power: f32,
    /// Directions that it faces.
    pub(super) facing: Facing,
}

/// A cone of directions that surfaces face, and how far from there they shine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    /// Unit vector.
    pub(super) axis: Vec3,
    /// Cosine of the angle around `axis` that holds all normals; −1 for any.
    pub(super) cos_spread: f32,
    /// Cosine of the angle to a normal within which light is emitted.
    pub(super) cos_emission: f32,
    /// Shines the same on the other side.
    pub(super) two_sided: bool,
}

impl Facing {
    /// Shines everywhere.
    pub(super) const ANYWHERE: Self = Self {
        axis: Vec3::Z,
        cos_spread: -1.0,
        cos_emission: 0.0,
        two_sided: false,
    };
}

/// A binary tree over lights. A leaf is one light.
///
/// A light is chosen by walking down, at each node in proportion to an estimate of what the lights of each side send to
/// the point: power over squared distance, by the cosine of the least angle at which one of them may be seen, zero where
/// none can be. What is in the way, and how the surface is turned that receives the light, does not count.
///
/// Source: Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018, with the
/// bounds as in Pharr et al., "Physically Based Rendering", 4th ed., section 12.6.
#[derive(Debug, Default)]
pub(super) struct LightTree {
    /// The left child of an inner node is the next one.
    nodes: Vec<Node>,
    /// For each light the turns that lead to it from the root, first turn lowest: 1 is right.
    turns: Vec<u64>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    center: Vec3,
    /// Of a ball around all of it.
    radius_sq: f32,
    axis: Vec3,
    cos_spread: f32,
    sin_spread: f32,
    cos_emission: f32,
    power: f32,
    two_sided: bool,
    /// The right child, or the light of a leaf.
    next: u32,
    is_leaf: bool,
}

/// From this depth on, lights are split in halves, so that no way down has more than 64 turns.
const HALVE_FROM: u32 = 32;
/// A point may lie on a light, and the sum of two has to be finite.
const MOST_IMPORTANT: f32 = 1e30;
/// Candidate planes along an axis, and one.
const BUCKETS: usize = 12;

impl LightTree {
    /// Builds a tree. Deterministic: ties are broken by the order of the lights.
    pub(super) fn build(lights: &[LightBounds]) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * lights.len()),
            turns: vec![0; lights.len()],
        };
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        if !order.is_empty() {
            tree.grow(lights, &mut order, 0, 0);
        }
        tree
    }

    fn grow(&mut self, lights: &[LightBounds], order: &mut [u32], depth: u32, turns: u64) {
        let all = joined(lights, order);
        let index = self.nodes.len();
        self.nodes.push(Node::new(&all));
        if let [only] = order {
            self.nodes[index].next = *only;
            self.nodes[index].is_leaf = true;
            self.turns[*only as usize] = turns;
            return;
        }
        let middle = split(lights, order, &all.bounds, depth);
        let (left, right) = order.split_at_mut(middle);
        self.grow(lights, left, depth + 1, turns);
        self.nodes[index].next = self.nodes.len() as u32;
        self.grow(lights, right, depth + 1, turns | 1 << depth);
    }

    /// Chooses a light with `u` in [0, 1); returns it with its probability. `None` where no light can arrive.
    #[inline]
    pub(super) fn sample(&self, from: Vec3, mut u: f64) -> Option<(u32, f32)> {
        let mut probability = 1.0;
        let mut index = 0;
        loop {
            let node = self.nodes.get(index)?;
            if node.is_leaf {
                return Some((node.next, probability));
            }
            let left = self.share_of_left(index, node, from)?;
            if u < f64::from(left) {
                u /= f64::from(left);
                probability *= left;
                index += 1;
            } else {
                u = (u - f64::from(left)) / (1.0 - f64::from(left));
                probability *= 1.0 - left;
                index = node.next as usize;
            }
        }
    }

    /// Probability with which [`LightTree::sample`] chooses a light.
    #[inline]
    pub(super) fn probability(&self, from: Vec3, light: u32) -> f32 {
        let mut turns = self.turns[light as usize];
        let mut probability = 1.0;
        let mut index = 0;
        loop {
            let node = &self.nodes[index];
            if node.is_leaf {
                return probability;
            }
            let Some(left) = self.share_of_left(index, node, from) else {
                return 0.0;
            };
            if turns & 1 == 0 {
                probability *= left;
                index += 1;
            } else {
                probability *= 1.0 - left;
                index = node.next as usize;
            }
            turns >>= 1;
        }
    }

    #[inline]
    fn share_of_left(&self, index: usize, node: &Node, from: Vec3) -> Option<f32> {
        let left = self.nodes[index + 1].importance(from);
        let right = self.nodes[node.next as usize].importance(from);
        let sum = left + right;
        (sum > 0.0).then(|| left / sum)
    }
}

impl Node {
    fn new(light: &LightBounds) -> Self {
        let facing = &light.facing;
        let radius = 0.5 * light.bounds.diagonal();
        Self {
            center: light.bounds.center(),
            radius_sq: radius * radius,
            axis: facing.axis,
            cos_spread: facing.cos_spread,
            sin_spread: (1.0 - facing.cos_spread * facing.cos_spread).max(0.0).sqrt(),
            cos_emission: facing.cos_emission,
            power: light.power,
            two_sided: facing.two_sided,
            next: 0,
            is_leaf: false,
        }
    }

    /// An estimate of what arrives at a point; zero only where nothing can.
    #[inline]
    fn importance(&self, from: Vec3) -> f32 {
        let between = from - self.center;
        let distance_sq = between.length_squared();
        // Within the ball around the lights, one of them may be anywhere.
        if distance_sq <= self.radius_sq {
            return (self.power / self.radius_sq).min(MOST_IMPORTANT);
        }
        let mut cos = (between.dot(self.axis) / distance_sq.sqrt()).clamp(-1.0, 1.0);
        if self.two_sided {
            cos = cos.abs();
        }
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        // Angles of the cone of normals and of the ball, as far as they exceed that of the point.
        let (cos, sin) = less(cos, sin, self.cos_spread, self.sin_spread);
        let sin_ball_sq = self.radius_sq / distance_sq;
        let (cos, _) = less(cos, sin, (1.0 - sin_ball_sq).sqrt(), sin_ball_sq.sqrt());
        if cos <= self.cos_emission {
            return 0.0;
        }
        // A cosine near zero says that the bounds are coarse, not that little light arrives.
        (self.power * cos.max(1e-3) / distance_sq).min(MOST_IMPORTANT)
    }
}

/// Cosine and sine of max(0, a − b), for two angles in [0, π] by cosine and sine.
#[inline]
fn less(cos_a: f32, sin_a: f32, cos_b: f32, sin_b: f32) -> (f32, f32) {
    if cos_a >= cos_b {
        (1.0, 0.0)
    } else {
        (cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b)
    }
}

fn joined(lights: &[LightBounds], order: &[u32]) -> LightBounds {
    let (first, rest) = (&lights[order[0] as usize], &order[1..]);
    rest.iter().fold(*first, |all, i| join(&all, &lights[*i as usize]))
}

fn join(a: &LightBounds, b: &LightBounds) -> LightBounds {
    let (axis, cos_spread) = join_cones(a.facing, b.facing);
    LightBounds {
        bounds: a.bounds.union(&b.bounds),
        power: a.power + b.power,
        facing: Facing {
            axis,
            cos_spread,
            cos_emission: a.facing.cos_emission.min(b.facing.cos_emission),
            two_sided: a.facing.two_sided || b.facing.two_sided,
        },
    }
}

/// The least cone around two.
fn join_cones(a: Facing, b: Facing) -> (Vec3, f32) {
    let (a, b) = if a.cos_spread <= b.cos_spread { (a, b) } else { (b, a) };
    let (wide, narrow) = (math::acos(a.cos_spread), math::acos(b.cos_spread));
    let between = math::acos(a.axis.dot(b.axis).clamp(-1.0, 1.0));
    if (between + narrow).min(PI) <= wide {
        return (a.axis, a.cos_spread);
    }
    let spread = 0.5 * (wide + between + narrow);
    let across = (b.axis - a.axis * a.axis.dot(b.axis)).try_normalize();
    let Some(across) = across.filter(|_| spread < PI) else {
        return (a.axis, -1.0);
    };
    let (sin, cos) = math::sin_cos(spread - wide);
    // A little wider, since the axis is rounded.
    (
        (a.axis * cos + across * sin).normalize(),
        math::cos((spread + 1e-4).min(PI)),
    )
}

/// Sorts lights into two sides; returns how many are on the first.
fn split(lights: &[LightBounds], order: &mut [u32], bounds: &Bounds, depth: u32) -> usize {
    let center = |i: u32| lights[i as usize].bounds.center();
    let (low, high) = order
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), i| {
            (low.min(center(*i)), high.max(center(*i)))
        });
    let size = high - low;
    let best = (0..3)
        .filter(|axis| depth < HALVE_FROM && size[*axis] > 0.0)
        .filter_map(|axis| best_plane(lights, order, bounds, axis, (low[axis], size[axis])))
        .min_by(|a, b| a.cost.total_cmp(&b.cost));
    if let Some(best) = best {
        // Stable, so that the order of the lights breaks ties.
        order.sort_by_key(|i| bucket(center(*i)[best.axis], low[best.axis], size[best.axis]) > best.bucket);
        let middle =
            order.partition_point(|i| bucket(center(*i)[best.axis], low[best.axis], size[best.axis]) <= best.bucket);
        if middle > 0 && middle < order.len() {
            return middle;
        }
    }
    let axis = size.max_position();
    order.sort_by(|a, b| center(*a)[axis].total_cmp(&center(*b)[axis]));
    order.len() / 2
}

struct Plane {
    axis: usize,
    /// The last bucket on the first side.
    bucket: usize,
    cost: f32,
}

fn bucket(x: f32, low: f32, size: f32) -> usize {
    (((x - low) / size * BUCKETS as f32) as usize).min(BUCKETS - 1)
}

fn best_plane(
    lights: &[LightBounds],
    order: &[u32],
    bounds: &Bounds,
    axis: usize,
    (low, size): (f32, f32),
) -> Option<Plane> {
    let mut buckets: [Option<LightBounds>; BUCKETS] = [None; BUCKETS];
    for i in order {
        let light = &lights[*i as usize];
        let into = &mut buckets[bucket(light.bounds.center()[axis], low, size)];
        *into = Some(into.map_or(*light, |all| join(&all, light)));
    }
    let extent = bounds.max - bounds.min;
    // Long boxes are better split across.
    let shape = extent.max_element() / extent[axis].max(f32::MIN_POSITIVE);
    let side = |range: &[Option<LightBounds>]| range.iter().flatten().copied().reduce(|a, b| join(&a, &b));
    (0..BUCKETS - 1)
        .filter_map(|last| {
            let (left, right) = (side(&buckets[..=last])?, side(&buckets[last + 1..])?);
            let cost = shape * (cost(&left) + cost(&right));
            Some(Plane {
                axis,
                bucket: last,
                cost,
            })
        })
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Power times surface times the solid angle that is shone on.
fn cost(light: &LightBounds) -> f32 {
    let spread = math::acos(light.facing.cos_spread);
    let reach = (spread + math::acos(light.facing.cos_emission).min(FRAC_PI_2)).min(PI);
    let (sin, cos) = math::sin_cos(spread);
    let solid_angle = TAU * (1.0 - cos)
        + FRAC_PI_2 * (2.0 * reach * sin - math::cos(spread - 2.0 * reach) - 2.0 * spread * sin + cos);
    let e = light.bounds.max - light.bounds.min;
    let area = 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
    light.power * solid_angle * area
}

#[cfg(test)]
mod tests {
    use super::*;
    use radiometry::{SampleStream, StageKey, warp};

    fn lights(n: u32) -> Vec<LightBounds> {
        (0..n)
            .map(|i| {
                let s = SampleStream::new(2, StageKey::new("tree"), 0, i);
                let center = warp::sample_uniform_sphere(s.draw_2d(0, 0)) * (5.0 * s.draw_1d(0, 2));
                let reach = Vec3::splat(0.1 * s.draw_1d(0, 3));
                LightBounds {
                    bounds: Bounds {
                        min: center - reach,
                        max: center + reach,
                    },
                    power: 0.1 + s.draw_1d(0, 4),
                    facing: match i % 3 {
                        0 => Facing::ANYWHERE,
                        kind => Facing {
                            axis: warp::sample_uniform_sphere(s.draw_2d(0, 1)).normalize(),
                            cos_spread: 1.0,
                            cos_emission: 0.0,
                            two_sided: kind == 2,
                        },
                    },
                }
            })
            .collect()
    }

    fn points() -> impl Iterator<Item = Vec3> {
        (0..20).map(|i| {
            let s = SampleStream::new(3, StageKey::new("points"), 0, i);
            warp::sample_uniform_sphere(s.draw_2d(0, 0)) * (8.0 * s.draw_1d(0, 2))
        })
    }

    #[test]
    fn probabilities_are_those_of_sampling() {
        for n in [1, 2, 3, 50, 1000] {
            let lights = lights(n);
            let tree = LightTree::build(&lights);
            for from in points() {
                let sum: f64 = (0..n).map(|i| f64::from(tree.probability(from, i))).sum();
                let (steps, mut chosen) = (1000, 0);
                for k in 0..steps {
                    let u = (f64::from(k) + 0.5) / f64::from(steps);
                    if let Some((light, probability)) = tree.sample(from, u) {
                        assert_eq!(probability, tree.probability(from, light));
                        assert!(probability > 0.0);
                        chosen += 1;
                    }
                }
                // What is left is chosen where a group might shine here, but none of it does.
                assert!((sum - f64::from(chosen) / f64::from(steps)).abs() < 0.02, "{n}: {sum}");
                assert!(sum > 0.8 && sum < 1.001, "{n}: {sum}");
            }
        }
    }

    #[test]
    fn whatever_can_arrive_can_be_chosen() {
        let lights = lights(300);
        let tree = LightTree::build(&lights);
        for from in points() {
            for (i, light) in lights.iter().enumerate() {
                let mut arrives = light.facing.cos_spread < 0.0 || light.facing.two_sided;
                // A corner that sees the front.
                for corner in 0..8 {
                    let pick = |axis: usize| {
                        if corner >> axis & 1 == 0 {
                            light.bounds.min[axis]
                        } else {
                            light.bounds.max[axis]
                        }
                    };
                    let to = from - Vec3::new(pick(0), pick(1), pick(2));
                    arrives |= to.dot(light.facing.axis) > 1e-4;
                }
                assert!(
                    !arrives || tree.probability(from, i as u32) > 0.0,
                    "light {i} from {from}"
                );
            }
        }
    }

    #[test]
    fn lights_in_one_place_are_no_trouble() {
        let one = lights(1)[0];
        let tree = LightTree::build(&vec![one; 5000]);
        let from = Vec3::new(3.0, 9.0, 1.0);
        let p = tree.probability(from, 17);
        assert!((p - 1.0 / 5000.0).abs() < 1e-6, "{p}");
        let none = LightTree::build(&[]);
        assert!(none.sample(from, 0.5).is_none());
    }

    #[test]
    fn near_lights_are_chosen_more_often() {
        let lights = lights(1000);
        let tree = LightTree::build(&lights);
        let anywhere = |light: &&LightBounds| light.facing.cos_spread < 0.0;
        let near = |light: &LightBounds| light.bounds.center() + Vec3::new(0.2, 0.1, 0.05);
        let chosen: Vec<f32> = (0..)
            .zip(&lights)
            .filter(|(_, light)| anywhere(light))
            .map(|(i, light)| tree.probability(near(light), i))
            .collect();
        let mean = chosen.iter().sum::<f32>() / chosen.len() as f32;
        assert!(mean > 5.0 / 1000.0, "{mean}");
    }
}

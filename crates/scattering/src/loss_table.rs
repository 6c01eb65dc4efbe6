use glam::{Vec2, Vec3};
use radiometry::math;
use std::f32::consts::{FRAC_1_PI, TAU};
use std::sync::OnceLock;

/// Losses of single scattering on a grid over (slab, α, angle), with what it takes to sample them.
///
/// Rows are equal steps of α^⅛ from [`LOWEST_ALPHA`] to 1. Within a row the angle is q = √(1 − √(α (1 − μ)/(α + μ))),
/// μ = cosθ: the loss of a nearly smooth surface is a bump at μ ≈ α, which this coordinate spreads out at every α; the
/// outer root resolves the horizon, where losses rise steeply.
///
/// A row is computed when it is first asked for, so the grid may be fine: a scene pays for the surfaces that it has, a
/// millisecond a row. Its values are a function of its place alone, whoever asks first.
pub(crate) struct LossTable {
    alpha_steps: usize,
    angle_steps: usize,
    /// 1 − E by (slab, α, μ).
    loss: Box<dyn Fn(usize, f32, f32) -> f32 + Send + Sync>,
    rows: Box<[OnceLock<Row>]>,
}

type Row = Box<[Node]>;

/// A node of a row, and the cell that begins with it. 12 bytes.
#[derive(Clone, Copy)]
struct Node {
    /// 1 − E.
    loss: f32,
    /// 2 ∫₀ (1 − E(μ)) μ dμ up to the node; of the last one it is 1 − Ē.
    cumulative: f32,
    /// Mean of 1 − E over μ² in the cell.
    mean: f32,
}

/// The first row; smoother surfaces are delta lobes.
const LOWEST_ALPHA: f32 = crate::SMOOTH_ALPHA;

impl LossTable {
    /// A table of `loss(slab, α, μ)`, still empty.
    pub(crate) fn new(
        slabs: usize,
        alpha_steps: usize,
        angle_steps: usize,
        loss: impl Fn(usize, f32, f32) -> f32 + Send + Sync + 'static,
    ) -> Self {
        Self {
            alpha_steps,
            angle_steps,
            loss: Box::new(loss),
            rows: (0..slabs * (alpha_steps + 1)).map(|_| OnceLock::new()).collect(),
        }
    }

    /// Lower index and fraction of a row, and α of the two rows about it.
    #[inline]
    fn locate_alpha(&self, alpha: f32) -> (usize, f32, [f32; 2]) {
        let low = eighth_root(LOWEST_ALPHA);
        let (i, f) = cell((eighth_root(alpha) - low) / (1.0 - low), self.alpha_steps);
        (i, f, [self.alpha_of(i), self.alpha_of(i + 1)])
    }

    #[inline]
    fn alpha_of(&self, alpha_index: usize) -> f32 {
        alpha_of_row(alpha_index as f32 / self.alpha_steps as f32)
    }

    /// The side of a surface of width `alpha`, in a table of one slab.
    #[inline]
    pub(crate) fn of_alpha(&'static self, alpha: f32) -> SideLoss<1> {
        let (i, f, alphas) = self.locate_alpha(alpha);
        let rows = [[(self.row(0, i), 1.0 - f)], [(self.row(0, i + 1), f)]];
        SideLoss { alphas, rows }
    }

    /// The side of a surface of width `alpha`, between two slabs.
    ///
    /// - `slab`: lower index and fraction.
    #[inline]
    pub(crate) fn of_slab_and_alpha(&'static self, (slab, g): (usize, f32), alpha: f32) -> SideLoss<2> {
        let (i, f, alphas) = self.locate_alpha(alpha);
        let pair = |i: usize, share: f32| {
            [
                (self.row(slab, i), (1.0 - g) * share),
                (self.row(slab + 1, i), g * share),
            ]
        };
        let rows = [pair(i, 1.0 - f), pair(i + 1, f)];
        SideLoss { alphas, rows }
    }

    #[inline]
    fn row(&self, slab: usize, alpha_index: usize) -> &[Node] {
        self.rows[slab * (self.alpha_steps + 1) + alpha_index].get_or_init(|| self.compute(slab, alpha_index))
    }

    #[cold]
    fn compute(&self, slab: usize, alpha_index: usize) -> Row {
        let alpha = self.alpha_of(alpha_index);
        let cos = |j: usize| cos_of_angle(j as f32 / self.angle_steps as f32, alpha);
        let node = |j: usize| Node {
            loss: (self.loss)(slab, alpha, cos(j)),
            cumulative: 0.0,
            mean: 0.0,
        };
        let mut row: Row = (0..=self.angle_steps).map(node).collect();
        let mut sum = 0.0;
        for j in 0..self.angle_steps {
            let edges = (
                j as f32 / self.angle_steps as f32,
                (j + 1) as f32 / self.angle_steps as f32,
            );
            let integral = integral_of_cell((row[j].loss, row[j + 1].loss), edges, alpha);
            let (low, high) = (f64::from(cos(j)), f64::from(cos(j + 1)));
            row[j].mean = (integral / ((high - low) * (high + low))) as f32;
            sum += integral;
            row[j + 1].cumulative = sum as f32;
        }
        row
    }
}

#[inline]
pub(crate) fn eighth_root(x: f32) -> f32 {
    x.sqrt().sqrt().sqrt()
}

/// α at a fraction of the rows.
pub(crate) fn alpha_of_row(x: f32) -> f32 {
    let low = eighth_root(LOWEST_ALPHA);
    let root = low + (1.0 - low) * x;
    let squared = root * root;
    let fourth = squared * squared;
    fourth * fourth
}

/// 2 ∫ v(q(μ)) μ dμ over a cell, for v linear in q: midpoints in q.
fn integral_of_cell(ends: (f32, f32), edges: (f32, f32), alpha: f32) -> f64 {
    const STEPS: usize = 32;
    let at = |k: usize| edges.0 + (edges.1 - edges.0) * k as f32 / STEPS as f32;
    (0..STEPS)
        .map(|k| {
            let (low, high) = (cos_of_angle(at(k), alpha), cos_of_angle(at(k + 1), alpha));
            let value = ends.0 + (ends.1 - ends.0) * (k as f32 + 0.5) / STEPS as f32;
            f64::from(value) * f64::from((high - low) * (high + low))
        })
        .sum()
}

/// q = √(1 − √(α (1 − μ)/(α + μ))), rising from 0 to 1 with μ.
#[inline]
fn angle_of_cos(mu: f32, alpha: f32) -> f32 {
    let y = alpha * (1.0 - mu).max(0.0) / (alpha + mu);
    (1.0 - y.sqrt()).max(0.0).sqrt()
}

#[inline]
fn cos_of_angle(q: f32, alpha: f32) -> f32 {
    let root = 1.0 - q * q;
    let y = root * root;
    alpha * (1.0 - y) / (alpha + y)
}

/// Lower node and fraction of x ∈ [0, 1] on `steps` equal steps.
#[inline]
pub(crate) fn cell(x: f32, steps: usize) -> (usize, f32) {
    let x = x.clamp(0.0, 1.0) * steps as f32;
    let i = (x as usize).min(steps - 1);
    (i, x - i as f32)
}

/// What one side of one surface loses, by the angle: a blend of rows of a table, `N` for each of two α.
///
/// Each row is read at its own place of the angle, so that the average of the blend is the blend of averages, exactly.
#[derive(Clone, Copy)]
pub(crate) struct SideLoss<const N: usize> {
    alphas: [f32; 2],
    /// Rows of one length, and the share of each.
    rows: [[(&'static [Node], f32); N]; 2],
}

impl<const N: usize> SideLoss<N> {
    #[inline]
    fn angle_steps(&self) -> usize {
        self.rows[0][0].0.len() - 1
    }

    /// 1 − E(cosθ), and the mean of it over the cells about the angle.
    #[inline]
    fn blend(&self, cos_theta: f32) -> (f32, f32) {
        let steps = self.angle_steps();
        let (mut loss, mut mean) = (0.0, 0.0);
        for (alpha, rows) in self.alphas.iter().zip(&self.rows) {
            let (j, f) = cell(angle_of_cos(cos_theta, *alpha), steps);
            for (row, share) in rows {
                if let [low, high, ..] = &row[j..] {
                    loss += share * (low.loss + f * (high.loss - low.loss));
                    mean += share * low.mean;
                }
            }
        }
        (loss, mean)
    }

    /// 1 − E(cosθ), in [0, 1].
    #[inline]
    pub(crate) fn at(&self, cos_theta: f32) -> f32 {
        self.blend(cos_theta).0
    }

    /// What [`Self::at`] and [`Self::pdf`] say.
    #[inline]
    pub(crate) fn at_and_pdf(&self, cos_theta: f32) -> (f32, f32) {
        let (loss, mean) = self.blend(cos_theta);
        (loss, mean * cos_theta * FRAC_1_PI / self.average())
    }

    /// 1 − Ē = 2 ∫ (1 − E(μ)) μ dμ.
    #[inline]
    pub(crate) fn average(&self) -> f32 {
        let last = self.angle_steps();
        let rows = self.rows.iter().flatten();
        rows.map(|(row, share)| share * row[last].cumulative).sum()
    }

    /// Draws a direction above the surface, nearly in proportion to (1 − E(μ)) μ: a row and a cell by their integrals, then
    /// μ² evenly.
    pub(crate) fn sample(&self, u: Vec2) -> Vec3 {
        let steps = self.angle_steps();
        let (mut chosen, mut alpha, mut target) = (self.rows[0][0].0, self.alphas[0], 0.0);
        let mut rest = u.x * self.average();
        'rows: for (row_alpha, rows) in self.alphas.iter().zip(&self.rows) {
            for (row, share) in rows {
                let part = share * row[steps].cumulative;
                if part > 0.0 {
                    // Rounding may leave a rest at the end: the last row takes it.
                    (chosen, alpha, target) = (*row, *row_alpha, rest / share);
                    if rest < part {
                        break 'rows;
                    }
                    rest -= part;
                }
            }
        }
        let j = chosen.partition_point(|node| node.cumulative <= target).clamp(1, steps) - 1;
        let (before, after) = (chosen[j].cumulative, chosen[j + 1].cumulative);
        let inside = after - before;
        let rest = if inside > 0.0 { (target - before) / inside } else { 0.5 };
        let edge = |j: usize| {
            let cos = cos_of_angle(j as f32 / steps as f32, alpha);
            cos * cos
        };
        let (a, b) = (edge(j), edge(j + 1));
        let cos_sq = (a + (b - a) * rest.clamp(0.0, 1.0)).clamp(0.0, 1.0);
        let (sin, cos) = math::sin_cos(TAU * u.y);
        let sin_theta = (1.0 - cos_sq).sqrt();
        Vec3::new(sin_theta * cos, sin_theta * sin, cos_sq.sqrt())
    }

    /// Density of [`Self::sample`], per solid angle.
    #[inline]
    pub(crate) fn pdf(&self, cos_theta: f32) -> f32 {
        self.at_and_pdf(cos_theta).1
    }
}

use glam::{Vec2, Vec3};
use radiometry::math;
use std::f32::consts::{FRAC_1_PI, TAU};

/// Losses of single scattering on a grid over (slab, α, angle), with what it takes to sample them.
///
/// Rows are equal steps of α^⅛ from [`LOWEST_ALPHA`] to 1. Within a row the angle is q = √(1 − √(α (1 − μ)/(α + μ))),
/// μ = cosθ: the loss of a nearly smooth surface is a bump at μ ≈ α, which this coordinate spreads out at every α; the
/// outer root resolves the horizon, where losses rise steeply.
pub(crate) struct LossTable {
    alpha_steps: usize,
    angle_steps: usize,
    /// 1 − E at the nodes of each row.
    losses: Vec<f32>,
    /// 2 ∫₀ (1 − E(μ)) μ dμ / α² up to the nodes of each row; the last is (1 − Ē)/α². The division leaves a quantity
    /// that varies little from row to row, which blends well.
    cumulative: Vec<f32>,
}

/// The first row; smoother surfaces are delta lobes.
const LOWEST_ALPHA: f32 = crate::SMOOTH_ALPHA;

impl LossTable {
    /// Tabulates `loss(slab, α, μ)`.
    pub(crate) fn build(
        slabs: usize,
        alpha_steps: usize,
        angle_steps: usize,
        loss: impl Fn(usize, f32, f32) -> f32,
    ) -> Self {
        let nodes = slabs * (alpha_steps + 1) * (angle_steps + 1);
        let mut table = Self {
            alpha_steps,
            angle_steps,
            losses: Vec::with_capacity(nodes),
            cumulative: Vec::with_capacity(nodes),
        };
        let edge = |j: usize| j as f32 / angle_steps as f32;
        for slab in 0..slabs {
            for i in 0..=alpha_steps {
                let alpha = alpha_of_row(i as f32 / alpha_steps as f32);
                let first = table.losses.len();
                let row = (0..=angle_steps).map(|j| loss(slab, alpha, cos_of_angle(edge(j), alpha)));
                table.losses.extend(row);
                let mut sum = 0.0;
                table.cumulative.push(0.0);
                for j in 0..angle_steps {
                    let ends = (table.losses[first + j], table.losses[first + j + 1]);
                    sum += integral_of_cell(ends, (edge(j), edge(j + 1)), alpha);
                    table.cumulative.push((sum / f64::from(alpha * alpha)) as f32);
                }
            }
        }
        table
    }

    /// Position of a row: lower index and fraction.
    fn locate_alpha(&self, alpha: f32) -> (usize, f32) {
        let low = eighth_root(LOWEST_ALPHA);
        cell((eighth_root(alpha) - low) / (1.0 - low), self.alpha_steps)
    }

    /// The side of a surface of width `alpha`, in a table of one slab.
    #[inline]
    pub(crate) fn of_alpha(&'static self, alpha: f32) -> SideLoss<2> {
        let (i, f) = self.locate_alpha(alpha);
        SideLoss {
            table: self,
            alpha,
            rows: [(self.row(0, i), 1.0 - f), (self.row(0, i + 1), f)],
        }
    }

    /// The side of a surface of width `alpha`, between two slabs.
    ///
    /// - `slab`: lower index and fraction.
    #[inline]
    pub(crate) fn of_slab_and_alpha(&'static self, (slab, g): (usize, f32), alpha: f32) -> SideLoss<4> {
        let (i, f) = self.locate_alpha(alpha);
        SideLoss {
            table: self,
            alpha,
            rows: [
                (self.row(slab, i), (1.0 - g) * (1.0 - f)),
                (self.row(slab, i + 1), (1.0 - g) * f),
                (self.row(slab + 1, i), g * (1.0 - f)),
                (self.row(slab + 1, i + 1), g * f),
            ],
        }
    }

    /// Index of the first node of a row.
    fn row(&self, slab: usize, alpha_index: usize) -> usize {
        (slab * (self.alpha_steps + 1) + alpha_index) * (self.angle_steps + 1)
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

/// What one side of one surface loses, by the angle: a blend of `N` rows of a table.
#[derive(Clone, Copy)]
pub(crate) struct SideLoss<const N: usize> {
    table: &'static LossTable,
    alpha: f32,
    /// First node of each row, and its share.
    rows: [(usize, f32); N],
}

impl<const N: usize> SideLoss<N> {
    #[inline]
    fn blend(&self, values: &[f32], node: usize) -> f32 {
        self.rows.iter().map(|(row, share)| share * values[row + node]).sum()
    }

    /// 1 − E(cosθ), in [0, 1].
    #[inline]
    pub(crate) fn at(&self, cos_theta: f32) -> f32 {
        let (j, f) = cell(angle_of_cos(cos_theta, self.alpha), self.table.angle_steps);
        let low = self.blend(&self.table.losses, j);
        let high = self.blend(&self.table.losses, j + 1);
        low + f * (high - low)
    }

    /// 1 − Ē = 2 ∫ (1 − E(μ)) μ dμ.
    #[inline]
    pub(crate) fn average(&self) -> f32 {
        self.alpha * self.alpha * self.scaled_average()
    }

    #[inline]
    fn scaled_average(&self) -> f32 {
        self.blend(&self.table.cumulative, self.table.angle_steps)
    }

    /// μ² at both ends of a cell.
    #[inline]
    fn squared_edges(&self, j: usize) -> (f32, f32) {
        let scale = 1.0 / self.table.angle_steps as f32;
        let low = cos_of_angle(j as f32 * scale, self.alpha);
        let high = cos_of_angle((j + 1) as f32 * scale, self.alpha);
        (low * low, high * high)
    }

    /// Draws a direction above the surface, nearly in proportion to (1 − E(μ)) μ: a cell by its integral, then μ² evenly.
    pub(crate) fn sample(&self, u: Vec2) -> Vec3 {
        let target = u.x * self.scaled_average();
        let (mut low, mut high) = (0, self.table.angle_steps);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if self.blend(&self.table.cumulative, middle) <= target {
                low = middle;
            } else {
                high = middle;
            }
        }
        let before = self.blend(&self.table.cumulative, low);
        let inside = self.blend(&self.table.cumulative, high) - before;
        let rest = if inside > 0.0 { (target - before) / inside } else { 0.5 };
        let (a, b) = self.squared_edges(low);
        let cos_sq = (a + (b - a) * rest.clamp(0.0, 1.0)).clamp(0.0, 1.0);
        let (sin, cos) = math::sin_cos(TAU * u.y);
        let sin_theta = (1.0 - cos_sq).sqrt();
        Vec3::new(sin_theta * cos, sin_theta * sin, cos_sq.sqrt())
    }

    /// Density of [`Self::sample`], per solid angle.
    #[inline]
    pub(crate) fn pdf(&self, cos_theta: f32) -> f32 {
        let (j, _) = cell(angle_of_cos(cos_theta, self.alpha), self.table.angle_steps);
        let (a, b) = self.squared_edges(j);
        let inside = self.blend(&self.table.cumulative, j + 1) - self.blend(&self.table.cumulative, j);
        inside / (self.scaled_average() * (b - a)) * cos_theta * FRAC_1_PI
    }
}

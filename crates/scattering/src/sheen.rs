use crate::loss_table::cell;
use glam::Vec3;
use radiometry::math;
use std::f32::consts::{FRAC_1_PI, TAU};
use std::sync::LazyLock;

/// The soft shine of cloth towards its edges: a distribution of fibres that stand up.
///
/// `f = D(h)/(4 (cosθ_o + cosθ_i − cosθ_o cosθ_i))`, `D(h) = (2 + 1/α) sin(θ_h)^(1/α)/(2π)`
///
/// Source: Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", SIGGRAPH course 2017, with the visibility of
/// Neubelt and Pettineo 2013, as in `KHR_materials_sheen`. Differs: where the lobe would return more than all light it is
/// scaled down by a constant, so it stays reciprocal.
#[derive(Clone, Copy)]
pub(crate) struct Sheen {
    inverse_alpha: f32,
    row: (usize, f32),
    scale: f32,
}

/// The least roughness: below it the lobe is a spike at the horizon.
const LOWEST_ROUGHNESS: f32 = 0.1;
const ROUGHNESS_STEPS: usize = 24;
const ANGLE_STEPS: usize = 24;

impl Sheen {
    /// - `roughness`: α is its square; clamped to [0.1, 1].
    pub(crate) fn new(roughness: f32) -> Self {
        let roughness = if roughness >= LOWEST_ROUGHNESS {
            roughness.min(1.0)
        } else {
            LOWEST_ROUGHNESS
        };
        let row = cell(
            (roughness - LOWEST_ROUGHNESS) / (1.0 - LOWEST_ROUGHNESS),
            ROUGHNESS_STEPS,
        );
        let scales = &TABLE.scales;
        Self {
            inverse_alpha: 1.0 / (roughness * roughness),
            row,
            scale: scales[row.0] * (1.0 - row.1) + scales[row.0 + 1] * row.1,
        }
    }

    /// f of two directions on one side, without colour.
    pub(crate) fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.scale * unscaled(self.inverse_alpha, wo, wi)
    }

    /// Directional albedo without colour: `∫ f cosθ_i dω_i`, in [0, 1].
    pub(crate) fn albedo(&self, cos_theta: f32) -> f32 {
        let (j, g) = cell(cos_theta.clamp(0.0, 1.0).sqrt(), ANGLE_STEPS);
        let (i, f) = self.row;
        let at = |row: usize| {
            let first = row * (ANGLE_STEPS + 1) + j;
            TABLE.albedos[first] * (1.0 - g) + TABLE.albedos[first + 1] * g
        };
        (self.scale * (at(i) * (1.0 - f) + at(i + 1) * f)).min(1.0)
    }
}

fn unscaled(inverse_alpha: f32, wo: Vec3, wi: Vec3) -> f32 {
    let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
    let sum = cos_o + cos_i - cos_o * cos_i;
    if sum <= 0.0 {
        return 0.0;
    }
    let h = (wo + wi).normalize_or(Vec3::Z);
    let sin_h = (h.x * h.x + h.y * h.y).min(1.0).sqrt();
    (2.0 + inverse_alpha) * math::powf(sin_h, inverse_alpha) * (0.125 * FRAC_1_PI) / sum
}

/// Albedos of the unscaled lobe on a grid over (roughness, √μ), and the scale of each roughness.
struct SheenTable {
    albedos: Vec<f32>,
    scales: Vec<f32>,
}

static TABLE: LazyLock<SheenTable> = LazyLock::new(|| {
    let mut table = SheenTable {
        albedos: Vec::new(),
        scales: Vec::new(),
    };
    for i in 0..=ROUGHNESS_STEPS {
        let roughness = LOWEST_ROUGHNESS + (1.0 - LOWEST_ROUGHNESS) * i as f32 / ROUGHNESS_STEPS as f32;
        let inverse_alpha = 1.0 / (roughness * roughness);
        let row = (0..=ANGLE_STEPS).map(|j| {
            let root = j as f32 / ANGLE_STEPS as f32;
            integrate(inverse_alpha, root * root)
        });
        let row: Vec<f32> = row.collect();
        table.scales.push(1.0 / row.iter().copied().fold(1.0, f32::max));
        table.albedos.extend(row);
    }
    table
});

/// `∫ f cosθ_i dω_i` by midpoints in azimuth and in √cosθ, which resolves the horizon.
fn integrate(inverse_alpha: f32, cos_o: f32) -> f32 {
    const AZIMUTHS: usize = 24;
    const HEIGHTS: usize = 40;
    let wo = Vec3::new(((1.0 - cos_o) * (1.0 + cos_o)).max(0.0).sqrt(), 0.0, cos_o);
    let mut sum = 0.0_f64;
    for a in 0..AZIMUTHS {
        let (sin, cos) = math::sin_cos(0.5 * TAU * (a as f32 + 0.5) / AZIMUTHS as f32);
        for b in 0..HEIGHTS {
            let root = (b as f32 + 0.5) / HEIGHTS as f32;
            let cos_i = root * root;
            let sin_i = (1.0 - cos_i * cos_i).sqrt();
            let wi = Vec3::new(sin_i * cos, sin_i * sin, cos_i);
            sum += f64::from(unscaled(inverse_alpha, wo, wi) * cos_i * 2.0 * root);
        }
    }
    (sum * f64::from(TAU) / (AZIMUTHS * HEIGHTS) as f64) as f32
}

use super::{Hemisphere, HemisphereSample};
use glam::Vec3;
use radiometry::{Rgb, math};
use std::f32::consts::TAU;

/// Strata of the hemisphere that are joined in each direction before they are compared.
///
/// Derivatives by place are made of differences between neighbours, each of them as important as the irradiance itself, so
/// finer cells have more noise: joining B by B takes it to one B-th. Coarse cells blur where things begin and end.
const JOINED: u32 = 3;

/// A run of strata along one coordinate of the hemisphere that is looked at as one.
#[derive(Clone, Copy)]
pub(super) struct Run {
    pub(super) first: u32,
    pub(super) end: u32,
}

impl Run {
    /// Cuts `count` strata into runs of about [`JOINED`].
    fn cut(count: u32) -> Vec<Self> {
        let number = (count / JOINED).max(1);
        let border = |i: u32| i * count / number;
        let run = |i: u32| Self {
            first: border(i),
            end: border(i + 1),
        };
        (0..number).map(run).collect()
    }
}

/// Strata that are looked at as one.
#[derive(Clone, Copy)]
pub(super) struct Joined {
    /// Mean radiance.
    pub(super) light: Rgb,
    /// Mean of one over the distance.
    pub(super) near: f32,
    /// Of the mean of the channels of `light`.
    pub(super) variance: f32,
}

/// A hemisphere whose strata were joined.
pub(super) struct Strata {
    hemisphere: Hemisphere,
    pub(super) along_theta: Vec<Run>,
    pub(super) along_phi: Vec<Run>,
    /// Ring by ring.
    pub(super) cells: Vec<Joined>,
}

impl Strata {
    /// - `samples`: ring by ring.
    pub(super) fn new(hemisphere: &Hemisphere, samples: &[HemisphereSample]) -> Self {
        let (along_theta, along_phi) = (Run::cut(hemisphere.rings()), Run::cut(hemisphere.cells()));
        let pairs = along_theta
            .iter()
            .flat_map(|ring| along_phi.iter().map(|cell| (*ring, *cell)));
        let cells = pairs
            .map(|(ring, cell)| Joined::new(ring, cell, hemisphere.cells(), samples))
            .collect();
        Self {
            hemisphere: *hemisphere,
            along_theta,
            along_phi,
            cells,
        }
    }

    /// Rings of joined strata.
    pub(super) fn rings(&self) -> usize {
        self.along_theta.len()
    }

    /// Joined strata of a ring.
    pub(super) fn columns(&self) -> usize {
        self.along_phi.len()
    }

    /// Place in [`Strata::cells`].
    pub(super) fn index(&self, ring: usize, column: usize) -> usize {
        ring * self.along_phi.len() + column
    }

    pub(super) fn cell(&self, ring: usize, column: usize) -> &Joined {
        &self.cells[self.index(ring, column)]
    }

    /// Direction of the middle of joined strata, in the frame of the normal.
    pub(super) fn middle(&self, ring: usize, column: usize) -> Vec3 {
        let middle = |run: Run, count: u32| 0.5 * (run.first + run.end) as f32 / count as f32;
        let sin_sq = middle(self.along_theta[ring], self.hemisphere.rings());
        let (sin_phi, cos_phi) = math::sin_cos(TAU * middle(self.along_phi[column], self.hemisphere.cells()));
        let sin = sin_sq.sqrt();
        Vec3::new(sin * cos_phi, sin * sin_phi, (1.0 - sin_sq).max(0.0).sqrt())
    }
}

impl Joined {
    fn new(ring: Run, cell: Run, cells: u32, samples: &[HemisphereSample]) -> Self {
        let strata = || {
            let row = |t: u32| &samples[(t * cells + cell.first) as usize..(t * cells + cell.end) as usize];
            (ring.first..ring.end).flat_map(row)
        };
        let count = ((ring.end - ring.first) * (cell.end - cell.first)) as f32;
        let light = strata().map(|sample| sample.radiance).sum::<Rgb>() * (1.0 / count);
        let near = strata().map(|sample| sample.inverse_distance).sum::<f32>() / count;
        let mean = light.mean();
        let deviation = |sample: &HemisphereSample| (sample.radiance.mean() - mean) * (sample.radiance.mean() - mean);
        Self {
            light,
            near,
            variance: strata().map(deviation).sum::<f32>() / (count * (count - 1.0).max(1.0)),
        }
    }
}

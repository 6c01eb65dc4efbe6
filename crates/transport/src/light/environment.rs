use glam::{Mat3, Vec2, Vec3};
use radiometry::{Distribution, Rgb, math, warp};
use std::f32::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

/// Light from all directions in which there is nothing else.
#[derive(Clone, Debug)]
pub struct Environment {
    /// W·m⁻²·sr⁻¹ without a map, else a factor for what the map says.
    pub radiance: Rgb,
    /// What comes from where.
    pub map: Option<Arc<EnvironmentMap>>,
    /// Rotation that takes a direction of the world to one of the map.
    pub map_from_world: Mat3,
}

impl Environment {
    /// The same radiance from everywhere.
    #[must_use]
    pub fn uniform(radiance: Rgb) -> Self {
        Self {
            radiance,
            map: None,
            map_from_world: Mat3::IDENTITY,
        }
    }

    /// Radiance that arrives from a unit direction, looking that way.
    #[inline]
    #[must_use]
    pub fn radiance_from(&self, direction: Vec3) -> Rgb {
        match &self.map {
            None => self.radiance,
            Some(map) => self.radiance * map.radiance_from(self.map_from_world * direction),
        }
    }

    /// Radiance that arrives from all directions together, ∫ L dω in W·m⁻².
    #[must_use]
    pub fn fluence(&self) -> Rgb {
        match &self.map {
            None => self.radiance * (2.0 * TAU),
            Some(map) => self.radiance * map.fluence,
        }
    }

    /// Bounds the radiance that arrives from anywhere, in any channel.
    pub(super) fn brightest(&self) -> f32 {
        let texels = self.map.iter().flat_map(|map| &map.texels);
        let largest = texels.map(|texel| texel.max_element()).reduce(f32::max);
        self.radiance.max_element() * largest.unwrap_or(1.0)
    }

    /// Chooses a direction roughly in proportion to radiance; returns it with its density per solid angle.
    #[inline]
    pub(crate) fn sample(&self, u: Vec2) -> (Vec3, f32) {
        match &self.map {
            None => (warp::sample_uniform_sphere(u), warp::PDF_UNIFORM_SPHERE),
            Some(map) => {
                let (direction, pdf) = map.sample(u);
                ((self.map_from_world.transpose() * direction).normalize(), pdf)
            }
        }
    }

    /// Density per solid angle of [`Environment::sample`].
    #[inline]
    pub(crate) fn pdf(&self, direction: Vec3) -> f32 {
        match &self.map {
            None => warp::PDF_UNIFORM_SPHERE,
            Some(map) => map.pdf(self.map_from_world * direction),
        }
    }
}

/// A picture of everything around, by latitude and longitude, with what it takes to sample it.
///
/// A direction (x, y, z) is at u = atan2(x, −z)/2π mod 1 from the left, v = acos(y)/π from the top. Between the centres of
/// texels radiance is interpolated linearly, around the seam and over the poles too.
///
/// Cells are chosen by the mean radiance of the interpolation times their solid angle, and directions evenly within one.
#[derive(Debug)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    /// Rows from the top.
    texels: Vec<Rgb>,
    /// Grid of cells that directions are chosen from; at most [`MOST_CELLS`] wide.
    columns: usize,
    rows: usize,
    by_row: Distribution,
    by_column: Vec<Distribution>,
    /// ∫ L dω in W·m⁻².
    fluence: Rgb,
}

/// Cells along a circle of latitude; larger maps have several texels to a cell.
const MOST_CELLS: usize = 2048;

impl EnvironmentMap {
    /// - `texels`: `width · height`, rows from the top, each finite and not negative. W·m⁻²·sr⁻¹.
    ///
    /// # Panics
    /// When the number of texels is another, or zero.
    #[must_use]
    pub fn new(width: usize, height: usize, texels: Vec<Rgb>) -> Self {
        assert!(
            width > 0 && height > 0 && texels.len() == width * height,
            "a map has width · height texels"
        );
        let mut map = Self {
            width,
            height,
            texels,
            columns: width.min(MOST_CELLS),
            rows: height.min(MOST_CELLS / 2),
            by_row: Distribution::default(),
            by_column: Vec::new(),
            fluence: Rgb::BLACK,
        };
        let mut weights = Vec::with_capacity(map.rows);
        let mut fluence = [0.0_f64; 3];
        for row in 0..map.rows {
            let solid_angle = f64::from(map.solid_angle_of_row(row)) / map.columns as f64;
            let means: Vec<Rgb> = (0..map.columns).map(|column| map.mean_of_cell(column, row)).collect();
            for mean in &means {
                for (sum, value) in fluence.iter_mut().zip(mean.to_array()) {
                    *sum += f64::from(value) * solid_angle;
                }
            }
            let cells = Distribution::new(means.iter().map(|mean| f64::from(mean.mean())));
            weights.push(cells.total() * solid_angle);
            map.by_column.push(cells);
        }
        map.by_row = Distribution::new(weights);
        let [r, g, b] = fluence.map(|sum| sum as f32);
        map.fluence = Rgb::new(r, g, b);
        map
    }

    fn solid_angle_of_row(&self, row: usize) -> f32 {
        let (top, bottom) = self.cosines_of_row(row);
        TAU * (top - bottom)
    }

    /// Cosines of the polar angles of the upper and lower edge of a row of cells.
    fn cosines_of_row(&self, row: usize) -> (f32, f32) {
        let cos = |edge: usize| match edge {
            0 => 1.0,
            edge if edge == self.rows => -1.0,
            edge => math::cos(PI * edge as f32 / self.rows as f32),
        };
        (cos(row), cos(row + 1))
    }

    /// Mean of the interpolated radiance over a cell, but for the change of solid angle within it.
    fn mean_of_cell(&self, column: usize, row: usize) -> Rgb {
        // Interpolation gives a texel an eighth of each neighbour in each direction.
        const TENT: [f32; 3] = [0.125, 0.75, 0.125];
        let first = |index: usize, cells: usize, texels: usize| index * texels / cells;
        let (x0, x1) = (
            first(column, self.columns, self.width),
            first(column + 1, self.columns, self.width).max(first(column, self.columns, self.width) + 1),
        );
        let (y0, y1) = (
            first(row, self.rows, self.height),
            first(row + 1, self.rows, self.height).max(first(row, self.rows, self.height) + 1),
        );
        let mut sum = Rgb::BLACK;
        for y in y0..y1 {
            for x in x0..x1 {
                for (dy, wy) in TENT.iter().enumerate() {
                    for (dx, wx) in TENT.iter().enumerate() {
                        sum += self.texel(x as i64 + dx as i64 - 1, y as i64 + dy as i64 - 1) * (wx * wy);
                    }
                }
            }
        }
        sum * (1.0 / ((x1 - x0) * (y1 - y0)) as f32)
    }

    /// A texel, around the seam, and beyond a pole the one on the other side.
    #[inline]
    fn texel(&self, x: i64, y: i64) -> Rgb {
        let (width, height) = (self.width as i64, self.height as i64);
        let (x, y) = if y < 0 {
            (x + width / 2, -1 - y)
        } else if y >= height {
            (x + width / 2, 2 * height - 1 - y)
        } else {
            (x, y)
        };
        let y = y.clamp(0, height - 1);
        self.texels[y as usize * self.width + x.rem_euclid(width) as usize]
    }

    /// Interpolated radiance from a unit direction of the map.
    #[inline]
    fn radiance_from(&self, direction: Vec3) -> Rgb {
        let uv = lat_long(direction);
        let (x, y) = (uv.x * self.width as f32 - 0.5, uv.y * self.height as f32 - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let (x0, y0) = (x0 as i64, y0 as i64);
        let row = |y: i64| self.texel(x0, y) * (1.0 - fx) + self.texel(x0 + 1, y) * fx;
        row(y0) * (1.0 - fy) + row(y0 + 1) * fy
    }

    fn sample(&self, u: Vec2) -> (Vec3, f32) {
        let Some((row, row_probability, rest_y)) = self.by_row.sample(u.y) else {
            return (warp::sample_uniform_sphere(u), warp::PDF_UNIFORM_SPHERE);
        };
        let (column, probability, rest_x) = self.by_column[row].sample(u.x).unwrap_or((0, 1.0, u.x));
        let (top, bottom) = self.cosines_of_row(row);
        let y = top + (bottom - top) * rest_y;
        let (sin, cos) = math::sin_cos(TAU * (column as f32 + rest_x) / self.columns as f32);
        let r = ((1.0 - y) * (1.0 + y)).max(0.0).sqrt();
        let direction = Vec3::new(r * sin, y, -r * cos);
        (direction, self.density(row, row_probability * probability))
    }

    fn density(&self, row: usize, probability: f32) -> f32 {
        probability * self.columns as f32 / self.solid_angle_of_row(row)
    }

    fn pdf(&self, direction: Vec3) -> f32 {
        if self.by_row.is_empty() {
            return warp::PDF_UNIFORM_SPHERE;
        }
        let uv = lat_long(direction);
        let column = ((uv.x * self.columns as f32) as usize).min(self.columns - 1);
        let row = ((uv.y * self.rows as f32) as usize).min(self.rows - 1);
        self.density(
            row,
            self.by_row.probability(row) * self.by_column[row].probability(column),
        )
    }
}

/// Where a unit direction is in the picture: from the left and from the top, each in [0, 1].
#[inline]
fn lat_long(direction: Vec3) -> Vec2 {
    let turn = math::atan2(direction.x, -direction.z) * (0.5 * FRAC_1_PI);
    let u = if turn < 0.0 { turn + 1.0 } else { turn };
    Vec2::new(u, math::acos(direction.y.clamp(-1.0, 1.0)) * FRAC_1_PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use radiometry::{SampleStream, StageKey};

    fn map(width: usize, height: usize, f: impl Fn(usize, usize) -> f32) -> EnvironmentMap {
        let texels = (0..width * height).map(|i| Rgb::splat(f(i % width, i / width)));
        EnvironmentMap::new(width, height, texels.collect())
    }

    /// Dark but for a gradient and a sun of one texel.
    fn sky() -> EnvironmentMap {
        map(64, 32, |x, y| {
            if (x, y) == (40, 6) {
                5000.0
            } else {
                0.01 * (y + x) as f32
            }
        })
    }

    #[test]
    fn corners_of_the_picture_are_where_they_should_be() {
        let at = |x: f32, y: f32, z: f32| lat_long(Vec3::new(x, y, z));
        assert!((at(0.0, 0.0, -1.0) - Vec2::new(0.0, 0.5)).length() < 1e-6);
        assert!((at(1.0, 0.0, 0.0) - Vec2::new(0.25, 0.5)).length() < 1e-6);
        assert!((at(0.0, 0.0, 1.0) - Vec2::new(0.5, 0.5)).length() < 1e-6);
        assert!((at(-1.0, 0.0, 0.0) - Vec2::new(0.75, 0.5)).length() < 1e-6);
        assert!(at(0.0, 1.0, 0.0).y < 1e-6 && at(0.0, -1.0, 0.0).y > 1.0 - 1e-6);
        // A texel is seen at its centre.
        let one = map(8, 4, |x, y| if (x, y) == (2, 1) { 3.0 } else { 0.0 });
        let (phi, theta) = (TAU * 2.5 / 8.0, PI * 1.5 / 4.0);
        let direction = Vec3::new(
            math::sin(theta) * math::sin(phi),
            math::cos(theta),
            -math::sin(theta) * math::cos(phi),
        );
        assert!((one.radiance_from(direction).r - 3.0).abs() < 1e-4);
    }

    #[test]
    fn sampling_has_the_density_it_says_and_finds_all_light() {
        let sky = sky();
        let (n, mut sum) = (1 << 16, 0.0_f64);
        let mut counts = vec![0_u32; 32 * 16];
        for i in 0..n {
            let u = SampleStream::new(4, StageKey::new("sky"), 0, i).draw_2d(0, 0);
            let (direction, pdf) = sky.sample(u);
            assert!((direction.length() - 1.0).abs() < 1e-5);
            assert!((sky.pdf(direction) - pdf).abs() <= 1e-3 * pdf, "{direction}");
            sum += f64::from(sky.radiance_from(direction).r / pdf);
            let uv = lat_long(direction);
            counts[(uv.y * 16.0).min(15.0) as usize * 32 + (uv.x * 32.0).min(31.0) as usize] += 1;
        }
        // The fluence by uniform directions.
        let mut uniform = 0.0_f64;
        let m = 1 << 20;
        for i in 0..m {
            let u = SampleStream::new(5, StageKey::new("sky"), 0, i).draw_2d(0, 0);
            uniform += f64::from(sky.radiance_from(warp::sample_uniform_sphere(u).normalize()).r);
        }
        let uniform = uniform / f64::from(m) * f64::from(2.0 * TAU);
        let found = sum / f64::from(n);
        assert!((found - uniform).abs() < 0.01 * uniform, "{found} {uniform}");
        assert!((f64::from(sky.fluence.r) - uniform).abs() < 0.01 * uniform);
        // Chi-square over blocks of the sphere against the integrated density.
        let mut chi_square = 0.0;
        let mut cells = 0;
        for (cell, count) in counts.iter().enumerate() {
            let (row, column) = (cell / 32, cell % 32);
            let mass: f64 = [(0, 0), (0, 1), (1, 0), (1, 1)]
                .into_iter()
                .map(|(y, x)| {
                    let (y, x) = (2 * row + y, 2 * column + x);
                    f64::from(sky.by_row.probability(y) * sky.by_column[y].probability(x))
                })
                .sum();
            let expected = mass * f64::from(n);
            if expected > 5.0 {
                chi_square += (f64::from(*count) - expected).powi(2) / expected;
                cells += 1;
            }
        }
        // Stratified samples fluctuate less than independent ones, never more.
        assert!(chi_square < f64::from(cells) + 4.0 * (2.0 * f64::from(cells)).sqrt());
    }

    #[test]
    fn a_uniform_map_is_a_uniform_environment() {
        for (width, height) in [(1, 1), (3, 2), (5000, 1)] {
            let even = map(width, height, |_, _| 2.0);
            assert!((even.fluence.g - 4.0 * TAU).abs() < 1e-3 * even.fluence.g, "{width}");
            for u in [Vec2::new(0.1, 0.9), Vec2::new(0.99, 0.01)] {
                let (direction, pdf) = even.sample(u);
                assert!((pdf - warp::PDF_UNIFORM_SPHERE).abs() < 1e-4 * pdf);
                assert!((even.radiance_from(direction).r - 2.0).abs() < 1e-5);
            }
        }
        // A black one can be asked for all the same.
        let black = map(4, 2, |_, _| 0.0);
        assert!(black.sample(Vec2::splat(0.3)).1 > 0.0 && black.pdf(Vec3::X) > 0.0);
    }
}

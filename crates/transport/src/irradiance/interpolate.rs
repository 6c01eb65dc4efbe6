use super::{CacheSettings, IrradianceCache, IrradianceRecord};
use glam::Vec3;
use radiometry::Rgb;
use std::f32::consts::FRAC_1_PI;

/// How far a place may lie before or behind the plane of a record, in radii within which it holds.
const FRONT_TOLERANCE: f32 = 0.1;

/// Rays may have missed what is nearest; up to this share of the nearest that they met there is nothing.
const CLEAR_SHARE: f32 = 0.5;

/// ε/a at the record itself, so that the weight of the plain form is finite there.
const LEAST_ERROR: f32 = 0.01;

/// What records tell of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolated {
    /// E of indirect light, W·m⁻², no channel negative.
    pub irradiance: Rgb,
    /// How many records there are on each square metre around, m⁻²: `Σ_j 1/(π R_j²)` over those that count, `R_j` the distance
    /// within which they do. Each is spread evenly over the disc that it tells of, so over a flat surface it adds up to their
    /// number. Source: kernels by sample point (Breiman, Meisel and Purcell, 1977).
    pub record_density: f32,
    /// Mean distance of the records, weighted as their light: what is smaller is blurred, metres.
    pub blur: f32,
}

impl IrradianceCache {
    /// True when a record tells enough of a place that no other is needed.
    ///
    /// - `normal`: unit, on the side that light comes from.
    /// - `sees`: whether nothing stands between the place and a record; asked only of records with something near them.
    #[must_use]
    pub fn covers(&self, position: Vec3, normal: Vec3, sees: impl Fn(&IrradianceRecord) -> bool) -> bool {
        let CacheSettings {
            min_weight, validity, ..
        } = self.settings;
        let candidates = self.octree.candidates(position);
        candidates.map(|row| &self.records[row as usize]).any(|record| {
            let radius = record.effective_range() / min_weight;
            error_at(record, (position, normal), radius, min_weight, validity).is_some()
                && (!validity || record.is_clear(position) || sees(record))
        })
    }

    /// Interpolates the irradiance at a place between the records that hold there; `None` where none does.
    ///
    /// `E(x) = Σ w_j (E_j + (n_j × n)·∇_r E_j + t_j (x − x_j)·∇_t E_j)/Σ w_j`, over records with
    /// `ε_j/a = |x − x_j|/R_j + √(1 − n·n_j)/a < 1` whose plane the place lies in, 1/a = [`CacheSettings::read_weight`] and
    /// `R_j` = [`CacheSettings::read_radius`]. `w_j = √t_j (1 − (ε_j/a)²)²`, without gradients `1/ε_j − 1/a`. Both fall to zero
    /// where a record ends, so that its end does not show.
    ///
    /// `t_j` is one, or less where the range was widened to the least: how much of it was found. At a contact such a record is
    /// too dark for most of what it covers, and more are made there than further out. Above the skirting of `interior.ron` at
    /// 640×400 the first row of pixels is too dark by 2.5 % without the factor, right by 0.1 % with the root, and by the whole
    /// share too bright by 1.4 %.
    ///
    /// Source: Ward, Rubinstein and Clear 1988; Ward and Heckbert 1992. Differs: a weight that is smooth at the record as
    /// well, so that the noise of no single record shows (a cone: Tabellion and Lamorlette, SIGGRAPH 2004).
    ///
    /// - `normal`, `sees`: as for [`IrradianceCache::covers`].
    #[inline]
    #[must_use]
    pub fn interpolate(
        &self,
        position: Vec3,
        normal: Vec3,
        sees: impl Fn(&IrradianceRecord) -> bool,
    ) -> Option<Interpolated> {
        let CacheSettings {
            gradients, validity, ..
        } = self.settings;
        let min_weight = self.settings.read_weight();
        let records = self.octree.candidates(position).map(|row| &self.records[row as usize]);
        let (mut sum, mut weights, mut record_density, mut distances) = (Rgb::BLACK, 0.0, 0.0, 0.0);
        for record in records {
            let radius = self.settings.read_radius(record);
            let Some(error) = error_at(record, (position, normal), radius, min_weight, validity) else {
                continue;
            };
            if validity && !record.is_clear(position) && !sees(record) {
                continue;
            }
            let (value, weight) = if gradients {
                let rest = 1.0 - error * error;
                let value = record.extrapolate(position, normal);
                (value, rest * rest * record.trust().sqrt())
            } else {
                (record.irradiance, 1.0 / error.max(LEAST_ERROR) - 1.0)
            };
            sum += value * weight;
            weights += weight;
            distances += weight * position.distance(record.position);
            record_density += FRAC_1_PI / (radius * radius);
        }
        (weights > 0.0).then(|| Interpolated {
            irradiance: (sum * (1.0 / weights)).map(|channel| channel.max(0.0)),
            record_density,
            blur: distances / weights,
        })
    }
}

/// ε/a of a record at a place with its normal, in [0, 1); `None` where the record does not hold.
///
/// - `radius`: within which it holds, metres.
/// - `min_weight`: 1/a of turned normals, ≥ 1.
/// - `in_plane`: whether the place has to lie in the plane of the record.
#[inline]
fn error_at(
    record: &IrradianceRecord,
    (position, normal): (Vec3, Vec3),
    radius: f32,
    min_weight: f32,
    in_plane: bool,
) -> Option<f32> {
    let step = position - record.position;
    let distance_sq = step.length_squared();
    if distance_sq >= radius * radius {
        return None;
    }
    let turned = (1.0 - normal.dot(record.normal)).max(0.0).sqrt();
    let error = distance_sq.sqrt() / radius + turned * min_weight;
    let height = 0.5 * step.dot(normal + record.normal);
    let tolerance = FRONT_TOLERANCE * radius + 4.0 * f32::EPSILON * position.abs().max_element();
    (error < 1.0 && (!in_plane || height.abs() <= tolerance)).then_some(error)
}

impl IrradianceRecord {
    /// True where nothing can stand between the record and a place, by what its rays have met.
    #[inline]
    fn is_clear(&self, position: Vec3) -> bool {
        let clear = CLEAR_SHARE * self.nearest;
        self.position.distance_squared(position) < clear * clear
    }

    /// How much of the range that counts was found; below one where it is widened to the least.
    #[inline]
    fn trust(&self) -> f32 {
        (self.range / self.effective_range()).min(1.0)
    }

    /// E at another place and normal, linear.
    #[inline]
    fn extrapolate(&self, position: Vec3, normal: Vec3) -> Rgb {
        // Where the range is widened, a linear change would end too early.
        let turned = self.rotation.along(self.normal.cross(normal));
        let moved = self.translation.along((position - self.position) * self.trust());
        (self.irradiance + turned + moved).map(|channel| channel.max(0.0))
    }
}

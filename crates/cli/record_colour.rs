//! What colour a record is shown in.

use crate::args::RecordColour;
use crate::point_colour::{at_share, ramp, shown, white};
use crate::point_picture::Point;
use pipeline_data::IrradianceRecord;
use radiometry::math;

/// Of the records by irradiance, the one at this place is shown at full brightness: lower than for photons, since each is
/// there to be seen, and the brightest lie in few places.
const WHITE_SHARE: f64 = 0.9;

/// Shares of the records, by range, at the ends of the ramp.
const ENDS: [f64; 2] = [0.01, 0.99];

/// Display colours of records.
pub(crate) struct Colours {
    by: RecordColour,
    /// Irradiance of the largest channel, in W·m⁻², that is shown at full brightness.
    white: f32,
    /// Logarithms of the ranges, in metres, at the ends of the ramp.
    ends: [f32; 2],
    count: f32,
}

impl Colours {
    pub(crate) fn new(by: RecordColour, records: &[IrradianceRecord]) -> Self {
        let irradiance = records.iter().map(|entity| entity.record.irradiance.max_element());
        let ranges: Vec<f32> = records.iter().map(log_range).collect();
        Self {
            by,
            white: white(irradiance.collect(), WHITE_SHARE),
            ends: ENDS.map(|share| at_share(ranges.clone(), share).unwrap_or(0.0)),
            count: records.len() as f32,
        }
    }

    /// The record as a point to draw.
    pub(crate) fn point(&self, entity: &IrradianceRecord) -> Point {
        let [nearest, furthest] = self.ends;
        let colour = match self.by {
            RecordColour::Irradiance => shown(entity.record.irradiance.to_array(), self.white),
            RecordColour::Range => ramp((log_range(entity) - nearest) / (furthest - nearest).max(f32::EPSILON)),
            RecordColour::Number => ramp(entity.number as f32 / self.count),
        };
        Point {
            place: entity.record.position,
            colour,
        }
    }
}

fn log_range(entity: &IrradianceRecord) -> f32 {
    math::ln(entity.record.effective_range())
}

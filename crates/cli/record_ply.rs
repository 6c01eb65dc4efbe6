//! Irradiance records as a point cloud.

use crate::point_cloud::{begin, put_floats, put_point};
use crate::record_colour::Colours;
use glam::DVec3;
use pipeline_data::IrradianceRecord;
use std::io::{self, Write};

const PROPERTIES: [&str; 5] = [
    "float irradiance_r",
    "float irradiance_g",
    "float irradiance_b",
    "float range",
    "uint number",
];

/// Writes one vertex a record: place, normal, colour, irradiance of indirect light in W·m⁻², range in metres, number.
pub(crate) fn write(
    file: &mut impl Write,
    records: &[IrradianceRecord],
    origin: DVec3,
    colours: &Colours,
) -> io::Result<()> {
    let about = "irradiance records; irradiance of indirect light in W/m2, range in m";
    begin(file, about, &PROPERTIES, records.len())?;
    for entity in records {
        put_point(file, &colours.point(entity), origin, entity.record.normal)?;
        put_floats(file, entity.record.irradiance.to_array())?;
        put_floats(file, [entity.record.effective_range()])?;
        file.write_all(&entity.number.to_le_bytes())?;
    }
    Ok(())
}

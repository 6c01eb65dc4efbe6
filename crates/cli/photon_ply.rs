//! Photons as a point cloud.

use crate::photon_colour::Colours;
use crate::point_cloud::{begin, put_floats, put_point};
use glam::DVec3;
use pipeline_data::PhotonsOfKind;
use radiometry::unpack_direction;
use std::io::{self, Write};

const PROPERTIES: [&str; 9] = [
    "float flux_r",
    "float flux_g",
    "float flux_b",
    "float from_x",
    "float from_y",
    "float from_z",
    "uchar map",
    "uint path",
    "uint bounce",
];

/// Writes one vertex a photon: place, normal, colour, flux in W, direction to where it came from, map (0 direct, 1 caustic,
/// 2 indirect), path and bounce.
pub(crate) fn write(file: &mut impl Write, maps: &[PhotonsOfKind], origin: DVec3, colours: &Colours) -> io::Result<()> {
    let count = maps.iter().map(|(_, photons)| photons.len()).sum();
    let about = "photons; map 0 direct, 1 caustic, 2 indirect; flux in W";
    begin(file, about, &PROPERTIES, count)?;
    for (kind, photons) in maps {
        for photon in photons {
            let point = colours.point(*kind, photon);
            put_point(file, &point, origin, unpack_direction(photon.normal))?;
            put_floats(file, photon.flux.to_array())?;
            put_floats(file, unpack_direction(photon.direction).to_array())?;
            file.write_all(&[*kind as u8])?;
            file.write_all(&photon.path.to_le_bytes())?;
            file.write_all(&photon.bounce.to_le_bytes())?;
        }
    }
    Ok(())
}

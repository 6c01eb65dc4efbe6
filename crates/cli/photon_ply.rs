//! Photons as a point cloud for other programs: PLY, binary, little-endian, as `MeshLab` and Blender open it.

use crate::args::PhotonColour;
use crate::photon_colour::Colours;
use glam::{DVec3, Vec3};
use pipeline_data::PhotonsOfKind;
use radiometry::unpack_direction;
use std::io::{self, Write};

const PROPERTIES: [&str; 18] = [
    "double x",
    "double y",
    "double z",
    "float nx",
    "float ny",
    "float nz",
    "uchar red",
    "uchar green",
    "uchar blue",
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

/// Writes one vertex a photon: place in the scene file's world, normal of the surface, colour, flux in W, direction to
/// where it came from, map (0 direct, 1 caustic, 2 indirect), path and bounce.
pub(crate) fn write(
    file: &mut impl Write,
    maps: &[PhotonsOfKind],
    origin: DVec3,
    colour: PhotonColour,
) -> io::Result<()> {
    let colours = Colours::new(colour, maps);
    let count: usize = maps.iter().map(|(_, photons)| photons.len()).sum();
    writeln!(file, "ply\nformat binary_little_endian 1.0")?;
    writeln!(file, "comment photons; map 0 direct, 1 caustic, 2 indirect; flux in W")?;
    writeln!(file, "element vertex {count}")?;
    for property in PROPERTIES {
        writeln!(file, "property {property}")?;
    }
    writeln!(file, "end_header")?;
    for (kind, photons) in maps {
        for photon in photons {
            let place = Vec3::from_array(photon.position).as_dvec3() + origin;
            for coordinate in place.to_array() {
                file.write_all(&coordinate.to_le_bytes())?;
            }
            let floats = |file: &mut _, values: [f32; 3]| {
                let bytes = values.map(f32::to_le_bytes);
                Write::write_all(file, bytes.as_flattened())
            };
            floats(file, unpack_direction(photon.normal).to_array())?;
            file.write_all(&colours.bytes_of(*kind, photon))?;
            floats(file, photon.flux.to_array())?;
            floats(file, unpack_direction(photon.direction).to_array())?;
            file.write_all(&[*kind as u8])?;
            file.write_all(&photon.path.to_le_bytes())?;
            file.write_all(&photon.bounce.to_le_bytes())?;
        }
    }
    Ok(())
}

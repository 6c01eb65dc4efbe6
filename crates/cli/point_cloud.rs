//! Point clouds for other programs: PLY, binary, little-endian, as `MeshLab` and Blender open it.

use crate::point_colour::to_bytes;
use crate::point_picture::Point;
use glam::{DVec3, Vec3};
use std::io::{self, Write};

/// What every point begins with.
const PLACED: [&str; 9] = [
    "double x",
    "double y",
    "double z",
    "float nx",
    "float ny",
    "float nz",
    "uchar red",
    "uchar green",
    "uchar blue",
];

/// Writes the head of a cloud. That many points have to follow.
///
/// - `further`: type and name of the properties beside place, normal and colour.
pub(crate) fn begin(file: &mut impl Write, about: &str, further: &[&str], count: usize) -> io::Result<()> {
    writeln!(file, "ply\nformat binary_little_endian 1.0\ncomment {about}")?;
    writeln!(file, "element vertex {count}")?;
    for property in PLACED.iter().chain(further) {
        writeln!(file, "property {property}")?;
    }
    writeln!(file, "end_header")
}

/// Writes what a point begins with: place in the scene file's world, normal of the surface, colour.
pub(crate) fn put_point(file: &mut impl Write, point: &Point, origin: DVec3, normal: Vec3) -> io::Result<()> {
    let place = (point.place.as_dvec3() + origin).to_array().map(f64::to_le_bytes);
    file.write_all(place.as_flattened())?;
    put_floats(file, normal.to_array())?;
    file.write_all(&to_bytes(point.colour))
}

pub(crate) fn put_floats<const N: usize>(file: &mut impl Write, values: [f32; N]) -> io::Result<()> {
    file.write_all(values.map(f32::to_le_bytes).as_flattened())
}

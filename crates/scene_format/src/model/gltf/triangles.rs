//! From a primitive to triangles in memory.

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::super::ModelFile;
use super::super::error::Fault;
use super::accessor::Layout;
use super::buffers::Buffers;
use super::elements::Elements;
use super::primitive::{Mode, Shape};
use crate::mesh::{MeshPlace, Oddity, RawMesh, Tally, unit};

/// Where the bytes of a primitive are.
#[derive(Clone, Copy)]
pub(super) struct Data<'b> {
    pub(super) buffers: &'b Buffers,
    pub(super) model: ModelFile<'b>,
}

impl<'b> Data<'b> {
    fn elements(&self, layout: &'b Layout) -> Result<Elements<'b>, Fault> {
        Elements::of(layout, self.buffers, &self.model)
    }
}

/// Reads a primitive. Only vertices that a triangle uses are kept, in their order.
pub(super) fn read(shape: &Shape, data: Data<'_>) -> Result<RawMesh, Fault> {
    let corners = read_corners(shape, data)?;
    let (used, corners) = compact(corners, shape.positions.count);
    let mut raw = RawMesh {
        triangles: triangles(shape.mode, &corners),
        ..RawMesh::default()
    };
    drop(corners);
    let positions = data.elements(&shape.positions)?;
    raw.positions = each(&used, |vertex| {
        Ok(Vec3::from_array(positions.vector(vertex)?).as_dvec3())
    })?;
    if let Some(layout) = &shape.normals {
        raw.normals = read_normals(&data.elements(layout)?, &used, &mut raw.warnings)?;
    }
    for layout in &shape.uv_sets {
        let uvs = data.elements(layout)?;
        // The format's origin is the upper left of a picture.
        let set = each(&used, |vertex| {
            let [u, v] = uvs.vector(vertex)?;
            Ok(Vec2::new(u, 1.0 - v))
        })?;
        raw.uv_sets.push(set);
    }
    if let Some(layout) = &shape.colours {
        let colours = data.elements(layout)?;
        let colour = |vertex| {
            let [r, g, b, a] = colours.vector(vertex)?;
            Ok(Vec4::new(r, g, b, if layout.width == 4 { a } else { 1.0 }))
        };
        raw.colours = Some(each(&used, colour)?);
    }
    Ok(raw)
}

fn each<T>(used: &[u32], mut read: impl FnMut(usize) -> Result<T, Fault>) -> Result<Vec<T>, Fault> {
    used.iter().map(|vertex| read(*vertex as usize)).collect()
}

fn read_corners(shape: &Shape, data: Data<'_>) -> Result<Vec<u32>, Fault> {
    let vertices = shape.positions.count;
    let Some(layout) = &shape.indices else {
        return Ok((0..vertices as u32).collect());
    };
    let indices = data.elements(layout)?;
    let corner = |row| {
        let index = indices.index(row);
        if (index as usize) < vertices {
            return Ok(index);
        }
        let at = format!("accessors[{}]", layout.accessor);
        Err(Fault::invalid(
            &at,
            format!("index {row} is {index}, but there are {vertices} vertices"),
        ))
    };
    (0..layout.count).map(corner).collect()
}

/// Numbers the vertices that are used, in their order; gives their old numbers, and the corners with new ones.
///
/// - `vertices`: how many there are. A few corners among many vertices cost no more than the corners.
fn compact(mut corners: Vec<u32>, vertices: usize) -> (Vec<u32>, Vec<u32>) {
    if corners.len() >= vertices / 8 {
        let mut new = vec![0_u32; vertices];
        for corner in &corners {
            new[*corner as usize] = 1;
        }
        let mut used = Vec::new();
        for (old, new) in (0_u32..).zip(&mut new) {
            if *new == 1 {
                *new = used.len() as u32;
                used.push(old);
            }
        }
        for corner in &mut corners {
            *corner = new[*corner as usize];
        }
        return (used, corners);
    }
    let mut used = corners.clone();
    used.sort_unstable();
    used.dedup();
    for corner in &mut corners {
        *corner = used.partition_point(|old| old < corner) as u32;
    }
    (used, corners)
}

/// Makes triangles of corners, of which there are three at least.
fn triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        // Every second one of a strip runs the other way.
        Mode::Strip => corners
            .windows(3)
            .enumerate()
            .map(|(row, c)| {
                if row % 2 == 0 {
                    [c[0], c[1], c[2]]
                } else {
                    [c[0], c[2], c[1]]
                }
            })
            .collect(),
        Mode::Fan => corners[1..].windows(2).map(|c| [c[0], c[1], corners[0]]).collect(),
    }
}

/// Reads unit normals; none if one has no length.
fn read_normals(
    normals: &Elements<'_>,
    used: &[u32],
    warnings: &mut Vec<crate::mesh::MeshWarning>,
) -> Result<Option<Vec<Vec3>>, Fault> {
    let mut zero = Tally::default();
    let all = each(used, |vertex| {
        let normal: DVec3 = Vec3::from_array(normals.vector(vertex)?).as_dvec3();
        if normal == DVec3::ZERO {
            zero.add(MeshPlace::Vertex(vertex));
            return Ok(Vec3::ZERO);
        }
        Ok(unit(normal))
    })?;
    warnings.extend(zero.warning(Oddity::ZeroNormal));
    Ok((zero.count == 0).then_some(all))
}

use crate::{MOST_DISTANT, SpatialError};
use glam::{DAffine3, Vec2, Vec3, Vec4};
use std::sync::Arc;

/// An analytic shape around its object-space origin; lengths in metres, before the transform of the instance.
///
/// Surfaces are exact: a sphere is no polyhedron. Normals point outward (or along +Z). Texture coordinates are in
/// [0, 1]².
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// u runs around the Y axis, 0.5 at +Z; v from the south pole (−Y) to the north pole in equal angles.
    Sphere {
        /// Radius, > 0.
        radius: f32,
    },
    /// A rectangle in XY, facing +Z; (u, v) run along X and Y.
    Quad {
        /// Width and height, each > 0.
        size: Vec2,
    },
    /// A disc in XY, facing +Z; (u, v) run along X and Y over the square around it.
    Disc {
        /// Radius, > 0.
        radius: f32,
    },
    /// A box; primitives 0 to 5 are the faces +X, −X, +Y, −Y, +Z, −Z; (u, v) run along the face's two axes in
    /// cyclic order.
    Cuboid {
        /// Full edge lengths, each > 0.
        size: Vec3,
    },
    /// A cylinder around Y; u runs around it, v along each face. Faces: bottom, wall, top; an open one has only the wall.
    Cylinder {
        /// Radius, > 0.
        radius: f32,
        /// Full height, > 0.
        height: f32,
        /// Whether bottom and top are closed.
        capped: bool,
    },
    /// A ring with a round section, around Y; u runs around the axis, v around the tube.
    Torus {
        /// From the axis to the middle of the tube, > 0.
        major_radius: f32,
        /// Radius of the tube, > 0 and at most `major_radius`.
        minor_radius: f32,
    },
    /// A finger ring around Y: a tube with thick walls and 45° chamfers on its four edges; u runs around it, v along
    /// each face.
    Band {
        /// Radius of the hole, > 0.
        inner_radius: f32,
        /// Outer radius, greater than the inner.
        outer_radius: f32,
        /// Full height, > 0.
        height: f32,
        /// Width of the chamfers, at most half the height and half the wall.
        bevel: f32,
    },
}

impl Shape {
    /// True when the shape separates an inside from an outside.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        !matches!(
            self,
            Self::Quad { .. } | Self::Disc { .. } | Self::Cylinder { capped: false, .. }
        )
    }
}

/// Triangles with shared vertices, in object space. Their outside is where the vertices run counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertex positions, metres.
    pub positions: Vec<Vec3>,
    /// Normals for shading, one for each position; any length but zero. `None`: flat.
    pub normals: Option<Vec<Vec3>>,
    /// Texture coordinates, one for each position; (0, 0) is the lower left of a picture.
    pub uvs: Option<Vec<Vec2>>,
    /// Further sets of texture coordinates, from the second on, like `uvs`.
    pub more_uvs: Vec<Vec<Vec2>>,
    /// Linear red, green, blue and coverage, one for each position.
    pub colours: Option<Vec<Vec4>>,
    /// Three rows of `positions` each.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// True when the mesh separates an inside from an outside: every edge is run through equally often both ways.
    ///
    /// Vertices at the same position count as one, so that seams in the texture do not open a mesh.
    /// Cost: O(n log n).
    #[must_use]
    pub fn is_closed(&self) -> bool {
        let key = |v: u32| self.positions[v as usize].to_array().map(|x| (x + 0.0).to_bits());
        let mut edges: Vec<([[u32; 3]; 2], i32)> = Vec::with_capacity(3 * self.triangles.len());
        for t in &self.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let (a, b) = (key(a), key(b));
                if a < b {
                    edges.push(([a, b], 1));
                } else if b < a {
                    edges.push(([b, a], -1));
                }
            }
        }
        edges.sort_unstable();
        !edges.is_empty()
            && edges
                .chunk_by(|a, b| a.0 == b.0)
                .all(|same| same.iter().map(|e| e.1).sum::<i32>() == 0)
    }

    /// A set of texture coordinates, counted from 0, if it is there.
    #[must_use]
    pub fn uv_set(&self, set: u32) -> Option<&[Vec2]> {
        match set {
            0 => self.uvs.as_deref(),
            _ => self.more_uvs.get(set as usize - 1).map(Vec::as_slice),
        }
    }

    /// Checks what queries rely on; `geometry` is the row that errors name.
    pub(crate) fn check(&self, geometry: usize) -> Result<(), SpatialError> {
        let count = self.positions.len();
        let finite = |attribute, broken: Option<usize>| match broken {
            Some(vertex) => Err(SpatialError::NonFiniteVertex {
                geometry,
                attribute,
                vertex,
            }),
            None => Ok(()),
        };
        let complete = |attribute, values: usize| {
            if values == count {
                return Ok(());
            }
            Err(SpatialError::AttributeCount {
                geometry,
                attribute,
                count: values,
                positions: count,
            })
        };
        finite("position", self.positions.iter().position(|p| !p.is_finite()))?;
        let too_far = |p: &Vec3| p.abs().max_element() > MOST_DISTANT;
        if let Some(vertex) = self.positions.iter().position(too_far) {
            return Err(SpatialError::VertexTooFar { geometry, vertex });
        }
        if let Some(normals) = &self.normals {
            complete("normal", normals.len())?;
            finite("normal", normals.iter().position(|n| !n.is_finite()))?;
        }
        for uvs in self.uvs.iter().chain(&self.more_uvs) {
            complete("uv", uvs.len())?;
            finite("uv", uvs.iter().position(|uv| !uv.is_finite()))?;
        }
        if let Some(colours) = &self.colours {
            complete("colour", colours.len())?;
            finite("colour", colours.iter().position(|colour| !colour.is_finite()))?;
        }
        for (triangle, vertices) in self.triangles.iter().enumerate() {
            if let Some(vertex) = vertices.iter().copied().find(|v| *v as usize >= count) {
                return Err(SpatialError::VertexOutOfRange {
                    geometry,
                    triangle,
                    vertex,
                    count,
                });
            }
        }
        Ok(())
    }
}

/// What an instance places in the world.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// An analytic shape.
    Shape(Shape),
    /// Triangles, shared with whoever loaded them.
    Mesh(Arc<TriangleMesh>),
}

impl Geometry {
    /// True when the geometry separates an inside from an outside.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Shape(shape) => shape.is_closed(),
            Self::Mesh(mesh) => mesh.is_closed(),
        }
    }
}

/// A geometry in the world. Its row number is how hits name it.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Row of the geometry.
    pub geometry: u32,
    /// Where it is, after the scene was moved to its centre (rebased).
    pub placement: Placement,
}

/// World from object space, over the time of the shutter. Any invertible transform, mirrored ones included.
#[derive(Clone, Debug, PartialEq)]
pub enum Placement {
    /// The same all the time.
    Fixed(DAffine3),
    /// At evenly spaced times from 0 to 1 of the shutter, at least two. In between, every point of the geometry moves in
    /// a straight line, so turning takes as many as the arc needs to look round.
    Moving(Arc<[DAffine3]>),
}

impl Instance {
    /// An instance that stays where it is.
    #[must_use]
    pub fn fixed(geometry: u32, world_from_object: DAffine3) -> Self {
        Self {
            geometry,
            placement: Placement::Fixed(world_from_object),
        }
    }
}

//! Choice of a point of a mesh by world area.

use super::rectangle::Rectangle;
use crate::TriangleMesh;
use crate::attributes::blend;
use crate::placed::Pose;
use crate::surface::{WorldTriangle, mesh_uv};
use glam::{DVec2, DVec3, Vec2, Vec4};
use radiometry::{Distribution, warp};
use std::sync::Arc;

/// The triangles of an instance, weighted by world area.
#[derive(Debug)]
pub(super) struct Triangles {
    mesh: Arc<TriangleMesh>,
    by_area: Distribution,
    /// Whether vertices are rounded in world space.
    rounded: bool,
    /// Present when the two triangles of the mesh form a rectangle.
    halves: Option<Halves>,
}

/// A rectangle made of two triangles: corner and sides belong to the first.
#[derive(Debug)]
struct Halves {
    rectangle: Rectangle,
    /// Which vertex of each triangle lies off the diagonal.
    corners: [usize; 2],
}

/// Weights of the second and third vertex of a uniformly chosen point of a triangle.
pub(super) fn sample_triangle(u: Vec2) -> Vec2 {
    let b = warp::sample_triangle(u);
    Vec2::new(b.y, (1.0 - b.x - b.y).max(0.0))
}

impl Triangles {
    pub(super) fn new(mesh: Arc<TriangleMesh>, pose: &Pose, rounded: bool) -> Self {
        let area = |t| WorldTriangle::new(pose, &mesh, t, rounded).area_vector.length();
        let by_area = Distribution::new((0..mesh.triangles.len() as u32).map(area));
        let halves = Halves::new(&mesh, pose, rounded);
        Self {
            mesh,
            by_area,
            rounded,
            halves,
        }
    }

    pub(super) fn count(&self) -> u32 {
        self.mesh.triangles.len() as u32
    }

    pub(super) fn rectangle(&self) -> Option<Rectangle> {
        self.halves.as_ref().map(|h| h.rectangle)
    }

    pub(super) fn world(&self, pose: &Pose, triangle: u32) -> WorldTriangle {
        WorldTriangle::new(pose, &self.mesh, triangle, self.rounded)
    }

    pub(super) fn uv(&self, triangle: u32, uv: Vec2) -> Vec2 {
        mesh_uv(&self.mesh, triangle, uv)
    }

    /// Texture coordinates in one of the sets of the mesh, if it is there.
    ///
    /// - `weights`: of the second and third vertex.
    pub(super) fn uv_set(&self, triangle: u32, weights: Vec2, set: u32) -> Option<Vec2> {
        Some(blend(&self.mesh, self.mesh.uv_set(set)?, triangle, weights))
    }

    /// Colour and coverage of the vertices; one where there are none.
    ///
    /// - `weights`: of the second and third vertex.
    pub(super) fn vertex_colour(&self, triangle: u32, weights: Vec2) -> Vec4 {
        let colours = self.mesh.colours.as_deref();
        colours.map_or(Vec4::ONE, |colours| blend(&self.mesh, colours, triangle, weights))
    }

    /// Chooses a triangle and the weights of its second and third vertex.
    pub(super) fn sample(&self, u: Vec2) -> (u32, Vec2) {
        let (triangle, _, rest) = self.by_area.sample(u.x).unwrap_or((0, 1.0, u.x));
        (triangle as u32, sample_triangle(Vec2::new(rest, u.y)))
    }

    /// Triangle and weights at these shares of the rectangle's sides.
    pub(super) fn in_rectangle(&self, share: DVec2) -> (u32, Vec2) {
        let Some(halves) = &self.halves else {
            return (0, Vec2::ZERO);
        };
        let second = share.x + share.y > 1.0;
        let along = if second {
            // Seen from the opposite corner. As both run the same way around, the first side from there is parallel to
            // the first one from here.
            DVec2::ONE - share
        } else {
            share
        };
        let corner = halves.corners[usize::from(second)];
        let mut weights = [0.0; 3];
        weights[corner] = 1.0 - along.x - along.y;
        weights[(corner + 1) % 3] = along.x;
        weights[(corner + 2) % 3] = along.y;
        (u32::from(second), Vec2::new(weights[1] as f32, weights[2] as f32))
    }
}

impl Halves {
    fn new(mesh: &TriangleMesh, pose: &Pose, rounded: bool) -> Option<Self> {
        if mesh.triangles.len() != 2 {
            return None;
        }
        let [first, second] = [0, 1].map(|t| WorldTriangle::new(pose, mesh, t, rounded));
        if !(first.area_vector.dot(second.area_vector) > 0.0) {
            return None;
        }
        let size = first.area_vector.length().sqrt();
        let near = |p: DVec3, q: DVec3| p.distance(q) <= 1e-6 * size;
        let [a, b] = [&first.vertices, &second.vertices];
        let off = |own: &[DVec3; 3], other: &[DVec3; 3]| {
            let mut alone = (0..3).filter(|i| !other.iter().any(|q| near(own[*i], *q)));
            match (alone.next(), alone.next()) {
                (Some(i), None) => Some(i),
                _ => None,
            }
        };
        let (i, j) = (off(a, b)?, off(b, a)?);
        let (corner, along_x, along_y) = (a[i], a[(i + 1) % 3], a[(i + 2) % 3]);
        // In a parallelogram the corners off the diagonal have the same middle as those on it.
        if !near(corner + b[j], along_x + along_y) {
            return None;
        }
        Some(Self {
            rectangle: Rectangle::new(corner, along_x - corner, along_y - corner)?,
            corners: [i, j],
        })
    }
}

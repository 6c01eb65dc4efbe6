//! Points on the surface of an instance, for emission.
//!
//! Three ways to choose one, from general to special: by world area (`table` for shapes, a discrete distribution for
//! triangles); uniformly in the cone that a sphere subtends (`cone`); uniformly in the solid angle of a rectangle
//! (`rectangle`). Whichever chose a point, its density is computed from the rounded point by the same function that
//! answers for points found otherwise, so that both sides of multiple importance sampling agree.

mod cone;
mod rectangle;
mod table;
mod triangles;

#[cfg(test)]
mod tests;

use crate::placed::{Placed, Pose};
use crate::ray_scene::Prepared;
use crate::shapes::Solid;
use crate::surface::{WorldTriangle, unit};
use crate::{Bounds, RayScene, SurfacePoint};
use cone::Ball;
use glam::{DVec3, Vec2, Vec3, Vec4};
use radiometry::warp;
use rectangle::Rectangle;
use std::sync::Arc;
use table::Table;
use triangles::Triangles;

/// A point chosen on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// Position, world space, metres: on the surface but for rounding.
    pub p: Vec3,
    /// Bound on the distance from `p` to the surface, metres.
    pub error: f32,
    /// Geometric normal, world space, unit length, outward.
    pub ng: Vec3,
    /// Texture coordinates, as in [`SurfacePoint`].
    pub uv: Vec2,
    /// Triangle of the mesh, or face of the shape.
    pub primitive: u32,
    /// Density with which [`SurfaceSampler::sample_area`] chooses this point, per world m².
    pub pdf_area: f32,
}

/// A point chosen on a surface as seen from elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionSample {
    /// The point. Its `pdf_area` is not the density of this choice; `pdf` is.
    pub sample: SurfaceSample,
    /// Unit direction from where it is seen to the point.
    pub wi: Vec3,
    /// Distance to the point, metres.
    pub distance: f32,
    /// Density of the direction `wi` per solid angle.
    pub pdf: f32,
}

/// A part of a surface that is chosen as a whole before a point of it is: a triangle, or all of a shape or a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePiece {
    /// Box around it, world space, over the time of the shutter.
    pub bounds: Bounds,
    /// World area when the shutter opens, m².
    pub area: f64,
    /// Unit vector in the middle of its outward normals.
    pub axis: Vec3,
    /// Least cosine between its normals and `axis`; −1 when they may be anywhere.
    pub cos_spread: f32,
}

/// Chooses points on the surface of one instance. Independent of the scene that it was built from.
///
/// Which side of the surface emits is the caller's to decide, and so is whether anything stands between.
#[derive(Clone, Debug)]
pub struct SurfaceSampler {
    instance: Placed,
    surface: Surface,
    aim: Aim,
    area: f64,
}

#[derive(Clone, Debug)]
enum Surface {
    Solid { solid: Arc<Solid>, table: Arc<Table> },
    Triangles(Arc<Triangles>),
}

/// How directions are chosen when there is something better than area.
#[derive(Clone, Copy, Debug)]
enum Aim {
    Area,
    Ball(Ball),
    Rectangle(Rectangle),
}

impl SurfaceSampler {
    /// Prepares to sample the surface of an instance; `None` when it has no area.
    ///
    /// Cost: up to 4096 evaluations for a curved face under a transform that changes angles; O(n) for a mesh.
    ///
    /// # Panics
    ///
    /// When there is no such instance.
    #[must_use]
    pub fn new(scene: &RayScene, instance: u32) -> Option<Self> {
        let area = scene.instance_area(instance);
        if !(area > 0.0 && area.is_finite()) {
            return None;
        }
        let placed = scene.instances[instance as usize].clone();
        let (surface, aim) = match &scene.geometries[placed.geometry as usize] {
            Prepared::Solid(solid) => {
                let table = Arc::new(Table::new(solid, &placed.opening)?);
                let aim = Aim::at_solid(solid, &placed.opening);
                let solid = Arc::clone(solid);
                (Surface::Solid { solid, table }, aim)
            }
            Prepared::Mesh { mesh, tree } => {
                let triangles = Triangles::new(Arc::clone(mesh), &placed.opening, tree.is_none());
                let aim = triangles.rectangle().filter(|_| !placed.moves());
                let aim = aim.map_or(Aim::Area, Aim::Rectangle);
                (Surface::Triangles(Arc::new(triangles)), aim)
            }
        };
        Some(Self {
            instance: placed,
            surface,
            aim,
            area,
        })
    }

    /// Area in world space when the shutter opens, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Chooses a point by world area.
    ///
    /// Exactly uniform on flat faces and meshes, and on curved faces of revolution and spheres under transforms that
    /// keep angles. On curved faces under other transforms, and on a torus, the choice is uniform over cells of a table
    /// (64 × 64 or 256 × 1) and uniform in parameters within a cell: uniform per area to within the variation across a
    /// cell, with the exact density in `pdf_area`. On an instance that changes its size while the shutter is open, the
    /// choice is uniform by its area at the opening.
    ///
    /// - `u`: in [0, 1)².
    /// - `time`: in [0, 1] of the shutter.
    #[must_use]
    pub fn sample_area(&self, u: Vec2, time: f32) -> SurfaceSample {
        let pose = &*self.instance.at(time);
        match &self.surface {
            Surface::Solid { solid, table } => {
                let (face, parameters) = table.sample(u);
                self.solid_sample(pose, solid, table, face, solid.point(face, parameters).0)
            }
            Surface::Triangles(triangles) => {
                let (triangle, uv) = triangles.sample(u);
                self.triangle_sample(pose, triangles, triangle, uv)
            }
        }
    }

    /// How many pieces there are: the triangles of a mesh, or 1 for a shape and for two triangles that form a rectangle.
    #[must_use]
    pub fn piece_count(&self) -> u32 {
        match (&self.surface, &self.aim) {
            (Surface::Triangles(triangles), Aim::Area) => triangles.count(),
            _ => 1,
        }
    }

    /// The piece that a primitive, a triangle of the mesh or a face of the shape, belongs to.
    #[must_use]
    pub fn piece_of(&self, primitive: u32) -> u32 {
        if self.piece_count() == 1 { 0 } else { primitive }
    }

    /// Where a piece lies, how large it is, and where it faces.
    #[must_use]
    pub fn piece(&self, piece: u32) -> SurfacePiece {
        let anywhere = SurfacePiece {
            bounds: self.instance.bounds,
            area: self.area,
            axis: Vec3::Z,
            cos_spread: -1.0,
        };
        match &self.surface {
            Surface::Triangles(triangles) => {
                let triangle = triangles.world(&self.instance.opening, piece);
                let one = self.piece_count() > 1;
                let area = if one {
                    0.5 * triangle.area_vector.length()
                } else {
                    self.area
                };
                if self.instance.moves() {
                    return SurfacePiece { area, ..anywhere };
                }
                SurfacePiece {
                    bounds: if one { triangle.bounds() } else { self.instance.bounds },
                    area,
                    axis: triangle.normal(),
                    cos_spread: 1.0,
                }
            }
            Surface::Solid { solid, .. } => match &**solid {
                Solid::Quad { .. } | Solid::Disc { .. } if !self.instance.moves() => SurfacePiece {
                    axis: unit(self.instance.opening.world_normal(DVec3::Z)),
                    cos_spread: 1.0,
                    ..anywhere
                },
                _ => anywhere,
            },
        }
    }

    /// Chooses a point of a piece as seen from `from`: uniformly in solid angle for spheres and rectangles, else by area.
    ///
    /// Spheres under transforms that keep angles, from outside: the cone that they subtend. Quads that stay rectangles,
    /// and meshes of two triangles that form one and do not move, between 10⁻³ and 6.2 steradians: Ureña et al., "An
    /// Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013.
    ///
    /// - `from`: world space, metres.
    /// - `piece`: below [`SurfaceSampler::piece_count`].
    /// - `u`: in [0, 1)².
    /// - `time`: in [0, 1] of the shutter.
    /// - returns `None` where the chosen point is seen edge on or coincides with `from`.
    #[must_use]
    pub fn sample_toward(&self, from: Vec3, piece: u32, u: Vec2, time: f32) -> Option<DirectionSample> {
        let pose = &*self.instance.at(time);
        let aim = self.aim_at(pose);
        let sample = match &self.surface {
            Surface::Solid { solid, table } => {
                let (face, near) = match &aim {
                    Aim::Ball(ball) => ball
                        .sample(from.as_dvec3(), u.as_dvec2())
                        .map(|p| (0, pose.object_from_world.transform_point3(p))),
                    Aim::Rectangle(rectangle) => rectangle
                        .sample(from.as_dvec3(), u.as_dvec2())
                        .map(|share| (0, solid.point(0, share).0)),
                    Aim::Area => None,
                }
                .unwrap_or_else(|| {
                    let (face, parameters) = table.sample(u);
                    (face, solid.point(face, parameters).0)
                });
                self.solid_sample(pose, solid, table, face, near)
            }
            Surface::Triangles(triangles) => {
                let share = match &aim {
                    Aim::Rectangle(rectangle) => rectangle.sample(from.as_dvec3(), u.as_dvec2()),
                    _ => None,
                };
                let (triangle, uv) = match (share, aim) {
                    (Some(share), _) => triangles.in_rectangle(share),
                    (None, Aim::Area) => (piece, triangles::sample_triangle(u)),
                    (None, _) => triangles.sample(u),
                };
                self.triangle_sample(pose, triangles, triangle, uv)
            }
        };
        let between = sample.p.as_dvec3() - from.as_dvec3();
        let distance = between.length();
        let wi = (between / distance).as_vec3();
        let pdf = self.pdf(from, sample.p, sample.ng, &aim, || match &self.surface {
            Surface::Solid { .. } => sample.pdf_area,
            Surface::Triangles(triangles) => self.piece_pdf(pose, triangles, sample.primitive),
        });
        (pdf > 0.0 && pdf.is_finite() && wi.is_finite()).then_some(DirectionSample {
            sample,
            wi,
            distance: distance as f32,
            pdf,
        })
    }

    /// Density per solid angle with which [`SurfaceSampler::sample_toward`] chooses the direction from `from` to a
    /// point of this instance, found for instance by a ray, among those of its piece.
    ///
    /// - returns infinity for a point seen edge on.
    #[must_use]
    pub fn pdf_toward(&self, from: Vec3, point: &SurfacePoint) -> f32 {
        let pose = &*self.instance.at(point.time);
        self.pdf(from, point.p, point.ng, &self.aim_at(pose), || match &self.surface {
            Surface::Solid { solid, table } => self.solid_pdf(pose, solid, table, point.primitive, point.p),
            Surface::Triangles(triangles) => self.piece_pdf(pose, triangles, point.primitive),
        })
    }

    /// Density per m² of a uniform choice in the piece of a triangle.
    fn piece_pdf(&self, pose: &Pose, triangles: &Triangles, triangle: u32) -> f32 {
        match self.aim {
            Aim::Area => (2.0 / triangles.world(pose, triangle).area_vector.length()) as f32,
            _ => (1.0 / self.area) as f32,
        }
    }

    fn aim_at(&self, pose: &Pose) -> Aim {
        match &self.surface {
            Surface::Solid { solid, .. } if self.instance.moves() => Aim::at_solid(solid, pose),
            _ => self.aim,
        }
    }

    fn pdf(&self, from: Vec3, p: Vec3, ng: Vec3, aim: &Aim, pdf_area: impl FnOnce() -> f32) -> f32 {
        let solid_angle = match aim {
            Aim::Area => None,
            Aim::Ball(ball) => ball.solid_angle(from.as_dvec3()),
            Aim::Rectangle(rectangle) => rectangle.solid_angle(from.as_dvec3()),
        };
        if let Some(solid_angle) = solid_angle {
            return (1.0 / solid_angle) as f32;
        }
        let between = p.as_dvec3() - from.as_dvec3();
        let distance_sq = between.length_squared();
        if !(distance_sq > 0.0) {
            return 0.0;
        }
        let cos = between.dot(ng.as_dvec3()) / distance_sq.sqrt();
        warp::solid_angle_pdf(pdf_area(), distance_sq as f32, cos as f32)
    }

    /// Density of [`SurfaceSampler::sample_area`] at a point, per m².
    fn solid_pdf(&self, pose: &Pose, solid: &Solid, table: &Table, face: u32, p: Vec3) -> f32 {
        let local = || pose.object_from_world.transform_point3(p.as_dvec3());
        let pdf = table.pdf_area(solid, face, local);
        if !self.instance.moves() {
            return pdf;
        }
        let normal = solid.project(local(), face).n;
        let area = |pose: &Pose| (pose.cofactor() * normal).length();
        (f64::from(pdf) * area(&self.instance.opening) / area(pose)) as f32
    }

    fn triangle_pdf(&self, triangles: &Triangles, triangle: u32, now: impl FnOnce() -> WorldTriangle) -> f32 {
        if !self.instance.moves() {
            return (1.0 / self.area) as f32;
        }
        let opening = triangles.world(&self.instance.opening, triangle);
        (opening.area_vector.length() / (now().area_vector.length() * self.area)) as f32
    }

    /// Texture coordinates of a point of this surface in one of the sets of its mesh.
    ///
    /// - `primitive`, `p`, `uv`: of a [`SurfaceSample`] or a [`SurfacePoint`].
    /// - `set`: from 0; one that is not there, and every one of a shape, is the first.
    #[must_use]
    pub fn uv_set(&self, primitive: u32, p: Vec3, uv: Vec2, time: f32, set: u32) -> Vec2 {
        match &self.surface {
            Surface::Triangles(triangles) if set > 0 => {
                let shape = triangles.world(&self.instance.at(time), primitive);
                triangles
                    .uv_set(primitive, shape.weights(p.as_dvec3()), set)
                    .unwrap_or(uv)
            }
            _ => uv,
        }
    }

    /// Colour and coverage of the vertices at a point of this surface; one where the geometry has none.
    ///
    /// - `primitive`, `p`: of a [`SurfaceSample`] or a [`SurfacePoint`].
    #[must_use]
    pub fn vertex_colour(&self, primitive: u32, p: Vec3, time: f32) -> Vec4 {
        match &self.surface {
            Surface::Triangles(triangles) => {
                let shape = triangles.world(&self.instance.at(time), primitive);
                triangles.vertex_colour(primitive, shape.weights(p.as_dvec3()))
            }
            Surface::Solid { .. } => Vec4::ONE,
        }
    }

    fn solid_sample(&self, pose: &Pose, solid: &Solid, table: &Table, face: u32, near: DVec3) -> SurfaceSample {
        let local = solid.project(near, face);
        let (p, error) = pose.world_point(local.p);
        SurfaceSample {
            p,
            error,
            ng: unit(pose.world_normal(local.n)),
            uv: local.uv,
            primitive: face,
            pdf_area: self.solid_pdf(pose, solid, table, face, p),
        }
    }

    fn triangle_sample(&self, pose: &Pose, triangles: &Triangles, triangle: u32, uv: Vec2) -> SurfaceSample {
        let shape = triangles.world(pose, triangle);
        let (p, error) = shape.point(uv);
        SurfaceSample {
            p,
            error,
            ng: shape.normal(),
            uv: triangles.uv(triangle, uv),
            primitive: triangle,
            pdf_area: self.triangle_pdf(triangles, triangle, || shape),
        }
    }
}

impl Aim {
    fn at_solid(solid: &Solid, pose: &Pose) -> Self {
        match solid {
            Solid::Sphere { radius } => Ball::new(pose, *radius).map(Self::Ball),
            Solid::Quad { half } => Rectangle::of_quad(pose, *half).map(Self::Rectangle),
            _ => None,
        }
        .unwrap_or(Self::Area)
    }
}

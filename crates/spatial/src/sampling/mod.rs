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

use crate::placed::Placed;
use crate::ray_scene::Prepared;
use crate::shapes::Solid;
use crate::surface::unit;
use crate::{RayScene, SurfacePoint};
use cone::Ball;
use glam::{DVec3, Vec2, Vec3};
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
        let placed = scene.instances[instance as usize];
        let (surface, aim) = match &scene.geometries[placed.geometry as usize] {
            Prepared::Solid(solid) => {
                let table = Arc::new(Table::new(solid, &placed)?);
                let aim = match &**solid {
                    Solid::Sphere { radius } => Ball::new(&placed, *radius).map(Aim::Ball),
                    Solid::Quad { half } => Rectangle::of_quad(&placed, *half).map(Aim::Rectangle),
                    _ => None,
                };
                let solid = Arc::clone(solid);
                (Surface::Solid { solid, table }, aim)
            }
            Prepared::Mesh { mesh, tree } => {
                let triangles = Triangles::new(Arc::clone(mesh), &placed, tree.is_none());
                let aim = triangles.rectangle().map(Aim::Rectangle);
                (Surface::Triangles(Arc::new(triangles)), aim)
            }
        };
        Some(Self {
            instance: placed,
            surface,
            aim: aim.unwrap_or(Aim::Area),
            area,
        })
    }

    /// Area in world space, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Chooses a point by world area.
    ///
    /// Exactly uniform on flat faces and meshes, and on curved faces of revolution and spheres under transforms that
    /// keep angles. On curved faces under other transforms, and on a torus, the choice is uniform over cells of a table
    /// (64 × 64 or 256 × 1) and uniform in parameters within a cell: uniform per area to within the variation across a
    /// cell, with the exact density in `pdf_area`.
    ///
    /// - `u`: in [0, 1)².
    #[must_use]
    pub fn sample_area(&self, u: Vec2) -> SurfaceSample {
        match &self.surface {
            Surface::Solid { solid, table } => {
                let (face, parameters) = table.sample(u);
                self.solid_sample(solid, table, face, solid.point(face, parameters).0)
            }
            Surface::Triangles(triangles) => {
                let (triangle, uv) = triangles.sample(u);
                self.triangle_sample(triangles, triangle, uv)
            }
        }
    }

    /// Chooses a point as seen from `from`: uniformly in solid angle for spheres and rectangles, else by area.
    ///
    /// Spheres under transforms that keep angles, from outside: the cone that they subtend. Quads that stay rectangles,
    /// and meshes of two triangles that form one, between 10⁻³ and 6.2 steradians: Ureña et al., "An Area-Preserving
    /// Parametrization for Spherical Rectangles", EGSR 2013.
    ///
    /// - `from`: world space, metres.
    /// - `u`: in [0, 1)².
    /// - returns `None` where the chosen point is seen edge on or coincides with `from`.
    #[must_use]
    pub fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<DirectionSample> {
        let sample = match (&self.aim, &self.surface) {
            (Aim::Ball(ball), Surface::Solid { solid, table }) => match ball.sample(from.as_dvec3(), u.as_dvec2()) {
                Some(p) => {
                    let local = self.instance.object_from_world.transform_point3(p);
                    self.solid_sample(solid, table, 0, local)
                }
                None => self.sample_area(u),
            },
            (Aim::Rectangle(rectangle), surface) => match rectangle.sample(from.as_dvec3(), u.as_dvec2()) {
                Some(share) => match surface {
                    Surface::Solid { solid, table } => self.solid_sample(solid, table, 0, solid.point(0, share).0),
                    Surface::Triangles(triangles) => {
                        let (triangle, uv) = triangles.in_rectangle(share);
                        self.triangle_sample(triangles, triangle, uv)
                    }
                },
                None => self.sample_area(u),
            },
            _ => self.sample_area(u),
        };
        let between = sample.p.as_dvec3() - from.as_dvec3();
        let distance = between.length();
        let wi = (between / distance).as_vec3();
        let pdf = self.pdf(from, sample.p, sample.ng, sample.primitive);
        (pdf > 0.0 && pdf.is_finite() && wi.is_finite()).then_some(DirectionSample {
            sample,
            wi,
            distance: distance as f32,
            pdf,
        })
    }

    /// Density per solid angle with which [`SurfaceSampler::sample_toward`] chooses the direction from `from` to a
    /// point of this instance, found for instance by a ray.
    ///
    /// - returns infinity for a point seen edge on.
    #[must_use]
    pub fn pdf_toward(&self, from: Vec3, point: &SurfacePoint) -> f32 {
        self.pdf(from, point.p, point.ng, point.primitive)
    }

    fn pdf(&self, from: Vec3, p: Vec3, ng: Vec3, primitive: u32) -> f32 {
        let solid_angle = match &self.aim {
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
        warp::solid_angle_pdf(self.pdf_area(p, primitive), distance_sq as f32, cos as f32)
    }

    /// Density of [`SurfaceSampler::sample_area`] at a point, per m².
    fn pdf_area(&self, p: Vec3, primitive: u32) -> f32 {
        match &self.surface {
            Surface::Solid { solid, table } => {
                let local = |p: Vec3| self.instance.object_from_world.transform_point3(p.as_dvec3());
                table.pdf_area(solid, primitive, || local(p))
            }
            Surface::Triangles(_) => (1.0 / self.area) as f32,
        }
    }

    fn solid_sample(&self, solid: &Solid, table: &Table, face: u32, near: DVec3) -> SurfaceSample {
        let local = solid.project(near, face);
        let (p, error) = self.instance.world_point(local.p);
        SurfaceSample {
            p,
            error,
            ng: unit(self.instance.world_normal(local.n)),
            uv: local.uv,
            primitive: face,
            pdf_area: table.pdf_area(solid, face, || {
                self.instance.object_from_world.transform_point3(p.as_dvec3())
            }),
        }
    }

    fn triangle_sample(&self, triangles: &Triangles, triangle: u32, uv: Vec2) -> SurfaceSample {
        let shape = triangles.world(&self.instance, triangle);
        let (p, error) = shape.point(uv);
        SurfaceSample {
            p,
            error,
            ng: shape.normal(),
            uv: triangles.uv(triangle, uv),
            primitive: triangle,
            pdf_area: (1.0 / self.area) as f32,
        }
    }
}

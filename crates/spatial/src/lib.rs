//! Where rays meet surfaces, where surfaces can be sampled, and which photons are near.
//!
//! The crate answers with row numbers and plain values. It knows analytic shapes and triangle meshes, not materials,
//! lights or entities.
//!
//! - **Exact shapes.** A sphere is a sphere: [`Shape`]s are intersected in object space and double precision, under any
//!   invertible transform, mirrored and non-uniform ones included. Normals go by the inverse transpose, so that outside
//!   stays outside.
//! - **No holes.** Triangles are tested watertight (Woop et al. 2013) and boxes are padded by what their test may round,
//!   so no ray slips through a shared edge or vertex, at any scale.
//! - **No epsilon.** A [`SurfacePoint`] carries a bound on its own rounding, a few units in the last place; rays leave it
//!   from [`spawn_origin`] and are connected by [`connect`]. Intersections next to the origin are decided in double
//!   precision, so neither the place just left nor a wall a ten-thousandth of the scene away is mistaken.
//! - **One tree.** A [`RayScene`] is one compressed wide tree (obvhs) over triangles, shapes and instanced meshes alike.
//!   A mesh placed once lies in it triangle by triangle, a mesh placed a thousand times is stored once.
//! - **Moving instances.** A [`Placement`] may change over the time of the shutter, and each ray meets it where it is at
//!   the ray's time.
//! - **Uniform by world area.** A [`SurfaceSampler`] chooses points of an instance with densities that hold for world
//!   space whatever the transform, and by solid angle where there is a closed form.
//! - **Photons.** A [`PhotonTree`] finds the nearest ones to a point.
//! - **Records.** A [`RecordOctree`] finds the spheres that contain a point.
//!
//! Everything is deterministic: the same input yields the same bits for any number of threads, which only share
//! finished structures.
//!
//! Deliberately absent: deforming meshes, curves, displacement, ray packets, and rebasing, which the caller does in
//! double precision before instances come here.
//!
//! ```
//! use glam::{DAffine3, DVec3, Vec3};
//! use spatial::{Geometry, Instance, Ray, RayScene, Shape, spawn_origin};
//!
//! let sphere = Geometry::Shape(Shape::Sphere { radius: 1.0 });
//! let instance = Instance::fixed(0, DAffine3::from_translation(DVec3::Z * -5.0));
//! let scene = RayScene::build(vec![sphere], vec![instance])?;
//!
//! let ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
//! let hit = scene.intersect(&ray).expect("the sphere lies ahead");
//! assert_eq!(hit.t, 4.0);
//! let point = scene.surface(&ray, &hit);
//! assert_eq!(point.ng, Vec3::Z);
//! // A ray back to where it came from meets nothing, least of all the sphere.
//! let back = Ray::new(spawn_origin(point.p, point.error, point.ng, Vec3::Z), Vec3::Z);
//! assert!(!scene.occluded(&back));
//! # Ok::<(), spatial::SpatialError>(())
//! ```

#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "`!(a < b)` also holds for NaN, which is what is meant"
)]

mod attributes;
mod bounds;
mod error;
mod geometry;
mod median_split;
mod mesh_tree;
mod photon_tree;
mod placed;
mod query;
mod ray;
mod ray_scene;
mod record_octree;
mod sampling;
mod shapes;
mod surface;
mod tree;
mod triangle;

pub use bounds::Bounds;
pub use error::SpatialError;
pub use geometry::{Geometry, Instance, Placement, Shape, TriangleMesh};
pub use photon_tree::{InvalidPhotonTree, Nearest, NearestScratch, Neighbour, PhotonTree, PhotonTreeError};
pub use placed::straight_between;
pub use ray::{Ray, RayHit, SurfacePoint, connect, spawn_origin};
pub use ray_scene::{MOST_DISTANT, RayScene};
pub use record_octree::{InvalidRecordOctree, RecordOctree, RecordOctreeError};
pub use sampling::{DirectionSample, SurfacePiece, SurfaceSample, SurfaceSampler};

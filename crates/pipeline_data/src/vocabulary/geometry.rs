use bevy_ecs::component::Component;
use bevy_ecs::query::QueryData;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::Reflect;
use bevy_reflect::std_traits::ReflectDefault;
use glam::{Vec2, Vec3};
use scene_format::{AssetPath, Range, Required, Unit};
use spatial::Shape;

/// A sphere around the prim's origin; exact, no polyhedron.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Sphere {
    /// Radius.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub radius: f32,
}

impl Default for Sphere {
    fn default() -> Self {
        Self { radius: 1.0 }
    }
}

/// A rectangle in the XY plane, facing +Z.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Quad {
    /// Width along X and height along Y.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub size: Vec2,
}

impl Default for Quad {
    fn default() -> Self {
        Self { size: Vec2::ONE }
    }
}

/// A disc in the XY plane, facing +Z.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Disc {
    /// Radius.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub radius: f32,
}

impl Default for Disc {
    fn default() -> Self {
        Self { radius: 1.0 }
    }
}

/// A box around the prim's origin.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Cuboid {
    /// Full length of the edges along X, Y and Z.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub size: Vec3,
}

impl Default for Cuboid {
    fn default() -> Self {
        Self { size: Vec3::ONE }
    }
}

/// A cylinder around the Y axis, its middle at the prim's origin; exact, no polyhedron.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Cylinder {
    /// Radius.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub radius: f32,
    /// Full height.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub height: f32,
    /// Whether discs close both ends. Without them it has no inside, so no glass.
    pub capped: bool,
}

impl Default for Cylinder {
    fn default() -> Self {
        Self {
            radius: 1.0,
            height: 1.0,
            capped: true,
        }
    }
}

/// A ring with a round section, around the Y axis.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Torus {
    /// From the axis to the middle of the tube.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub major_radius: f32,
    /// Radius of the tube, at most `major_radius`.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub minor_radius: f32,
}

impl Default for Torus {
    fn default() -> Self {
        Self {
            major_radius: 1.0,
            minor_radius: 0.25,
        }
    }
}

/// A finger ring around the Y axis: a tube with a thick wall, its four edges cut off at 45°.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Band {
    /// Radius of the hole.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub inner_radius: f32,
    /// Outer radius, greater than `inner_radius`.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub outer_radius: f32,
    /// Full height.
    #[reflect(@Range::above(0.0), @Unit("m"))]
    pub height: f32,
    /// Width of the cut edges, at most half the height and half the wall; 0 leaves them sharp.
    #[reflect(@Range::at_least(0.0), @Unit("m"))]
    pub bevel: f32,
}

impl Default for Band {
    fn default() -> Self {
        Self {
            inner_radius: 0.9,
            outer_radius: 1.0,
            height: 0.5,
            bevel: 0.0,
        }
    }
}

/// Triangles from a file. Prims that name the same part of a file share it in memory.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Default)]
pub struct Mesh {
    /// A Wavefront `.obj` file or a glTF 2.0 file, `.gltf` or `.glb`, relative to the scene file that names it. Its faces
    /// must run counter-clockwise seen from outside. Its materials are not read here: a reference to the file brings them.
    #[reflect(@Required)]
    pub file: AssetPath,
    /// The mesh of a glTF file, or the object or group of an `.obj` file: its name, or `#3` for its number, from 0. Left
    /// out, the only mesh of a glTF file, or all of an `.obj` file.
    pub mesh: Option<String>,
    /// One primitive of the mesh, from 0; in an `.obj` file what the object has of one material. Left out, all of them.
    #[reflect(@Range::at_least(0.0))]
    pub primitive: Option<u32>,
    /// Whether the file's normals shade the surface. Without them, or when off, faces look flat: none are invented.
    pub smooth: bool,
    /// Whether the colours of the file's vertices multiply `Diffuse.albedo`, `Principled.base_color` and `Principled.alpha`.
    pub colors: bool,
}

impl Default for Mesh {
    fn default() -> Self {
        Self {
            file: AssetPath::default(),
            mesh: None,
            primitive: None,
            smooth: true,
            colors: true,
        }
    }
}

/// The geometry components of a prim, whichever it has.
#[derive(QueryData)]
pub struct GeometryComponents {
    sphere: Option<&'static Sphere>,
    quad: Option<&'static Quad>,
    disc: Option<&'static Disc>,
    cuboid: Option<&'static Cuboid>,
    cylinder: Option<&'static Cylinder>,
    torus: Option<&'static Torus>,
    band: Option<&'static Band>,
    mesh: Option<&'static Mesh>,
}

/// What a geometry component stands for.
#[derive(Clone, Copy, Debug)]
pub enum GeometrySource<'a> {
    /// An analytic shape.
    Shape(Shape),
    /// The triangles of a file.
    Mesh(&'a Mesh),
}

impl<'w> GeometryComponentsItem<'w, '_> {
    /// Name and meaning of each geometry component of the prim. A sound prim has at most one.
    pub fn sources(&self) -> impl Iterator<Item = (&'static str, GeometrySource<'w>)> {
        let shapes = [
            self.sphere.map(|s| ("Sphere", Shape::Sphere { radius: s.radius })),
            self.quad.map(|q| ("Quad", Shape::Quad { size: q.size })),
            self.disc.map(|d| ("Disc", Shape::Disc { radius: d.radius })),
            self.cuboid.map(|c| ("Cuboid", Shape::Cuboid { size: c.size })),
            self.cylinder.map(|c| ("Cylinder", c.shape())),
            self.torus.map(|t| ("Torus", t.shape())),
            self.band.map(|b| ("Band", b.shape())),
        ];
        let shapes = shapes
            .into_iter()
            .flatten()
            .map(|(name, shape)| (name, GeometrySource::Shape(shape)));
        shapes.chain(self.mesh.map(|mesh| ("Mesh", GeometrySource::Mesh(mesh))))
    }
}

impl Cylinder {
    fn shape(&self) -> Shape {
        Shape::Cylinder {
            radius: self.radius,
            height: self.height,
            capped: self.capped,
        }
    }
}

impl Torus {
    fn shape(&self) -> Shape {
        Shape::Torus {
            major_radius: self.major_radius,
            minor_radius: self.minor_radius,
        }
    }
}

impl Band {
    fn shape(&self) -> Shape {
        Shape::Band {
            inner_radius: self.inner_radius,
            outer_radius: self.outer_radius,
            height: self.height,
            bevel: self.bevel,
        }
    }
}

use thiserror::Error;

/// Why a scene could not be prepared for ray queries.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SpatialError {
    /// The transform of an instance has no inverse, so that nothing can be traced through it.
    #[error("instance {instance}: its transform is singular; give every axis a scale other than 0")]
    SingularTransform {
        /// Row of the instance.
        instance: usize,
    },
    /// The transform of an instance contains an infinity or a NaN.
    #[error("instance {instance}: its transform is not finite")]
    NonFiniteTransform {
        /// Row of the instance.
        instance: usize,
    },
    /// The geometry of an instance reaches further than can be computed with in single precision.
    #[error(
        "instance {instance}: it reaches further than 1e15 m from the middle of the scene; bring it nearer or make it smaller"
    )]
    Overflow {
        /// Row of the instance.
        instance: usize,
    },
    /// An instance names a geometry that does not exist.
    #[error("instance {instance}: geometry {geometry} does not exist, there are {count}")]
    UnknownGeometry {
        /// Row of the instance.
        instance: usize,
        /// Row that it names.
        geometry: u32,
        /// How many geometries there are.
        count: usize,
    },
    /// The dimensions of a shape enclose nothing.
    #[error("geometry {geometry}: {reason}")]
    InvalidShape {
        /// Row of the geometry.
        geometry: usize,
        /// What is wrong, and what would be right.
        reason: &'static str,
    },
    /// A triangle names a vertex that does not exist.
    #[error("geometry {geometry}: triangle {triangle} names vertex {vertex}, there are {count}")]
    VertexOutOfRange {
        /// Row of the geometry.
        geometry: usize,
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// A vertex position, normal or texture coordinate is an infinity or a NaN.
    #[error("geometry {geometry}: the {attribute} of vertex {vertex} is not finite")]
    NonFiniteVertex {
        /// Row of the geometry.
        geometry: usize,
        /// `position`, `normal` or `uv`.
        attribute: &'static str,
        /// The vertex.
        vertex: usize,
    },
    /// A vertex of a mesh is further from the origin of its file than can be computed with in single precision.
    #[error("geometry {geometry}: vertex {vertex} lies further than 1e15 from the origin; write smaller coordinates")]
    VertexTooFar {
        /// Row of the geometry.
        geometry: usize,
        /// The vertex.
        vertex: usize,
    },
    /// A vertex attribute has not one value for each position.
    #[error("geometry {geometry}: {count} {attribute}s for {positions} positions")]
    AttributeCount {
        /// Row of the geometry.
        geometry: usize,
        /// `normal` or `uv`.
        attribute: &'static str,
        /// How many values there are.
        count: usize,
        /// How many positions there are.
        positions: usize,
    },
    /// More primitives than row numbers of 32 bits can name.
    #[error("too many primitives: {count}; at most 2³¹ are possible")]
    TooManyPrimitives {
        /// How many there are.
        count: usize,
    },
}

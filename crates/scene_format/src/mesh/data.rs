//! What a mesh is once it is read, and what is done to every mesh.

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::error::{MeshPlace, MeshWarning, Oddity};
use super::obj_scan::Tally;

/// Sine of the least angle that a triangle with an area has.
const LEAST_SINE: f64 = 1e-12;

/// A mesh of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// The middle of the bounding box, in the units of the file.
    pub origin: DVec3,
    /// Relative to `origin`.
    pub positions: Vec<Vec3>,
    /// One for each position, unit length; only if every face has them.
    pub normals: Option<Vec<Vec3>>,
    /// One for each position; only if every face has them. (0, 0) is the lower left of a picture, whatever the file's
    /// own convention.
    pub uvs: Option<Vec<Vec2>>,
    /// Further sets of texture coordinates, from the second on, like `uvs`. glTF only.
    pub more_uvs: Vec<Vec<Vec2>>,
    /// Linear red, green, blue and coverage, one for each position. glTF only.
    pub colours: Option<Vec<Vec4>>,
    /// Indices into the positions, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// What is odd about it.
    pub warnings: Vec<MeshWarning>,
}

/// A mesh before its positions are centred and its flat triangles dropped.
#[derive(Debug, Default)]
pub(crate) struct RawMesh {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) normals: Option<Vec<Vec3>>,
    pub(crate) uv_sets: Vec<Vec<Vec2>>,
    pub(crate) colours: Option<Vec<Vec4>>,
    /// Each within the positions.
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) warnings: Vec<MeshWarning>,
}

/// Why a raw mesh is no mesh.
#[derive(Debug)]
pub(crate) enum Unusable {
    /// No triangle has an area; the place of the first.
    Flat(MeshPlace),
    /// Its positions are further apart than single precision can hold.
    TooWide,
}

impl RawMesh {
    /// Centres the positions and leaves out the triangles without an area.
    ///
    /// - `place_of`: where the triangle of a number was written; called with rising numbers.
    pub(crate) fn finish(self, mut place_of: impl FnMut(usize) -> MeshPlace) -> Result<MeshData, Unusable> {
        let start = self.positions.first().copied().unwrap_or_default();
        let (low, high) = self
            .positions
            .iter()
            .fold((start, start), |(low, high), p| (low.min(*p), high.max(*p)));
        let origin = low * 0.5 + high * 0.5;
        let mut relative = self.positions;
        for position in &mut relative {
            *position -= origin;
        }
        let limit = f64::from(f32::MAX) * 0.5;
        if relative.iter().any(|p| p.abs().max_element() > limit) {
            return Err(Unusable::TooWide);
        }
        let mut flat = Tally::default();
        let mut number = 0;
        let mut triangles = self.triangles;
        triangles.retain(|corners| {
            let [a, b, c] = corners.map(|corner| relative[corner as usize]);
            let fine = has_area(a, b, c);
            let place = place_of(number);
            if !fine {
                flat.add(place);
            }
            number += 1;
            fine
        });
        if triangles.is_empty() {
            return Err(Unusable::Flat(flat.first));
        }
        let mut warnings = self.warnings;
        warnings.extend(flat.warning(Oddity::DegenerateTriangle));
        let mut uv_sets = self.uv_sets.into_iter();
        Ok(MeshData {
            origin,
            positions: relative.iter().map(|p| p.as_vec3()).collect(),
            normals: self.normals,
            uvs: uv_sets.next(),
            more_uvs: uv_sets.collect(),
            colours: self.colours,
            triangles,
            warnings,
        })
    }
}

/// Makes a vector that is not zero one long, however long it is.
pub(crate) fn unit(vector: DVec3) -> Vec3 {
    (vector / vector.abs().max_element()).normalize().as_vec3()
}

fn has_area(a: DVec3, b: DVec3, c: DVec3) -> bool {
    let [ab, ac] = [b - a, c - a];
    let longest = ab.abs().max_element().max(ac.abs().max_element());
    if longest == 0.0 {
        return false;
    }
    // Scaled first, so that nothing over- or underflows.
    let [ab, ac] = [ab / longest, ac / longest];
    let bc = ac - ab;
    let product = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    ab.cross(ac).length() > LEAST_SINE * product
}

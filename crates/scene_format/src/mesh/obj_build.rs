//! From the arrays of an OBJ file to meshes.

use std::collections::{BTreeSet, HashMap};

use glam::{Vec2, Vec3};

use super::data::{MeshData, RawMesh, Unusable, unit};
use super::error::{MeshError, MeshPlace, Oddity};
use super::obj_scan::{Face, NONE, ObjFile, Tally};

impl ObjFile {
    /// Builds one mesh of all faces.
    pub(crate) fn whole(&self, file: &str) -> Result<MeshData, MeshError> {
        self.build(file, self.faces.iter())
    }

    /// Builds one mesh of some parts. Cost: linear in their faces.
    pub(crate) fn of_parts(&self, file: &str, parts: &[u32]) -> Result<MeshData, MeshError> {
        let faces = parts.iter().flat_map(|part| &self.faces_of_part[*part as usize]);
        self.build(file, faces.map(|face| &self.faces[*face as usize]))
    }

    fn build<'f>(&'f self, file: &str, faces: impl Iterator<Item = &'f Face> + Clone) -> Result<MeshData, MeshError> {
        let (use_uvs, use_normals, warnings) = self.usable(faces.clone());
        let mut raw = RawMesh {
            normals: use_normals.then(Vec::new),
            uv_sets: if use_uvs { vec![Vec::new()] } else { Vec::new() },
            warnings,
            ..RawMesh::default()
        };
        // Never iterated, so its order does not matter.
        let mut vertex_of_corner: HashMap<[u32; 3], u32> = HashMap::new();
        let mut vertices: Vec<u32> = Vec::new();
        for face in faces.clone() {
            vertices.clear();
            for corner in self.corners_of(face) {
                let key = [
                    corner[0],
                    if use_uvs { corner[1] } else { NONE },
                    if use_normals { corner[2] } else { NONE },
                ];
                let next = raw.positions.len() as u32;
                let vertex = *vertex_of_corner.entry(key).or_insert(next);
                if vertex == next {
                    self.push_vertex(&mut raw, key);
                }
                vertices.push(vertex);
            }
            let fan = (2..vertices.len()).map(|last| [vertices[0], vertices[last - 1], vertices[last]]);
            raw.triangles.extend(fan);
        }
        let mut lines = faces.flat_map(|face| std::iter::repeat_n(face.line as usize, face.corners as usize - 2));
        raw.finish(|_| MeshPlace::Line(lines.next().unwrap_or(0)))
            .map_err(|problem| match problem {
                Unusable::Flat(first) => MeshError::OnlyDegenerate {
                    file: file.to_owned(),
                    first,
                },
                Unusable::TooWide => MeshError::TooWide {
                    file: file.to_owned(),
                    limit: f64::from(f32::MAX),
                },
            })
    }

    fn corners_of(&self, face: &Face) -> &[[u32; 3]] {
        &self.corners[face.first_corner..][..face.corners as usize]
    }

    fn push_vertex(&self, raw: &mut RawMesh, [position, uv, normal]: [u32; 3]) {
        raw.positions.push(self.positions[position as usize]);
        if let Some(uvs) = raw.uv_sets.first_mut() {
            let uv: Vec2 = self.uvs[uv as usize].as_vec2();
            uvs.push(uv);
        }
        if let Some(normals) = &mut raw.normals {
            let normal: Vec3 = unit(self.normals[normal as usize]);
            normals.push(normal);
        }
    }

    /// Tells whether all faces have texture coordinates and normals, and what is odd about them.
    fn usable<'f>(&'f self, faces: impl Iterator<Item = &'f Face>) -> (bool, bool, Vec<super::MeshWarning>) {
        let [mut bare_normals, mut bare_uvs, mut zero] = <[Tally; 3]>::default();
        let mut count = 0;
        let mut zeros = BTreeSet::new();
        for face in faces {
            count += 1;
            let line = MeshPlace::Line(face.line as usize);
            let corners = self.corners_of(face);
            if corners.iter().any(|corner| corner[1] == NONE) {
                bare_uvs.add(line);
            }
            if corners.iter().any(|corner| corner[2] == NONE) {
                bare_normals.add(line);
            }
            if !self.zero_normals.is_empty() {
                let found = corners.iter().filter_map(|corner| {
                    let row = self
                        .zero_normals
                        .binary_search_by_key(&corner[2], |(normal, _)| *normal);
                    row.ok()
                });
                zeros.extend(found);
            }
        }
        for row in zeros {
            zero.add(MeshPlace::Line(self.zero_normals[row].1 as usize));
        }
        let mut warnings = Vec::new();
        if count == self.faces.len() {
            warnings.extend(self.few.warning(Oddity::FewCorners));
        }
        if bare_normals.count < count {
            warnings.extend(bare_normals.warning(Oddity::PartialNormals));
            warnings.extend(zero.warning(Oddity::ZeroNormal));
        }
        if bare_uvs.count < count {
            warnings.extend(bare_uvs.warning(Oddity::PartialUvs));
        }
        let use_normals = bare_normals.count == 0 && zero.count == 0;
        (bare_uvs.count == 0, use_normals, warnings)
    }
}

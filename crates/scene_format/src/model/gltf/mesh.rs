//! Meshes of a glTF file, found by name and read.

use std::collections::BTreeMap;

use super::super::error::{Fault, quote_some};
use super::super::meshes::MeshPart;
use super::super::{ModelFile, ModelLimits};
use super::buffers::Buffers;
use super::document::Document;
use super::graph::no_such;
use super::image;
use super::json::Mesh;
use super::primitive::{Shape, is_drawn};
use super::triangles::{Data, read};
use crate::mesh::Unusable;
use crate::mesh::{MeshData, MeshLimits, MeshPlace, Oddity, RawMesh, Tally};

/// Triangles and vertices that may be made of each byte of the files: a few bytes that claim to be many meshes, all of
/// the same data, must not fill the memory.
const COST_PER_BYTE: u64 = 32;

/// Triangles and vertices that may be made of a file, however small it is.
const LEAST_COST: u64 = 1_000_000;

/// A file whose meshes and images can be read.
#[derive(Debug)]
pub(in crate::model) struct GltfMeshes {
    document: Document,
    names: MeshNames,
    buffers: Buffers,
    /// Vertices and indices that were read so far.
    cost: u64,
    limits: MeshLimits,
}

impl GltfMeshes {
    pub(in crate::model) fn open(file: &ModelFile<'_>, limits: &MeshLimits) -> Result<Self, Fault> {
        let model_limits = ModelLimits {
            bytes: limits.bytes,
            ..ModelLimits::default()
        };
        let document = Document::parse(file, &model_limits)?;
        let left = limits.bytes.saturating_sub(file.bytes.len() as u64);
        Ok(Self {
            names: MeshNames::of(&document.root.meshes, model_limits.name_bytes),
            buffers: Buffers::new(&document.root, left),
            document,
            cost: 0,
            limits: limits.clone(),
        })
    }

    /// Files that were read besides.
    pub(in crate::model) fn files(&self) -> &[(std::path::PathBuf, Vec<u8>)] {
        self.buffers.files()
    }

    /// Reads the primitives of a mesh, or one of them.
    pub(in crate::model) fn read(&mut self, part: &MeshPart, file: &ModelFile<'_>) -> Result<MeshData, Fault> {
        let number = self.find(part)?;
        let primitives = &self.document.root.meshes[number].primitives;
        let count = primitives.len();
        let wanted = match part.primitive {
            None => 0..count,
            Some(primitive) if (primitive as usize) < count => primitive as usize..primitive as usize + 1,
            Some(primitive) => return Err(no_such(&format!("meshes[{number}]"), "primitive", primitive, count)),
        };
        let mut raws = Vec::new();
        for primitive in wanted {
            let described = &self.document.root.meshes[number].primitives[primitive];
            if is_drawn(described) {
                raws.push((primitive, self.read_primitive(number, primitive, file)?));
            } else if part.primitive.is_some() {
                let at = format!("meshes[{number}].primitives[{primitive}]");
                return Err(Fault::unsupported(&at, "it has no triangles"));
            }
        }
        let at = format!("meshes[{number}]");
        if raws.iter().map(|(_, raw)| raw.positions.len()).sum::<usize>() > self.limits.vertices {
            let message = format!("more than {} vertices", self.limits.vertices);
            return Err(Fault::limit(&at, message));
        }
        if raws.is_empty() {
            return Err(Fault::unsupported(&at, "it has no triangles"));
        }
        join(raws).finish(MeshPlace::Triangle).map_err(|problem| match problem {
            Unusable::Flat(first) => Fault::flat(&at, format!("no triangle has an area; the first {first}")),
            Unusable::TooWide => Fault::limit(&at, "its positions are further apart than single precision can hold")
                .remedy("scale the model down"),
        })
    }

    /// Reads the bytes of an image.
    pub(in crate::model) fn image(&mut self, number: u32, file: &ModelFile<'_>) -> Result<Vec<u8>, Fault> {
        image::read(number, &self.document, &mut self.buffers, file)
    }

    fn read_primitive(&mut self, mesh: usize, primitive: usize, file: &ModelFile<'_>) -> Result<RawMesh, Fault> {
        let root = &self.document.root;
        let at = format!("meshes[{mesh}].primitives[{primitive}]");
        // Three indices a triangle; strips and fans have fewer, which the limit forgives.
        let most = self
            .limits
            .vertices
            .max(self.limits.triangles.saturating_mul(3))
            .min(u32::MAX as usize);
        let shape = Shape::of(root, &root.meshes[mesh].primitives[primitive], &at, most)?;
        if shape.positions.count > self.limits.vertices {
            let message = format!("more than {} vertices", self.limits.vertices);
            return Err(Fault::limit(&at, message));
        }
        for layout in shape.layouts() {
            let sparse = layout.sparse.iter().flat_map(|sparse| [sparse.indices, sparse.values]);
            for span in layout.base.into_iter().chain(sparse) {
                self.buffers.load(span.buffer, root, self.document.bin.as_ref(), file)?;
            }
        }
        self.cost = self.cost.saturating_add(shape.cost());
        let read_bytes: usize = self.buffers.files().iter().map(|(_, bytes)| bytes.len()).sum();
        let budget = LEAST_COST + COST_PER_BYTE * (file.bytes.len() + read_bytes) as u64;
        if self.cost > budget {
            let message = format!("with it, {budget} vertices would be made of a file that is too small for them");
            return Err(Fault::limit(&at, message).remedy("let nodes share meshes, instead of meshes share data"));
        }
        let data = Data {
            buffers: &self.buffers,
            model: *file,
        };
        read(&shape, data)
    }

    fn find(&self, part: &MeshPart) -> Result<usize, Fault> {
        let meshes = &self.document.root.meshes;
        let Some(wanted) = &part.mesh else {
            return match meshes.len() {
                1 => Ok(0),
                0 => Err(Fault::invalid("meshes", "there is no mesh in the file")),
                count => Err(
                    Fault::invalid("meshes", format!("there are {count}, and none is named")).remedy(&format!(
                        "write `mesh: {:?}`, or one of the others",
                        self.names.names[0]
                    )),
                ),
            };
        };
        self.names.find(wanted).ok_or_else(|| {
            let fault = Fault::invalid("meshes", format!("there is no mesh {wanted:?}"));
            let known = self.names.names.iter().map(String::as_str);
            match crate::diagnostic::nearest(wanted, known.clone()) {
                Some(name) => fault.remedy(&format!("did you mean {name:?}?")),
                None => fault.remedy(&format!("meshes in the file: {}", quote_some(known))),
            }
        })
    }
}

/// What scenes call the meshes of a file.
#[derive(Debug)]
pub(super) struct MeshNames {
    /// By number.
    pub(super) names: Vec<String>,
    by_name: BTreeMap<String, usize>,
}

impl MeshNames {
    /// A mesh is called by its name if that is unique and fit to be written, else `#3` by its number.
    pub(super) fn of(meshes: &[Mesh], longest: usize) -> Self {
        let mut uses: BTreeMap<&str, usize> = BTreeMap::new();
        for mesh in meshes {
            *uses.entry(&mesh.name).or_default() += 1;
        }
        let names: Vec<String> = meshes
            .iter()
            .enumerate()
            .map(|(number, mesh)| match uses.get(mesh.name.as_str()) {
                Some(1) if is_fit(&mesh.name, longest) => mesh.name.clone(),
                _ => format!("#{number}"),
            })
            .collect();
        let by_name = names.iter().cloned().zip(0..).collect();
        Self { names, by_name }
    }

    /// Finds a mesh by what it is called, or by its number.
    fn find(&self, wanted: &str) -> Option<usize> {
        if let Some(number) = self.by_name.get(wanted) {
            return Some(*number);
        }
        let number: usize = wanted.strip_prefix('#')?.parse().ok()?;
        (number < self.names.len()).then_some(number)
    }
}

/// Tells whether a name can be written in a scene, and is not mistaken for a number.
pub(in crate::model) fn is_fit(name: &str, longest: usize) -> bool {
    let fits = !name.is_empty() && name.len() <= longest && !name.starts_with('#');
    fits && !name.contains(|c: char| c.is_control() || c == '"' || c == '\\')
}

/// Makes one mesh of primitives with their numbers; it has what all of them have.
fn join(mut raws: Vec<(usize, RawMesh)>) -> RawMesh {
    if raws.len() == 1
        && let Some((_, only)) = raws.pop()
    {
        return only;
    }
    let sets = raws.iter().map(|(_, raw)| raw.uv_sets.len()).min().unwrap_or(0);
    let all_have = |has: fn(&RawMesh) -> bool| raws.iter().all(|(_, raw)| has(raw));
    let mut joined = RawMesh {
        normals: all_have(|raw| raw.normals.is_some()).then(Vec::new),
        colours: all_have(|raw| raw.colours.is_some()).then(Vec::new),
        uv_sets: vec![Vec::new(); sets],
        ..RawMesh::default()
    };
    let [mut bare_normals, mut bare_uvs] = <[Tally; 2]>::default();
    let count = raws.len();
    for (number, raw) in raws {
        let first = joined.positions.len() as u32;
        joined
            .triangles
            .extend(raw.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
        joined.positions.extend(raw.positions);
        joined.warnings.extend(raw.warnings);
        for _ in 0..raw.triangles.len() {
            if raw.normals.is_none() {
                bare_normals.add(MeshPlace::Primitive(number));
            }
            if raw.uv_sets.is_empty() {
                bare_uvs.add(MeshPlace::Primitive(number));
            }
        }
        if let (Some(all), Some(some)) = (&mut joined.normals, raw.normals) {
            all.extend(some);
        }
        if let (Some(all), Some(some)) = (&mut joined.colours, raw.colours) {
            all.extend(some);
        }
        for (all, some) in joined.uv_sets.iter_mut().zip(raw.uv_sets) {
            all.extend(some);
        }
    }
    let triangles = joined.triangles.len();
    if count > 1 && bare_normals.count < triangles {
        joined.warnings.extend(bare_normals.warning(Oddity::PartialNormals));
    }
    if bare_uvs.count < triangles {
        joined.warnings.extend(bare_uvs.warning(Oddity::PartialUvs));
    }
    joined
}

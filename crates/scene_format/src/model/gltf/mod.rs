//! glTF 2.0, as text or in the binary container.
//!
//! The `json` types say what a file says; everything that they claim is checked by hand before it is used. Translation
//! looks at the structure alone and needs no buffer; triangles are read by [`GltfMeshes`].
//!
//! Source: Khronos Group, glTF 2.0 specification, version 2.0.1. Differs: data that is not aligned to its size is read,
//! and positions and texture coordinates of whole numbers are read whether or not `KHR_mesh_quantization` is named.

mod accessor;
mod buffers;
mod container;
mod document;
mod elements;
mod graph;
mod image;
mod json;
mod lamp;
mod material;
mod material_json;
mod mesh;
mod node;
mod primitive;
mod texture;
mod triangles;

pub(super) use mesh::{GltfMeshes, is_fit};

use std::collections::BTreeSet;

use super::error::{Fault, ModelWarning};
use super::names::{Wanted, legal_name, sibling_names};
use super::write::{Component, LayerText};
use super::{ModelFile, ModelLimits, TranslatedModel};
use crate::schema::Schema;
use document::Document;
use json::Root;
use material::PrimMaterial;
use mesh::MeshNames;

/// The scope that holds the materials of a model.
pub(super) const MATERIALS: &str = "Materials";

/// What is the same for all prims of a file.
struct Translation<'a> {
    root: &'a Root,
    schema: &'a Schema<'a>,
    /// What prims call the file.
    file_name: &'a str,
    root_name: String,
    meshes: MeshNames,
    /// For each mesh the primitives that are drawn.
    drawn_of_mesh: Vec<Vec<u32>>,
    materials: Vec<PrimMaterial>,
    /// What primitives without a material have.
    default_material: Option<PrimMaterial>,
    warnings: Vec<ModelWarning>,
    /// What is left out, each once.
    left_out: BTreeSet<&'static str>,
}

/// Writes the scene of a file as a layer.
pub(super) fn translate(
    file: &ModelFile<'_>,
    file_name: &str,
    schema: &Schema<'_>,
    limits: &ModelLimits,
) -> Result<TranslatedModel, Fault> {
    let document = Document::parse(file, limits)?;
    let root = &document.root;
    let roots = graph::scene_roots(root)?;
    let root_name = root_name(file_name, limits);
    let mut translation = Translation {
        root,
        schema,
        file_name,
        meshes: MeshNames::of(&root.meshes, limits.name_bytes),
        drawn_of_mesh: Vec::new(),
        materials: Vec::new(),
        default_material: None,
        root_name,
        warnings: document.warnings.clone(),
        left_out: BTreeSet::new(),
    };
    translation.note_absences(&roots);
    accessor::check_views(root)?;
    translation.check_meshes()?;
    translation.convert_materials(limits)?;
    let mut text = LayerText::new(&translation.root_name, limits);
    text.open(&translation.root_name, "", "")?;
    translation.write_materials(&mut text)?;
    translation.write_nodes(&roots, &[MATERIALS], &mut text, limits)?;
    text.close();
    Ok(TranslatedModel {
        text: text.finish(),
        warnings: translation.finish_warnings(),
        files: Vec::new(),
    })
}

/// The name of a file without its ending, made legal.
pub(super) fn root_name(file_name: &str, limits: &ModelLimits) -> String {
    let stem = file_name.rsplit_once('.').map_or(file_name, |(stem, _)| stem);
    legal_name(
        &Wanted {
            name: stem,
            fallback: "Model".to_owned(),
        },
        limits.name_bytes,
    )
}

impl Translation<'_> {
    fn note_absences(&mut self, roots: &[u32]) {
        if !self.root.animations.is_empty() {
            self.left_out.insert("animations");
        }
        if !self.root.skins.is_empty() {
            self.left_out.insert("skins (meshes stay in their first pose)");
        }
        if self.root.scenes.len() > 1 {
            self.warn(
                "scenes",
                format!("only scene {} of several is used", self.root.scene.unwrap_or(0)),
            );
        }
        if roots.is_empty() {
            self.warn(
                "",
                "the scene of the file has no nodes, so there is nothing to see".to_owned(),
            );
        }
    }

    fn warn(&mut self, at: &str, message: String) {
        self.warnings.push(ModelWarning {
            at: at.to_owned(),
            message,
        });
    }

    /// Notes that something is left out if the schema does not have its component.
    fn knows(&mut self, component: &str, what: &'static str) -> bool {
        let known = self.schema.index_of(component).is_some();
        if !known {
            self.left_out.insert(what);
        }
        known
    }

    fn convert_materials(&mut self, limits: &ModelLimits) -> Result<(), Fault> {
        let root = self.root;
        texture::check_textures(root)?;
        self.warnings.extend(texture::check_samplers(root));
        let schema = self.schema;
        let Some(info) = schema.component(material::SURFACE) else {
            self.left_out.insert("materials");
            return Ok(());
        };
        let wanted: Vec<Wanted<'_>> = root
            .materials
            .iter()
            .enumerate()
            .map(|(number, material)| Wanted {
                name: &material.name,
                fallback: format!("Material{number}"),
            })
            .collect();
        let names = sibling_names(&wanted, &[], limits.name_bytes);
        for ((number, material), name) in root.materials.iter().enumerate().zip(names) {
            let converted = self.convert_material(material, info, &format!("materials[{number}]"), name)?;
            self.materials.push(converted);
        }
        let mut primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
        if primitives.any(|primitive| primitive.material.is_none() && primitive::is_drawn(primitive)) {
            let taken: Vec<&str> = self.materials.iter().map(|material| material.name.as_str()).collect();
            let wanted = Wanted {
                name: "Default",
                fallback: String::new(),
            };
            let name = sibling_names(&[wanted], &taken, limits.name_bytes).concat();
            self.default_material = Some(self.convert_material(&json::Material::default(), info, "", name)?);
        }
        Ok(())
    }

    fn write_materials(&self, text: &mut LayerText<'_>) -> Result<(), Fault> {
        if self.materials.is_empty() && self.default_material.is_none() {
            return Ok(());
        }
        text.open(MATERIALS, "", "materials")?;
        for (number, material) in self.materials.iter().chain(&self.default_material).enumerate() {
            let original = self.root.materials.get(number).map_or("", |material| &material.name);
            text.open(&material.name, original, &format!("materials[{number}]"))?;
            text.component(&material.surface);
            text.close();
        }
        text.close();
        Ok(())
    }

    /// The component that gives a prim its material.
    fn bind(&self, material: Option<u32>, at: &str) -> Result<Option<Component>, Fault> {
        let count = self.root.materials.len();
        let found = match material {
            None => self.default_material.as_ref(),
            Some(index) if index as usize >= count => {
                return Err(graph::no_such(&format!("{at}.material"), "material", index, count));
            }
            Some(index) => self.materials.get(index as usize),
        };
        Ok(found.map(|found| {
            let path = format!("/{}/{MATERIALS}/{}", self.root_name, found.name);
            Component::new("MaterialBinding").text("target", &path)
        }))
    }

    /// All that is left out becomes one warning.
    fn finish_warnings(mut self) -> Vec<ModelWarning> {
        if !self.left_out.is_empty() {
            let all: Vec<&str> = self.left_out.iter().copied().collect();
            self.warn("", format!("not supported yet, so left out: {}", all.join(", ")));
        }
        self.warnings
    }
}

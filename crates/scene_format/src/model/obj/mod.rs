//! Wavefront OBJ files: objects and groups become prims, each with what it has of one material.
//!
//! A file of one object and one material becomes a single prim; an object of several materials has a child for each.
//! Statements of groups and objects begin the same thing, and the last one counts. Only the division of the file is
//! read here; the lines with numbers are checked when [`ObjMeshes`] reads them.

mod libraries;
mod material;
mod mtl;

use super::error::{Fault, ModelWarning, quote_some};
use super::gltf::{MATERIALS, is_fit, root_name};
use super::meshes::MeshPart;
use super::names::{Wanted, sibling_names};
use super::write::{Component, LayerText};
use super::{ModelFile, ModelLimits, TranslatedModel};
use crate::mesh::{Lines, MeshData, MeshError, MeshLimits, ObjFile, ObjParts, keyword_and_rest, obj_text, words};
use crate::schema::Schema;
use libraries::Libraries;
use material::PrimMaterial;
use mtl::{Library, MtlMaterial};

/// An OBJ file whose meshes can be read.
#[derive(Debug)]
pub(super) struct ObjMeshes(ObjFile);

impl ObjMeshes {
    pub(super) fn open(file: &ModelFile<'_>, limits: &MeshLimits) -> Result<Self, Fault> {
        Ok(Self(ObjFile::parse(file.name, file.bytes, limits)?))
    }

    /// Reads everything, an object, or what an object has of one material.
    pub(super) fn read(&self, part: &MeshPart, file: &ModelFile<'_>) -> Result<MeshData, Fault> {
        let objects = &self.0.parts.objects;
        let object = match &part.mesh {
            None if part.primitive.is_none() => return Ok(self.0.whole(file.name)?),
            None if objects.len() == 1 => 0,
            None => {
                let message = format!("there are {} objects, and none is named", objects.len());
                return Err(Fault::invalid("", message).remedy("write `mesh` with the name of an object"));
            }
            Some(name) => self.find(name)?,
        };
        let parts = &objects[object].parts;
        let Some(primitive) = part.primitive else {
            return Ok(self.0.of_parts(file.name, parts)?);
        };
        match parts.get(primitive as usize) {
            Some(part) => Ok(self.0.of_parts(file.name, &[*part])?),
            None => {
                let message = format!(
                    "there is no part {primitive} of object {object}, which has {}",
                    parts.len()
                );
                Err(Fault::invalid("", message).remedy("parts are counted from 0, one for each material"))
            }
        }
    }

    fn find(&self, name: &str) -> Result<usize, Fault> {
        let parts = &self.0.parts;
        let numbered = || {
            let number: usize = name.strip_prefix('#')?.parse().ok()?;
            (number < parts.objects.len()).then_some(number)
        };
        parts.object_of_name(name).or_else(numbered).ok_or_else(|| {
            let names = parts.objects.iter().map(|object| object.name.as_str());
            let fault = Fault::invalid("", format!("there is no object or group {name:?}"));
            match crate::diagnostic::nearest(name, names.clone()) {
                Some(near) => fault.remedy(&format!("did you mean {near:?}?")),
                None => fault.remedy(&format!("objects in the file: {}", quote_some(names))),
            }
        })
    }
}

/// Writes a file as a layer.
pub(super) fn translate(
    file: &ModelFile<'_>,
    file_name: &str,
    schema: &Schema<'_>,
    limits: &ModelLimits,
) -> Result<TranslatedModel, Fault> {
    let text = obj_text(file.name, file.bytes, limits.bytes)?;
    let mut parts = ObjParts::default();
    let mut libraries = Libraries::default();
    for (line, text) in Lines::of(text) {
        match keyword_and_rest(&text) {
            ("f", _) if words(&text).count() > 3 => {
                parts.face();
            }
            ("mtllib", names) => libraries.read(names, line, file, limits),
            (keyword, rest) => parts.statement(keyword, rest),
        }
    }
    if parts.objects.is_empty() {
        let file = file.name.to_owned();
        return Err(MeshError::NoFaces { file }.into());
    }
    let materials = libraries.library.materials.iter();
    let wanted: Vec<Wanted<'_>> = materials
        .clone()
        .enumerate()
        .map(|(number, material)| Wanted {
            name: &material.name,
            fallback: format!("Material{number}"),
        })
        .collect();
    let names = sibling_names(&wanted, &[], limits.name_bytes);
    let diffuse = schema.component("Diffuse");
    let has_textures = diffuse.is_some_and(|info| info.field("albedo_texture").is_some());
    let mut translation = Translation {
        file_name,
        root_name: root_name(file_name, limits),
        materials: materials
            .zip(names)
            .map(|(material, name)| material::convert(material, name, has_textures))
            .collect(),
        parts: &parts,
        library: &libraries.library,
        warnings: libraries.warnings.clone(),
    };
    translation.warn_of_unknown();
    translation.warn_of_textures(has_textures);
    Ok(TranslatedModel {
        text: translation.write(limits)?,
        warnings: translation.warnings,
        files: libraries.files,
    })
}

/// What is the same for all prims of a file.
struct Translation<'a> {
    file_name: &'a str,
    root_name: String,
    parts: &'a ObjParts,
    library: &'a Library,
    materials: Vec<PrimMaterial>,
    warnings: Vec<ModelWarning>,
}

impl Translation<'_> {
    fn write(&self, limits: &ModelLimits) -> Result<String, Fault> {
        let mut text = LayerText::new(&self.root_name, limits);
        text.open(&self.root_name, "", "")?;
        let objects = &self.parts.objects;
        if let [object] = &objects[..] {
            let only = Component::new("Mesh").text("file", self.file_name);
            self.write_object(0, only, object.parts.len() == 1, &[MATERIALS], &mut text, limits)?;
        } else {
            let wanted: Vec<Wanted<'_>> = objects
                .iter()
                .enumerate()
                .map(|(number, object)| Wanted {
                    name: &object.name,
                    fallback: format!("Object{number}"),
                })
                .collect();
            let names = sibling_names(&wanted, &[MATERIALS], limits.name_bytes);
            for ((number, object), name) in objects.iter().enumerate().zip(names) {
                text.open(&name, &object.name, "")?;
                let called = if is_fit(&object.name, limits.name_bytes) {
                    object.name.clone()
                } else {
                    format!("#{number}")
                };
                let mesh = Component::new("Mesh")
                    .text("file", self.file_name)
                    .text("mesh", &called);
                self.write_object(number, mesh, object.parts.len() == 1, &[], &mut text, limits)?;
                text.close();
            }
        }
        self.write_materials(&mut text)?;
        text.close();
        Ok(text.finish())
    }

    /// Writes an object on the open prim, or as its children if it has several materials.
    fn write_object(
        &self,
        number: usize,
        mesh: Component,
        alone: bool,
        taken: &[&str],
        text: &mut LayerText<'_>,
        limits: &ModelLimits,
    ) -> Result<(), Fault> {
        let parts = &self.parts.objects[number].parts;
        if alone {
            return parts.iter().try_for_each(|part| {
                self.write_part(*part, &mesh, text);
                Ok(())
            });
        }
        let wanted: Vec<Wanted<'_>> = parts
            .iter()
            .map(|part| Wanted {
                name: self.parts.material_name(*part).unwrap_or("Plain"),
                fallback: "Plain".to_owned(),
            })
            .collect();
        let names = sibling_names(&wanted, taken, limits.name_bytes);
        for ((row, part), name) in parts.iter().enumerate().zip(names) {
            let original = self.parts.material_name(*part).unwrap_or("");
            text.open(&name, original, "")?;
            let mesh = mesh.clone().raw("primitive", row.to_string());
            self.write_part(*part, &mesh, text);
            text.close();
        }
        Ok(())
    }

    fn write_part(&self, part: u32, mesh: &Component, text: &mut LayerText<'_>) {
        text.component(mesh);
        let row = self
            .parts
            .material_name(part)
            .and_then(|name| self.library.row_of(name));
        if let Some(material) = row.map(|row| &self.materials[row]) {
            let path = format!("/{}/{MATERIALS}/{}", self.root_name, material.name);
            text.component(&Component::new("MaterialBinding").text("target", &path));
            if let Some(emission) = &material.emission {
                text.component(emission);
            }
        }
    }

    fn write_materials(&self, text: &mut LayerText<'_>) -> Result<(), Fault> {
        if self.materials.is_empty() {
            return Ok(());
        }
        text.open(MATERIALS, "", "")?;
        for (material, written) in self.materials.iter().zip(&self.library.materials) {
            text.open(&material.name, &written.name, "")?;
            text.component(&material.surface);
            text.close();
        }
        text.close();
        Ok(())
    }

    fn warn_of_unknown(&mut self) {
        let names = self.parts.materials.iter().map(String::as_str);
        let unknown = quote_some(names.filter(|name| self.library.row_of(name).is_none()));
        if !unknown.is_empty() {
            self.warnings.push(ModelWarning {
                at: String::new(),
                message: format!("no library has these materials: {unknown}"),
            });
        }
    }

    fn warn_of_textures(&mut self, has_textures: bool) {
        let lost = |material: &MtlMaterial, converted: &PrimMaterial| {
            let shown = has_textures && converted.surface.name == "Diffuse";
            material.has_other_textures || (material.diffuse_texture.is_some() && !shown)
        };
        let mut pairs = self.library.materials.iter().zip(&self.materials);
        if pairs.any(|(material, converted)| lost(material, converted)) {
            self.warnings.push(ModelWarning {
                at: String::new(),
                message: "not supported yet, so left out: textures other than `map_Kd` of matt materials".to_owned(),
            });
        }
    }
}

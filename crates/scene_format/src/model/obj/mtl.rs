//! Material libraries of OBJ files.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::mesh::{Lines, keyword_and_rest, numbers, words};

/// A material as its library describes it; what is not written is none.
#[derive(Debug, Default, PartialEq)]
pub(super) struct MtlMaterial {
    pub(super) name: String,
    /// `Kd`: diffuse reflectance.
    pub(super) diffuse: Option<DVec3>,
    /// `Ks`: specular reflectance.
    pub(super) specular: Option<DVec3>,
    /// `Ke`: emitted radiance.
    pub(super) emission: Option<DVec3>,
    /// `Tf`: factor for light that goes through.
    pub(super) filter: Option<DVec3>,
    /// `Ns`: exponent of the highlight.
    pub(super) exponent: Option<f64>,
    /// `Ni`: index of refraction.
    pub(super) ior: Option<f64>,
    /// `d`, or 1 − `Tr`: 1 is opaque.
    pub(super) opacity: Option<f64>,
    /// `Pr`: roughness, of the extension for physically based rendering.
    pub(super) roughness: Option<f64>,
    /// `Pm`: metalness, of the same extension.
    pub(super) metallic: Option<f64>,
    /// `illum`: the way to shade it, from 0 to 10.
    pub(super) illumination: Option<f64>,
    /// `map_Kd`: a file with the diffuse reflectance, relative to the model. It multiplies `Kd`.
    pub(super) diffuse_texture: Option<String>,
    /// Whether it has another texture.
    pub(super) has_other_textures: bool,
}

/// From what a library calls a texture to what the layer calls it, or why that is impossible.
pub(super) type FindTexture<'f> = dyn Fn(&str) -> Result<String, String> + 'f;

/// The materials of all libraries of a file.
#[derive(Debug, Default)]
pub(super) struct Library {
    /// In the order of their first descriptions; a later one of the same name does not count.
    pub(super) materials: Vec<MtlMaterial>,
    rows: BTreeMap<String, usize>,
}

impl Library {
    /// Finds a material.
    pub(super) fn row_of(&self, name: &str) -> Option<usize> {
        self.rows.get(name).copied()
    }

    /// Adds the materials of a library. Gives the lines that cannot be read, at most ten, with what is wrong.
    ///
    /// - `find_texture`: finds the file that the library names.
    pub(super) fn read(&mut self, text: &str, find_texture: &FindTexture<'_>) -> Vec<(usize, String)> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut problems = Vec::new();
        let mut current: Option<usize> = None;
        for (line, text) in Lines::of(text) {
            let (keyword, rest) = keyword_and_rest(&text);
            if keyword == "newmtl" {
                current = self.begin(rest);
                continue;
            }
            let Some(material) = current.map(|row| &mut self.materials[row]) else {
                continue;
            };
            if let Err(problem) = material.statement(keyword, rest, &text, find_texture)
                && problems.len() < 10
            {
                problems.push((line, format!("{problem}, so `{keyword}` is left out")));
            }
        }
        problems
    }

    fn begin(&mut self, name: &str) -> Option<usize> {
        if self.rows.contains_key(name) {
            return None;
        }
        let row = self.materials.len();
        self.rows.insert(name.to_owned(), row);
        self.materials.push(MtlMaterial {
            name: name.to_owned(),
            ..MtlMaterial::default()
        });
        Some(row)
    }
}

impl MtlMaterial {
    fn statement(
        &mut self,
        keyword: &str,
        rest: &str,
        line: &str,
        find_texture: &FindTexture<'_>,
    ) -> Result<(), String> {
        match keyword {
            "Kd" => self.diffuse = Some(colour(line)?),
            "Ks" => self.specular = Some(colour(line)?),
            "Ke" => self.emission = Some(colour(line)?),
            "Tf" => self.filter = Some(colour(line)?),
            "Ns" => self.exponent = Some(number(line)?),
            "Ni" => self.ior = Some(number(line)?),
            "d" => self.opacity = Some(number(&line.replacen("-halo", "", 1))?),
            "Tr" => self.opacity = Some(1.0 - number(line)?),
            "Pr" => self.roughness = Some(number(line)?),
            "Pm" => self.metallic = Some(number(line)?),
            "illum" => self.illumination = Some(number(line)?),
            "map_Kd" => self.diffuse_texture = Some(find_texture(rest)?),
            _ if is_map(keyword) => self.has_other_textures = true,
            _ => {}
        }
        Ok(())
    }
}

fn is_map(keyword: &str) -> bool {
    keyword.starts_with("map_") || matches!(keyword, "bump" | "norm" | "disp" | "decal" | "refl")
}

/// Reads `r g b`, or one number for all three.
fn colour(line: &str) -> Result<DVec3, String> {
    let count = words(line).count() - 1;
    let mut words = words(line).skip(1);
    if count == 1 {
        return numbers::<1>(&mut words, 1).map(|[grey]| DVec3::splat(grey));
    }
    numbers(&mut words, 3).map(DVec3::from_array)
}

fn number(line: &str) -> Result<f64, String> {
    numbers::<1>(&mut words(line).skip(1), 1).map(|[number]| number)
}

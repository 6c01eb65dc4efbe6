//! What an OBJ file is divided into: objects or groups, and in each the materials.

use std::collections::BTreeMap;

/// An object or group, all of its mentions together.
#[derive(Debug)]
pub(crate) struct ObjObject {
    /// What `o` or `g` says; empty for faces before the first of them.
    pub(crate) name: String,
    /// Numbers of its parts, in the order of their first faces.
    pub(crate) parts: Vec<u32>,
}

/// The objects of a file, in the order of their first faces.
#[derive(Debug, Default)]
pub(crate) struct ObjParts {
    pub(crate) objects: Vec<ObjObject>,
    /// Names of materials, as `usemtl` gives them.
    pub(crate) materials: Vec<String>,
    /// For each part its material.
    pub(crate) material_of_part: Vec<Option<u32>>,
    row_of_object: BTreeMap<String, usize>,
    row_of_material: BTreeMap<String, u32>,
    part_of: BTreeMap<(usize, Option<u32>), u32>,
    name: String,
    material: Option<u32>,
    /// The part of the last face, if nothing was said since.
    part: Option<u32>,
}

impl ObjParts {
    /// Takes a line that may begin a part: `o`, `g` or `usemtl` with the rest of the line.
    pub(crate) fn statement(&mut self, keyword: &str, rest: &str) {
        match keyword {
            "o" | "g" => rest.clone_into(&mut self.name),
            "usemtl" => {
                let next = self.materials.len() as u32;
                self.material = (!rest.is_empty()).then(|| match self.row_of_material.get(rest) {
                    Some(row) => *row,
                    None => {
                        self.materials.push(rest.to_owned());
                        self.row_of_material.insert(rest.to_owned(), next);
                        next
                    }
                });
            }
            _ => return,
        }
        self.part = None;
    }

    /// Takes a face and gives the part that it belongs to.
    pub(crate) fn face(&mut self) -> u32 {
        if let Some(part) = self.part {
            return part;
        }
        let next = self.objects.len();
        let object = match self.row_of_object.get(&self.name) {
            Some(object) => *object,
            None => {
                self.row_of_object.insert(self.name.clone(), next);
                self.objects.push(ObjObject {
                    name: self.name.clone(),
                    parts: Vec::new(),
                });
                next
            }
        };
        let next = self.material_of_part.len() as u32;
        let part = *self.part_of.entry((object, self.material)).or_insert(next);
        if part == next {
            self.material_of_part.push(self.material);
            self.objects[object].parts.push(part);
        }
        self.part = Some(part);
        part
    }

    /// Finds an object by its name.
    pub(crate) fn object_of_name(&self, name: &str) -> Option<usize> {
        self.row_of_object.get(name).copied()
    }

    /// The name of the material of a part.
    pub(crate) fn material_name(&self, part: u32) -> Option<&str> {
        let material = self.material_of_part[part as usize]?;
        Some(&self.materials[material as usize])
    }
}

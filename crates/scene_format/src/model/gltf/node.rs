//! Nodes: each becomes a prim, with what it carries.

use glam::{DMat4, DQuat, DVec3};

use super::super::ModelLimits;
use super::super::error::Fault;
use super::super::names::{Wanted, sibling_names};
use super::super::write::{Component, LayerText, numbers};
use super::Translation;
use super::graph::no_such;
use super::json::{Mesh, Node};
use super::primitive::{Shape, is_drawn};

/// Elements that an accessor may claim when only its description is looked at.
const MOST: usize = u32::MAX as usize;

impl Translation<'_> {
    /// Writes nodes below the open prim.
    ///
    /// - `taken`: names that other children of the prim have.
    ///
    /// The nodes are a forest, and `text` refuses depth, so the recursion is bounded.
    pub(super) fn write_nodes(
        &mut self,
        nodes: &[u32],
        taken: &[&str],
        text: &mut LayerText<'_>,
        limits: &ModelLimits,
    ) -> Result<(), Fault> {
        let root = self.root;
        let wanted: Vec<Wanted<'_>> = nodes
            .iter()
            .map(|node| Wanted {
                name: &root.nodes[*node as usize].name,
                fallback: format!("Node{node}"),
            })
            .collect();
        let names = sibling_names(&wanted, taken, limits.name_bytes);
        for (number, name) in nodes.iter().zip(names) {
            let at = format!("nodes[{number}]");
            let node = &root.nodes[*number as usize];
            text.open(&name, &node.name, &at)?;
            self.write_node(node, &at, text, limits)?;
            text.close();
        }
        Ok(())
    }

    fn write_node(
        &mut self,
        node: &Node,
        at: &str,
        text: &mut LayerText<'_>,
        limits: &ModelLimits,
    ) -> Result<(), Fault> {
        let placement = placement(node, at)?;
        if placement.singular {
            text.inactive();
            self.warn(at, "it is scaled to nothing, so it is switched off".to_owned());
        } else if let Some(transform) = &placement.transform {
            text.component(transform);
        }
        if let Some(extensions) = &node.extensions {
            if let Some(light) = &extensions.light
                && let Some(component) = self.light(light.light, at)?
            {
                text.component(&component);
            }
            if extensions.instancing.is_some() {
                self.left_out.insert("instances on the GPU (one is shown)");
            }
        }
        if let Some(camera) = node.camera
            && let Some(component) = self.camera(camera, at)?
        {
            text.component(&component);
        }
        if let Some(skin) = node.skin
            && skin as usize >= self.root.skins.len()
        {
            return Err(no_such(&format!("{at}.skin"), "skin", skin, self.root.skins.len()));
        }
        let parts = match node.mesh {
            Some(mesh) => self.write_mesh(mesh, at, text)?,
            None => Vec::new(),
        };
        let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
        self.write_nodes(&node.children, &parts, text, limits)
    }

    /// Writes the mesh of a node: on its prim, or one child for each primitive. Gives the names of the children.
    fn write_mesh(&mut self, index: u32, at: &str, text: &mut LayerText<'_>) -> Result<Vec<String>, Fault> {
        let meshes = &self.root.meshes;
        let Some(mesh) = meshes.get(index as usize) else {
            return Err(no_such(&format!("{at}.mesh"), "mesh", index, meshes.len()));
        };
        let drawn = self.drawn_of_mesh[index as usize].clone();
        if let [primitive] = drawn[..] {
            let alone = mesh.primitives.len() == 1;
            self.write_primitive(index, primitive, alone, text)?;
            return Ok(Vec::new());
        }
        let mut names = Vec::new();
        for primitive in drawn {
            let name = format!("Primitive{primitive}");
            text.open(&name, "", &format!("meshes[{index}].primitives[{primitive}]"))?;
            self.write_primitive(index, primitive, false, text)?;
            text.close();
            names.push(name);
        }
        Ok(names)
    }

    /// Checks what all meshes are made of, and finds the primitives that are drawn.
    pub(super) fn check_meshes(&mut self) -> Result<(), Fault> {
        let root = self.root;
        for (index, mesh) in root.meshes.iter().enumerate() {
            let drawn = self.check_mesh(mesh, index)?;
            self.drawn_of_mesh.push(drawn);
        }
        Ok(())
    }

    fn check_mesh(&mut self, mesh: &Mesh, index: usize) -> Result<Vec<u32>, Fault> {
        if mesh.primitives.is_empty() {
            return Err(Fault::invalid(&format!("meshes[{index}].primitives"), "it is empty"));
        }
        let mut drawn = Vec::new();
        for (number, primitive) in (0_u32..).zip(&mesh.primitives) {
            if !is_drawn(primitive) {
                self.left_out.insert("points, lines and primitives without positions");
                continue;
            }
            if !primitive.targets.is_empty() {
                self.left_out.insert("morph targets");
            }
            let at = format!("meshes[{index}].primitives[{number}]");
            Shape::of(self.root, primitive, &at, MOST)?;
            drawn.push(number);
        }
        Ok(drawn)
    }

    /// Writes components that show a primitive.
    ///
    /// - `alone`: whether it is all of its mesh.
    fn write_primitive(
        &mut self,
        mesh: u32,
        primitive: u32,
        alone: bool,
        text: &mut LayerText<'_>,
    ) -> Result<(), Fault> {
        let mut component = Component::new("Mesh").text("file", self.file_name);
        if self.root.meshes.len() > 1 {
            component = component.text("mesh", &self.meshes.names[mesh as usize]);
        }
        if !alone {
            component = component.raw("primitive", primitive.to_string());
        }
        text.component(&component);
        let at = format!("meshes[{mesh}].primitives[{primitive}]");
        let material = self.root.meshes[mesh as usize].primitives[primitive as usize].material;
        if let Some(component) = self.bind(material, &at)? {
            text.component(&component);
        }
        Ok(())
    }
}

/// Where a node is.
struct Placement {
    /// None: where its parent is.
    transform: Option<Component>,
    singular: bool,
}

fn placement(node: &Node, at: &str) -> Result<Placement, Fault> {
    let parts = [
        node.translation.is_some(),
        node.rotation.is_some(),
        node.scale.is_some(),
    ];
    if let Some(matrix) = &node.matrix {
        if parts.contains(&true) {
            let message = "a node has a matrix, or translation, rotation and scale, not both";
            return Err(Fault::invalid(&format!("{at}.matrix"), message));
        }
        return matrix_placement(matrix, &format!("{at}.matrix"));
    }
    let translate = DVec3::from_array(*node.translation.as_deref().unwrap_or(&[0.0; 3]));
    let scale = DVec3::from_array(*node.scale.as_deref().unwrap_or(&[1.0; 3]));
    let rotation = DQuat::from_array(*node.rotation.as_deref().unwrap_or(&[0.0, 0.0, 0.0, 1.0]));
    // Halfway to the largest number, so that squares and products stay finite.
    let fine = |largest: f64| largest < 1e150;
    for (fine, field) in [
        (fine(translate.abs().max_element()), "translation"),
        (fine(scale.abs().max_element()), "scale"),
        (
            fine(rotation.to_array().iter().fold(0.0, |a: f64, b| a.max(b.abs()))),
            "rotation",
        ),
    ] {
        if !fine {
            return Err(Fault::invalid(
                &format!("{at}.{field}"),
                "it is too large to be computed with",
            ));
        }
    }
    if rotation.length_squared() == 0.0 {
        return Err(Fault::invalid(
            &format!("{at}.rotation"),
            "a quaternion of length 0 is no rotation",
        ));
    }
    let mut transform = Component::new("Transform");
    for (written, field, value) in [
        (translate != DVec3::ZERO, "translate", translate.to_array().to_vec()),
        (rotation != DQuat::IDENTITY, "quaternion", rotation.to_array().to_vec()),
        (scale != DVec3::ONE, "scale", scale.to_array().to_vec()),
    ] {
        if written {
            transform = transform.raw(field, numbers(&value));
        }
    }
    Ok(Placement {
        transform: parts.contains(&true).then_some(transform),
        singular: scale.abs().min_element() == 0.0,
    })
}

fn matrix_placement(matrix: &[f64; 16], at: &str) -> Result<Placement, Fault> {
    let columns = DMat4::from_cols_array(matrix);
    if columns.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err(Fault::invalid(
            at,
            "its last row is not (0, 0, 0, 1), so it is no placement",
        ));
    }
    if matrix.iter().any(|number| number.abs() >= 1e150) {
        return Err(Fault::invalid(at, "it is too large to be computed with"));
    }
    Ok(Placement {
        transform: (columns != DMat4::IDENTITY).then(|| Component::new("Transform").raw("matrix", numbers(matrix))),
        singular: columns.determinant() == 0.0,
    })
}

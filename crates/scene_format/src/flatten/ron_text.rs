//! One layer in the syntax of scenes, in the composed order.

use std::fmt::Write;
use std::path::Path;

use super::ron_value::{quoted, ron_value};
use crate::layer::{Specifier, TimeSettings};
use crate::scene::{ComponentValue, FieldState, Prim, Scene};

/// Writes a composed scene as one layer without arcs, which composes to the same scene.
///
/// Files are named relative to the folder of the scene; the text belongs into that folder. Where a
/// file lies elsewhere, its full name is written, which a scene may not use.
pub fn flatten_ron(scene: &Scene) -> String {
    let folder = scene.folders.scene.clone();
    let mut writer = Writer {
        text: String::from("#![enable(implicit_some)]\nLayer(\n    version: 1,\n"),
        asset: &|path| relative(path, &folder),
    };
    if let Some(path) = &scene.default_prim {
        let _ = writeln!(
            writer.text,
            "    default_prim: {},",
            quoted(path.trim_start_matches('/'))
        );
    }
    if scene.time != TimeSettings::default() {
        let TimeSettings { start, end, fps } = scene.time;
        let _ = writeln!(writer.text, "    time: (start: {start}, end: {end}, fps: {fps}),");
    }
    writer.text.push_str("    prims: {\n");
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); scene.prims.len()];
    for (number, prim) in scene.prims.iter().enumerate() {
        if let Some(parent) = prim.parent {
            children[parent].push(number);
        }
    }
    for (number, prim) in scene.prims.iter().enumerate() {
        if prim.parent.is_none() {
            writer.prim(scene, number, &children, 2);
        }
    }
    writer.text.push_str("    },\n)\n");
    writer.text
}

/// Names a file relative to a folder, with `/`.
fn relative(path: &str, folder: &Path) -> String {
    let mut up = String::new();
    for above in folder.ancestors() {
        if let Ok(rest) = Path::new(path).strip_prefix(above) {
            let parts: Vec<_> = rest.iter().map(|part| part.to_string_lossy()).collect();
            return format!("{up}{}", parts.join("/"));
        }
        up.push_str("../");
    }
    path.to_owned()
}

struct Writer<'a> {
    text: String,
    asset: &'a dyn Fn(&str) -> String,
}

impl Writer<'_> {
    fn line(&mut self, level: usize, text: &str) {
        let indent = 4 * level;
        let _ = writeln!(self.text, "{:indent$}{text}", "");
    }

    /// At most as deep as composition lets prims be.
    fn prim(&mut self, scene: &Scene, number: usize, children: &[Vec<usize>], level: usize) {
        let prim = &scene.prims[number];
        let word = match prim.specifier {
            Specifier::Def => "Def",
            Specifier::Over => "Over",
            Specifier::Class => "Class",
        };
        let key = if prim.parent.is_none() { &prim.path } else { &prim.name };
        let is_empty = prim.active && prim.type_label.is_none() && prim.doc.is_none() && prim.components.is_empty();
        if is_empty && children[number].is_empty() {
            return self.line(level, &format!("{}: {word}(),", quoted(key)));
        }
        self.line(level, &format!("{}: {word}(", quoted(key)));
        self.fields(prim, level + 1);
        if !children[number].is_empty() {
            self.line(level + 1, "children: {");
            for &child in &children[number] {
                self.prim(scene, child, children, level + 2);
            }
            self.line(level + 1, "},");
        }
        self.line(level, "),");
    }

    fn fields(&mut self, prim: &Prim, level: usize) {
        if let Some(label) = &prim.type_label {
            self.line(level, &format!("type: {},", quoted(label)));
        }
        if let Some(doc) = &prim.doc {
            self.line(level, &format!("doc: {},", quoted(doc)));
        }
        if !prim.active {
            self.line(level, "active: false,");
        }
        for component in &prim.components {
            let line = self.component(component);
            self.line(level, &line);
        }
    }

    fn component(&self, component: &ComponentValue) -> String {
        let value = |value: &dyn bevy_reflect::PartialReflect| ron_value(value, self.asset);
        let fields: Vec<String> = component
            .fields
            .iter()
            .filter_map(|field| {
                let text = match &field.state {
                    FieldState::Constant(constant) => value(&**constant),
                    FieldState::Samples(samples) => {
                        let list = samples
                            .iter()
                            .map(|(time, sample)| format!("{time}: {}", value(&**sample)));
                        format!("Samples({{{}}})", list.collect::<Vec<_>>().join(", "))
                    }
                    // Nothing is weaker here that would have to be hidden.
                    FieldState::Blocked => return None,
                };
                Some(format!("{}: {text}", field.name))
            })
            .collect();
        format!("{}: ({}),", component.name, fields.join(", "))
    }
}

//! Writes a layer.

use glam::DVec3;

use super::ModelLimits;
use super::error::Fault;

/// A component with the text of its fields.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Component {
    pub(super) name: &'static str,
    fields: Vec<(&'static str, String)>,
}

impl Component {
    pub(super) fn new(name: &'static str) -> Self {
        Self {
            name,
            fields: Vec::new(),
        }
    }

    /// Adds a field whose value is written already.
    pub(super) fn raw(mut self, field: &'static str, value: String) -> Self {
        self.fields.push((field, value));
        self
    }

    pub(super) fn number(self, field: &'static str, value: f64) -> Self {
        self.raw(field, number(value))
    }

    pub(super) fn vector(self, field: &'static str, value: DVec3) -> Self {
        self.raw(field, numbers(&value.to_array()))
    }

    pub(super) fn flag(self, field: &'static str, value: bool) -> Self {
        self.raw(field, value.to_string())
    }

    pub(super) fn text(self, field: &'static str, value: &str) -> Self {
        self.raw(field, quoted(value))
    }

    /// Writes the fields: `(a: 1, b: 2)`.
    pub(super) fn value(&self) -> String {
        let fields: Vec<String> = self
            .fields
            .iter()
            .map(|(field, value)| format!("{field}: {value}"))
            .collect();
        format!("({})", fields.join(", "))
    }
}

/// Writes a number so that the same one is read; `number` must be finite.
fn number(number: f64) -> String {
    format!("{number:?}")
}

/// Writes `(1, 2, 3)`.
pub(super) fn numbers(all: &[f64]) -> String {
    let all: Vec<String> = all.iter().copied().map(number).collect();
    format!("({})", all.join(", "))
}

/// Writes a text in quotes; control characters become blanks.
fn quoted(text: &str) -> String {
    let mut written = String::with_capacity(text.len() + 2);
    written.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => written.extend(['\\', c]),
            c if c.is_control() => written.push(' '),
            c => written.push(c),
        }
    }
    written.push('"');
    written
}

/// Steps of indentation at most, so that deep models do not consist of blanks.
const DEEPEST_INDENT: usize = 20;

/// The longest comment that keeps a model's own name, in characters.
const LONGEST_DOC: usize = 200;

/// The text of a layer, prim by prim.
pub(super) struct LayerText<'l> {
    text: String,
    /// Open prims.
    depth: usize,
    /// Steps of indentation.
    indent: usize,
    /// Whether `children` is open, for each open prim.
    has_children: Vec<bool>,
    prims: usize,
    limits: &'l ModelLimits,
}

impl<'l> LayerText<'l> {
    /// Begins a layer whose default prim is `root`.
    pub(super) fn new(root: &str, limits: &'l ModelLimits) -> Self {
        Self {
            text: format!("Layer(\n    default_prim: {},\n    prims: {{\n", quoted(root)),
            depth: 0,
            indent: 2,
            has_children: Vec::new(),
            prims: 0,
            limits,
        }
    }

    /// Begins a prim below the one that is open. `name` is legal; `original` is kept as a comment where it differs.
    pub(super) fn open(&mut self, name: &str, original: &str, at: &str) -> Result<(), Fault> {
        self.prims += 1;
        if self.prims > self.limits.prims {
            return Err(Fault::limit(
                at,
                format!("this makes more than {} prims", self.limits.prims),
            ));
        }
        if self.depth >= self.limits.prim_depth {
            let deepest = self.limits.prim_depth;
            return Err(
                Fault::limit(at, format!("prims would be nested more than {deepest} deep"))
                    .remedy("flatten the hierarchy of the model"),
            );
        }
        if self.text.len() > self.limits.text_bytes {
            let limit = self.limits.text_bytes;
            return Err(Fault::limit(
                at,
                format!("as a layer the model has more than {limit} bytes"),
            ));
        }
        let slash = if self.depth == 0 { "/" } else { "" };
        if let Some(has_children) = self.has_children.last_mut()
            && !*has_children
        {
            *has_children = true;
            self.line("children: {");
            self.indent += 1;
        }
        self.line(&format!("\"{slash}{name}\": Def("));
        self.depth += 1;
        self.indent += 1;
        self.has_children.push(false);
        if !original.is_empty() && original != name {
            let short: String = original.chars().take(LONGEST_DOC).collect();
            self.line(&format!("doc: {},", quoted(&short)));
        }
        Ok(())
    }

    /// Adds a component to the open prim, before its children.
    pub(super) fn component(&mut self, component: &Component) {
        self.line(&format!("{}: {},", component.name, component.value()));
    }

    /// Switches the open prim off.
    pub(super) fn inactive(&mut self) {
        self.line("active: false,");
    }

    /// Ends the open prim.
    pub(super) fn close(&mut self) {
        if self.has_children.pop() == Some(true) {
            self.indent -= 1;
            self.line("},");
        }
        self.depth -= 1;
        self.indent -= 1;
        self.line("),");
    }

    /// Ends the layer.
    pub(super) fn finish(mut self) -> String {
        self.text.push_str("    },\n)\n");
        self.text
    }

    fn line(&mut self, line: &str) {
        let steps = self.indent.min(DEEPEST_INDENT);
        self.text.extend(std::iter::repeat_n("    ", steps));
        self.text.push_str(line);
        self.text.push('\n');
    }
}

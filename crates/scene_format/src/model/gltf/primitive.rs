//! The description of a primitive: which accessors it uses, and that they fit together.

use super::super::error::Fault;
use super::accessor::{Layout, Number};
use super::json::{Primitive, Root};

/// How vertices make triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// A primitive of triangles whose accessors are sound.
#[derive(Debug)]
pub(super) struct Shape {
    pub(super) mode: Mode,
    pub(super) indices: Option<Layout>,
    pub(super) positions: Layout,
    pub(super) normals: Option<Layout>,
    pub(super) uv_sets: Vec<Layout>,
    pub(super) colours: Option<Layout>,
}

/// Tells whether a primitive is of triangles and has positions: others are not rendered.
pub(super) fn is_drawn(primitive: &Primitive) -> bool {
    primitive.mode > 3 && primitive.attributes.contains_key("POSITION")
}

impl Shape {
    /// Checks a primitive that is drawn.
    ///
    /// - `most`: vertices or indices that an accessor may have.
    pub(super) fn of(root: &Root, primitive: &Primitive, at: &str, most: usize) -> Result<Self, Fault> {
        let mode = match primitive.mode {
            4 => Mode::Triangles,
            5 => Mode::Strip,
            6 => Mode::Fan,
            mode => return Err(Fault::invalid(&format!("{at}.mode"), format!("{mode} is not a mode"))),
        };
        let attribute = |name: &str| -> Result<Option<Layout>, Fault> {
            match primitive.attributes.get(name) {
                None => Ok(None),
                Some(index) => {
                    let at = format!("{at}.attributes.{name}");
                    let layout = Layout::of(root, *index, &at, most)?;
                    check_format(&layout, name, &at)?;
                    Ok(Some(layout))
                }
            }
        };
        let Some(positions) = attribute("POSITION")? else {
            return Err(Fault::invalid(&format!("{at}.attributes"), "there is no POSITION"));
        };
        let mut uv_sets = Vec::new();
        while let Some(layout) = attribute(&format!("TEXCOORD_{}", uv_sets.len()))? {
            uv_sets.push(layout);
        }
        let normals = attribute("NORMAL")?;
        let colours = attribute("COLOR_0")?;
        for other in normals.iter().chain(&uv_sets).chain(&colours) {
            if other.count != positions.count {
                let message = format!(
                    "accessor {} has {} elements, but there are {} positions",
                    other.accessor, other.count, positions.count
                );
                return Err(Fault::invalid(&format!("{at}.attributes"), message));
            }
        }
        let indices = match primitive.indices {
            None => None,
            Some(index) => {
                let layout = Layout::of(root, index, &format!("{at}.indices"), most)?;
                layout.check_indices(root)?;
                Some(layout)
            }
        };
        let shape = Self {
            mode,
            indices,
            positions,
            normals,
            uv_sets,
            colours,
        };
        shape.check_count(at)?;
        Ok(shape)
    }

    /// Corners in the order in which they make triangles.
    pub(super) fn corners(&self) -> usize {
        self.indices
            .as_ref()
            .map_or(self.positions.count, |layout| layout.count)
    }

    /// Vertices and indices that have to be looked at.
    pub(super) fn cost(&self) -> u64 {
        let sparse = self
            .layouts()
            .filter_map(|layout| layout.sparse.map(|sparse| sparse.count));
        (self.corners() + sparse.sum::<usize>()) as u64
    }

    /// Every accessor that is used.
    pub(super) fn layouts(&self) -> impl Iterator<Item = &Layout> {
        [&self.positions]
            .into_iter()
            .chain(&self.indices)
            .chain(&self.normals)
            .chain(&self.uv_sets)
            .chain(&self.colours)
    }

    fn check_count(&self, at: &str) -> Result<(), Fault> {
        let corners = self.corners();
        let what = if self.indices.is_some() { "indices" } else { "vertices" };
        if corners < 3 {
            return Err(Fault::invalid(at, format!("{corners} {what} make no triangle")));
        }
        if self.mode == Mode::Triangles && !corners.is_multiple_of(3) {
            let message = format!("{corners} {what} do not make triangles: that is no multiple of 3");
            return Err(Fault::invalid(at, message));
        }
        Ok(())
    }
}

fn check_format(layout: &Layout, name: &str, at: &str) -> Result<(), Fault> {
    let widths: &[usize] = match name {
        "POSITION" | "NORMAL" => &[3],
        "COLOR_0" => &[3, 4],
        _ => &[2],
    };
    let whole = layout.number != Number::F32;
    // Whole positions and texture coordinates count as they are; whole normals and colours are parts of 1.
    let needs_scale = matches!(name, "NORMAL" | "COLOR_0");
    if !widths.contains(&layout.width)
        || layout.number == Number::U32
        || (whole && needs_scale && !layout.normalized)
        || (!whole && layout.normalized)
    {
        let message = format!(
            "accessor {} has {} numbers of type {:?}{} in an element, which {name} cannot have",
            layout.accessor,
            layout.width,
            layout.number,
            if layout.normalized { ", normalized," } else { "" },
        );
        return Err(Fault::invalid(at, message));
    }
    Ok(())
}

//! Accessors: what they claim, checked against the buffers before a byte is read.

use super::super::error::Fault;
use super::graph::no_such;
use super::json::{Accessor, Root};

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Number {
    fn of(code: u32, at: &str) -> Result<Self, Fault> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => {
                let at = format!("{at}.componentType");
                return Err(Fault::invalid(&at, format!("{code} is not a type of number")));
            }
        })
    }

    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

/// Elements in a buffer: they lie within its declared length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) buffer: usize,
    /// Byte of the first element in the buffer.
    pub(super) start: u64,
    /// Bytes from one element to the next.
    pub(super) stride: u64,
}

/// Elements that differ from those of the span.
#[derive(Clone, Copy, Debug)]
pub(super) struct SparseLayout {
    pub(super) count: usize,
    pub(super) indices: Span,
    pub(super) index_type: Number,
    pub(super) values: Span,
}

/// What an accessor means.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Its own number, for messages.
    pub(super) accessor: u32,
    pub(super) count: usize,
    pub(super) number: Number,
    /// Numbers in an element.
    pub(super) width: usize,
    pub(super) normalized: bool,
    /// None: all zero.
    pub(super) base: Option<Span>,
    pub(super) sparse: Option<SparseLayout>,
}

impl Layout {
    /// Checks an accessor that `at` names.
    ///
    /// - `most`: elements that it may have.
    pub(super) fn of(root: &Root, index: u32, at: &str, most: usize) -> Result<Self, Fault> {
        let accessor = root
            .accessors
            .get(index as usize)
            .ok_or_else(|| no_such(at, "accessor", index, root.accessors.len()))?;
        let at = format!("accessors[{index}]");
        let number = Number::of(accessor.component_type, &at)?;
        let width = match accessor.kind.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            kind => {
                let message = format!("elements of type {kind:?} are not part of a mesh");
                return Err(Fault::invalid(&format!("{at}.type"), message));
            }
        };
        if accessor.count == 0 {
            return Err(Fault::invalid(&format!("{at}.count"), "it is 0"));
        }
        if accessor.count > most as u64 {
            let message = format!("{} elements are more than the limit of {most}", accessor.count);
            return Err(Fault::limit(&format!("{at}.count"), message));
        }
        let size = number.bytes() * width as u64;
        let base = match accessor.buffer_view {
            None => None,
            Some(view) => Some(
                Elements {
                    view,
                    offset: accessor.byte_offset,
                    count: accessor.count,
                    size,
                    may_stride: true,
                }
                .locate(root, &at)?,
            ),
        };
        Ok(Self {
            accessor: index,
            count: accessor.count as usize,
            number,
            width,
            normalized: accessor.normalized,
            base,
            sparse: sparse_layout(root, accessor, size, &at)?,
        })
    }

    /// Refuses what cannot be an index of a vertex.
    pub(super) fn check_indices(&self, root: &Root) -> Result<(), Fault> {
        let at = format!("accessors[{}]", self.accessor);
        if self.width != 1 || !self.number.is_unsigned() || self.normalized {
            let message = "indices must be SCALAR, of unsigned whole numbers, not normalized";
            return Err(Fault::invalid(&at, message));
        }
        let accessor = root.accessors.get(self.accessor as usize);
        let view = accessor.and_then(|accessor| accessor.buffer_view);
        let stride = view.and_then(|view| root.buffer_views.get(view as usize)?.byte_stride);
        if stride.is_some() {
            let at = format!("{at}.bufferView");
            return Err(Fault::invalid(
                &at,
                "indices cannot lie in a buffer view with a `byteStride`",
            ));
        }
        Ok(())
    }
}

fn sparse_layout(root: &Root, accessor: &Accessor, size: u64, at: &str) -> Result<Option<SparseLayout>, Fault> {
    let Some(sparse) = &accessor.sparse else {
        return Ok(None);
    };
    let at = format!("{at}.sparse");
    if sparse.count == 0 || sparse.count > accessor.count {
        let message = format!("{} of {} elements cannot be replaced", sparse.count, accessor.count);
        return Err(Fault::invalid(&format!("{at}.count"), message));
    }
    let indices_at = format!("{at}.indices");
    let index_type = Number::of(sparse.indices.component_type, &indices_at)?;
    if !index_type.is_unsigned() {
        let at = format!("{indices_at}.componentType");
        return Err(Fault::invalid(&at, "indices must be unsigned whole numbers"));
    }
    let elements = |view, offset, size| Elements {
        view,
        offset,
        count: sparse.count,
        size,
        may_stride: false,
    };
    let indices = elements(
        sparse.indices.buffer_view,
        sparse.indices.byte_offset,
        index_type.bytes(),
    );
    let values = elements(sparse.values.buffer_view, sparse.values.byte_offset, size);
    Ok(Some(SparseLayout {
        count: sparse.count as usize,
        indices: indices.locate(root, &indices_at)?,
        index_type,
        values: values.locate(root, &format!("{at}.values"))?,
    }))
}

/// Checks that all buffer views lie within their buffers, and their strides.
pub(super) fn check_views(root: &Root) -> Result<(), Fault> {
    (0..root.buffer_views.len()).try_for_each(|view| check_view(root, view))
}

/// Checks that a buffer view lies within its buffer, and its stride.
pub(super) fn check_view(root: &Root, number: usize) -> Result<(), Fault> {
    let view = &root.buffer_views[number];
    let at = |field: &str| format!("bufferViews[{number}].{field}");
    let buffer = root
        .buffers
        .get(view.buffer as usize)
        .ok_or_else(|| no_such(&at("buffer"), "buffer", view.buffer, root.buffers.len()))?;
    let end = view.byte_offset.checked_add(view.byte_length);
    if end.is_none_or(|end| end > buffer.byte_length) {
        let message = format!(
            "{} bytes from byte {} on are not in buffer {}, which has {}",
            view.byte_length, view.byte_offset, view.buffer, buffer.byte_length
        );
        return Err(Fault::invalid(&at("byteLength"), message));
    }
    match view.byte_stride {
        Some(stride) if !(4..=252).contains(&stride) || stride % 4 != 0 => {
            let message = format!("{stride} is not a multiple of 4 from 4 to 252");
            Err(Fault::invalid(&at("byteStride"), message))
        }
        _ => Ok(()),
    }
}

/// Elements that something says are in a buffer view.
struct Elements {
    view: u32,
    offset: u64,
    count: u64,
    size: u64,
    may_stride: bool,
}

impl Elements {
    /// Checks that they are.
    fn locate(&self, root: &Root, at: &str) -> Result<Span, Fault> {
        let at_view = format!("{at}.bufferView");
        let view = root
            .buffer_views
            .get(self.view as usize)
            .ok_or_else(|| no_such(&at_view, "buffer view", self.view, root.buffer_views.len()))?;
        check_view(root, self.view as usize)?;
        let view_at = |field: &str| format!("bufferViews[{}].{field}", self.view);
        let stride = match view.byte_stride {
            Some(_) if !self.may_stride => {
                let message = "sparse data cannot lie in a buffer view with a `byteStride`";
                return Err(Fault::invalid(&at_view, message));
            }
            Some(stride) if stride < self.size => {
                let message = format!("elements of {} bytes overlap at a distance of {stride}", self.size);
                return Err(Fault::invalid(&view_at("byteStride"), message));
            }
            Some(stride) => stride,
            None => self.size,
        };
        // `count` is at most a limit and `stride` at most 252, so only the sum with the offset can overflow.
        let needed = stride
            .saturating_mul(self.count - 1)
            .saturating_add(self.size)
            .saturating_add(self.offset);
        if needed > view.byte_length {
            let message = format!(
                "{} elements need {needed} bytes, but buffer view {} has {}",
                self.count, self.view, view.byte_length
            );
            return Err(Fault::invalid(at, message));
        }
        Ok(Span {
            buffer: view.buffer as usize,
            start: view.byte_offset + self.offset,
            stride,
        })
    }
}

//! The elements of an accessor, read one by one: nothing is copied, so a claim of many costs nothing.

use super::super::ModelFile;
use super::super::error::Fault;
use super::accessor::{Layout, Number, Span};
use super::buffers::Buffers;

/// The data of an accessor whose buffers are loaded.
pub(super) struct Elements<'b> {
    layout: &'b Layout,
    base: Option<Run<'b>>,
    /// Numbers of replaced elements, rising, with the data that replaces them.
    sparse: Option<(Vec<u32>, Run<'b>)>,
}

/// Elements at equal distances.
#[derive(Clone, Copy)]
struct Run<'b> {
    bytes: &'b [u8],
    start: usize,
    stride: usize,
}

impl<'b> Run<'b> {
    fn of(span: &Span, buffers: &'b Buffers, model: &ModelFile<'b>) -> Self {
        Self {
            bytes: buffers.bytes(span.buffer, model),
            start: span.start as usize,
            stride: span.stride as usize,
        }
    }

    /// The bytes from a number of an element on.
    fn at(&self, element: usize, part: usize, size: usize) -> &'b [u8] {
        let start = self.start + element * self.stride + part * size;
        self.bytes.get(start..).unwrap_or(&[])
    }
}

impl<'b> Elements<'b> {
    pub(super) fn of(layout: &'b Layout, buffers: &'b Buffers, model: &ModelFile<'b>) -> Result<Self, Fault> {
        let mut elements = Self {
            layout,
            base: layout.base.map(|span| Run::of(&span, buffers, model)),
            sparse: None,
        };
        let Some(sparse) = layout.sparse else {
            return Ok(elements);
        };
        let run = Run::of(&sparse.indices, buffers, model);
        let mut numbers: Vec<u32> = Vec::with_capacity(sparse.count);
        for row in 0..sparse.count {
            let number = whole(run.at(row, 0, 0), sparse.index_type);
            let at = || format!("accessors[{}].sparse.indices", layout.accessor);
            if number as usize >= layout.count {
                let message = format!("number {row} is {number}, but there are {} elements", layout.count);
                return Err(Fault::invalid(&at(), message));
            }
            if numbers.last().is_some_and(|last| *last >= number) {
                let message = format!("number {row} is {number}, not greater than the one before it");
                return Err(Fault::invalid(&at(), message));
            }
            numbers.push(number);
        }
        elements.sparse = Some((numbers, Run::of(&sparse.values, buffers, model)));
        Ok(elements)
    }

    /// The bytes from a number of an element on; none where all is zero.
    fn bytes(&self, element: usize, part: usize) -> Option<&'b [u8]> {
        let size = self.layout.number.bytes() as usize;
        if let Some((numbers, values)) = &self.sparse
            && let Ok(row) = numbers.binary_search(&(element as u32))
        {
            return Some(values.at(row, part, size));
        }
        self.base.map(|base| base.at(element, part, size))
    }

    /// Reads an index.
    pub(super) fn index(&self, element: usize) -> u32 {
        self.bytes(element, 0)
            .map_or(0, |bytes| whole(bytes, self.layout.number))
    }

    /// Reads a vector of real numbers; those beyond the accessor's width are 0.
    ///
    /// # Errors
    ///
    /// For what is not finite.
    pub(super) fn vector<const N: usize>(&self, element: usize) -> Result<[f32; N], Fault> {
        let mut vector = [0.0; N];
        for (part, place) in vector.iter_mut().enumerate().take(self.layout.width) {
            let Some(bytes) = self.bytes(element, part) else {
                continue;
            };
            *place = real(bytes, self.layout.number, self.layout.normalized);
            if !place.is_finite() {
                let at = format!("accessors[{}]", self.layout.accessor);
                return Err(Fault::invalid(&at, format!("element {element} is not finite")));
            }
        }
        Ok(vector)
    }
}

fn word<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or([0; N])
}

fn whole(bytes: &[u8], number: Number) -> u32 {
    match number {
        Number::U8 => u32::from(word::<1>(bytes)[0]),
        Number::U16 => u32::from(u16::from_le_bytes(word(bytes))),
        _ => u32::from_le_bytes(word(bytes)),
    }
}

/// Reads a real number; whole ones are scaled to −1 to 1, or 0 to 1, if they are normalized.
fn real(bytes: &[u8], number: Number, normalized: bool) -> f32 {
    let (value, largest) = match number {
        Number::I8 => (f32::from(i8::from_le_bytes(word(bytes))), f32::from(i8::MAX)),
        Number::U8 => (f32::from(word::<1>(bytes)[0]), f32::from(u8::MAX)),
        Number::I16 => (f32::from(i16::from_le_bytes(word(bytes))), f32::from(i16::MAX)),
        Number::U16 => (f32::from(u16::from_le_bytes(word(bytes))), f32::from(u16::MAX)),
        Number::U32 => (u32::from_le_bytes(word(bytes)) as f32, u32::MAX as f32),
        Number::F32 => return f32::from_le_bytes(word(bytes)),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}

//! EXR output: one part, scan lines, 32-bit floats, lossless, and the same bytes every time.
//!
//! Two things in the usual way of writing would spoil the last point. The `exr` crate keeps custom
//! attributes in a hash map and writes them in its order, which changes from run to run: here the
//! header is written again, sorted by name, once the pixels are in place. And blocks are compressed on
//! the current rayon pool and written in increasing order, rather than by a pool of the crate's own.

use std::collections::BTreeSet;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

use exr::block::writer::ChunksWriter;
use exr::block::{BlockIndex, UncompressedBlock};
use exr::math::Vec2;
use exr::meta::attribute::{
    self, AttributeValue, ChannelDescription, Chromaticities, Compression, IntegerBounds, LineOrder, SampleType, Text,
};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes, standard_names};
use exr::meta::{BlockDescription, Headers, MetaData, magic_number};
use glam::UVec2;
use rayon::prelude::*;

use crate::atomic::{WriteError, atomic_write};
use crate::pixels::Image;

/// Longest channel name, and longest attribute name that every reader accepts.
const MAX_NAME_BYTES: usize = 31;

/// What the header of a file says about the render, as text attributes.
///
/// They are named `pipeline.sceneHash`, `pipeline.seed`, `pipeline.samples` and `pipeline.version`.
/// Nothing about time, machine or threads belongs here: equal renders shall be equal files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Hash of the composed scene, in hexadecimal.
    pub scene_hash: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Samples a pixel.
    pub samples: u64,
    /// Version of the program.
    pub version: String,
    /// More attributes: a name of 1 to 31 bytes of visible ASCII, and any text.
    pub extra: Vec<(String, String)>,
}

impl Metadata {
    fn attributes(&self) -> Vec<(String, String)> {
        let own = [
            ("pipeline.sceneHash", self.scene_hash.clone()),
            ("pipeline.seed", self.seed.to_string()),
            ("pipeline.samples", self.samples.to_string()),
            ("pipeline.version", self.version.clone()),
        ];
        let own = own.into_iter().map(|(name, value)| (name.to_owned(), value));
        own.chain(self.extra.iter().cloned()).collect()
    }
}

/// Why an EXR file could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExrWriteError {
    /// A channel has a name or length that the format does not allow.
    #[error("channel \"{name}\" cannot be written: {reason}; rename it, or leave it out")]
    Channel {
        /// The channel.
        name: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// An attribute has a name that the format does not allow.
    #[error("header attribute \"{name}\" cannot be written: {reason}; rename it")]
    Attribute {
        /// The attribute.
        name: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Writes an image as EXR, atomically (see [`atomic_write`]).
///
/// All channels are stored as 32-bit floats under their own names, compressed without loss (ZIP, 16
/// lines a block). Display window: the full film. Data window: the crop. Chromaticities: Rec.709.
///
/// # Errors
///
/// An [`ExrWriteError`]; the path then still has what it had before.
///
/// Cost: compression in parallel on the current rayon pool. The bytes depend on the arguments alone.
pub fn write_exr(path: &Path, image: &Image, metadata: &Metadata) -> Result<(), ExrWriteError> {
    check_channels(image)?;
    check_attributes(metadata)?;
    atomic_write(path, |writer| encode(image, metadata, writer).map_err(io_error))?;
    Ok(())
}

fn check_channels(image: &Image) -> Result<(), ExrWriteError> {
    let refuse = |name: &str, reason| {
        let name = name.to_owned();
        Err(ExrWriteError::Channel { name, reason })
    };
    if image.window.validate().is_err() || image.channels.is_empty() {
        return refuse("", "the image has no pixels or no channels");
    }
    let mut seen = BTreeSet::new();
    for channel in &image.channels {
        let name = channel.name.as_str();
        if !is_name(name) {
            return refuse(name, "a name has 1 to 31 bytes of visible ASCII");
        }
        if !seen.insert(name) {
            return refuse(name, "another channel has the same name");
        }
        if channel.samples.len() != image.window.pixel_count() {
            return refuse(name, "it does not have one sample for each pixel of the crop");
        }
    }
    Ok(())
}

fn check_attributes(metadata: &Metadata) -> Result<(), ExrWriteError> {
    let mut seen = BTreeSet::new();
    for (name, _) in metadata.attributes() {
        let reason = if !is_name(&name) {
            "a name has 1 to 31 bytes of visible ASCII"
        } else if standard_names::ALL.contains(&name.as_bytes()) {
            "the format gives this name a meaning of its own"
        } else if !seen.insert(name.clone()) {
            "another attribute has the same name"
        } else {
            continue;
        };
        return Err(ExrWriteError::Attribute { name, reason });
    }
    Ok(())
}

fn is_name(name: &str) -> bool {
    (1..=MAX_NAME_BYTES).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic())
}

fn encode(image: &Image, metadata: &Metadata, writer: &mut (impl Write + Seek)) -> exr::error::UnitResult {
    let mut planes: Vec<(&str, &[f32])> = image
        .channels
        .iter()
        .map(|c| (c.name.as_str(), c.samples.as_slice()))
        .collect();
    planes.sort_unstable_by_key(|&(name, _)| name);
    let headers: Headers = std::iter::once(header(image, &planes, metadata)).collect();
    let sorted = sorted_header(&headers)?;
    exr::block::write(&mut *writer, headers, true, |meta, chunks| {
        let blocks: Vec<_> = meta.enumerate_ordered_header_block_indices().collect();
        // A few blocks a thread at a time, so that memory does not grow with the image.
        for batch in blocks.chunks(8 * rayon::current_num_threads()) {
            let compressed: Vec<_> = batch
                .par_iter()
                .map(|&(_, index)| {
                    let data = block_data(index, image.window.size(), &planes);
                    UncompressedBlock { index, data }.compress_to_chunk(&meta.headers)
                })
                .collect();
            for (&(number, _), chunk) in batch.iter().zip(compressed) {
                chunks.write_chunk(number, chunk?)?;
            }
        }
        Ok(())
    })?;
    writer.seek(SeekFrom::Start(0))?;
    writer.write_all(&sorted)?;
    writer.seek(SeekFrom::End(0))?;
    Ok(())
}

fn header(image: &Image, planes: &[(&str, &[f32])], metadata: &Metadata) -> Header {
    let window = &image.window;
    let size = |v: UVec2| Vec2(v.x as usize, v.y as usize);
    let channels = planes
        .iter()
        .map(|(name, _)| ChannelDescription::new(text(name), SampleType::F32, false));
    let shared = ImageAttributes {
        chromaticities: Some(Chromaticities {
            red: Vec2(0.64, 0.33),
            green: Vec2(0.30, 0.60),
            blue: Vec2(0.15, 0.06),
            white: Vec2(0.3127, 0.3290),
        }),
        ..ImageAttributes::new(IntegerBounds::new((0, 0), size(window.resolution)))
    };
    let attributes = metadata.attributes();
    let own = LayerAttributes {
        layer_position: Vec2(window.crop_min.x as i32, window.crop_min.y as i32),
        other: attributes
            .iter()
            .map(|(name, value)| (text(name), AttributeValue::Text(text(value))))
            .collect(),
        ..LayerAttributes::default()
    };
    Header::new(text(""), size(window.size()), channels.collect())
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_shared_attributes(shared)
        .with_attributes(own)
}

/// The bytes up to the end of the header, with the attributes in the order of their names.
///
/// The same attributes as the library writes, so the same length: the rest of the file stays valid.
fn sorted_header(headers: &Headers) -> exr::error::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    magic_number::write(&mut bytes)?;
    MetaData::validate(headers, true)?.write(&mut bytes)?;
    for header in headers {
        let mut attributes: Vec<_> = header.all_named_attributes().collect();
        attributes.sort_unstable_by_key(|&(name, _)| name);
        for (name, value) in attributes {
            attribute::write(name, &value, &mut bytes)?;
        }
        bytes.push(0);
    }
    Ok(bytes)
}

/// Gathers a block as the format wants it: line by line, within a line channel by channel.
fn block_data(index: BlockIndex, size: UVec2, planes: &[(&str, &[f32])]) -> Vec<u8> {
    let width = size.x as usize;
    let Vec2(_, top) = index.pixel_position;
    let Vec2(_, height) = index.pixel_size;
    let mut data = Vec::with_capacity(width * height * planes.len() * size_of::<f32>());
    for y in top..top + height {
        for (_, samples) in planes {
            let line = &samples[y * width..][..width];
            data.extend(line.iter().flat_map(|sample| sample.to_ne_bytes()));
        }
    }
    data
}

/// Text of any kind; values are stored as UTF-8.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}

fn io_error(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests;

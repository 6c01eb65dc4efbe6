//! EXR input, for comparing images: any flat one-part file, by channel name.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use exr::block::reader::ChunksReader;
use exr::block::{self, UncompressedBlock};
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;
use glam::{IVec2, UVec2};
use rayon::prelude::*;

use crate::accumulate::zeroed;
use crate::exr_scan::{MAX_VALUES, check_header};
use crate::pixels::RgbImage;

/// Largest file that is read: the largest image, uncompressed, and as much again for the header.
const MAX_FILE_BYTES: u64 = 2 * MAX_VALUES * 4;

/// An EXR file in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrImage {
    /// Width of the data window in pixels.
    pub width: u32,
    /// Height of the data window in pixels.
    pub height: u32,
    /// First pixel of the data window, relative to the display window, and size of the latter.
    pub window: (IVec2, UVec2),
    /// Name and samples of each channel, sorted by name; rows from the top. Half and unsigned channels
    /// are converted to `f32`, which is exact for half, and for integers up to 2^24.
    pub channels: Vec<(String, Vec<f32>)>,
    /// Name and value of each custom text attribute, sorted by name.
    pub attributes: Vec<(String, String)>,
}

impl ExrImage {
    /// Returns the samples of the channel with exactly this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        let found = self.channels.iter().find(|(other, _)| other == name);
        found.map(|(_, samples)| samples.as_slice())
    }

    /// Returns the text attribute with exactly this name.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(other, _)| other == name);
        found.map(|(_, value)| value.as_str())
    }

    /// Returns a layer as RGB: `""` for `R G B`, `"direct"` for `direct.R` and so on.
    ///
    /// - returns nothing if one of the three channels is missing.
    #[must_use]
    pub fn rgb(&self, layer: &str) -> Option<RgbImage> {
        RgbImage::gather(UVec2::new(self.width, self.height), layer, |name| self.channel(name))
    }
}

/// Why an EXR file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExrReadError {
    /// The system could not open or read it.
    #[error("cannot read {}: {source}; check the path and its permissions", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system reported.
        source: io::Error,
    },
    /// It was read, but makes no sense.
    #[error("cannot read {}: {source}", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: ExrDecodeError,
    },
}

/// What is wrong with the bytes of an EXR file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExrDecodeError {
    /// The first bytes are something else.
    #[error("it is not an OpenEXR file; give an .exr file")]
    NotExr,
    /// A kind of EXR that is not read here.
    #[error("it has {what}, which is not supported; convert it to a flat image of one part")]
    Unsupported {
        /// The feature.
        what: &'static str,
    },
    /// The image would take too much memory.
    #[error("{width}x{height} pixels with {channels} channels are more than {most} values; crop it, or drop channels")]
    TooLarge {
        /// Width of the data window.
        width: u32,
        /// Height of the data window.
        height: u32,
        /// Number of channels.
        channels: u64,
        /// Most values that are read.
        most: u64,
    },
    /// The file is larger than any image that could be read.
    #[error("the file is larger than 2 GiB; crop the image, or drop channels")]
    FileTooLarge,
    /// It is cut off or contradicts itself.
    #[error("the file is damaged or cut off{}; copy or render it again", detail(what))]
    Malformed {
        /// Where it was noticed; may be empty.
        what: String,
    },
}

fn detail(what: &str) -> String {
    if what.is_empty() {
        String::new()
    } else {
        format!(" ({what})")
    }
}

/// Reads a flat one-part EXR file: scan lines or tiles, half, float or unsigned, any compression that
/// the `exr` crate knows. Of an image with resolution levels, the largest.
///
/// # Errors
///
/// An [`ExrReadError`]. Safe on hostile files: at most 2^28 values, never a panic.
pub fn read_exr(path: &Path) -> Result<ExrImage, ExrReadError> {
    let bytes = read_limited(path).map_err(|source| ExrReadError::Open {
        path: path.to_owned(),
        source,
    })?;
    let image = match bytes {
        Some(bytes) => decode_exr(&bytes),
        None => Err(ExrDecodeError::FileTooLarge),
    };
    image.map_err(|source| ExrReadError::Decode {
        path: path.to_owned(),
        source,
    })
}

/// Reads a whole file, or nothing if it is too large; pipes have no length to ask for beforehand.
fn read_limited(path: &Path) -> io::Result<Option<Vec<u8>>> {
    if fs::metadata(path)?.len() > MAX_FILE_BYTES {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= MAX_FILE_BYTES).then_some(bytes))
}

/// Decodes an EXR file in memory; see [`read_exr`].
///
/// # Errors
///
/// An [`ExrDecodeError`] for bytes that are not such a file.
pub fn decode_exr(bytes: &[u8]) -> Result<ExrImage, ExrDecodeError> {
    decode_exr_within(bytes, MAX_VALUES)
}

/// As [`decode_exr`], with another limit.
///
/// - `most_values`: over all channels; each takes four bytes.
///
/// # Errors
///
/// An [`ExrDecodeError`] for bytes that are not such a file.
pub fn decode_exr_within(bytes: &[u8], most_values: u64) -> Result<ExrImage, ExrDecodeError> {
    check_header(bytes, most_values)?;
    // The decoder asserts some of its expectations about a file; a damaged one may break them.
    match catch_unwind(AssertUnwindSafe(|| decode(bytes))) {
        Ok(result) => result,
        Err(_) => Err(ExrDecodeError::Malformed {
            what: "the decoder gave up".to_owned(),
        }),
    }
}

impl From<exr::error::Error> for ExrDecodeError {
    fn from(error: exr::error::Error) -> Self {
        Self::Malformed {
            what: error.to_string(),
        }
    }
}

fn decode(bytes: &[u8]) -> Result<ExrImage, ExrDecodeError> {
    let reader = block::read(io::Cursor::new(bytes), false)?;
    let malformed = |what: &str| ExrDecodeError::Malformed { what: what.to_owned() };
    let [header] = reader.headers() else {
        return Err(ExrDecodeError::Unsupported { what: "several parts" });
    };
    let header = header.clone();
    let Vec2(width, height) = header.layer_size;
    let area = width * height;
    let plane = || zeroed(Some(area), 0.0_f32).ok_or_else(|| malformed("it does not fit in memory"));
    let mut planes = (0..header.channels.list.len())
        .map(|_| plane())
        .collect::<Result<Vec<_>, _>>()?;

    let largest = Vec2(0, 0);
    let mut chunks = reader.filter_chunks(false, |_, _, block| block.level == largest)?;
    let meta = chunks.meta_data().clone();
    let mut seen = BTreeSet::new();
    let mut covered = 0;
    loop {
        let batch = 8 * rayon::current_num_threads();
        let batch = chunks.by_ref().take(batch).collect::<Result<Vec<_>, _>>()?;
        if batch.is_empty() {
            break;
        }
        let blocks = batch
            .into_par_iter()
            .map(|chunk| UncompressedBlock::decompress_chunk(chunk, &meta, false));
        for block in blocks.collect::<Result<Vec<_>, _>>()? {
            if block.index.level != largest
                || !seen.insert((block.index.pixel_position.0, block.index.pixel_position.1))
            {
                return Err(malformed("a block is there twice"));
            }
            covered += block.index.pixel_size.area();
            copy_block(&block, &header, &mut planes)?;
        }
    }
    if covered != area {
        return Err(malformed("blocks are missing"));
    }
    let names = header.channels.list.iter().map(|c| lossy(c.name.as_slice()));
    let display = header.shared_attributes.display_window;
    let position = header.own_attributes.layer_position;
    Ok(ExrImage {
        width: width as u32,
        height: height as u32,
        window: (
            IVec2::new(position.0 - display.position.0, position.1 - display.position.1),
            UVec2::new(display.size.0 as u32, display.size.1 as u32),
        ),
        channels: names.zip(planes).collect(),
        attributes: text_attributes(&header),
    })
}

fn copy_block(block: &UncompressedBlock, header: &Header, planes: &mut [Vec<f32>]) -> Result<(), ExrDecodeError> {
    let width = header.layer_size.0;
    for line in block.lines(&header.channels) {
        let Vec2(x, y) = line.location.position;
        let channel = line.location.channel;
        let target = &mut planes[channel][y * width + x..][..line.location.sample_count];
        match header.channels.list[channel].sample_type {
            SampleType::F32 => line.read_samples_into_slice(target)?,
            SampleType::F16 => {
                for (to, from) in target.iter_mut().zip(line.read_samples::<f16>()) {
                    *to = from?.to_f32();
                }
            }
            SampleType::U32 => {
                for (to, from) in target.iter_mut().zip(line.read_samples::<u32>()) {
                    *to = from? as f32;
                }
            }
        }
    }
    Ok(())
}

#[expect(clippy::iter_over_hash_type, reason = "sorted right after")]
fn text_attributes(header: &Header) -> Vec<(String, String)> {
    let mut attributes = Vec::new();
    for (name, value) in &header.own_attributes.other {
        if let AttributeValue::Text(text) = value {
            attributes.push((lossy(name.as_slice()), lossy(text.as_slice())));
        }
    }
    attributes.sort_unstable();
    attributes
}

fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[cfg(test)]
mod tests;

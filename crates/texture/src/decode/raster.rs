//! PNG, JPEG and Radiance HDR, by the `image` crate.

use super::PictureLimits;
use crate::picture::Texels;
use crate::{Picture, TextureError};
use image::codecs::hdr::HdrDecoder;
use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::{ColorType, ImageDecoder, ImageError, Limits};
use std::io::Cursor;

/// Most that the format of PNG can pack into a byte.
const DEFLATE: u64 = 1032;
/// Most pixels of a JPEG for each byte: a block of 8 by 8 values takes at least a bit, and a component has at least a
/// value for every 4 by 4 pixels.
const PIXELS_OF_JPEG_BYTE: u64 = 8 * 8 * 4 * 4 * 8;
/// Reserved for what is beside the pixels of a PNG, such as a profile.
const BESIDE: u64 = 16 << 20;

pub(super) fn decode_png(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, TextureError> {
    if let Some(claim) = bytes.get(16..24) {
        let side = |at: usize| u32::from_be_bytes([claim[at], claim[at + 1], claim[at + 2], claim[at + 3]]);
        limits.check(side(0), side(4))?;
    }
    let mut reserve = Limits::no_limits();
    reserve.max_alloc = Some(BESIDE + bytes.len() as u64);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), reserve).map_err(describe)?;
    // Palettes and single bits take less in the file than in memory: at most 32 times.
    if decoder.total_bytes() / 32 > DEFLATE * bytes.len() as u64 {
        return Err(TextureError::malformed("too short for its pixels"));
    }
    read(decoder, limits)
}

pub(super) fn decode_jpeg(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, TextureError> {
    if !jpeg_ends(bytes) {
        return Err(TextureError::malformed("the end is missing"));
    }
    let decoder = JpegDecoder::new(Cursor::new(bytes)).map_err(describe)?;
    let (width, height) = decoder.dimensions();
    limits.check(width, height)?;
    if u64::from(width) * u64::from(height) > PIXELS_OF_JPEG_BYTE * bytes.len() as u64 {
        return Err(TextureError::malformed("too short for its pixels"));
    }
    read(decoder, limits)
}

/// Tells whether the scan of a JPEG is followed by its end mark; the decoder fills what is missing with grey.
fn jpeg_ends(bytes: &[u8]) -> bool {
    const END: [u8; 2] = [0xff, 0xd9];
    const SCAN: u8 = 0xda;
    let mut at = 2;
    while let Some(&[0xff, mark, high, low]) = bytes.get(at..at + 4) {
        if mark == 0xff {
            // A fill byte: any number of them may stand before a mark.
            at += 1;
            continue;
        }
        at += 2 + usize::from(u16::from_be_bytes([high, low]));
        if mark == SCAN {
            break;
        }
    }
    bytes
        .get(at..)
        .is_some_and(|scan| scan.windows(2).any(|pair| pair == END))
}

pub(super) fn decode_hdr(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, TextureError> {
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(describe)?;
    // Every row begins with a texel of its own.
    if u64::from(decoder.dimensions().1) * 4 > bytes.len() as u64 {
        return Err(TextureError::malformed("too short for its rows"));
    }
    let exposure = decoder.metadata().exposure.filter(|e| e.is_finite() && *e > 0.0);
    let picture = read(decoder, limits)?;
    match exposure {
        Some(exposure) if exposure != 1.0 => picture.scaled(1.0 / exposure),
        _ => Ok(picture),
    }
}

/// Checks the claims of a file, then reads it.
fn read(decoder: impl ImageDecoder, limits: &PictureLimits) -> Result<Picture, TextureError> {
    let (width, height) = decoder.dimensions();
    limits.check(width, height)?;
    let kind = decoder.color_type();
    let size = usize::try_from(decoder.total_bytes()).map_err(TextureError::malformed)?;
    let mut bytes = vec![0_u8; size];
    decoder.read_image(&mut bytes).map_err(describe)?;
    let channels = kind.channel_count();
    let texels = match kind {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => Texels::U8(bytes.into_boxed_slice()),
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            let (pairs, _) = bytes.as_chunks::<2>();
            Texels::U16(pairs.iter().map(|pair| u16::from_ne_bytes(*pair)).collect())
        }
        ColorType::Rgb32F | ColorType::Rgba32F => {
            let (words, _) = bytes.as_chunks::<4>();
            Texels::F32(words.iter().map(|word| f32::from_ne_bytes(*word)).collect())
        }
        other => {
            return Err(TextureError::Unsupported {
                what: format!("the pixel format {other:?}"),
            });
        }
    };
    Picture::new(width, height, channels, texels)
}

fn describe(error: ImageError) -> TextureError {
    match error {
        ImageError::Unsupported(what) => TextureError::Unsupported { what: what.to_string() },
        other => TextureError::malformed(other),
    }
}

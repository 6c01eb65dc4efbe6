//! From the bytes of a file to a picture.

mod exr;
mod raster;

use crate::{Picture, TextureError};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The largest picture that is decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureLimits {
    /// Most pixels from side to side, either way; 65,536.
    pub side: u32,
    /// Most pixels in all; 2²⁷, for example 16,384 by 8,192, which are at most 2 GiB.
    pub pixels: u64,
}

impl Default for PictureLimits {
    fn default() -> Self {
        Self {
            side: 1 << 16,
            pixels: 1 << 27,
        }
    }
}

impl PictureLimits {
    /// Another number of pixels in all. More of them also allow a longer side.
    #[must_use]
    pub fn of_pixels(pixels: u64) -> Self {
        let default = Self::default();
        let growth = pixels.div_ceil(default.pixels).max(1);
        Self {
            side: u32::try_from(growth.saturating_mul(default.side.into())).unwrap_or(u32::MAX),
            pixels,
        }
    }

    /// Bytes that no sensible file of a picture within the limits exceeds: four floats a pixel, and as much again.
    #[must_use]
    pub fn file_bytes(&self) -> u64 {
        self.pixels.saturating_mul(32).saturating_add(1 << 20)
    }

    /// Refuses what a file claims, before anything is reserved for it.
    fn check(&self, width: u32, height: u32) -> Result<(), TextureError> {
        let refuse = |limit: String| Err(TextureError::TooLarge { width, height, limit });
        if width == 0 || height == 0 {
            return Err(TextureError::Empty);
        }
        if u64::from(width) * u64::from(height) > self.pixels {
            return refuse(format!("{} in all", self.pixels));
        }
        if width.max(height) > self.side {
            return refuse(format!("{} from side to side", self.side));
        }
        Ok(())
    }
}

/// The kinds of files that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Png,
    Jpeg,
    Hdr,
    Exr,
}

impl Kind {
    /// Tells the kind by the first bytes; names of files may lie.
    fn of(bytes: &[u8]) -> Option<Self> {
        let starts = [
            (b"\x89PNG\r\n\x1a\n".as_slice(), Self::Png),
            (b"\xff\xd8\xff", Self::Jpeg),
            (b"#?RADIANCE", Self::Hdr),
            (b"#?RGBE", Self::Hdr),
            (b"\x76\x2f\x31\x01", Self::Exr),
        ];
        starts
            .into_iter()
            .find_map(|(start, kind)| bytes.starts_with(start).then_some(kind))
    }
}

/// Decodes a PNG, JPEG, Radiance HDR or `OpenEXR` file; its first bytes tell which.
///
/// PNG of any depth and colour type, of an animation the first frame; JPEG of 8 bits; HDR with its `EXPOSURE` taken back,
/// so that values are radiance; EXR with the channels R, G, B and perhaps A, or Y and perhaps A, of any compression.
/// Profiles, orientations and pixel aspects are not looked at.
///
/// Safe on hostile bytes: what is reserved is bounded by the limits and by a multiple of the file.
///
/// # Errors
///
/// A [`TextureError`]; it names no file.
pub fn decode(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, TextureError> {
    let kind = Kind::of(bytes).ok_or(TextureError::UnknownKind)?;
    let run = || match kind {
        Kind::Png => raster::decode_png(bytes, limits),
        Kind::Jpeg => raster::decode_jpeg(bytes, limits),
        Kind::Hdr => raster::decode_hdr(bytes, limits),
        Kind::Exr => exr::decode_exr(bytes, limits),
    };
    // Decoders of others may assert what a damaged file breaks.
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| Err(TextureError::malformed("the decoder gave up")))
}

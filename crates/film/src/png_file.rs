//! 8-bit pictures for viewing.

use std::io::{self, Write};
use std::path::Path;

use image::ImageEncoder;
use image::codecs::png::PngEncoder;

use crate::atomic::{WriteError, atomic_write};
use crate::pixels::RgbImage;
use crate::tone::{ToneMap, display_rgb8};

/// Writes an image as 8-bit sRGB PNG, tone-mapped, atomically (see [`atomic_write`]).
///
/// - `image`: linear; the colours of a render are premultiplied by coverage, so without its alpha it
///   shows over black.
/// - `exposure`: stops; the image is multiplied by 2^exposure first.
///
/// # Errors
///
/// A [`WriteError`]; the path then still has what it had before.
pub fn write_png(path: &Path, image: &RgbImage, exposure: f32, map: ToneMap) -> Result<(), WriteError> {
    write_rgb8_png(path, image.width, image.height, &display_rgb8(image, exposure, map))
}

/// Writes display-ready 8-bit pixels as PNG, atomically (see [`atomic_write`]).
///
/// - `pixels`: three bytes a pixel, sRGB, rows from the top, `3 · width · height` of them.
///
/// # Errors
///
/// A [`WriteError`], of kind `InvalidData` if the number of bytes does not fit the size.
///
/// The bytes of the file depend on the arguments alone.
pub fn write_rgb8_png(path: &Path, width: u32, height: u32, pixels: &[u8]) -> Result<(), WriteError> {
    atomic_write(path, |writer| {
        let expected = 3 * u64::from(width) * u64::from(height);
        if expected == 0 || pixels.len() as u64 != expected {
            let message = format!("{} bytes are not {width}x{height} pixels", pixels.len());
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        // Encoded in memory first: the encoder would ignore errors when it writes the last bytes.
        let mut encoded = Vec::new();
        PngEncoder::new(&mut encoded)
            .write_image(pixels, width, height, image::ExtendedColorType::Rgb8)
            .map_err(io::Error::other)?;
        writer.write_all(&encoded)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn image() -> RgbImage {
        let pixel = |i: u32| [i as f32 * 0.01, 0.18, 4.0 / (i + 1) as f32];
        RgbImage {
            width: 23,
            height: 17,
            pixels: (0..23 * 17).map(pixel).collect(),
        }
    }

    #[test]
    fn comes_back_from_a_decoder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_png(&path, &image(), 0.5, ToneMap::Filmic).unwrap();
        let bytes = fs::read(&path).unwrap();
        let read = image::load_from_memory(&bytes).unwrap();
        assert_eq!(read.color(), image::ColorType::Rgb8);
        assert_eq!((read.width(), read.height()), (23, 17));
        assert_eq!(read.as_bytes(), display_rgb8(&image(), 0.5, ToneMap::Filmic));
        write_png(&path, &image(), 0.5, ToneMap::Filmic).unwrap();
        assert_eq!(fs::read(&path).unwrap(), bytes);
    }

    #[test]
    fn errors_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        assert!(write_rgb8_png(&path, 2, 2, &[0; 11]).is_err());
        assert!(write_rgb8_png(&path, 0, 2, &[]).is_err());
        assert!(!path.exists());
        #[cfg(target_os = "linux")]
        {
            let full = write_png(Path::new("/dev/full"), &image(), 0.0, ToneMap::Srgb);
            assert_eq!(full.unwrap_err().source.kind(), io::ErrorKind::StorageFull);
        }
    }
}

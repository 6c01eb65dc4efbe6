mod decoding;
mod hostile;
mod sampling;
mod transforming;

use crate::decode::{PictureLimits, decode};
use crate::{Picture, TextureError};
use image::codecs::hdr::HdrEncoder;
use image::{ColorType, ImageFormat};
use std::io::Cursor;

/// Encodes 8-bit values, or 16-bit ones by their bytes, with the `image` crate.
fn encoded(format: ImageFormat, width: u32, height: u32, kind: ColorType, bytes: &[u8]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image::write_buffer_with_format(&mut file, bytes, width, height, kind, format).unwrap();
    file.into_inner()
}

fn png(width: u32, height: u32, kind: ColorType, bytes: &[u8]) -> Vec<u8> {
    encoded(ImageFormat::Png, width, height, kind, bytes)
}

fn hdr(width: u32, values: &[[f32; 3]]) -> Vec<u8> {
    let mut file = Vec::new();
    let pixels: Vec<_> = values.iter().map(|value| image::Rgb(*value)).collect();
    HdrEncoder::new(&mut file)
        .encode(&pixels, width as usize, values.len() / width as usize)
        .unwrap();
    file
}

/// An EXR file of some channels, each with the values of all pixels.
fn exr(width: u32, channels: &[(&str, &[f32])]) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.exr");
    let height = channels[0].1.len() as u32 / width;
    let image = film::Image {
        window: film::FilmWindow::full(glam::UVec2::new(width, height)),
        channels: channels
            .iter()
            .map(|(name, values)| film::Channel {
                name: (*name).to_owned(),
                samples: values.to_vec(),
            })
            .collect(),
    };
    film::write_exr(&path, &image, &film::Metadata::default()).unwrap();
    std::fs::read(path).unwrap()
}

fn read(bytes: &[u8]) -> Result<Picture, TextureError> {
    decode(bytes, &PictureLimits::default())
}

//! `OpenEXR`, by the `film` crate.

use super::PictureLimits;
use crate::picture::Texels;
use crate::{Picture, TextureError};
use film::{ExrImage, decode_exr_within, exr_size};

/// Colour, alpha, and some more that is not looked at.
const MOST_CHANNELS: u64 = 8;

pub(super) fn decode_exr(bytes: &[u8], limits: &PictureLimits) -> Result<Picture, TextureError> {
    let (width, height) = exr_size(bytes)?;
    limits.check(width, height)?;
    let image = decode_exr_within(bytes, limits.pixels.saturating_mul(MOST_CHANNELS))?;
    let planes = colour_planes(&image)?;
    let pixels = width as usize * height as usize;
    let mut texels = Vec::with_capacity(pixels * planes.len());
    for pixel in 0..pixels {
        texels.extend(planes.iter().map(|plane| plane[pixel]));
    }
    Picture::new(
        image.width,
        image.height,
        planes.len() as u8,
        Texels::F32(texels.into_boxed_slice()),
    )
}

/// The channels of a colour or of a grey, and alpha if there is one.
fn colour_planes(image: &ExrImage) -> Result<Vec<&[f32]>, TextureError> {
    let all = |names: &[&str]| names.iter().map(|name| image.channel(name)).collect::<Option<Vec<_>>>();
    let mut planes = all(&["R", "G", "B"]).or_else(|| all(&["Y"])).ok_or_else(|| {
        let names: Vec<&str> = image.channels.iter().map(|(name, _)| name.as_str()).collect();
        TextureError::NoColour {
            found: names.join(", "),
        }
    })?;
    planes.extend(image.channel("A"));
    Ok(planes)
}

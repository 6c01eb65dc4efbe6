//! A map of what an audit found: numbers as EXR, a picture as PNG.

use crate::audit::Judged;
use crate::outputs::is_exr;
use film::{AuditTest, Channel, Image, Metadata, RgbImage};
use std::error::Error;
use std::path::Path;

/// The share of the traced mean that is painted at full strength.
const FULL_STRENGTH: f64 = 0.1;
/// What was not looked at.
const UNSEEN: [u8; 3] = [48, 48, 48];
/// Around blocks with a finding.
const FRAME: [u8; 3] = [255, 255, 255];

/// Writes the map.
///
/// - `significance`: chance below which a test is a finding.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn write(path: &Path, judged: &Judged, significance: f64) -> Result<(), Box<dyn Error>> {
    if is_exr(path) {
        let metadata = Metadata {
            version: env!("CARGO_PKG_VERSION").into(),
            ..Metadata::default()
        };
        film::write_exr(path, &numbers(judged), &metadata)?;
    } else {
        let (difference, bytes) = picture(judged, significance);
        film::write_rgb8_png(path, difference.width, difference.height, &bytes)?;
    }
    Ok(())
}

/// `R G B`: ours − traced, over each block. `ours`, `traced`: both, pixel by pixel. `error`: standard error of a block's
/// difference. `chance`: that noise made it, 1 where nothing can be said. 0 where nobody looked.
fn numbers(judged: &Judged) -> Image {
    let window = *judged.ours.window();
    let mut channels = Vec::new();
    let mut put = |layer: &str, image: RgbImage| {
        for (component, name) in ["R", "G", "B"].iter().enumerate() {
            let name = if layer.is_empty() {
                (*name).to_owned()
            } else {
                format!("{layer}.{name}")
            };
            let samples = image.pixels.iter().map(|pixel| pixel[component]).collect();
            channels.push(Channel { name, samples });
        }
    };
    put("", over_blocks(judged, |test| test.ours - test.traced));
    for (layer, film) in [("ours", &judged.ours), ("traced", &judged.traced)] {
        if let Some(image) = film.resolve().rgb("") {
            put(layer, image);
        }
    }
    put("error", over_blocks(judged, |test| test.standard_error));
    put("chance", over_blocks(judged, |test| test.chance.unwrap_or(1.0)));
    Image { window, channels }
}

/// A value of each block's beauty, over all of its pixels; 0 elsewhere.
fn over_blocks(judged: &Judged, value: impl Fn(&AuditTest) -> f64) -> RgbImage {
    let window = judged.ours.window();
    let size = window.size();
    let mut image = RgbImage {
        width: size.x,
        height: size.y,
        pixels: vec![[0.0; 3]; window.pixel_count()],
    };
    let beauty = judged.audit.blocks.iter().filter(|test| test.layer.is_none());
    for test in beauty {
        let Some(row) = test.block else { continue };
        for pixel in places(judged, row) {
            image.pixels[pixel][test.channel] = value(test) as f32;
        }
    }
    image
}

/// The pixels of a block, in raster order of the crop.
fn places(judged: &Judged, row: usize) -> impl Iterator<Item = usize> + use<> {
    let window = judged.ours.window();
    let (width, block) = (window.size().x as usize, &judged.blocks[row]);
    let (min, max) = (block.min - window.crop_min, block.max - window.crop_min);
    (min.y..max.y).flat_map(move |y| (min.x..max.x).map(move |x| y as usize * width + x as usize))
}

/// The difference, painted.
fn picture(judged: &Judged, significance: f64) -> (RgbImage, Vec<u8>) {
    let difference = over_blocks(judged, |test| test.ours - test.traced);
    let beauty = judged.audit.overall.iter().filter(|test| test.layer.is_none());
    let mean = beauty.map(|test| test.traced).sum::<f64>() / 3.0;
    let scale = (FULL_STRENGTH * mean).max(f64::MIN_POSITIVE) as f32;
    let painted = film::false_colour(&difference, scale.max(f32::MIN_POSITIVE));
    let mut bytes: Vec<u8> = UNSEEN.repeat(difference.pixels.len());
    let mut paint = |pixel: usize, colour: &[u8]| bytes[3 * pixel..][..3].copy_from_slice(colour);
    for row in 0..judged.blocks.len() {
        for pixel in places(judged, row) {
            paint(pixel, &painted[3 * pixel..][..3]);
        }
    }
    let is_found = |test: &&AuditTest| test.chance.is_some_and(|chance| chance < significance);
    for row in judged
        .audit
        .blocks
        .iter()
        .filter(is_found)
        .filter_map(|test| test.block)
    {
        let block = &judged.blocks[row];
        let size = (block.max - block.min).as_usizevec2();
        for (i, pixel) in places(judged, row).enumerate() {
            let (x, y) = (i % size.x, i / size.x);
            if x == 0 || y == 0 || x + 1 == size.x || y + 1 == size.y {
                paint(pixel, &FRAME);
            }
        }
    }
    (difference, bytes)
}

//! How far an image is from a reference.

use crate::pixels::RgbImage;

/// Share of the worst pixels that the trimmed error leaves out, so that a few fireflies do not decide.
pub const TRIM: f64 = 0.001;

/// Why two images cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MetricsError {
    /// They differ in size.
    #[error(
        "the image has {}x{} pixels, the reference {}x{}; render both with the same resolution and crop",
        image.0, image.1, reference.0, reference.1
    )]
    Size {
        /// Width and height of the image.
        image: (u32, u32),
        /// Width and height of the reference.
        reference: (u32, u32),
    },
    /// There is nothing to compare.
    #[error("the images have no pixels; render at least one")]
    Empty,
}

/// A pixel and its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstPixel {
    /// Column, from the left.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Its value in the image.
    pub image: [f32; 3],
    /// Its value in the reference.
    pub reference: [f32; 3],
    /// Its part of the relative squared error; the mean over the channels.
    pub error: f64,
}

/// The measures that [`compare`] takes. All numbers are taken in `f64`, in raster order.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Mean of the image, for each channel.
    pub mean_image: [f64; 3],
    /// Mean of the reference, for each channel.
    pub mean_reference: [f64; 3],
    /// (image − reference) / reference of the means: the bias. 0 if both are 0, else infinite over a
    /// reference of 0.
    pub relative_difference: [f64; 3],
    /// Mean over pixels and channels of (I − R)² / (R² + (0.1 · mean R)²), where mean R is over all
    /// pixels and channels.
    pub rel_mse: f64,
    /// The same without the worst ⌊[`TRIM`] · pixels⌋ pixels.
    pub rel_mse_trimmed: f64,
    /// The pixels with the largest errors, worst first; the first in raster order among equals.
    pub worst: Vec<WorstPixel>,
    /// How many pixels of the image, and of the reference, have a value that is not finite. Such values
    /// count as 0 everywhere above.
    pub non_finite: [usize; 2],
}

/// Compares an image with a reference.
///
/// - `worst`: how many of the worst pixels to list.
///
/// # Errors
///
/// [`MetricsError`] if the sizes differ or there are no pixels.
///
/// Cost: O(n log n) in the number of pixels, for the sort.
pub fn compare(image: &RgbImage, reference: &RgbImage, worst: usize) -> Result<Comparison, MetricsError> {
    check_sizes(image, reference)?;
    let mean_image = channel_means(&image.pixels);
    let mean_reference = channel_means(&reference.pixels);
    let floor = 0.1 * mean_reference.iter().sum::<f64>() / 3.0;
    let errors: Vec<f64> = image
        .pixels
        .iter()
        .zip(&reference.pixels)
        .map(|(&i, &r)| pixel_error(i, r, floor * floor))
        .collect();
    let mut ranked: Vec<usize> = (0..errors.len()).collect();
    ranked.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]));
    let trimmed = (TRIM * errors.len() as f64) as usize;
    let kept = &ranked[trimmed..];
    let width = image.width as usize;
    let describe = |&index: &usize| WorstPixel {
        x: (index % width) as u32,
        y: (index / width) as u32,
        image: image.pixels[index],
        reference: reference.pixels[index],
        error: errors[index],
    };
    Ok(Comparison {
        mean_image,
        mean_reference,
        relative_difference: std::array::from_fn(|c| relative(mean_image[c], mean_reference[c])),
        rel_mse: errors.iter().sum::<f64>() / errors.len() as f64,
        // From the smallest to the largest, which loses least.
        rel_mse_trimmed: kept.iter().rev().map(|&i| errors[i]).sum::<f64>() / kept.len() as f64,
        worst: ranked.iter().take(worst).map(describe).collect(),
        non_finite: [count_non_finite(image), count_non_finite(reference)],
    })
}

/// The means of both images over one block of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockDifference {
    /// First column of the block.
    pub x: u32,
    /// First row of the block.
    pub y: u32,
    /// Mean of the image over the block.
    pub mean_image: [f64; 3],
    /// Mean of the reference over the block.
    pub mean_reference: [f64; 3],
}

impl BlockDifference {
    /// Returns image − reference.
    #[must_use]
    pub fn difference(&self) -> [f64; 3] {
        std::array::from_fn(|c| self.mean_image[c] - self.mean_reference[c])
    }
}

/// Compares the means over square blocks, which shows local bias below the noise of single pixels.
///
/// - `side`: of a block in pixels, at least 1; 8 is usual. Blocks at the right and bottom are cut off.
/// - returns the blocks in rows from the top. Values that are not finite count as 0.
///
/// # Errors
///
/// [`MetricsError`] if the sizes differ or there are no pixels.
///
/// # Panics
///
/// If `side` is 0.
pub fn block_differences(
    image: &RgbImage,
    reference: &RgbImage,
    side: u32,
) -> Result<Vec<BlockDifference>, MetricsError> {
    assert!(side > 0, "a block has at least one pixel");
    check_sizes(image, reference)?;
    let (width, height) = (image.width, image.height);
    let corners = |end: u32| (0..end).step_by(side as usize);
    let blocks = corners(height).flat_map(|y| corners(width).map(move |x| (x, y)));
    Ok(blocks
        .map(|(x, y)| BlockDifference {
            x,
            y,
            mean_image: block_mean(image, x, y, side),
            mean_reference: block_mean(reference, x, y, side),
        })
        .collect())
}

/// Reduces an image to the means over square blocks, a pixel each: what [`block_differences`] compares, to keep as a small
/// reference.
///
/// - `side`: of a block in pixels, at least 1. Blocks at the right and bottom are cut off.
/// - values that are not finite count as 0.
///
/// # Panics
///
/// If `side` is 0.
#[must_use]
pub fn block_means(image: &RgbImage, side: u32) -> RgbImage {
    assert!(side > 0, "a block has at least one pixel");
    let size = (image.width.div_ceil(side), image.height.div_ceil(side));
    let blocks = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x * side, y * side)));
    RgbImage {
        width: size.0,
        height: size.1,
        pixels: blocks
            .map(|(x, y)| block_mean(image, x, y, side).map(|v| v as f32))
            .collect(),
    }
}

fn block_mean(image: &RgbImage, x: u32, y: u32, side: u32) -> [f64; 3] {
    let columns = x as usize..(x.saturating_add(side).min(image.width)) as usize;
    let rows = y as usize..(y.saturating_add(side).min(image.height)) as usize;
    let lines = rows.map(|row| &image.pixels[row * image.width as usize..][columns.clone()]);
    channel_means(lines.flatten())
}

/// Returns image − reference, for each pixel and channel; signed.
///
/// # Errors
///
/// [`MetricsError`] if the sizes differ or there are no pixels.
pub fn difference(image: &RgbImage, reference: &RgbImage) -> Result<RgbImage, MetricsError> {
    check_sizes(image, reference)?;
    let pairs = image.pixels.iter().zip(&reference.pixels);
    let pixels = pairs.map(|(i, r)| std::array::from_fn(|c| i[c] - r[c])).collect();
    Ok(RgbImage {
        width: image.width,
        height: image.height,
        pixels,
    })
}

/// Paints a signed difference: red where the image is too bright, blue where it is too dark, black where
/// it agrees, magenta where the difference is not a number.
///
/// - `scale`: the difference in Rec.709 luminance that is painted at full strength, above 0. A tenth of
///   the reference's mean is a good start.
/// - returns three bytes a pixel, for [`write_rgb8_png`](crate::write_rgb8_png). Strength is linear in
///   the byte, so that half the difference looks about half as strong.
#[must_use]
pub fn false_colour(difference: &RgbImage, scale: f32) -> Vec<u8> {
    let paint = |&[r, g, b]: &[f32; 3]| {
        let strength = (0.2126 * r + 0.7152 * g + 0.0722 * b) / scale;
        let byte = (strength.abs().min(1.0) * 255.0 + 0.5) as u8;
        if strength.is_nan() {
            [255, 0, 255]
        } else if strength > 0.0 {
            [byte, byte / 6, 0]
        } else {
            [0, byte / 3, byte]
        }
    };
    difference.pixels.iter().flat_map(paint).collect()
}

fn check_sizes(image: &RgbImage, reference: &RgbImage) -> Result<(), MetricsError> {
    let size = |i: &RgbImage| (i.width, i.height);
    let full = |i: &RgbImage| i.pixels.len() == i.width as usize * i.height as usize;
    if size(image) != size(reference) {
        return Err(MetricsError::Size {
            image: size(image),
            reference: size(reference),
        });
    }
    if image.pixels.is_empty() || !full(image) || !full(reference) {
        return Err(MetricsError::Empty);
    }
    Ok(())
}

/// The value as a number, 0 if it is not finite.
fn finite(value: f32) -> f64 {
    if value.is_finite() { f64::from(value) } else { 0.0 }
}

fn count_non_finite(image: &RgbImage) -> usize {
    image
        .pixels
        .iter()
        .filter(|pixel| !pixel.iter().all(|v| v.is_finite()))
        .count()
}

fn channel_means<'p>(pixels: impl IntoIterator<Item = &'p [f32; 3]>) -> [f64; 3] {
    let mut sums = [0.0; 3];
    let mut count = 0.0;
    for pixel in pixels {
        count += 1.0;
        for (sum, &value) in sums.iter_mut().zip(pixel) {
            *sum += finite(value);
        }
    }
    sums.map(|sum| sum / count)
}

fn relative(mean: f64, reference: f64) -> f64 {
    if mean == reference {
        0.0
    } else {
        (mean - reference) / reference
    }
}

/// Mean over the channels of (I − R)² / (R² + floor²); nothing off is no error, even over black.
fn pixel_error(image: [f32; 3], reference: [f32; 3], floor_sq: f64) -> f64 {
    let channel = |c: usize| {
        let (i, r) = (finite(image[c]), finite(reference[c]));
        if i == r {
            0.0
        } else {
            (i - r) * (i - r) / (r * r + floor_sq)
        }
    };
    (channel(0) + channel(1) + channel(2)) / 3.0
}

#[cfg(test)]
mod tests;

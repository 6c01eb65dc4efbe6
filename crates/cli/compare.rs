//! `pipeline compare`: how far an image is from a reference.

use crate::args::CompareArgs;
use crate::compare_text;
use crate::exit::Failure;
use crate::outputs::{check_writable, is_exr};
use crate::terminal::{print, say};
use film::{Comparison, ExrImage, Metadata, RgbImage};
use std::path::Path;

pub(crate) fn execute(options: &CompareArgs) -> Result<(), Failure> {
    let layer = options.layer.as_deref().unwrap_or("");
    let image = read_layer(&options.image, layer)?;
    let reference = read_layer(&options.reference, layer)?;
    let comparison =
        film::compare(&image, &reference, options.worst).map_err(|error| Failure::bad_input(error.to_string()))?;
    for (path, count) in [&options.image, &options.reference]
        .into_iter()
        .zip(comparison.non_finite)
    {
        if count > 0 {
            say(&format!(
                "warning: {count} pixels of {} are not finite; they count as black",
                path.display()
            ));
        }
    }
    if let Some(path) = &options.diff {
        check_writable([path])?;
        write_difference(path, &image, &reference, &comparison)?;
    }
    print(&if options.json {
        compare_text::json(&comparison)
    } else {
        compare_text::table(&comparison)
    })?;
    judge(options, &comparison)
}

fn read_layer(path: &Path, layer: &str) -> Result<RgbImage, Failure> {
    let image = film::read_exr(path).map_err(|error| Failure::bad_input(error.to_string()))?;
    image.rgb(layer).ok_or_else(|| {
        let wanted = if layer.is_empty() {
            "channels R, G and B".into()
        } else {
            format!("layer `{layer}`")
        };
        let there = layers(&image);
        let remedy = if there.is_empty() {
            "render it with this program, or convert it".to_owned()
        } else {
            format!("choose with --layer: {}", there.join(", "))
        };
        Failure::bad_input(format!("{} has no {wanted}; {remedy}", path.display()))
    })
}

/// Names of the layers that have red, green and blue.
fn layers(image: &ExrImage) -> Vec<&str> {
    let red = image.channels.iter().filter_map(|(name, _)| name.strip_suffix(".R"));
    red.filter(|layer| image.rgb(layer).is_some()).collect()
}

/// The share of the reference's mean that is painted at full strength.
const FULL_STRENGTH: f64 = 0.1;

fn write_difference(
    path: &Path,
    image: &RgbImage,
    reference: &RgbImage,
    comparison: &Comparison,
) -> Result<(), Failure> {
    let difference = film::difference(image, reference).map_err(|error| Failure::bad_input(error.to_string()))?;
    if is_exr(path) {
        let metadata = Metadata {
            version: env!("CARGO_PKG_VERSION").into(),
            ..Metadata::default()
        };
        return film::write_exr(path, &film::Image::from_rgb(&difference), &metadata)
            .map_err(|error| Failure::failed(error.to_string()));
    }
    let mean = comparison.mean_reference.iter().sum::<f64>() / 3.0;
    let scale = if mean > 0.0 { FULL_STRENGTH * mean } else { 1.0 };
    let painted = film::false_colour(&difference, scale as f32);
    film::write_rgb8_png(path, difference.width, difference.height, &painted)
        .map_err(|error| Failure::failed(error.to_string()))
}

/// Fails over the limit, if there is one; an image that is not finite is over any.
fn judge(options: &CompareArgs, comparison: &Comparison) -> Result<(), Failure> {
    let Some(limit) = options.max_relmse else { return Ok(()) };
    let (name, error) = if options.trim {
        ("trimmed relMSE", comparison.rel_mse_trimmed)
    } else {
        ("relMSE", comparison.rel_mse)
    };
    if comparison.non_finite[0] > 0 {
        return Err(Failure::failed("the image has pixels that are not finite"));
    }
    if error <= limit {
        return Ok(());
    }
    Err(Failure::failed(format!(
        "{name} {error:.3e} is over the limit {limit:.3e}"
    )))
}

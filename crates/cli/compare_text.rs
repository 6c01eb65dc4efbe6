//! A comparison as text and as JSON.

use crate::number::number;
use film::Comparison;
use std::fmt::Write;

/// A few lines for people.
pub(crate) fn table(comparison: &Comparison) -> String {
    let mut text = format!("{:14} {:>12} {:>12} {:>12}\n", "", "R", "G", "B");
    for (name, values) in [
        ("mean", comparison.mean_image),
        ("mean reference", comparison.mean_reference),
    ] {
        let [r, g, b] = values.map(number);
        let _ = writeln!(text, "{name:14} {r:>12} {g:>12} {b:>12}");
    }
    let [r, g, b] = comparison.relative_difference.map(percent);
    let _ = writeln!(text, "{:14} {r:>12} {g:>12} {b:>12}", "difference");
    let _ = writeln!(text, "{:14} {:>12}", "relMSE", number(comparison.rel_mse));
    let _ = writeln!(text, "{:14} {:>12}", "  trimmed", number(comparison.rel_mse_trimmed));
    let worst: Vec<_> = comparison.worst.iter().filter(|pixel| pixel.error > 0.0).collect();
    if !worst.is_empty() {
        text.push_str("worst pixels\n");
    }
    for pixel in worst {
        let [image, reference] = [pixel.image, pixel.reference].map(|rgb| {
            let [r, g, b] = rgb.map(|value| number(f64::from(value)));
            format!("({r}, {g}, {b})")
        });
        let place = format!("{},{}", pixel.x, pixel.y);
        let _ = writeln!(
            text,
            "  {place:12} {:>12}  {image} for {reference}",
            number(pixel.error)
        );
    }
    text
}

/// An object with the same measures, at full precision. A number that is not finite is `null`.
pub(crate) fn json(comparison: &Comparison) -> String {
    let worst: Vec<_> = comparison
        .worst
        .iter()
        .map(|pixel| {
            serde_json::json!({
                "x": pixel.x, "y": pixel.y, "image": pixel.image, "reference": pixel.reference, "error": pixel.error,
            })
        })
        .collect();
    let value = serde_json::json!({
        "mean": comparison.mean_image,
        "mean_reference": comparison.mean_reference,
        "relative_difference": comparison.relative_difference,
        "relmse": comparison.rel_mse,
        "relmse_trimmed": comparison.rel_mse_trimmed,
        "not_finite": comparison.non_finite,
        "worst": worst,
    });
    format!("{value:#}\n")
}

fn percent(share: f64) -> String {
    format!("{:+.3} %", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_images_have_no_worst_pixels() {
        let image = film::RgbImage {
            width: 2,
            height: 1,
            pixels: vec![[0.5; 3], [1.0; 3]],
        };
        let comparison = film::compare(&image, &image, 3).unwrap();
        let text = table(&comparison);
        assert!(!text.contains("worst"), "{text}");
        assert!(text.contains("relMSE                    0\n"), "{text}");
        let value: serde_json::Value = serde_json::from_str(&json(&comparison)).unwrap();
        assert_eq!(value["relmse"], 0.0);
        assert_eq!(value["worst"].as_array().map(Vec::len), Some(2));
    }
}

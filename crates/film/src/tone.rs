//! From linear radiance to the 8 bits of a display.
//!
//! For pictures to look at only: EXR files stay linear.

use rayon::prelude::*;

use crate::pixels::RgbImage;

/// How linear values are brought into the range of a display.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ToneMap {
    /// Clips at 1, then the sRGB curve. Exact below white; bright colours turn into flat patches.
    Srgb,
    /// Exact up to 0.4, so that middle grey stays 0.18; above, a smooth shoulder on the brightest
    /// channel, which keeps the hue, and a fade towards white the further the light exceeds the display.
    ///
    /// Source: Khronos Group, "PBR Neutral Tone Mapper", 2024.
    /// Differs: the shoulder starts at 0.4 instead of 0.76, for radiance has a far larger range than
    /// the product shots that the original is for; and no toe, so that middle grey is exact.
    #[default]
    Filmic,
}

/// Where the shoulder starts.
const SHOULDER: f32 = 0.4;
/// How fast light beyond the display fades to white.
const DESATURATION: f32 = 0.15;
/// Brighter values are taken as this one, which keeps the arithmetic finite.
const CEILING: f32 = 1e12;

/// Maps one colour to display-linear values.
///
/// - `radiance`: linear RGB, Rec.709; negative and not-a-number count as 0.
/// - returns linear RGB within 0 ..= 1, before the sRGB curve.
#[must_use]
pub fn tone_map(radiance: [f32; 3], map: ToneMap) -> [f32; 3] {
    let light = radiance.map(|value| within(value, CEILING));
    match map {
        ToneMap::Srgb => light.map(|value| value.min(1.0)),
        ToneMap::Filmic => compress(light),
    }
}

/// Limits a value to 0 ..= `ceiling`; what is not a number becomes 0.
fn within(value: f32, ceiling: f32) -> f32 {
    if value > 0.0 { value.min(ceiling) } else { 0.0 }
}

fn compress(light: [f32; 3]) -> [f32; 3] {
    let peak = light[0].max(light[1]).max(light[2]);
    if peak <= SHOULDER {
        return light;
    }
    let room = 1.0 - SHOULDER;
    let compressed = 1.0 - room * room / (peak + room - SHOULDER);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    light.map(|value| {
        let scaled = value * (compressed / peak);
        (scaled + (compressed - scaled) * white).min(1.0)
    })
}

/// Applies the sRGB curve and rounds to 8 bits.
///
/// - `linear`: display-linear; clipped to 0 ..= 1, not-a-number counts as 0.
///
/// Source: IEC 61966-2-1:1999. Deterministic.
#[must_use]
pub fn encode_srgb8(linear: f32) -> u8 {
    let value = f64::from(within(linear, 1.0));
    let encoded = if value <= 0.003_130_8 {
        12.92 * value
    } else {
        1.055 * libm::pow(value, 1.0 / 2.4) - 0.055
    };
    (encoded * 255.0 + 0.5) as u8
}

/// Makes an 8-bit sRGB picture.
///
/// - `exposure`: stops; the image is multiplied by 2^exposure first.
/// - returns three bytes a pixel, rows from the top.
///
/// Cost: three powers a pixel, in parallel on the current rayon pool.
#[must_use]
pub fn display_rgb8(image: &RgbImage, exposure: f32, map: ToneMap) -> Vec<u8> {
    let gain = libm::exp2f(exposure);
    let encode = |pixel: &[f32; 3]| tone_map(pixel.map(|v| v * gain), map).map(encode_srgb8);
    image.pixels.par_iter().flat_map_iter(encode).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAPS: [ToneMap; 2] = [ToneMap::Srgb, ToneMap::Filmic];

    #[test]
    fn srgb_has_its_known_values() {
        let known = [
            (0.0, 0),
            (1.0, 255),
            (0.18, 118),
            (0.5, 188),
            (0.215_861, 128),
            (0.002, 7),
        ];
        for (linear, expected) in known {
            assert_eq!(encode_srgb8(linear), expected, "{linear}");
        }
        let odd = [(f32::NAN, 0), (-3.0, 0), (f32::INFINITY, 255), (f32::NEG_INFINITY, 0)];
        for (linear, expected) in odd {
            assert_eq!(encode_srgb8(linear), expected);
        }
    }

    #[test]
    fn mid_tones_stay() {
        for map in MAPS {
            assert_eq!(tone_map([0.18; 3], map), [0.18; 3]);
            assert_eq!(tone_map([0.4, 0.1, 0.0], map), [0.4, 0.1, 0.0]);
        }
    }

    #[test]
    fn filmic_is_monotonic_smooth_and_below_one() {
        let at = |i: i32| tone_map([i as f32 * 0.001; 3], ToneMap::Filmic)[0];
        for i in 1..20_000 {
            let step = at(i) - at(i - 1);
            assert!((-1e-7..=0.001 + 1e-6).contains(&step), "{i}: {step}");
            let bend = (at(i + 1) - at(i)) - step;
            assert!(bend.abs() < 1e-5, "{i}: {bend}");
            assert!(at(i) < 1.0);
        }
    }

    #[test]
    fn bright_gold_rolls_off_to_white() {
        let gold = |gain: f32| tone_map([gain, 0.77 * gain, 0.34 * gain], ToneMap::Filmic);
        let mut saturation = 1.0;
        for gain in [0.5, 1.0, 2.0, 5.0, 20.0, 1000.0] {
            let [r, g, b] = gold(gain);
            assert!(r >= g && g >= b && r <= 1.0);
            assert!(1.0 - b / r < saturation, "gain {gain}");
            saturation = 1.0 - b / r;
        }
        assert!(saturation < 0.05);
        assert!(gold(1.0)[0] > 0.6 && gold(1.0)[2] < 0.35);
    }

    #[test]
    fn odd_values_stay_in_range() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1.0, 1e-45];
        for map in MAPS {
            for a in odd {
                for b in odd {
                    let mapped = tone_map([a, b, 0.5], map);
                    assert!(mapped.iter().all(|v| (0.0..=1.0).contains(v)), "{a} {b}: {mapped:?}");
                }
            }
        }
    }

    #[test]
    fn exposure_is_in_stops() {
        let pixels = |value: f32| RgbImage {
            width: 1,
            height: 1,
            pixels: vec![[value; 3]],
        };
        for map in MAPS {
            assert_eq!(
                display_rgb8(&pixels(0.05), 2.0, map),
                display_rgb8(&pixels(0.2), 0.0, map)
            );
        }
    }
}

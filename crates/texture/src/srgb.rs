//! The curve of sRGB.

use radiometry::math::powf_f64;
use std::sync::LazyLock;

/// Linear light of an sRGB value; both 1 at white.
///
/// Values above 1 go on along the curve. Source: IEC 61966-2-1:1999.
pub(crate) fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        powf_f64((encoded + 0.055) / 1.055, 2.4)
    }
}

/// Linear light of every 8-bit value.
pub(crate) static LINEAR_OF_8_BIT: LazyLock<Box<[f32]>> = LazyLock::new(|| table(u8::MAX.into()));
/// Linear light of every 16-bit value.
pub(crate) static LINEAR_OF_16_BIT: LazyLock<Box<[f32]>> = LazyLock::new(|| table(u16::MAX));

fn table(largest: u16) -> Box<[f32]> {
    let share = |value: u16| f64::from(value) / f64::from(largest);
    (0..=largest)
        .map(|value| linear_from_srgb(share(value)) as f32)
        .collect()
}

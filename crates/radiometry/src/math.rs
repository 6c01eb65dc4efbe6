//! Transcendental functions with the same bits on every machine.
//!
//! Each forwards to the pure-Rust `libm`. Square roots, rounding and the four operations are exact by IEEE 754 and are
//! used directly; everything else in the workspace comes through here (held by clippy's `disallowed_methods`).

/// Sine of an angle in radians.
#[inline]
#[must_use]
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of an angle in radians.
#[inline]
#[must_use]
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}

/// Tangent of an angle in radians.
#[inline]
#[must_use]
pub fn tan(x: f32) -> f32 {
    libm::tanf(x)
}

/// Sine and cosine of an angle in radians.
#[inline]
#[must_use]
pub fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}

/// Arc cosine in radians; the argument is clamped to [−1, 1].
#[inline]
#[must_use]
pub fn acos(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// Arc sine in radians; the argument is clamped to [−1, 1].
#[inline]
#[must_use]
pub fn asin(x: f32) -> f32 {
    libm::asinf(x.clamp(-1.0, 1.0))
}

/// Angle of the point (x, y) in radians, in [−π, π].
#[inline]
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// e to the power x.
#[inline]
#[must_use]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Natural logarithm.
#[inline]
#[must_use]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// Complementary error function, `2/√π ∫ e^(−t²) dt` from x to infinity; in [0, 2].
#[inline]
#[must_use]
pub fn erfc(x: f32) -> f32 {
    libm::erfcf(x)
}

/// x to the power y.
#[inline]
#[must_use]
pub fn powf(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// Cube root.
#[inline]
#[must_use]
pub fn cbrt(x: f32) -> f32 {
    libm::cbrtf(x)
}

/// Sine and cosine of an angle in radians, in double precision.
#[inline]
#[must_use]
pub fn sin_cos_f64(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Tangent of an angle in radians, in double precision.
#[inline]
#[must_use]
pub fn tan_f64(x: f64) -> f64 {
    libm::tan(x)
}

/// Arc cosine in radians, in double precision; the argument is clamped to [−1, 1].
#[inline]
#[must_use]
pub fn acos_f64(x: f64) -> f64 {
    libm::acos(x.clamp(-1.0, 1.0))
}

/// x to the power y, in double precision.
#[inline]
#[must_use]
pub fn powf_f64(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// x − ⌊x⌋ for the stratification of angles; in [0, 1).
#[inline]
#[must_use]
pub fn fract(x: f32) -> f32 {
    let f = x - x.floor();
    if f < 1.0 { f } else { 0.0 }
}

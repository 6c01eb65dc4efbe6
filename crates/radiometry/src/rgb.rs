use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

/// A radiometric quantity or a reflectance in linear RGB with Rec.709 primaries.
///
/// What it measures is said where it is used: radiance in W·m⁻²·sr⁻¹, irradiance in W·m⁻², flux in W, or a factor
/// without unit. 12 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Rgb {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
}

impl Rgb {
    /// Nothing at all.
    pub const BLACK: Self = Self::splat(0.0);
    /// One in every channel.
    pub const WHITE: Self = Self::splat(1.0);

    /// Builds a value from its three channels.
    #[inline]
    #[must_use]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self { r, g, b }
    }

    /// The same value in every channel.
    #[inline]
    #[must_use]
    pub const fn splat(v: f32) -> Self {
        Self { r: v, g: v, b: v }
    }

    /// Relative luminance of Rec.709: 0.2126 R + 0.7152 G + 0.0722 B.
    #[inline]
    #[must_use]
    pub fn luminance(self) -> f32 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// Mean of the three channels: the importance by which lights and lobes are chosen.
    #[inline]
    #[must_use]
    pub fn mean(self) -> f32 {
        (self.r + self.g + self.b) * (1.0 / 3.0)
    }

    /// The largest channel.
    #[inline]
    #[must_use]
    pub fn max_element(self) -> f32 {
        self.r.max(self.g).max(self.b)
    }

    /// True when every channel is exactly zero.
    #[inline]
    #[must_use]
    pub fn is_black(self) -> bool {
        self.r == 0.0 && self.g == 0.0 && self.b == 0.0
    }

    /// True when every channel is finite.
    #[inline]
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }

    /// Applies `f` to each channel.
    #[inline]
    #[must_use]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }

    /// The channels as an array.
    #[inline]
    #[must_use]
    pub const fn to_array(self) -> [f32; 3] {
        [self.r, self.g, self.b]
    }
}

impl From<Vec3> for Rgb {
    #[inline]
    fn from(v: Vec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<Rgb> for Vec3 {
    #[inline]
    fn from(c: Rgb) -> Self {
        Self::new(c.r, c.g, c.b)
    }
}

impl Index<usize> for Rgb {
    type Output = f32;
    #[inline]
    fn index(&self, channel: usize) -> &f32 {
        match channel {
            0 => &self.r,
            1 => &self.g,
            _ => &self.b,
        }
    }
}

macro_rules! channelwise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Rgb {
            type Output = Self;
            #[inline]
            fn $method(self, o: Self) -> Self {
                Self::new(self.r $op o.r, self.g $op o.g, self.b $op o.b)
            }
        }
    };
}
channelwise!(Add, add, +);
channelwise!(Sub, sub, -);
channelwise!(Mul, mul, *);
channelwise!(Div, div, /);

impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, s: f32) -> Self {
        Self::new(self.r * s, self.g * s, self.b * s)
    }
}

impl Div<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, s: f32) -> Self {
        self * (1.0 / s)
    }
}

impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl MulAssign<f32> for Rgb {
    #[inline]
    fn mul_assign(&mut self, s: f32) {
        *self = *self * s;
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::BLACK, |a, b| a + b)
    }
}

use crate::TextureError;
use crate::srgb::{LINEAR_OF_8_BIT, LINEAR_OF_16_BIT, linear_from_srgb};
use radiometry::Rgb;

/// What the stored values of a picture stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// They are linear already: data, or light.
    #[default]
    Linear,
    /// Colours by the curve of sRGB; alpha is linear all the same.
    Srgb,
}

/// A picture in memory: up to four channels of 8 or 16 bits or floats. Rows run from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: u32,
    height: u32,
    channels: u8,
    texels: Texels,
}

/// Values of all channels of a texel, texel by texel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Texels {
    U8(Box<[u8]>),
    U16(Box<[u16]>),
    F32(Box<[f32]>),
}

impl Texels {
    fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U16(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }
}

impl Picture {
    /// - `channels`: 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha.
    pub(crate) fn new(width: u32, height: u32, channels: u8, texels: Texels) -> Result<Self, TextureError> {
        let expected = width as usize * height as usize * usize::from(channels);
        if expected == 0 {
            return Err(TextureError::Empty);
        }
        if texels.len() != expected {
            return Err(TextureError::WrongCount {
                found: texels.len(),
                expected,
            });
        }
        let mut picture = Self {
            width,
            height,
            channels,
            texels,
        };
        picture.check_and_clamp()?;
        Ok(picture)
    }

    /// Makes a picture of linear values.
    ///
    /// - `values`: three for each texel, rows from the top; negative ones become 0.
    ///
    /// # Errors
    ///
    /// [`TextureError::Empty`], [`TextureError::WrongCount`] and [`TextureError::NotFinite`].
    pub fn from_rgb(width: u32, height: u32, values: Vec<f32>) -> Result<Self, TextureError> {
        Self::new(width, height, 3, Texels::F32(values.into_boxed_slice()))
    }

    /// Multiplies the floats of a picture.
    pub(crate) fn scaled(mut self, factor: f32) -> Result<Self, TextureError> {
        if let Texels::F32(values) = &mut self.texels {
            values.iter_mut().for_each(|value| *value *= factor);
        }
        self.check_and_clamp()?;
        Ok(self)
    }

    /// Refuses numbers that are not finite, and makes negative ones 0: colours outside of Rec.709 have some, which no light
    /// and no surface has.
    ///
    /// # Errors
    ///
    /// [`TextureError::NotFinite`], with the first such texel.
    fn check_and_clamp(&mut self) -> Result<(), TextureError> {
        let Texels::F32(values) = &mut self.texels else {
            return Ok(());
        };
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            let texel = (at / usize::from(self.channels)) as u64;
            return Err(TextureError::NotFinite {
                x: (texel % u64::from(self.width)) as u32,
                y: (texel / u64::from(self.width)) as u32,
            });
        }
        values.iter_mut().for_each(|value| *value = value.max(0.0));
        Ok(())
    }

    /// Texels from left to right, at least 1.
    #[inline]
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Texels from top to bottom, at least 1.
    #[inline]
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// How colours in it are stored unless somebody knows better: floats are linear, whole numbers sRGB.
    #[must_use]
    pub fn encoding(&self) -> Encoding {
        match self.texels {
            Texels::F32(_) => Encoding::Linear,
            _ => Encoding::Srgb,
        }
    }

    /// Memory of the texels, bytes.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let each = match self.texels {
            Texels::U8(_) => 1,
            Texels::U16(_) => 2,
            Texels::F32(_) => 4,
        };
        self.texels.len() * each
    }

    /// Linear red, green, blue and alpha of a texel, each finite and ≥ 0; grey is all three, and what has no alpha has 1.
    ///
    /// - `x`, `y`: column and row from the upper left.
    ///
    /// # Panics
    ///
    /// When there is no such texel.
    #[inline]
    #[must_use]
    pub fn rgba(&self, x: u32, y: u32, encoding: Encoding) -> [f32; 4] {
        assert!(x < self.width && y < self.height, "no texel {x}, {y}");
        let channels = usize::from(self.channels);
        let first = (y as usize * self.width as usize + x as usize) * channels;
        let colour = |at: usize| self.value(first + at, encoding);
        let alpha = |at: usize| self.value(first + at, Encoding::Linear);
        match channels {
            1 => {
                let grey = colour(0);
                [grey, grey, grey, 1.0]
            }
            2 => {
                let grey = colour(0);
                [grey, grey, grey, alpha(1)]
            }
            3 => [colour(0), colour(1), colour(2), 1.0],
            _ => [colour(0), colour(1), colour(2), alpha(3)],
        }
    }

    /// Linear colour of a texel as [`Picture::encoding`] has it: what a picture of surroundings shows there.
    ///
    /// # Panics
    ///
    /// When there is no such texel.
    #[inline]
    #[must_use]
    pub fn rgb(&self, x: u32, y: u32) -> Rgb {
        let [r, g, b, _] = self.rgba(x, y, self.encoding());
        Rgb::new(r, g, b)
    }

    /// One stored value, decoded.
    #[inline]
    fn value(&self, at: usize, encoding: Encoding) -> f32 {
        match (&self.texels, encoding) {
            (Texels::U8(values), Encoding::Srgb) => LINEAR_OF_8_BIT[usize::from(values[at])],
            (Texels::U8(values), Encoding::Linear) => f32::from(values[at]) / 255.0,
            (Texels::U16(values), Encoding::Srgb) => LINEAR_OF_16_BIT[usize::from(values[at])],
            (Texels::U16(values), Encoding::Linear) => f32::from(values[at]) / 65_535.0,
            (Texels::F32(values), Encoding::Srgb) => linear_from_srgb(values[at].into()) as f32,
            (Texels::F32(values), Encoding::Linear) => values[at],
        }
    }
}

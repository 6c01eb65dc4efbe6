use crate::{Encoding, Picture, TextureTransform};
use glam::Vec2;
use radiometry::Rgb;
use std::sync::Arc;

/// What is beside a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// Its mirror image, then the picture again.
    Mirror,
    /// Its outermost texels.
    Clamp,
}

/// How a value between texels comes about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// From the four nearest texels, in linear light.
    #[default]
    Linear,
    /// From the nearest alone.
    Nearest,
}

/// A channel of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Red, or grey.
    #[default]
    R,
    /// Green, or grey.
    G,
    /// Blue, or grey.
    B,
    /// Alpha; 1 where the picture has none.
    A,
}

/// A picture laid over a surface.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The picture, shared by all that show it.
    pub picture: Arc<Picture>,
    /// What is beside it, across and down.
    pub wrap: [Wrap; 2],
    /// How values between texels come about.
    pub filter: Filter,
    /// How texture coordinates are moved first.
    pub transform: TextureTransform,
    /// Which set of texture coordinates of the surface it follows.
    pub uv_set: u32,
    /// What its stored values stand for.
    pub encoding: Encoding,
    /// The channel of [`Texture::value`].
    pub channel: Channel,
    /// Multiplies what the picture says, ≥ 0; a value takes the first component.
    pub factor: Rgb,
}

impl Texture {
    /// Shows a picture as it is, colours by [`Picture::encoding`].
    #[must_use]
    pub fn new(picture: Arc<Picture>) -> Self {
        Self {
            encoding: picture.encoding(),
            picture,
            wrap: [Wrap::default(); 2],
            filter: Filter::default(),
            transform: TextureTransform::default(),
            uv_set: 0,
            channel: Channel::default(),
            factor: Rgb::WHITE,
        }
    }

    /// Linear colour at texture coordinates with a lower left origin; finite and ≥ 0 for a finite factor.
    #[inline]
    #[must_use]
    pub fn rgb(&self, uv: Vec2) -> Rgb {
        let [r, g, b, _] = self.rgba(uv);
        Rgb::new(r, g, b) * self.factor
    }

    /// The number at texture coordinates with a lower left origin.
    #[inline]
    #[must_use]
    pub fn value(&self, uv: Vec2) -> f32 {
        self.rgba(uv)[self.channel as usize] * self.factor.r
    }

    /// Least and greatest [`Texture::value`] that any coordinates can give. Cost: a look at every texel.
    #[must_use]
    pub fn range(&self) -> (f32, f32) {
        let values = self.texels().map(|texel| texel[self.channel as usize] * self.factor.r);
        values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        })
    }

    /// Greatest [`Texture::rgb`] that any coordinates can give, channel by channel. Cost: a look at every texel.
    #[must_use]
    pub fn max_rgb(&self) -> Rgb {
        let largest = |most: Rgb, [r, g, b, _]: [f32; 4]| Rgb::new(most.r.max(r), most.g.max(g), most.b.max(b));
        self.texels().fold(Rgb::BLACK, largest) * self.factor
    }

    /// Mean [`Texture::rgb`] of all texels: what a lamp is worth that shines by it. Cost: a look at every texel.
    #[must_use]
    pub fn mean_rgb(&self) -> Rgb {
        let sum = self.texels().fold([0.0_f64; 3], |sum, texel| {
            std::array::from_fn(|channel| sum[channel] + f64::from(texel[channel]))
        });
        let count = f64::from(self.picture.width()) * f64::from(self.picture.height());
        let [r, g, b] = sum.map(|sum| (sum / count) as f32);
        Rgb::new(r, g, b) * self.factor
    }

    fn texels(&self) -> impl Iterator<Item = [f32; 4]> {
        let width = self.picture.width();
        let row = move |y| (0..width).map(move |x| self.picture.rgba(x, y, self.encoding));
        (0..self.picture.height()).flat_map(row)
    }

    /// All channels, without the factor.
    #[inline]
    fn rgba(&self, uv: Vec2) -> [f32; 4] {
        let place = self.transform.place(uv);
        let picture = &*self.picture;
        let (width, height) = (picture.width(), picture.height());
        match self.filter {
            Filter::Nearest => {
                let x = self.wrap[0].texel(whole(place.x, width, 0.0).0, width);
                let y = self.wrap[1].texel(whole(place.y, height, 0.0).0, height);
                picture.rgba(x, y, self.encoding)
            }
            Filter::Linear => {
                let (column, across) = whole(place.x, width, 0.5);
                let (row, down) = whole(place.y, height, 0.5);
                let x = [column, column + 1].map(|x| self.wrap[0].texel(x, width));
                let y = [row, row + 1].map(|y| self.wrap[1].texel(y, height));
                let blend = |y: u32| {
                    let [left, right] = x.map(|x| picture.rgba(x, y, self.encoding));
                    mix(left, right, across)
                };
                mix(blend(y[0]), blend(y[1]), down)
            }
        }
    }
}

/// Splits a share of the picture into a whole texel and the way to the next, the first centre lying at `centre` texels.
///
/// Coordinates beyond the reach of whole numbers, or none at all, count as 0.
#[inline]
fn whole(share: f64, size: u32, centre: f64) -> (i64, f32) {
    const REACH: f64 = (1_i64 << 52) as f64;
    let at = share * f64::from(size) - centre;
    if at.is_nan() || at.abs() > REACH {
        return (0, 0.0);
    }
    let below = at.floor();
    (below as i64, (at - below) as f32)
}

#[inline]
fn mix(from: [f32; 4], to: [f32; 4], share: f32) -> [f32; 4] {
    std::array::from_fn(|channel| from[channel] + (to[channel] - from[channel]) * share)
}

impl Wrap {
    /// The texel of the picture that is shown at a place beside or in it.
    #[inline]
    fn texel(self, at: i64, size: u32) -> u32 {
        let count = i64::from(size);
        let texel = match self {
            Self::Repeat => at.rem_euclid(count),
            Self::Mirror => {
                let within = at.rem_euclid(2 * count);
                within.min(2 * count - 1 - within)
            }
            Self::Clamp => at.clamp(0, count - 1),
        };
        texel as u32
    }
}

//! Images in memory: named planes of numbers, and plain RGB.

use glam::UVec2;

use crate::window::FilmWindow;

/// One channel of an [`Image`].
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name as in an EXR file: `R`, `direct.G`, `normal.X`.
    pub name: String,
    /// One value a pixel of the crop, rows from the top.
    pub samples: Vec<f32>,
}

/// A resolved image: linear, Rec.709 primaries, one plane a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The full film and the crop that the planes cover.
    pub window: FilmWindow,
    /// The channels, in writing order of the caller (files sort them by name).
    pub channels: Vec<Channel>,
}

impl Image {
    /// Makes an image of the channels `R G B` that covers its whole film.
    #[must_use]
    pub fn from_rgb(rgb: &RgbImage) -> Self {
        let plane = |c: usize| rgb.pixels.iter().map(|pixel| pixel[c]).collect();
        let channel = |(c, name): (usize, &&str)| Channel {
            name: (*name).to_owned(),
            samples: plane(c),
        };
        Self {
            window: FilmWindow::full(UVec2::new(rgb.width, rgb.height)),
            channels: ["R", "G", "B"].iter().enumerate().map(channel).collect(),
        }
    }

    /// Returns the samples of the channel with exactly this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        let found = self.channels.iter().find(|channel| channel.name == name);
        found.map(|channel| channel.samples.as_slice())
    }

    /// Returns a layer as RGB: `""` for the beauty image, `"direct"` for `direct.R` and so on.
    ///
    /// - returns nothing if one of the three channels is missing.
    #[must_use]
    pub fn rgb(&self, layer: &str) -> Option<RgbImage> {
        RgbImage::gather(self.window.size(), layer, |name| self.channel(name))
    }
}

/// A plain RGB image, linear, Rec.709 primaries.
#[derive(Clone, Debug, PartialEq)]
pub struct RgbImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width · height` values, rows from the top.
    pub pixels: Vec<[f32; 3]>,
}

impl RgbImage {
    /// Puts three planes together, looked up by name.
    pub(crate) fn gather<'a>(size: UVec2, layer: &str, find: impl Fn(&str) -> Option<&'a [f32]>) -> Option<Self> {
        let plane = |component: &str| match layer {
            "" => find(component),
            _ => find(&format!("{layer}.{component}")),
        };
        let (red, green, blue) = (plane("R")?, plane("G")?, plane("B")?);
        let pixels = red.iter().zip(green).zip(blue).map(|((&r, &g), &b)| [r, g, b]);
        Some(Self {
            width: size.x,
            height: size.y,
            pixels: pixels.collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_found_by_name() {
        let rgb = RgbImage {
            width: 2,
            height: 1,
            pixels: vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
        };
        let mut image = Image::from_rgb(&rgb);
        assert_eq!(image.rgb(""), Some(rgb.clone()));
        assert_eq!(image.rgb("direct"), None);
        for channel in &mut image.channels {
            channel.name = format!("direct.{}", channel.name);
        }
        assert_eq!(image.rgb("direct"), Some(rgb));
    }
}

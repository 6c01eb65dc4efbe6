//! Which pixels a film holds, and in what order it stores them.

use glam::UVec2;

use crate::error::FilmError;

/// Longest side of a film, in pixels.
pub const MAX_SIDE: u32 = 65_536;

/// The part of an image that is rendered.
///
/// All coordinates are whole pixels, x to the right and y down, with (0, 0) the top left pixel of the
/// full film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FilmWindow {
    /// Size of the full film; each side within 1 ..= [`MAX_SIDE`].
    pub resolution: UVec2,
    /// First pixel of the crop, inclusive.
    pub crop_min: UVec2,
    /// End of the crop, exclusive; above `crop_min` and at most `resolution` on both axes.
    pub crop_max: UVec2,
}

impl FilmWindow {
    /// Returns the window that covers the whole film.
    #[must_use]
    pub fn full(resolution: UVec2) -> Self {
        Self {
            resolution,
            crop_min: UVec2::ZERO,
            crop_max: resolution,
        }
    }

    /// Checks the ranges that the fields document.
    ///
    /// # Errors
    ///
    /// [`FilmError::Resolution`] or [`FilmError::Crop`].
    pub fn validate(&self) -> Result<(), FilmError> {
        let size = self.resolution;
        if size.min_element() == 0 || size.max_element() > MAX_SIDE {
            return Err(FilmError::Resolution { resolution: size });
        }
        let fits = self.crop_min.cmplt(self.crop_max).all() && self.crop_max.cmple(size).all();
        if fits {
            Ok(())
        } else {
            Err(FilmError::Crop { window: *self })
        }
    }

    /// Returns the size of the crop in pixels; zero on an axis where the crop is inverted.
    #[must_use]
    pub fn size(&self) -> UVec2 {
        self.crop_max.saturating_sub(self.crop_min)
    }

    /// Returns the number of pixels in the crop.
    #[must_use]
    pub fn pixel_count(&self) -> usize {
        let size = self.size();
        size.x as usize * size.y as usize
    }
}

/// A one-to-one map between raster order and tile order.
///
/// Tiles of `tile_size`² pixels run in rows over the window, pixels in rows within a tile; tiles at the
/// right and bottom edges are cut off. So a contiguous range of storage indices is a compact patch of
/// the image, whose camera paths meet the same part of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileOrder {
    width: usize,
    height: usize,
    tile: usize,
}

impl TileOrder {
    /// Covers `size` pixels with tiles of `tile_size`², at least 1.
    pub(crate) fn new(size: UVec2, tile_size: u32) -> Self {
        Self {
            width: size.x as usize,
            height: size.y as usize,
            tile: tile_size as usize,
        }
    }

    /// Returns the pixel, relative to the window, of a storage index.
    pub(crate) fn position_of(&self, storage: usize) -> UVec2 {
        let Self { width, height, tile } = *self;
        let top = storage / (tile * width) * tile;
        let tile_height = tile.min(height - top);
        let in_row = storage - top * width;
        let left = in_row / (tile * tile_height) * tile;
        let tile_width = tile.min(width - left);
        let in_tile = in_row - left * tile_height;
        let (x, y) = (left + in_tile % tile_width, top + in_tile / tile_width);
        UVec2::new(x as u32, y as u32)
    }

    /// Returns the storage index of pixel (x, y) of the window.
    pub(crate) fn storage_of(&self, x: usize, y: usize) -> usize {
        let Self { width, height, tile } = *self;
        let (left, top) = (x / tile * tile, y / tile * tile);
        let tile_height = tile.min(height - top);
        let tile_width = tile.min(width - left);
        top * width + left * tile_height + (y - top) * tile_width + (x - left)
    }

    /// Iterates over storage indices in raster order.
    pub(crate) fn raster(self) -> impl Iterator<Item = usize> {
        (0..self.height).flat_map(move |y| (0..self.width).map(move |x| self.storage_of(x, y)))
    }
}

/// Which pixel of the window each storage index stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum StorageOrder {
    /// All pixels of the window.
    Tiles(TileOrder),
    /// These alone, relative to the window, in this order.
    Chosen { pixels: Vec<UVec2>, width: usize },
}

impl StorageOrder {
    /// Returns the number of pixels that are stored.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Tiles(order) => order.width * order.height,
            Self::Chosen { pixels, .. } => pixels.len(),
        }
    }

    /// Returns the pixel, relative to the window, of a storage index.
    pub(crate) fn position_of(&self, storage: usize) -> UVec2 {
        match self {
            Self::Tiles(order) => order.position_of(storage),
            Self::Chosen { pixels, .. } => pixels[storage],
        }
    }

    /// Lists place in raster order and storage index of every pixel that is stored: of a whole window by place, of
    /// chosen pixels by index.
    pub(crate) fn raster(&self) -> Box<dyn Iterator<Item = (usize, usize)> + Send + '_> {
        match self {
            Self::Tiles(order) => Box::new(order.raster().enumerate()),
            Self::Chosen { pixels, width } => {
                let place = move |pixel: &UVec2| pixel.y as usize * width + pixel.x as usize;
                Box::new(pixels.iter().map(place).zip(0..))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn tile_order_is_a_bijection(width in 1_u32..40, height in 1_u32..40, tile in 1_u32..50) {
            let order = TileOrder::new(UVec2::new(width, height), tile);
            let count = (width * height) as usize;
            let mut seen = vec![false; count];
            for (raster, storage) in order.raster().enumerate() {
                prop_assert!(!seen[storage]);
                seen[storage] = true;
                let expected = UVec2::new(raster as u32 % width, raster as u32 / width);
                prop_assert_eq!(order.position_of(storage), expected);
            }
            prop_assert!(seen.iter().all(|&s| s));
        }
    }

    #[test]
    fn first_tile_comes_first() {
        let order = TileOrder::new(UVec2::new(10, 10), 4);
        for storage in 0..16 {
            assert!(order.position_of(storage).max_element() < 4);
        }
        assert_eq!(order.position_of(16), UVec2::new(4, 0));
        assert_eq!(order.position_of(32), UVec2::new(8, 0));
        assert_eq!(order.position_of(34), UVec2::new(8, 1));
    }

    #[test]
    fn bad_windows_are_refused() {
        let good = FilmWindow::full(UVec2::new(8, 4));
        assert!(good.validate().is_ok());
        assert!(FilmWindow::full(UVec2::new(0, 4)).validate().is_err());
        assert!(FilmWindow::full(UVec2::new(4, MAX_SIDE + 1)).validate().is_err());
        let outside = FilmWindow {
            crop_max: UVec2::new(9, 4),
            ..good
        };
        assert!(outside.validate().is_err());
        let empty = FilmWindow {
            crop_min: UVec2::new(8, 0),
            ..good
        };
        assert!(empty.validate().is_err());
    }
}

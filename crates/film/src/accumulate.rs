//! The film: exact sums per pixel and channel, cut into spans to be filled in parallel.

use std::ops::Range;

use glam::UVec2;

use crate::batch::PixelBatches;
use crate::error::FilmError;
use crate::fixed_sum::FixedSum;
use crate::guard::{RejectedCounter, RejectedCounts};
use crate::layout::ChannelLayout;
use crate::span::FilmSpan;
use crate::window::{FilmWindow, MAX_SIDE, StorageOrder, TileOrder};

/// Accumulates the samples of a window of pixels.
///
/// Every channel of every pixel is a [`FixedSum`], so the film's state depends on the set of samples
/// alone: not on their order, on how spans were cut, on threads, or on merging films in any grouping.
///
/// Pixels are stored in tile order, or are chosen ones in the order of the choice; use [`Film::pixel_of`] to learn which pixel an index stands for.
///
/// Memory: see [`memory_bytes`].
#[derive(Debug)]
pub struct Film {
    window: FilmWindow,
    layout: ChannelLayout,
    order: StorageOrder,
    /// `channel_count` sums a pixel, pixel after pixel in tile order.
    pub(crate) sums: Vec<FixedSum>,
    /// One count a pixel, in the same order.
    pub(crate) samples: Vec<u32>,
    /// For the variance, one entry a pixel and set of batches, in the same order; empty without it.
    pub(crate) batches: Vec<PixelBatches>,
    pub(crate) rejected: RejectedCounter,
}

/// Returns the bytes that a film takes, with one resolved [`Image`](crate::Image) of it.
///
/// Cost: constant; allocates nothing, so that it can be asked before a render starts.
#[must_use]
pub fn memory_bytes(window: &FilmWindow, layout: &ChannelLayout) -> u64 {
    memory_of_pixels(window.pixel_count(), layout)
}

/// Returns the bytes that a film of so many pixels takes, with its resolved values.
#[must_use]
pub fn memory_of_pixels(pixels: usize, layout: &ChannelLayout) -> u64 {
    let sums = layout.channel_count() * size_of::<FixedSum>() + size_of::<u32>();
    let batches = layout.batch_sets() * size_of::<PixelBatches>();
    let resolved = (layout.channel_count() + 3 + 3 * usize::from(layout.variance)) * size_of::<f32>();
    pixels as u64 * (sums + batches + resolved) as u64
}

impl Film {
    /// Makes an empty film.
    ///
    /// - `tile_size`: side of a tile in pixels, 1 ..= [`MAX_SIDE`]. It decides the storage order only,
    ///   never the image. 16 to 64 keeps a span's camera rays together.
    ///
    /// # Errors
    ///
    /// A window, layout or tile size out of range, or too little memory.
    pub fn new(window: FilmWindow, layout: ChannelLayout, tile_size: u32) -> Result<Self, FilmError> {
        if !(1..=MAX_SIDE).contains(&tile_size) {
            return Err(FilmError::TileSize);
        }
        let order = StorageOrder::Tiles(TileOrder::new(window.size(), tile_size));
        Self::stored(window, layout, order)
    }

    /// Makes an empty film of some pixels of a window: what is asked of a few takes the memory of a few.
    ///
    /// - `pixels`: in coordinates of the full film, inside of the crop, each once. Storage indices follow their order.
    ///
    /// [`Film::resolve`] leaves all other pixels black. There are no checkpoints of such a film.
    ///
    /// # Errors
    ///
    /// A window, layout or pixel out of range, or too little memory.
    pub fn of_pixels(window: FilmWindow, layout: ChannelLayout, pixels: &[UVec2]) -> Result<Self, FilmError> {
        let is_outside = |pixel: &&UVec2| pixel.cmplt(window.crop_min).any() || pixel.cmpge(window.crop_max).any();
        if let Some(pixel) = pixels.iter().find(is_outside) {
            return Err(FilmError::Pixel { pixel: *pixel });
        }
        let order = StorageOrder::Chosen {
            pixels: pixels.iter().map(|pixel| *pixel - window.crop_min).collect(),
            width: window.size().x as usize,
        };
        Self::stored(window, layout, order)
    }

    fn stored(window: FilmWindow, layout: ChannelLayout, order: StorageOrder) -> Result<Self, FilmError> {
        window.validate()?;
        layout.validate()?;
        let pixels = order.len();
        let out_of_memory = || FilmError::Memory {
            bytes: memory_of_pixels(pixels, &layout),
        };
        let sums = zeroed(pixels.checked_mul(layout.channel_count()), FixedSum::ZERO).ok_or_else(out_of_memory)?;
        let samples = zeroed(Some(pixels), 0).ok_or_else(out_of_memory)?;
        let batches = pixels.checked_mul(layout.batch_sets());
        let batches = zeroed(batches, PixelBatches::default()).ok_or_else(out_of_memory)?;
        Ok(Self {
            window,
            layout,
            order,
            sums,
            samples,
            batches,
            rejected: RejectedCounter::default(),
        })
    }

    /// Returns the window.
    #[must_use]
    pub fn window(&self) -> &FilmWindow {
        &self.window
    }

    /// Returns the channels.
    #[must_use]
    pub fn layout(&self) -> &ChannelLayout {
        &self.layout
    }

    /// Returns the number of pixels, which is also the end of the storage indices.
    #[must_use]
    pub fn pixel_count(&self) -> usize {
        self.samples.len()
    }

    /// Returns how many samples the guard has dropped so far, over all pixels.
    #[must_use]
    pub fn rejected(&self) -> RejectedCounts {
        self.rejected.get()
    }

    /// Returns how many samples the pixel at a storage index has received, dropped ones included.
    ///
    /// # Panics
    ///
    /// If `storage` is not below [`Film::pixel_count`].
    #[must_use]
    pub fn sample_count(&self, storage: usize) -> u32 {
        self.samples[storage]
    }

    /// Returns the pixel at a storage index, in coordinates of the full film.
    ///
    /// # Panics
    ///
    /// If `storage` is not below [`Film::pixel_count`].
    #[must_use]
    pub fn pixel_of(&self, storage: usize) -> UVec2 {
        assert!(
            storage < self.pixel_count(),
            "storage index {storage} is not on the film"
        );
        self.window.crop_min + self.order.position_of(storage)
    }

    /// Cuts a range of storage indices into disjoint spans that can be filled in parallel.
    ///
    /// - `range`: within 0 .. [`Film::pixel_count`].
    /// - `span_len`: pixels a span, at least 1; the last span may be shorter.
    /// - returns the spans in order; none for an empty range.
    ///
    /// The cuts do not influence the image. Hand the result to rayon's `par_iter_mut`.
    ///
    /// # Panics
    ///
    /// If the range is not on the film, or `span_len` is 0.
    pub fn spans_mut(&mut self, range: Range<usize>, span_len: usize) -> Vec<FilmSpan<'_>> {
        let channels = self.layout.channel_count();
        let sums = &mut self.sums[range.start * channels..range.end * channels];
        let samples = &mut self.samples[range.clone()];
        let sets = self.layout.batch_sets();
        let mut batches = match sets {
            0 => [].chunks_mut(span_len),
            _ => self.batches[range.start * sets..range.end * sets].chunks_mut(span_len * sets),
        };
        sums.chunks_mut(span_len * channels)
            .zip(samples.chunks_mut(span_len))
            .enumerate()
            .map(|(index, (sums, samples))| FilmSpan {
                start: range.start + index * span_len,
                order: &self.order,
                window: &self.window,
                alpha_offset: self.layout.alpha_offset(),
                channels,
                sums,
                samples,
                batches: batches.next().unwrap_or_default(),
                rejected: &self.rejected,
            })
            .collect()
    }

    /// Adds all samples of another film; the same bits as if they had been added here.
    ///
    /// The films may differ in tile size. Their samples are to be different ones, together 0 .. n of each pixel.
    ///
    /// # Errors
    ///
    /// [`FilmError::Mismatch`] if window or channels differ; this film is then unchanged.
    pub fn merge(&mut self, other: &Self) -> Result<(), FilmError> {
        if self.window != other.window {
            return Err(FilmError::Mismatch { what: "window" });
        }
        if self.layout != other.layout {
            return Err(FilmError::Mismatch { what: "channels" });
        }
        let is_like = |order: &StorageOrder| matches!(order, StorageOrder::Tiles(_));
        if self.order != other.order && !(is_like(&self.order) && is_like(&other.order)) {
            return Err(FilmError::Mismatch { what: "pixels" });
        }
        let channels = self.layout.channel_count();
        let sets = self.layout.batch_sets();
        for ((_, to), (_, from)) in self.order.raster().zip(other.order.raster()) {
            self.samples[to] = self.samples[to].wrapping_add(other.samples[from]);
            let sums = &mut self.sums[to * channels..][..channels];
            for (sum, term) in sums.iter_mut().zip(&other.sums[from * channels..][..channels]) {
                sum.merge(*term);
            }
            let sums = self.batches[to * sets..][..sets].as_flattened_mut().as_flattened_mut();
            let terms = other.batches[from * sets..][..sets].as_flattened().as_flattened();
            for (sum, term) in sums.iter_mut().zip(terms) {
                sum.merge(*term);
            }
        }
        self.rejected.add(other.rejected());
        Ok(())
    }

    /// Tells whether only chosen pixels are stored.
    pub(crate) fn is_chosen(&self) -> bool {
        matches!(self.order, StorageOrder::Chosen { .. })
    }

    /// Lists the place in raster order and the storage index of every pixel; of a whole window in raster order.
    pub(crate) fn raster(&self) -> impl Iterator<Item = (usize, usize)> + Send + '_ {
        self.order.raster()
    }
}

/// Returns a vector of `count` copies, or nothing if it does not fit in memory.
pub(crate) fn zeroed<T: Clone>(count: Option<usize>, zero: T) -> Option<Vec<T>> {
    let mut vec = Vec::new();
    vec.try_reserve_exact(count?).ok()?;
    vec.resize(count?, zero);
    Some(vec)
}

#[cfg(test)]
mod tests;

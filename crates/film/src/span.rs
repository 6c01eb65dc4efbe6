//! Where samples arrive: a stretch of the film that one thread owns.

use glam::UVec2;

use crate::batch::{PixelBatches, batch_of};
use crate::fixed_sum::FixedSum;
use crate::guard::{Rejected, RejectedCounter, check_sample};
use crate::window::{FilmWindow, StorageOrder};

/// A contiguous run of pixels of a film, for one thread to fill.
#[derive(Debug)]
pub struct FilmSpan<'film> {
    pub(crate) start: usize,
    pub(crate) order: &'film StorageOrder,
    pub(crate) window: &'film FilmWindow,
    pub(crate) alpha_offset: usize,
    pub(crate) channels: usize,
    pub(crate) sums: &'film mut [FixedSum],
    pub(crate) samples: &'film mut [u32],
    /// Some sets a pixel; none without the variance.
    pub(crate) batches: &'film mut [PixelBatches],
    pub(crate) rejected: &'film RejectedCounter,
}

impl FilmSpan<'_> {
    /// Returns the storage index of the first pixel.
    #[must_use]
    pub fn start(&self) -> usize {
        self.start
    }

    /// Returns the number of pixels.
    #[must_use]
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Tells whether the span has no pixels; those from [`Film::spans_mut`](crate::Film::spans_mut) always have one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Returns a pixel of the span in coordinates of the full film.
    ///
    /// # Panics
    ///
    /// If `local` is not below [`FilmSpan::len`].
    #[must_use]
    pub fn pixel_of(&self, local: usize) -> UVec2 {
        assert!(local < self.len(), "pixel {local} is not in the span");
        self.window.crop_min + self.order.position_of(self.start + local)
    }

    /// Adds one sample to one pixel.
    ///
    /// - `local`: index within the span, below [`FilmSpan::len`].
    /// - `number`: which of the pixel's samples this is, from 0. It decides the batch, see [`BATCHES`](crate::BATCHES); in the end the
    ///   pixel has to have all samples below its count.
    /// - `radiance`: one linear RGB value a layer, W·m⁻²·sr⁻¹, in layout order, not negative.
    /// - `alpha`: coverage, 0 ..= 1.
    /// - `aux`: the values of all groups, one after another; may be negative.
    ///
    /// # Errors
    ///
    /// The reason, if a value is not a number, a radiance negative, or a magnitude not below 2^40. Such
    /// a sample counts in the pixel's number of samples, adds nothing else, and is counted in
    /// [`Film::rejected`](crate::Film::rejected): the error is for whoever wants to report the place.
    ///
    /// # Panics
    ///
    /// If `local` or the length of `radiance` or `aux` does not fit the span.
    ///
    /// Cost: a shift and an addition for each value; black layers are skipped. No allocation.
    #[inline]
    pub fn add_sample(
        &mut self,
        local: usize,
        number: u32,
        radiance: &[[f32; 3]],
        alpha: f32,
        aux: &[f32],
    ) -> Result<(), Rejected> {
        let lengths = (3 * radiance.len(), self.alpha_offset + 1 + aux.len());
        assert_eq!(lengths, (self.alpha_offset, self.channels), "sample and layout differ");
        self.samples[local] = self.samples[local].wrapping_add(1);
        check_sample(radiance, alpha, aux).inspect_err(|&reason| self.rejected.count(reason))?;
        let sums = &mut self.sums[local * self.channels..][..self.channels];
        let (layers, rest) = sums.split_at_mut(self.alpha_offset);
        for (sums, value) in layers.chunks_exact_mut(3).zip(radiance) {
            if *value != [0.0; 3] {
                add_values(sums, value);
            }
        }
        rest[0].add(alpha);
        add_values(&mut rest[1..], aux);
        let sets = self.batches.len() / self.samples.len();
        let batches = &mut self.batches[local * sets..][..sets];
        if let Some((beauty, layers)) = batches.split_first_mut() {
            let batch = batch_of(number);
            for (component, sum) in beauty[batch].iter_mut().enumerate() {
                sum.add(radiance.iter().map(|layer| layer[component]).sum());
            }
            for (layer, value) in layers.iter_mut().zip(radiance) {
                layer[batch].iter_mut().zip(value).for_each(|(sum, v)| sum.add(*v));
            }
        }
        Ok(())
    }
}

#[inline]
fn add_values(sums: &mut [FixedSum], values: &[f32]) {
    for (sum, &value) in sums.iter_mut().zip(values) {
        sum.add(value);
    }
}

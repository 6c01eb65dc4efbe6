//! From sums to an image.

use rayon::prelude::*;

use crate::accumulate::Film;
use crate::batch::{BATCH_RUN, BATCHES, Estimate, estimate};
use crate::pixels::{Channel, Image};

impl Film {
    /// Divides the sums by the sample counts.
    ///
    /// - returns one `f32` channel for each of [`image_channel_names`], rows from the top
    ///   over the crop. Layers, alpha and groups: mean over the pixel's samples. `R G B`: the sum
    ///   of the resolved layers in `f32`, in layer order, so that the layers in a file add up to its
    ///   beauty image exactly. `variance`: estimate of the variance *of the pixel mean* from the spread of its
    ///   [`BATCHES`](crate::BATCHES), unbiased if batches are independent and equally long; 0 with fewer than two
    ///   samples. A pixel without samples is 0 everywhere.
    ///
    /// Cost: one pass a channel, in parallel on the current rayon pool. The film can go on filling.
    ///
    /// [`image_channel_names`]: crate::ChannelLayout::image_channel_names
    #[must_use]
    pub fn resolve(&self) -> Image {
        let alpha = self.layout().alpha_offset();
        let mut means: Vec<Vec<f32>> = (0..self.layout().channel_count())
            .into_par_iter()
            .map(|channel| self.mean_of(channel))
            .collect();
        let beauty = (0..3).into_par_iter().map(|c| self.add_layers(&means[..alpha], c));
        let mut planes: Vec<Vec<f32>> = beauty.collect();
        if self.layout().variance {
            let variances = (0..3).into_par_iter().map(|c| self.variance_of(c));
            means.extend(variances.collect::<Vec<_>>());
        }
        // Alpha is stored after the layers but listed before them.
        means[..=alpha].rotate_right(1);
        planes.append(&mut means);
        let names = self.layout().image_channel_names();
        let channels = names.into_iter().zip(planes);
        Image {
            window: *self.window(),
            channels: channels.map(|(name, samples)| Channel { name, samples }).collect(),
        }
    }

    fn mean_of(&self, channel: usize) -> Vec<f32> {
        let channels = self.layout().channel_count();
        let mean = |storage: usize| match self.samples[storage] {
            0 => 0.0,
            count => (self.sums[storage * channels + channel].to_f64() / f64::from(count)) as f32,
        };
        self.plane(mean)
    }

    /// A value a pixel of the window, from storage indices; 0 where nothing is stored.
    fn plane(&self, value: impl Fn(usize) -> f32) -> Vec<f32> {
        let mut plane = vec![0.0; self.window().pixel_count()];
        for (place, storage) in self.raster() {
            plane[place] = value(storage);
        }
        plane
    }

    fn add_layers(&self, layers: &[Vec<f32>], component: usize) -> Vec<f32> {
        let mut beauty = vec![0.0; self.window().pixel_count()];
        for layer in layers.iter().skip(component).step_by(3) {
            for (sum, value) in beauty.iter_mut().zip(layer) {
                *sum += value;
            }
        }
        beauty
    }

    fn variance_of(&self, component: usize) -> Vec<f32> {
        self.plane(|storage| self.estimate(storage, None, component).variance as f32)
    }

    /// Returns mean and variance of one channel of a pixel, from its batches.
    ///
    /// - `layer`: a row of [`ChannelLayout::layers`](crate::ChannelLayout::layers), which takes `layer_variance`; none for
    ///   the beauty.
    ///
    /// # Panics
    ///
    /// Without the variance that is asked for, and beyond the pixels, layers or three channels.
    #[must_use]
    pub fn estimate(&self, storage: usize, layer: Option<usize>, component: usize) -> Estimate {
        let sets = self.layout().batch_sets();
        let set = layer.map_or(0, |layer| layer + 1);
        assert!(set < sets, "the film keeps no batches of this layer");
        estimate(&self.batches[storage * sets + set], component, self.samples[storage])
    }

    /// Estimates the relative error of the image: the root of the mean, over pixels and channels, of
    /// `variance / (mean² + (0.1 · mean of the image)²)`, which is the relMSE that a comparison with the true image would
    /// find.
    ///
    /// - returns nothing without the variance, and before every pixel has a sample in each batch.
    #[must_use]
    pub fn relative_error(&self) -> Option<f64> {
        let pixels = self.pixel_count();
        let fewest = self.samples.iter().copied().min()?;
        if !self.layout().variance || fewest < BATCHES * BATCH_RUN {
            return None;
        }
        let each = |component: usize| -> Vec<Estimate> {
            let estimate = |storage: usize| self.estimate(storage, None, component);
            (0..pixels).into_par_iter().map(estimate).collect()
        };
        let channels = [each(0), each(1), each(2)];
        // In a fixed order, so that where a render stops does not depend on threads.
        let sum: f64 = channels
            .iter()
            .map(|pixels| {
                let mean = pixels.iter().map(|found| found.mean).sum::<f64>() / pixels.len() as f64;
                let floor = (0.1 * mean) * (0.1 * mean);
                let error = |found: &Estimate| match found.mean * found.mean + floor {
                    scale if scale > 0.0 => found.variance / scale,
                    _ => 0.0,
                };
                pixels.iter().map(error).sum::<f64>()
            })
            .sum();
        Some((sum / (3 * pixels) as f64).sqrt())
    }
}

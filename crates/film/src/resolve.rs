//! From sums to an image.

use rayon::prelude::*;

use crate::accumulate::Film;
use crate::fixed_sum::FixedSum;
use crate::pixels::{Channel, Image};

impl Film {
    /// Divides the sums by the sample counts.
    ///
    /// - returns one `f32` channel for each of [`image_channel_names`], rows from the top
    ///   over the crop. Layers, alpha and groups: mean over the pixel's samples. `R G B`: the sum
    ///   of the resolved layers in `f32`, in layer order, so that the layers in a file add up to its
    ///   beauty image exactly. `variance`: unbiased estimate of the variance *of the pixel mean*,
    ///   Σ(x − x̄)² / (n(n − 1)), assuming independent samples; 0 with fewer than two. A pixel without
    ///   samples is 0 everywhere.
    ///
    /// Cost: one pass a channel, in parallel on the current rayon pool. The film can go on filling.
    ///
    /// [`image_channel_names`]: crate::ChannelLayout::image_channel_names
    #[must_use]
    pub fn resolve(&self) -> Image {
        let alpha = self.layout().alpha_offset();
        let moments = self.layout().variance_offset();
        let mut means: Vec<Vec<f32>> = (0..moments)
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
        self.raster().map(mean).collect()
    }

    fn add_layers(&self, layers: &[Vec<f32>], component: usize) -> Vec<f32> {
        let mut beauty = vec![0.0; self.pixel_count()];
        for layer in layers.iter().skip(component).step_by(3) {
            for (sum, value) in beauty.iter_mut().zip(layer) {
                *sum += value;
            }
        }
        beauty
    }

    fn variance_of(&self, component: usize) -> Vec<f32> {
        let channels = self.layout().channel_count();
        let alpha = self.layout().alpha_offset();
        let moment = self.layout().variance_offset() + component;
        let variance = |storage: usize| {
            let count = f64::from(self.samples[storage]);
            if count < 2.0 {
                return 0.0;
            }
            let sums = &self.sums[storage * channels..][..channels];
            let mut first = FixedSum::ZERO;
            sums[..alpha]
                .iter()
                .skip(component)
                .step_by(3)
                .for_each(|&sum| first.merge(sum));
            let first = first.to_f64();
            let spread = sums[moment].to_f64() - first * first / count;
            (spread.max(0.0) / (count * (count - 1.0))) as f32
        };
        self.raster().map(variance).collect()
    }
}

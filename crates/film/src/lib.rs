//! Film: where samples become an image, and an image becomes a file.
//!
//! A renderer hands over radiance, sample by sample and from any number of threads. This crate adds it
//! up, decides where within a pixel a sample should look, turns the sums into an image, writes it as
//! EXR and PNG, measures how far two images are apart, and tells a bias from noise ([`audit()`]). Slices and numbers in, values and files out;
//! it knows nothing of scenes, rays or entities.
//!
//! # The same bits
//!
//! The promise of the whole program is that an image depends on its scene alone. Four decisions here
//! carry it:
//!
//! - Sums are integers ([`FixedSum`]). Integer addition is associative, so threads, tiles, shards and
//!   resumed renders cannot show.
//! - A sample touches one pixel. Reconstruction filters are sampled ([`FilterSampler`]) instead of
//!   splatted, so a film falls apart into [`FilmSpan`]s that need no lock.
//! - Checkpoints are in raster order and carry a key, a version and a checksum ([`Film::load`]): a
//!   render resumes exactly, with other tiles if need be, or says why it cannot.
//! - Files hold no time, and their header is sorted ([`write_exr`]): equal images are equal files.
//!
//! # Safe with what it is given
//!
//! One guard, [`FilmSpan::add_sample`], keeps values that are negative, not numbers or absurdly large
//! out of the sums, and counts them. Files are written beside their target and renamed once they are
//! complete ([`atomic_write`]), so that a full disk or an interruption costs the new file and never the
//! old one. Files that are read ([`read_exr`], [`Film::load`]) may be hostile: what they claim is
//! checked before it is believed.
//!
//! # What it does not do
//!
//! No splatting: light tracing to the film would need another store. No colour management beyond
//! Rec.709 in and sRGB out, no denoising, no tiled, deep or multi-part EXR output.
//!
//! # Example
//!
//! ```
//! use film::{ChannelLayout, Film, FilmWindow, Metadata, ToneMap, write_exr, write_png};
//! use glam::UVec2;
//!
//! let layout = ChannelLayout {
//!     layers: vec!["direct".into(), "indirect".into()],
//!     ..ChannelLayout::default()
//! };
//! let mut film = Film::new(FilmWindow::full(UVec2::new(8, 8)), layout, 16)?;
//!
//! // Spans are disjoint: rayon's `par_iter_mut` fills them at the same time, with the same result.
//! let end = film.pixel_count();
//! for span in &mut film.spans_mut(0..end, 16) {
//!     for local in 0..span.len() {
//!         let x = span.pixel_of(local).x as f32;
//!         span.add_sample(local, 0, &[[x; 3], [0.5; 3]], 1.0, &[])?;
//!     }
//! }
//!
//! let image = film.resolve();
//! assert_eq!(image.channel("R").map(|r| r[3]), Some(3.5));
//!
//! # let folder = std::env::temp_dir().join(format!("film-example-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! write_exr(&folder.join("image.exr"), &image, &Metadata::default())?;
//! if let Some(beauty) = image.rgb("") {
//!     write_png(&folder.join("image.png"), &beauty, 0.0, ToneMap::Filmic)?;
//! }
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test that meets an error should fail"))]

mod accumulate;
mod atomic;
mod audit;
mod batch;
mod checkpoint;
mod error;
mod exr_file;
mod exr_read;
mod exr_scan;
mod filter;
mod fixed_sum;
mod guard;
mod layout;
mod metrics;
mod pixels;
mod png_file;
mod resolve;
mod significance;
mod span;
mod tone;
mod window;

pub use accumulate::{Film, memory_bytes, memory_of_pixels};
pub use atomic::{WriteError, atomic_write};
pub use audit::{Audit, AuditOptions, AuditTest, DARK, LEAST_AUDIT_SAMPLES, PixelBlock, audit};
pub use batch::{BATCH_RUN, BATCHES, Estimate};
pub use checkpoint::CheckpointError;
pub use error::FilmError;
pub use exr_file::{ExrWriteError, Metadata, write_exr};
pub use exr_read::{ExrDecodeError, ExrImage, ExrReadError, decode_exr, decode_exr_within, read_exr};
pub use exr_scan::exr_size;
pub use filter::{FilterKind, FilterSampler};
pub use fixed_sum::{FixedSum, MAX_MAGNITUDE};
pub use guard::{Rejected, RejectedCounts};
pub use layout::{AuxGroup, ChannelLayout};
pub use metrics::{
    BlockDifference, Comparison, MetricsError, TRIM, WorstPixel, block_differences, block_means, compare, difference,
    false_colour,
};
pub use pixels::{Channel, Image, RgbImage};
pub use png_file::{write_png, write_rgb8_png};
pub use significance::{Welch, holm, p_value, t_quantile};
pub use span::FilmSpan;
pub use tone::{ToneMap, display_rgb8, encode_srgb8, tone_map};
pub use window::{FilmWindow, MAX_SIDE};

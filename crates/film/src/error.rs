//! What can be wrong with a film.

use glam::UVec2;

use crate::window::{FilmWindow, MAX_SIDE};

/// Why a film cannot be made, or two films cannot be put together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// A side of the film is zero or too long.
    #[error("resolution {}x{} is out of range; use 1 to {MAX_SIDE} pixels a side", resolution.x, resolution.y)]
    Resolution {
        /// What was asked for.
        resolution: UVec2,
    },
    /// The crop is empty or reaches outside the film.
    #[error(
        "crop {},{} to {},{} is empty or not inside the film of {}x{} pixels; give its first pixel and \
         the pixel after its last, within the film",
        window.crop_min.x, window.crop_min.y, window.crop_max.x, window.crop_max.y,
        window.resolution.x, window.resolution.y
    )]
    Crop {
        /// What was asked for.
        window: FilmWindow,
    },
    /// A chosen pixel lies outside of the crop.
    #[error("pixel {},{} is not inside the crop; choose among its pixels", pixel.x, pixel.y)]
    Pixel {
        /// What was asked for.
        pixel: UVec2,
    },
    /// A tile must hold a pixel at least.
    #[error("tile size 0 is out of range; use 1 to {MAX_SIDE}")]
    TileSize,
    /// A channel name would not survive being written to a file.
    #[error("channel name \"{name}\" cannot be used: {reason}; rename the layer or group")]
    ChannelName {
        /// The offending name.
        name: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The sums do not fit in memory.
    #[error("a film of {bytes} bytes does not fit in memory; lower the resolution, crop, or drop channels")]
    Memory {
        /// What the film would take.
        bytes: u64,
    },
    /// Two films differ in window or channels.
    #[error("the films differ in {what} and cannot be merged; merge shares of one and the same render")]
    Mismatch {
        /// Window or channels.
        what: &'static str,
    },
}

//! Pictures from files, and their values at texture coordinates.
//!
//! Bytes go in, numbers come out; nothing here knows of scenes, rays or entities, and nothing opens a file.
//!
//! - **Files are not trusted.** [`decode`] looks at the size that a file claims before it reserves memory for it, and
//!   refuses what is over [`PictureLimits`] or what no such file could hold. Damaged files are errors, never panics, and
//!   a file that is cut off is damaged.
//! - **Pictures stay small.** A [`Picture`] keeps 8-bit values as bytes and 16-bit values in two, with as many channels
//!   as the file has. What they mean, light or data, is not of the picture but of each [`Texture`] that looks at it, so
//!   that one picture in memory serves several.
//! - **Filtering is in linear light.** Values are decoded first and blended then, with the centre of texel i at
//!   (i + ½)/width. Which texels take part is worked out in whole numbers, so the wrap modes are exact at the seams.
//!
//! Deliberately absent: mip maps and anisotropic filters, since a renderer that takes many samples of a pixel filters by
//! that; colour profiles, all files counting as sRGB or linear Rec.709; compressed textures of graphics cards.
//!
//! ```
//! use glam::Vec2;
//! use std::sync::Arc;
//! use texture::{PictureLimits, Texture, Wrap, decode};
//!
//! // A PNM file is none of the kinds that are read.
//! assert!(decode(b"P6 1 1 255 abc", &PictureLimits::default()).is_err());
//!
//! let picture = texture::Picture::from_rgb(2, 1, vec![0.0, 0.0, 0.0, 1.0, 0.5, 0.25])?;
//! let mut texture = Texture::new(Arc::new(picture));
//! texture.wrap = [Wrap::Clamp; 2];
//! assert_eq!(texture.rgb(Vec2::new(0.5, 0.5)).to_array(), [0.5, 0.25, 0.125]);
//! # Ok::<(), texture::TextureError>(())
//! ```

mod decode;
mod error;
mod picture;
mod srgb;
mod texture;
mod transform;

#[cfg(test)]
mod tests;

pub use decode::{PictureLimits, decode};
pub use error::TextureError;
pub use picture::{Encoding, Picture};
pub use texture::{Channel, Filter, Texture, Wrap};
pub use transform::TextureTransform;

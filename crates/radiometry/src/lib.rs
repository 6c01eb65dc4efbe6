//! Colour, frames, random numbers and sampling warps: the vocabulary that every other crate of the renderer speaks.
//!
//! Nothing here knows of scenes, rays or entities. Three decisions shape the crate:
//!
//! - **Same bits everywhere.** Transcendental functions come from [`math`], which calls one pure-Rust implementation,
//!   never the platform's. Random numbers are a pure function of a key ([`SampleStream`]), so nothing depends on which
//!   thread draws first.
//! - **Low discrepancy by default.** A [`SampleStream`] yields Owen-scrambled Sobol points, padded: each pair of
//!   dimensions is a (0,2)-sequence of its own. Stages address dimensions by name and bounce, so a new stage shifts
//!   nobody else's numbers.
//! - **A warp and its density live side by side.** Each `sample_*` in [`warp`] is documented with the density it has.
//!
//! It deliberately has no spectral representation: light is linear RGB with Rec.709 primaries, radiometric units.
//!
//! ```
//! use radiometry::{SampleStream, StageKey, warp};
//! let stream = SampleStream::new(0, StageKey::new("example"), 42, 7);
//! let direction = warp::sample_cosine_hemisphere(stream.draw_2d(0, 0));
//! assert!((direction.length() - 1.0).abs() < 1e-6 && direction.z >= 0.0);
//! ```

mod distribution;
mod frame;
pub mod math;
mod octahedral;
mod random;
mod rgb;
pub mod warp;

pub use distribution::Distribution;
pub use frame::Frame;
pub use octahedral::{pack_direction, unpack_direction};
pub use random::{SampleStream, StageKey, hash_u64};
pub use rgb::Rgb;

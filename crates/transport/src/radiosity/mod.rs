//! Radiosity: light that is exchanged between patches of all diffuse surfaces, solved once for the whole scene.
//!
//! `E_i = E_direct,i + Σ_j F_ij ρ_j E_j`, the irradiance of each patch from that of all others, with the form factors
//! `F_ij` from rays. Pure functions, in the order of a solution: [`PatchField::place`] lays patches over the scene,
//! [`find_direct`] asks the lights, [`find_form_factors`] casts the rays, [`FormFactors::solve`] lets the light go around, and
//! [`PatchField::indirect_irradiance`] reads it anywhere.
//!
//! A patch is a point of a surface that stands for the area around it, on one of its sides. Points are chosen by area with
//! a low-discrepancy sequence, so that curved shapes are as exact as flat ones, and thousands of small triangles share
//! one patch.
//!
//! Sources: Goral, Torrance, Greenberg and Battaile, "Modeling the Interaction of Light Between Diffuse Surfaces", SIGGRAPH
//! 1984; rays: Wallace, Elmquist and Haines, "A Ray Tracing Algorithm for Progressive Radiosity", SIGGRAPH 1989.
//! Differs: rays go from the point of the patch (collocation), which makes the form factors of a closed room add up to 1
//! exactly; light is gathered by all patches at once instead of shot by one after the other.

mod cast;
mod exchange;
mod field;
mod place;
mod reconstruct;
mod solve;

pub use cast::{PatchRow, cast_row};
pub use exchange::{ExchangeError, ExchangeSettings, find_direct, find_form_factors};
pub use field::{Patch, PatchField, PatchScratch};
pub use place::{PlaceError, PlaceSettings};
pub use reconstruct::PatchIrradiance;
pub use solve::{FormFactors, Solution};

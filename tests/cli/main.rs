//! The program as people meet it: arguments, messages, exit codes, files.
//!
//! Every test runs the real binary in a folder of its own, and fails if it ever panics.

#![allow(clippy::unwrap_used, reason = "a test that meets an error should fail")]

mod auditing;
mod bad_meshes;
mod bad_scenes;
mod command_line;
mod comparing;
mod disks;
mod errors_of_pixels;
mod interruption;
mod layering;
mod lens_and_shutter;
mod listing;
mod program;
mod rendering;
mod same_bits;
mod textures;

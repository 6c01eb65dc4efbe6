//! The stages of the renderer.

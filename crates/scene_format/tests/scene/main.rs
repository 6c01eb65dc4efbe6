//! Scenes as a program meets them: text in, prims or messages out.

#![allow(clippy::unwrap_used, reason = "a test that meets an error should fail")]

mod arc_messages;
mod composed;
mod explaining;
mod files;
mod fuzz;
mod limits;
mod messages;
mod schema;
mod session;
mod vocabulary;

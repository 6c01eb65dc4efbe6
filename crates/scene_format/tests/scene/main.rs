//! Scenes as a program meets them: text in, prims or messages out.

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

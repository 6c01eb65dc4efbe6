//! Scenes as a program meets them: text in, prims or messages out.

mod composed;
mod fuzz;
mod limits;
mod messages;
mod schema;
mod session;
mod vocabulary;

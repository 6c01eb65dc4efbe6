//! A composed scene written out, without layers: as RON that loads again, or as JSON for tools.

mod json;
mod json_value;
mod ron_text;
mod ron_value;

pub use json::{errors_json, flatten_json};
pub use ron_text::flatten_ron;
pub(crate) use ron_value::ron_value;

//! `pipeline flatten`: a composed scene as one layer.

use crate::args::FlattenArgs;
use crate::exit::Failure;
use crate::session;
use crate::terminal::print;
use scene_format::{errors_json, flatten_json, flatten_ron};

pub(crate) fn execute(options: &FlattenArgs) -> Result<(), Failure> {
    match session::compose(&options.scene)? {
        Ok(scene) if options.json => print(&format!("{}\n", flatten_json(&scene))),
        Ok(scene) => print(&flatten_ron(&scene)),
        Err(refusal) => {
            if options.json {
                print(&format!("{}\n", errors_json(&refusal)))?;
            }
            Err(session::refused(&refusal))
        }
    }
}

//! `pipeline explain`: why a value is what it is.

use crate::args::ExplainArgs;
use crate::exit::Failure;
use crate::session;
use crate::terminal::{print, use_colour};

pub(crate) fn execute(options: &ExplainArgs) -> Result<(), Failure> {
    let scene = session::compose(&options.scene)?.map_err(|refusal| session::refused(&refusal))?;
    let answer = scene_format::explain(&scene, &options.question);
    print(&answer.map_err(|error| Failure::bad_input(scene.report(&error, use_colour())))?)
}

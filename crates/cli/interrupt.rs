//! Ctrl-C, SIGTERM and SIGHUP: the first asks the render to stop and write, the second ends the program.

use crate::exit::{Failure, INTERRUPTED};
use crate::progress::Display;
use crate::terminal::say;
use pipeline_core::Cancellation;

/// Listens from now on.
///
/// # Errors
/// The system refuses handlers.
pub(crate) fn listen(cancellation: &Cancellation, display: &Display) -> Result<(), Failure> {
    let (cancellation, display) = (cancellation.clone(), display.clone());
    ctrlc::set_handler(move || {
        if cancellation.is_requested() {
            display.clear();
            say("interrupted again: nothing more is written");
            std::process::exit(i32::from(INTERRUPTED));
        }
        cancellation.request();
        display.note("interrupted: writing what there is; once more to leave without");
    })
    .map_err(|error| Failure::failed(format!("cannot listen for interruptions: {error}")))
}

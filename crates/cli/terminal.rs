//! The two streams: text for people on standard error, data on standard output.

use crate::exit::Failure;
use std::io::{self, ErrorKind, IsTerminal, Write};

/// True when standard error is a terminal.
pub(crate) fn is_interactive() -> bool {
    io::stderr().is_terminal()
}

/// True when messages may be coloured: on a terminal, and nobody asked for none (<https://no-color.org>).
pub(crate) fn use_colour() -> bool {
    is_interactive() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Tells people something, as a line. A closed standard error is nothing that anybody could be told.
pub(crate) fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", text.trim_end());
}

/// Writes data, and all of it at once, to standard output.
///
/// # Errors
/// A stream that cannot take it; but not one whose reader went away, which is how `| head` works.
pub(crate) fn print(data: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(data.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::failed(format!(
            "cannot write to standard output: {error}; redirect it to a place with space"
        ))),
        _ => Ok(()),
    }
}

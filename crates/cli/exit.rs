//! The one place that turns outcomes into reports and exit codes.

use crate::terminal::say;
use std::process::ExitCode;

/// Exit code of an interrupted render: 128 and the number of SIGINT, as shells have it.
pub(crate) const INTERRUPTED: u8 = 130;

/// Why a command did not do what it was asked.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) code: u8,
    messages: Vec<String>,
}

impl Failure {
    /// The render, a comparison or writing failed.
    pub(crate) fn failed(message: impl Into<String>) -> Self {
        Self::new(1, [message.into()])
    }

    /// The command line or a file that it names is bad.
    pub(crate) fn bad_input(message: impl Into<String>) -> Self {
        Self::new(2, [message.into()])
    }

    /// The scene is bad; the messages are finished text.
    pub(crate) fn bad_scene(messages: &[String]) -> Self {
        Self::new(2, messages.iter().cloned())
    }

    /// The image could not be written.
    pub(crate) fn not_written(messages: &[String]) -> Self {
        Self::new(1, messages.iter().cloned())
    }

    /// Somebody asked to stop, and the image was written.
    pub(crate) fn interrupted() -> Self {
        Self::new(INTERRUPTED, [])
    }

    fn new(code: u8, messages: impl IntoIterator<Item = String>) -> Self {
        Self {
            code,
            messages: messages.into_iter().collect(),
        }
    }
}

/// Reports a failure, if there is one, and gives the exit code.
pub(crate) fn conclude(ended: Result<(), Failure>) -> ExitCode {
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            for message in &failure.messages {
                say(&titled("error", message));
            }
            ExitCode::from(failure.code)
        }
    }
}

/// Puts the kind of a message in front of it, unless it says so itself.
pub(crate) fn titled(kind: &str, message: &str) -> String {
    let plain =
        message.trim_start_matches(|c: char| c == '\x1b' || c == '[' || c == ';' || c == 'm' || c.is_ascii_digit());
    let rest = plain.strip_prefix(kind).unwrap_or("");
    if rest.starts_with([':', '[']) {
        message.to_owned()
    } else {
        format!("{kind}: {message}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_get_one_title() {
        assert_eq!(titled("error", "no space"), "error: no space");
        assert_eq!(titled("error", "error: no space"), "error: no space");
        assert_eq!(titled("error", "error[bad-set]: no"), "error[bad-set]: no");
        let painted = "\x1b[1;31merror[bad-set]\x1b[0m: no";
        assert_eq!(titled("error", painted), painted);
        assert_eq!(titled("error", "errors abound"), "error: errors abound");
    }
}

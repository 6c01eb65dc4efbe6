//! Shows how far the render is: a bar on a terminal, else a line now and then.

use crate::summary::duration_text;
use crate::terminal::{is_interactive, say};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pipeline_core::{Progress, ProgressReading};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How often the state is read.
const TICK: Duration = Duration::from_millis(100);
/// How often a line appears in a log while the stage stays the same.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Where progress is shown. Clones show the same.
#[derive(Clone)]
pub(crate) enum Display {
    /// Nowhere.
    Silent,
    /// A line at a time, for logs.
    Lines,
    /// A bar that is drawn over and over.
    Bar(ProgressBar),
}

impl Display {
    /// The display that suits standard error.
    pub(crate) fn new(quiet: bool) -> Self {
        if quiet {
            return Self::Silent;
        }
        if !is_interactive() {
            return Self::Lines;
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
        let style = ProgressStyle::with_template("{prefix:>10} [{wide_bar}] {msg}");
        bar.set_style(
            style
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .progress_chars("=> "),
        );
        Self::Bar(bar)
    }

    /// Says something to people between two states of the bar.
    pub(crate) fn note(&self, text: &str) {
        match self {
            Self::Silent => {}
            Self::Lines => say(text),
            Self::Bar(bar) => bar.suspend(|| say(text)),
        }
    }

    /// Takes the bar away.
    pub(crate) fn clear(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }

    fn show(&self, reading: &ProgressReading, left: Option<Duration>, changed: bool) {
        match self {
            Self::Silent => {}
            Self::Lines => say(&line(reading, left)),
            Self::Bar(bar) => {
                if changed {
                    bar.reset();
                    bar.set_prefix(reading.stage.clone());
                }
                bar.set_length(reading.total.max(1));
                bar.set_position(reading.done);
                bar.set_message(amount(reading, left));
            }
        }
    }
}

/// A thread that shows progress until it is dropped.
pub(crate) struct Watcher {
    display: Display,
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Watcher {
    /// Starts to show what `progress` says. A time limit shortens the time left.
    pub(crate) fn start(progress: Progress, display: Display, time_limit: Option<Duration>) -> Self {
        let mut watcher = Self {
            display: display.clone(),
            stop: None,
            thread: None,
        };
        if !matches!(display, Display::Silent) {
            let (stop, stopped) = channel();
            let mut view = View::new(time_limit);
            let look = move || {
                while stopped.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                    view.look(&progress.read(), &display);
                }
            };
            watcher.stop = Some(stop);
            // Without a thread there is no progress shown, which is no reason not to render.
            watcher.thread = std::thread::Builder::new().name("progress".into()).spawn(look).ok();
        }
        watcher
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        self.stop = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        self.display.clear();
    }
}

/// What was shown so far.
struct View {
    begun: Instant,
    time_limit: Option<Duration>,
    stage: String,
    stage_begun: Instant,
    /// Work that was done when the stage was first seen: a resumed render starts in the middle.
    done_at_start: u64,
    last_line: Instant,
}

impl View {
    fn new(time_limit: Option<Duration>) -> Self {
        let now = Instant::now();
        Self {
            begun: now,
            time_limit,
            stage: String::new(),
            stage_begun: now,
            done_at_start: 0,
            last_line: now,
        }
    }

    fn look(&mut self, reading: &ProgressReading, display: &Display) {
        if reading.stage.is_empty() {
            return;
        }
        let changed = reading.stage != self.stage;
        if changed {
            self.stage.clone_from(&reading.stage);
            self.stage_begun = Instant::now();
            self.done_at_start = reading.done;
        }
        if changed || matches!(display, Display::Bar(_)) || self.last_line.elapsed() >= LINE_EVERY {
            self.last_line = Instant::now();
            display.show(reading, self.time_left(reading), changed);
        }
    }

    /// From the speed in this stage so far; nothing while there is none.
    fn time_left(&self, reading: &ProgressReading) -> Option<Duration> {
        let limit = self.time_limit.map(|limit| limit.saturating_sub(self.begun.elapsed()));
        let done = reading.done.saturating_sub(self.done_at_start);
        if done == 0 || reading.total < reading.done {
            return limit;
        }
        let seconds = self.stage_begun.elapsed().as_secs_f64() / done as f64 * (reading.total - reading.done) as f64;
        let by_speed = Duration::try_from_secs_f64(seconds).ok();
        [by_speed, limit].into_iter().flatten().min()
    }
}

/// `rendering 12/64 waves, 19 %, 4 s left`
fn line(reading: &ProgressReading, left: Option<Duration>) -> String {
    format!("{} {}", reading.stage, amount(reading, left))
        .trim_end()
        .to_owned()
}

fn amount(reading: &ProgressReading, left: Option<Duration>) -> String {
    if !reading.note.is_empty() {
        return format!("{} {}, {}", reading.done, reading.unit, reading.note);
    }
    if reading.total == 0 {
        return String::new();
    }
    let percent = 100.0 * reading.done as f64 / reading.total as f64;
    let mut text = format!("{}/{} {}, {percent:.0} %", reading.done, reading.total, reading.unit);
    if let Some(left) = left {
        text.push_str(&format!(", {} left", duration_text(left)));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_say_stage_amount_and_time() {
        let mut reading = ProgressReading {
            stage: "rendering".into(),
            done: 16,
            total: 64,
            unit: "waves",
            note: String::new(),
        };
        assert_eq!(line(&reading, None), "rendering 16/64 waves, 25 %");
        let left = Some(Duration::from_secs(75));
        assert_eq!(line(&reading, left), "rendering 16/64 waves, 25 %, 1 min 15 s left");
        reading.total = 0;
        assert_eq!(line(&reading, left), "rendering");
    }

    #[test]
    fn a_resumed_stage_counts_from_where_it_began() {
        let mut view = View::new(None);
        let reading = |done| ProgressReading {
            stage: "rendering".into(),
            done,
            total: 100,
            unit: "waves",
            note: String::new(),
        };
        view.look(&reading(50), &Display::Silent);
        assert_eq!(view.time_left(&reading(50)), None);
        view.stage_begun = Instant::now() - Duration::from_secs(10);
        let left = view.time_left(&reading(75)).unwrap().as_secs_f64();
        assert!((left - 10.0).abs() < 1.0, "{left}");
    }
}

//! What people are told at the end of a render.

use crate::terminal::say;
use bevy_app::App;
use pipeline_core::{Counters, RenderClock};
use pipeline_data::{FilmSums, RenderRequest, RenderSettings};
use pipeline_stages::image::EstimatedError;
use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

/// Counters of samples that the film's guard left out.
const REJECTED: &str = "rejected";

/// Samples that were negative or not finite.
pub(crate) fn rejected_samples(counters: &Counters) -> u64 {
    let rejected = counters.iter().filter(|(name, _)| name.contains(REJECTED));
    rejected.map(|(_, count)| count).sum()
}

/// Tells counters that should be 0 and are not.
pub(crate) fn tell_trouble(app: &App) {
    for (name, count) in app.world().resource::<Counters>().iter() {
        if count > 0 && name.contains(REJECTED) {
            say(&format!("warning: {count} × {name}"));
        }
    }
}

/// Tells samples, time and files.
pub(crate) fn tell_result(app: &App, elapsed: Duration, written: &[PathBuf]) {
    let time = duration_text(elapsed);
    match samples_done(app) {
        Some(samples) => say(&format!("{samples} samples a pixel in {time}")),
        None => say(&format!("done in {time}")),
    }
    if let Some(records) = reused_records(app) {
        say(&records);
    }
    if let Some(EstimatedError(error)) = app.world().get_resource() {
        say(&format!("estimated relative error {:.2} %", 100.0 * error));
    }
    for path in written {
        say(&format!("wrote {}", path.display()));
    }
}

/// How many irradiance records came from a file, and how many more were made; none where there was no file.
pub(crate) fn reused_records(app: &App) -> Option<String> {
    app.world().resource::<RenderRequest>().records.as_ref()?;
    let counters = app.world().resource::<Counters>();
    let count = |name: &str| counters.get(&format!("irradiance_cache/{name}"));
    Some(format!(
        "{} records reused, {} added",
        count("reused"),
        count("records")
    ))
}

/// Samples a pixel, earlier runs of a resumed render included: of the pixel that has the fewest, and how many it wants.
fn samples_done(app: &App) -> Option<String> {
    let world = app.world();
    let wanted = world.get_resource::<RenderSettings>()?.samples;
    let film = &world.get_resource::<FilmSums>()?.0;
    let samples = (0..film.pixel_count()).map(|pixel| film.sample_count(pixel)).min()?;
    let clock = world.resource::<RenderClock>();
    Some(if clock.waves_done >= clock.waves_total {
        format!("{samples}")
    } else {
        format!("{samples} of {wanted}")
    })
}

/// Tells the command line that goes on from here.
pub(crate) fn tell_how_to_resume() {
    say(&format!("to go on: {}", resuming(std::env::args_os())));
}

/// The same command line with `--resume`.
fn resuming(arguments: impl Iterator<Item = OsString>) -> String {
    let mut words: Vec<String> = arguments.map(|word| quoted(&word.to_string_lossy())).collect();
    if !words.iter().any(|word| word == "--resume") {
        words.push("--resume".into());
    }
    words.join(" ")
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// A time for people.
pub(crate) fn duration_text(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let whole = seconds.round() as u64;
    if seconds < 9.95 {
        format!("{seconds:.1} s")
    } else if whole < 60 {
        format!("{whole} s")
    } else if whole < 3600 {
        format!("{} min {:02} s", whole / 60, whole % 60)
    } else {
        format!("{} h {:02} min", whole / 3600, whole / 60 % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short() {
        let text = |seconds| duration_text(Duration::from_secs_f64(seconds));
        assert_eq!(text(0.04), "0.0 s");
        assert_eq!(text(9.94), "9.9 s");
        assert_eq!(text(9.96), "10 s");
        assert_eq!(text(59.6), "1 min 00 s");
        assert_eq!(text(75.0), "1 min 15 s");
        assert_eq!(text(7300.0), "2 h 01 min");
    }

    #[test]
    fn the_command_to_resume_can_be_pasted() {
        let words = ["pipeline", "run", "my scene.ron", "--set", "/A.B.c=\"it's\""];
        let line = resuming(words.iter().map(Into::into));
        assert_eq!(line, r#"pipeline run 'my scene.ron' --set '/A.B.c="it'\''s"' --resume"#);
        assert_eq!(resuming(["p", "--resume"].iter().map(Into::into)), "p --resume");
    }
}

//! `pipeline run`: renders a scene to image files.

use crate::args::{RenderArgs, RunArgs, SceneArgs};
use crate::exit::Failure;
use crate::interrupt;
use crate::outputs;
use crate::profiling::Profiler;
use crate::progress::{Display, Watcher};
use crate::session;
use crate::summary;
use bevy_app::App;
use pipeline_core::{Cancellation, Counters, Outcome, Progress, RenderClock, Report};
use pipeline_data::RenderRequest;
use std::path::PathBuf;
use std::time::{Duration, Instant};

pub(crate) fn execute(options: &RunArgs) -> Result<(), Failure> {
    let outputs = outputs::or_default(&options.render.output, &options.scene.scene)?;
    let profiler = Profiler::start(&options.render, false)?;
    render(&options.scene, &options.render, outputs, profiler.as_ref())?.ended
}

/// A render that is over.
pub(crate) struct Rendered {
    pub(crate) app: App,
    /// Success, or what the command has to end with.
    pub(crate) ended: Result<(), Failure>,
}

/// Renders, and tells people how it went.
///
/// # Errors
/// Whatever kept the render from beginning. How it ended stands in [`Rendered`].
pub(crate) fn render(
    scene: &SceneArgs,
    options: &RenderArgs,
    outputs: Vec<PathBuf>,
    profiler: Option<&Profiler>,
) -> Result<Rendered, Failure> {
    if options.resume && outputs.is_empty() {
        return Err(Failure::bad_input(
            "--resume needs the files of the interrupted render; give them with -o",
        ));
    }
    outputs::check_distinct(outputs.iter().chain(&options.profile).chain(&options.trace))?;
    outputs::check_writable(outputs.iter().chain(&options.profile).chain(&options.trace))?;
    session::use_threads(options.threads)?;
    let mut app = session::new_app();
    app.insert_resource(session::render_request(scene, options, outputs.clone()))
        .insert_resource(RenderClock {
            time_limit: options.time_limit,
            strict: options.strict,
            ..RenderClock::default()
        });
    let display = Display::new(options.quiet);
    interrupt::listen(app.world().resource::<Cancellation>(), &display)?;
    let progress = app.world().resource::<Progress>().clone();
    let watcher = Watcher::start(progress, display, options.time_limit);
    let begun = Instant::now();
    let outcome = pipeline_core::render(&mut app);
    drop(watcher);
    session::tell_warnings(&app);
    let mut ended = judge(&app, outcome, options.strict);
    let mut written = outputs;
    if let Some(profiler) = profiler {
        match profiler.write() {
            Ok(files) => written.extend(files),
            Err(failure) => ended = ended.and(Err(failure)),
        }
    }
    report(&app, outcome, options.quiet, begun.elapsed(), &written);
    Ok(Rendered { app, ended })
}

/// Tells what was rendered, and how to go on after an interruption or a time limit.
fn report(app: &App, outcome: Outcome, quiet: bool, elapsed: Duration, written: &[PathBuf]) {
    if matches!(outcome, Outcome::BadScene | Outcome::WriteFailed) {
        return;
    }
    summary::tell_trouble(app);
    if !quiet {
        summary::tell_result(app, elapsed, written);
    }
    let clock = app.world().resource::<RenderClock>();
    let is_partial = outcome == Outcome::Interrupted || clock.waves_done < clock.waves_total && !quiet;
    if is_partial && !app.world().resource::<RenderRequest>().outputs.is_empty() {
        summary::tell_how_to_resume();
    }
}

/// What the command ends with.
fn judge(app: &App, outcome: Outcome, strict: bool) -> Result<(), Failure> {
    let report = app.world().resource::<Report>();
    match outcome {
        Outcome::BadScene => Err(session::bad_scene(app)),
        Outcome::WriteFailed => Err(Failure::not_written(report.errors())),
        Outcome::Interrupted => Err(Failure::interrupted()),
        Outcome::Finished if strict => {
            let rejected = summary::rejected_samples(app.world().resource::<Counters>());
            if rejected > 0 {
                Err(Failure::failed(format!(
                    "{rejected} samples were negative or not finite and left out of the image, and --strict makes \
                     that an error; please report it with the scene"
                )))
            } else if report.warnings().is_empty() {
                Ok(())
            } else {
                Err(session::strict_failure(report))
            }
        }
        Outcome::Finished => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_core::CorePlugin;

    fn app() -> App {
        let mut app = App::empty();
        app.add_plugins(CorePlugin);
        app
    }

    fn code(app: &App, outcome: Outcome, strict: bool) -> u8 {
        judge(app, outcome, strict).err().map_or(0, |failure| failure.code)
    }

    #[test]
    fn strict_renders_fail_for_dropped_samples_and_late_warnings() {
        let mut warned = app();
        warned.world_mut().resource_mut::<Report>().warn("few photons".into());
        assert_eq!(code(&warned, Outcome::Finished, false), 0);
        assert_eq!(code(&warned, Outcome::Finished, true), 2);
        let mut counters = warned.world_mut().resource_mut::<Counters>();
        counters.counter("image/rejected samples").add(3);
        assert_eq!(code(&warned, Outcome::Finished, false), 0);
        assert_eq!(code(&warned, Outcome::Finished, true), 1);
    }

    #[test]
    fn outcomes_have_exit_codes() {
        assert_eq!(code(&app(), Outcome::Finished, true), 0);
        assert_eq!(code(&app(), Outcome::WriteFailed, false), 1);
        assert_eq!(code(&app(), Outcome::BadScene, false), 2);
        assert_eq!(code(&app(), Outcome::Interrupted, true), 130);
    }
}

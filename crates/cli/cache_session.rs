//! Making photons or records and nothing of them: what the commands share that show them.

use crate::args::{DrawArgs, SceneArgs};
use crate::exit::Failure;
use crate::interrupt;
use crate::outputs;
use crate::progress::{Display, Watcher};
use crate::session;
use crate::terminal::say;
use bevy_app::App;
use pipeline_core::{Cancellation, Outcome, Progress, RenderClock};
use pipeline_data::RenderRequest;
use std::path::{Path, PathBuf};

/// What a command makes of a scene, and the files that it writes it to.
pub(crate) struct CacheSession<'a> {
    pub(crate) scene: &'a SceneArgs,
    pub(crate) draw: &'a DrawArgs,
    pub(crate) output: &'a [PathBuf],
    /// Where the render ends.
    pub(crate) clock: RenderClock,
}

impl CacheSession<'_> {
    /// Loads the scene and makes what is to be shown.
    ///
    /// - `adjust`: adds to what is asked of the scene.
    ///
    /// # Errors
    /// Files that cannot be written, a bad scene, an interruption.
    pub(crate) fn make(&self, adjust: impl FnOnce(&mut RenderRequest)) -> Result<App, Failure> {
        outputs::check_writable(self.output)?;
        session::use_threads(self.draw.threads)?;
        let mut app = session::new_app();
        let mut request = RenderRequest {
            seed: self.draw.seed,
            resolution: self.draw.resolution.map(Into::into),
            crop: self.draw.crop,
            ..session::scene_request(self.scene)
        };
        adjust(&mut request);
        app.insert_resource(request).insert_resource(self.clock.clone());
        let display = Display::new(self.draw.quiet);
        interrupt::listen(app.world().resource::<Cancellation>(), &display)?;
        let progress = app.world().resource::<Progress>().clone();
        let watcher = Watcher::start(progress, display, None);
        let outcome = pipeline_core::render(&mut app);
        drop(watcher);
        session::tell_warnings(&app);
        match outcome {
            Outcome::BadScene => Err(session::bad_scene(&app)),
            Outcome::Interrupted => Err(Failure::interrupted()),
            Outcome::Finished | Outcome::WriteFailed => Ok(app),
        }
    }

    /// Tells how much there is, and writes each file.
    ///
    /// # Errors
    /// The first that cannot be written.
    pub(crate) fn write(
        &self,
        found: &[String],
        write: impl Fn(&Path) -> Result<(), film::WriteError>,
    ) -> Result<(), Failure> {
        let tell = |text: &str| {
            if !self.draw.quiet {
                say(text);
            }
        };
        found.iter().for_each(|line| tell(line));
        for path in self.output {
            write(path).map_err(|error| Failure::failed(error.to_string()))?;
            tell(&format!("wrote {}", path.display()));
        }
        Ok(())
    }
}

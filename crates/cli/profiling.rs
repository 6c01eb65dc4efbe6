//! Listens to what every system costs, when somebody asked for it.

use crate::args::RenderArgs;
use crate::exit::Failure;
use crate::stages::short_path;
use pipeline_core::{Profile, ProfileLayer};
use std::io::Write;
use std::path::{Path, PathBuf};
use tracing_subscriber::layer::SubscriberExt;

/// A profile and the files that it goes to.
pub(crate) struct Profiler {
    pub(crate) profile: Profile,
    table: Option<PathBuf>,
    trace: Option<PathBuf>,
}

impl Profiler {
    /// Starts to listen, if `always` or a file is asked for. Systems made before are not heard, so this comes before
    /// the application.
    ///
    /// # Errors
    /// Somebody listens already.
    pub(crate) fn start(options: &RenderArgs, always: bool) -> Result<Option<Self>, Failure> {
        if !always && options.profile.is_none() && options.trace.is_none() {
            return Ok(None);
        }
        let profile = Profile::new(options.trace.is_some());
        let subscriber = tracing_subscriber::registry().with(ProfileLayer::new(profile.clone()));
        tracing::subscriber::set_global_default(subscriber)
            .map_err(|error| Failure::failed(format!("cannot profile: {error}")))?;
        Ok(Some(Self {
            profile,
            table: options.profile.clone(),
            trace: options.trace.clone(),
        }))
    }

    /// Writes the files and returns their names.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(crate) fn write(&self) -> Result<Vec<PathBuf>, Failure> {
        if let Some(path) = &self.table {
            write_text(path, &self.profile.json())?;
        }
        if let Some(path) = &self.trace {
            write_text(path, &self.profile.trace_json(short_path))?;
        }
        Ok([&self.table, &self.trace].into_iter().flatten().cloned().collect())
    }
}

fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    film::atomic_write(path, |writer| writer.write_all(text.as_bytes()))
        .map_err(|error| Failure::failed(error.to_string()))
}

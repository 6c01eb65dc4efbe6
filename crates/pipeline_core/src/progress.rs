use bevy_ecs::resource::Resource;
use std::sync::{Arc, Mutex, PoisonError};

/// How far the render is, for whoever shows it. Written by the driver and by stages, read from another thread.
///
/// Nothing in the renderer reads it back, so showing progress cannot change a picture.
#[derive(Resource, Clone, Debug, Default)]
pub struct Progress(Arc<Mutex<ProgressReading>>);

/// What [`Progress`] says at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgressReading {
    /// What is going on, for people: "photons", "rendering".
    pub stage: String,
    /// Units of work done in this stage.
    pub done: u64,
    /// Units of work in all; 0 while unknown.
    pub total: u64,
    /// What a unit is: "photons", "samples".
    pub unit: &'static str,
    /// How far it is in words, where the end is not a number of units; empty elsewhere.
    pub note: String,
}

impl Progress {
    /// Starts a stage of `total` units of work.
    pub fn start(&self, stage: &str, unit: &'static str, total: u64) {
        *self.lock() = ProgressReading {
            stage: stage.into(),
            done: 0,
            total,
            unit,
            note: String::new(),
        };
    }

    /// Says how far it is in words, where the end is not a number of units.
    pub fn set_note(&self, note: &str) {
        self.lock().note = note.into();
    }

    /// Says that `done` units of the current stage are finished.
    pub fn set_done(&self, done: u64) {
        self.lock().done = done;
    }

    /// The present state.
    #[must_use]
    pub fn read(&self) -> ProgressReading {
        self.lock().clone()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, ProgressReading> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

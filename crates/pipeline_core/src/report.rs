use bevy_ecs::resource::Resource;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// What went wrong so far, as finished text with its place in the scene. Written by systems that may fail, read by the
/// driver and the command line.
///
/// Only `Load`, `Prepare` and `Finish` may add errors; a warning may come from anywhere.
#[derive(Resource, Clone, Debug, Default)]
pub struct Report {
    errors: Vec<String>,
    warnings: Vec<String>,
}

impl Report {
    /// Adds an error: the render will not go on.
    pub fn fail(&mut self, message: String) {
        self.errors.push(message);
    }

    /// Adds a warning: the picture can still make sense. The same warning is kept once.
    pub fn warn(&mut self, message: String) {
        if !self.warnings.contains(&message) {
            self.warnings.push(message);
        }
    }

    /// All errors, oldest first.
    #[must_use]
    pub fn errors(&self) -> &[String] {
        &self.errors
    }

    /// All warnings, oldest first.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// True when there is at least one error.
    #[must_use]
    pub fn failed(&self) -> bool {
        !self.errors.is_empty()
    }
}

/// A number that systems count up from any thread. Integer, so that the order of additions cannot matter.
#[derive(Clone, Debug, Default)]
pub struct Counter(Arc<AtomicU64>);

impl Counter {
    /// Adds `n`.
    pub fn add(&self, n: u64) {
        self.0.fetch_add(n, Ordering::Relaxed);
    }

    /// The sum so far.
    #[must_use]
    pub fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// All counters by name, `"stage/counted thing"`. A stage asks for its counters once, when it is built.
#[derive(Resource, Clone, Debug, Default)]
pub struct Counters(BTreeMap<&'static str, Counter>);

impl Counters {
    /// The counter of this name; made on first use.
    pub fn counter(&mut self, name: &'static str) -> Counter {
        self.0.entry(name).or_default().clone()
    }

    /// The value of a counter; 0 when nobody counts it.
    #[must_use]
    pub fn get(&self, name: &str) -> u64 {
        self.0.get(name).map_or(0, Counter::get)
    }

    /// Names and values, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, u64)> {
        self.0.iter().map(|(name, counter)| (*name, counter.get()))
    }
}

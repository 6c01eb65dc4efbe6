use bevy_ecs::resource::Resource;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The wish to stop, shared between a signal handler and the driver.
///
/// The driver looks at it between waves and photon batches; a system never needs to. What was rendered until then is
/// written.
#[derive(Resource, Clone, Debug, Default)]
pub struct Cancellation(Arc<AtomicBool>);

impl Cancellation {
    /// Asks the render to stop at the next wave. Safe to call from any thread.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// True once somebody asked to stop.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

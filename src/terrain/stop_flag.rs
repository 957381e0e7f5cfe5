//! A computation that nobody waits for any more is told so by a flag.

use std::sync::atomic::{AtomicBool, Ordering};

/// Says that a computation may end early, since its answer is not needed any more.
#[derive(Debug, Default)]
pub struct StopFlag(AtomicBool);

impl StopFlag {
    /// Lets the computation end early.
    pub fn stop(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it may.
    pub fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

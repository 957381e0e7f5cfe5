//! A flag that ends a computation whose answer nobody needs any more.

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

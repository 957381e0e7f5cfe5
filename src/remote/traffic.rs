//! The requests and bytes that a run has read from servers, for its note.

use std::sync::atomic::{AtomicU64, Ordering};

static REQUESTS: AtomicU64 = AtomicU64::new(0);
static BYTES: AtomicU64 = AtomicU64::new(0);

/// Requests and the bytes of their replies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Requests that were sent, tries again among them.
    pub requests: u64,
    /// Bytes of the bodies of all replies.
    pub bytes: u64,
}

impl Traffic {
    /// The traffic of this run so far.
    pub fn of_run() -> Self {
        Self { requests: REQUESTS.load(Ordering::Relaxed), bytes: BYTES.load(Ordering::Relaxed) }
    }

    /// Adds a request to that of this run.
    pub fn count_request() {
        REQUESTS.fetch_add(1, Ordering::Relaxed);
    }

    /// Adds bytes of a reply to that of this run.
    pub fn count_bytes(bytes: usize) {
        BYTES.fetch_add(bytes as u64, Ordering::Relaxed);
    }
}

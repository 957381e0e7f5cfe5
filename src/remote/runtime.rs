//! The thread that waits for servers.
//!
//! Requests run on a thread of their own, and who wants a reply waits for it: that is sound on any thread, those of the HTTP
//! service among them, where a second runtime must not be entered.

use std::future::Future;
use std::sync::OnceLock;
use std::sync::mpsc::sync_channel;

use tokio::runtime::{Builder, Runtime};

use crate::error::RemoteError;

static RUNTIME: OnceLock<Option<Runtime>> = OnceLock::new();

fn runtime() -> Option<&'static Runtime> {
    let start =
        || Builder::new_multi_thread().worker_threads(1).thread_name("remote").enable_all().build().ok();
    RUNTIME.get_or_init(start).as_ref()
}

/// The result of `work`, which runs on the thread for servers.
///
/// # Errors
/// The system starts no thread, or the work panicked.
pub(crate) fn wait_for<T: Send + 'static>(
    work: impl Future<Output = T> + Send + 'static,
) -> Result<T, RemoteError> {
    let runtime = runtime().ok_or_else(|| RemoteError::Store("the system starts no thread".into()))?;
    let (sender, receiver) = sync_channel(1);
    runtime.spawn(async move {
        // Who waits is there until the result is.
        let _ = sender.send(work.await);
    });
    receiver.recv().map_err(|_| RemoteError::BrokenReply("it cannot be taken apart"))
}

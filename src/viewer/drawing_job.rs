//! A picture of the view that is drawn on a thread.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use crate::message::chain::error_text;
use crate::pipeline::view_snapshot::ViewSnapshot;

/// A picture that is being drawn.
pub struct DrawingJob {
    /// What is drawn.
    pub snapshot: ViewSnapshot,
    done: Receiver<Result<PathBuf, String>>,
}

impl DrawingJob {
    /// Begins to draw; `wake` is called when [`DrawingJob::poll`] has the picture.
    pub fn start(snapshot: ViewSnapshot, wake: impl FnOnce() + Send + 'static) -> Self {
        let (sender, done) = channel();
        let drawn = snapshot.clone();
        thread::spawn(move || {
            // Nobody waits for the picture where the window was closed.
            let _ = sender.send(drawn.write(&|_| ()).map_err(|error| error_text(&error)));
            wake();
        });
        Self { snapshot, done }
    }

    /// The picture's file, or why there is none; `None` while it is being drawn.
    pub fn poll(&self) -> Option<Result<PathBuf, String>> {
        match self.done.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("drawing it failed; please report this".to_owned())),
        }
    }
}

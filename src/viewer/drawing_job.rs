//! A picture of the view that is drawn on a thread.

use std::path::PathBuf;

use egui::Context;

use crate::worker::WorkerJob;
use sandtable_base::message::chain::error_text;
use sandtable_editing::view_snapshot::ViewSnapshot;

/// A picture that is being drawn.
pub struct DrawingJob {
    /// The view that is drawn.
    pub snapshot: ViewSnapshot,
    job: WorkerJob<Result<PathBuf, String>>,
}

impl DrawingJob {
    /// Begins to draw; the window shows a frame when [`DrawingJob::poll`] has the picture.
    pub fn start(context: &Context, snapshot: ViewSnapshot) -> Self {
        let drawn = snapshot.clone();
        let draw = move || drawn.write(&|_| ()).map_err(|error| error_text(&error));
        Self { snapshot, job: WorkerJob::start(context, draw) }
    }

    /// The picture's file, or why there is none; `None` while it is being drawn.
    pub fn poll(&self) -> Option<Result<PathBuf, String>> {
        let done = self.job.poll()?;
        Some(done.unwrap_or_else(|failure| Err(format!("drawing it failed: {failure}"))))
    }
}

//! The thread that draws a frame while the window makes the next.
//!
//! ```text
//!   window    panels ─ ground ─┬─ panels ─ ground ─ · · · ─┬─ panels ─ ground ─ · ·      · waits for the frame before
//!   drawing                    └─► upload ─ record ─ send ─┴─► upload ─ record ─ send
//! ```
//!
//! Culling, levels of detail and what is cut to them are so a frame ahead of what is drawn, on every adapter, and each picture
//! still has the ground of its own camera. Where the adapter is a processor, sending takes a third of a frame or more: Mesa's
//! Vulkan moves all corners before it returns, and waits for those pixels that a later pass reads.
//!
//! A thread is started for each frame: that takes some hundredths of a millisecond.

use std::panic::resume_unwind;
use std::thread::{self, JoinHandle};

use crate::error::ViewerError;
use crate::frame_drawer::DrawnFrame;

/// Draws one frame at a time.
#[derive(Debug, Default)]
pub struct FrameThread(Option<JoinHandle<Result<DrawnFrame, ViewerError>>>);

impl FrameThread {
    /// Begins with a frame; that of the frame before is to be finished.
    pub fn start(&mut self, draw: impl FnOnce() -> Result<DrawnFrame, ViewerError> + Send + 'static) {
        self.0 = Some(thread::spawn(draw));
    }

    /// Waits until the frame is drawn and sent; returns what it showed, and `None` where none was begun since this was called
    /// last.
    ///
    /// # Errors
    /// The frame's.
    pub fn finish(&mut self) -> Result<Option<DrawnFrame>, ViewerError> {
        let Some(drawing) = self.0.take() else { return Ok(None) };
        drawing.join().unwrap_or_else(|panic| resume_unwind(panic)).map(Some)
    }
}

impl Drop for FrameThread {
    fn drop(&mut self) {
        // Drivers do not outlive the program's end while they work.
        let _ = self.0.take().map(JoinHandle::join);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_frame_is_drawn_while_the_next_is_made() {
        let mut thread = FrameThread::default();
        let (make_next, made) = mpsc::channel();
        thread.start(move || {
            // Nothing comes here where the frame is drawn before the next is begun.
            let pipelines = made.recv_timeout(Duration::from_secs(60)).unwrap_or(0);
            Ok(DrawnFrame { pipelines, ..DrawnFrame::default() })
        });
        make_next.send(7).expect("it is still being drawn");
        let drawn = thread.finish().expect("drawn").expect("one was begun");
        assert_eq!(drawn.pipelines, 7);
        assert!(thread.finish().expect("nothing failed").is_none(), "each frame is told of once");
    }

    #[test]
    fn what_follows_a_frame_and_fails_is_told_when_it_is_finished() {
        let mut thread = FrameThread::default();
        thread.start(|| Err(ViewerError::NoFrames("unplugged".into())));
        let error = thread.finish().expect_err("it failed");
        assert!(error.to_string().contains("unplugged"), "{error}");
        assert!(thread.finish().expect("told before").is_none());
    }
}

//! The sending of frames to the adapter, on a thread of its own where that is a processor.
//!
//! ```text
//!   hardware    update ─ record ─ send │ update ─ record ─ send │              the adapter draws meanwhile
//!   processor   update ─ record │ update ───── record │ update
//!                               └─► send: corners ──┘ └─► send: corners
//! ```
//!
//! Mesa's Vulkan on the processor moves all corners of a frame, and waits for those pixels that a later pass reads, before
//! sending returns: a third of a frame or more, in which the next frame brings its ground up to date.

use std::panic::resume_unwind;
use std::thread::{self, JoinHandle};

use crate::error::ViewerError;
use sandtable_gpu::adapter::Gpu;

/// What follows the sending of a frame's commands, of which it takes the number.
pub type AfterSending = Box<dyn FnOnce(&Gpu, wgpu::SubmissionIndex) -> Result<(), ViewerError> + Send>;

/// Sends frames one after the other.
#[derive(Debug, Default)]
pub struct FrameSending(Option<JoinHandle<Result<(), ViewerError>>>);

impl FrameSending {
    /// Sends the commands of a frame, once those of the frame before are sent. Where the adapter is a processor, this returns
    /// at once; nothing is to be sent besides until [`FrameSending::finish`] returns.
    ///
    /// # Errors
    /// What `after` returns, or that of the frame before returned.
    pub fn send(
        &mut self,
        gpu: &Gpu,
        commands: Vec<wgpu::CommandBuffer>,
        after: AfterSending,
    ) -> Result<(), ViewerError> {
        self.finish()?;
        let gpu = gpu.clone();
        let is_software = gpu.is_software();
        let send = move || {
            let index = gpu.queue().submit(commands);
            after(&gpu, index)
        };
        if !is_software {
            return send();
        }
        self.0 = Some(thread::spawn(send));
        Ok(())
    }

    /// Waits until all that was handed over is sent.
    ///
    /// # Errors
    /// What followed the sending returned.
    pub fn finish(&mut self) -> Result<(), ViewerError> {
        let sent = self.0.take().map(JoinHandle::join);
        sent.map_or(Ok(()), |sent| sent.unwrap_or_else(|panic| resume_unwind(panic)))
    }
}

impl Drop for FrameSending {
    fn drop(&mut self) {
        // Drivers do not outlive the program's end while they work.
        let _ = self.0.take().map(JoinHandle::join);
    }
}

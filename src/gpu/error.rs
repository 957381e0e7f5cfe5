//! Errors of the GPU renderer.

use std::sync::Arc;

use crate::adapter::GpuApi;
use sandtable_base::limits::memory::MemoryRefused;
use sandtable_draw::list::DrawListError;

/// Why the GPU renderer gives no picture. In every case but an unsound list, the CPU renderer can draw it.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum GpuError {
    #[error(
        "no GPU adapter can be used here ({}); draw with the CPU renderer instead: --backend cpu, the default",
        join(.0)
    )]
    NoAdapter(Vec<(GpuApi, DriverError)>),
    #[error("the draw list is unsound: {0}")]
    List(#[from] DrawListError),
    /// There is not enough memory for the shadow maps that the processor draws or plans.
    #[error(transparent)]
    Memory(#[from] MemoryRefused),
    #[error("{what} exceed the {limit} {unit} that {adapter} holds; use less detail or --backend cpu")]
    TooLarge {
        what: String,
        /// The adapter's limit.
        limit: u64,
        /// The unit of the limit.
        unit: &'static str,
        adapter: String,
    },
    #[error("{adapter} ran out of memory while {doing}; ask for a smaller picture or use --backend cpu")]
    OutOfMemory { doing: &'static str, adapter: String },
    #[error("{adapter} was lost while {doing} ({reason}); open it again, or use --backend cpu")]
    DeviceLost { doing: &'static str, adapter: String, reason: String },
    #[error("{adapter} failed while {doing}: {source}; use --backend cpu")]
    Driver { doing: &'static str, adapter: String, source: Arc<DriverError> },
}

/// An error of a driver.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum DriverError {
    #[error(transparent)]
    Adapter(#[from] wgpu::RequestAdapterError),
    #[error(transparent)]
    Device(#[from] wgpu::RequestDeviceError),
    #[error(transparent)]
    Command(#[from] wgpu::Error),
    #[error(transparent)]
    Wait(#[from] wgpu::PollError),
    #[error(transparent)]
    Map(#[from] wgpu::BufferAsyncError),
    #[error(transparent)]
    MapRange(#[from] wgpu::MapRangeError),
    #[error("the device was lost ({0})")]
    Lost(String),
    /// The driver or `wgpu` panicked.
    #[error("the driver crashed")]
    Crash,
    #[error("the driver returned too few pixels")]
    TooFewPixels,
}

fn join(tried: &[(GpuApi, DriverError)]) -> String {
    let each: Vec<String> = tried.iter().map(|(api, error)| format!("{api:?}: {error}")).collect();
    each.join("; ")
}

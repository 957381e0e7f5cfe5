//! Why the GPU renderer gives no picture.

use std::sync::Arc;

use crate::draw::list::DrawListError;
use crate::render::gpu::adapter::GpuApi;

/// Why the GPU renderer gives no picture. In every case but an unsound list, the CPU renderer can draw it.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No interface offers an adapter that can be opened.
    #[error(
        "no GPU adapter can be used here ({}); draw with the CPU renderer instead: --backend cpu, the default",
        join(.0)
    )]
    NoAdapter(Vec<(GpuApi, DriverError)>),
    /// The draw list is unsound.
    #[error("the draw list is unsound: {0}")]
    List(#[from] DrawListError),
    /// The scene or the picture exceeds a limit of the adapter.
    #[error("{what} exceed the {limit} {unit} that {adapter} holds; use less detail or --backend cpu")]
    TooLarge {
        /// What is too large, with its size; a plural.
        what: String,
        /// The adapter's limit.
        limit: u64,
        /// The unit of the limit.
        unit: &'static str,
        /// The adapter's name.
        adapter: String,
    },
    /// The adapter's memory is exhausted.
    #[error("{adapter} ran out of memory while {doing}; ask for a smaller picture or use --backend cpu")]
    OutOfMemory {
        /// What was being done.
        doing: &'static str,
        /// The adapter's name.
        adapter: String,
    },
    /// The driver refused a command or failed.
    #[error("{adapter} failed while {doing}: {source}; use --backend cpu")]
    Driver {
        /// What was being done.
        doing: &'static str,
        /// The adapter's name.
        adapter: String,
        /// The driver's report.
        source: Arc<DriverError>,
    },
}

/// What a driver reports.
#[derive(Debug, thiserror::Error)]
pub enum DriverError {
    /// There is no adapter.
    #[error(transparent)]
    Adapter(#[from] wgpu::RequestAdapterError),
    /// The adapter gives no device.
    #[error(transparent)]
    Device(#[from] wgpu::RequestDeviceError),
    /// A command failed.
    #[error(transparent)]
    Command(#[from] wgpu::Error),
    /// The device did not finish in time.
    #[error(transparent)]
    Wait(#[from] wgpu::PollError),
    /// A buffer cannot be read.
    #[error(transparent)]
    Map(#[from] wgpu::BufferAsyncError),
    /// A part of a buffer cannot be read.
    #[error(transparent)]
    MapRange(#[from] wgpu::MapRangeError),
    /// The device was lost.
    #[error("the device was lost ({0})")]
    Lost(String),
    /// The driver or `wgpu` panicked.
    #[error("the driver crashed")]
    Crash,
    /// A picture came back incomplete.
    #[error("the driver returned too few pixels")]
    TooFewPixels,
}

fn join(tried: &[(GpuApi, DriverError)]) -> String {
    let each: Vec<String> = tried.iter().map(|(api, error)| format!("{api:?}: {error}")).collect();
    each.join("; ")
}

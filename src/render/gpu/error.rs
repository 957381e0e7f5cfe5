//! What can keep the GPU from drawing: one enum, each case a sentence with a remedy.

/// Why there is no picture from the GPU. Every case leaves the CPU renderer as a way out.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No driver offers an adapter, or none that can be opened.
    #[error(
        "no GPU adapter can be used here ({tried}); draw with the CPU renderer instead: --backend cpu, the default"
    )]
    NoAdapter {
        /// What each interface said.
        tried: String,
    },
    /// The draw list contradicts itself.
    #[error("the draw list is unsound: {0}")]
    List(String),
    /// The picture is larger than the adapter can hold.
    #[error(
        "the picture is {width}×{height} pixels, but {adapter} draws at most {limit} a side; ask for a smaller picture or use --backend cpu"
    )]
    PictureSize {
        /// Columns asked for.
        width: u32,
        /// Rows asked for.
        height: u32,
        /// The longest side the adapter draws.
        limit: u32,
        /// The adapter's name.
        adapter: String,
    },
    /// The ground map has more posts a side than a texture can hold.
    #[error(
        "the ground has {columns}×{rows} posts, but {adapter} holds at most {limit} a side; use a smaller or coarser elevation model, or --backend cpu"
    )]
    GroundSize {
        /// Posts per row.
        columns: u32,
        /// Rows of posts.
        rows: u32,
        /// The most posts a side.
        limit: u32,
        /// The adapter's name.
        adapter: String,
    },
    /// Something needs a buffer larger than the adapter offers.
    #[error(
        "{what} takes {bytes} bytes, but {adapter} holds at most {limit} in one piece; use --backend cpu"
    )]
    BufferSize {
        /// What is too large.
        what: String,
        /// Bytes needed.
        bytes: u64,
        /// Bytes offered.
        limit: u64,
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
    #[error("{adapter} failed while {doing}: {reason}; use --backend cpu")]
    Failed {
        /// What was being done.
        doing: &'static str,
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
}

//! Shadow maps that the adapter draws: the texels of maps that the processor has planned.
//!
//! ```text
//! DrawList, Camera ─ processor ─► ShadowPlan: levels, numbered pages, the items that cast on each level
//!                                    │
//!   level by level:  rasterizer ─► fragment: page of its texel, atomicMax of its height ─► heights, page by page
//!   map by map:      compute    ─► solids that float taken away ─► texels;  highest of 3×3 pages ─► table
//! ```
//!
//! The light sees the buffers that the picture is drawn from, so that the ground and what is in view is sent once; solids out
//! of view that cast on a stored page are sent besides (`maker`). A fragment raises an integer that rises with the
//! height, since shaders have no maximum of floats that many invocations can take at once. Pages that are not stored take
//! no memory. The textures hold what they do where the processor draws the maps
//! ([`Shadows`](sandtable_render::shadow::Shadows)).
//!
//! # Cost
//! The processor plans, in a fiftieth to a seventh of the time in which it draws the maps. The device has 12 bytes for a
//! stored texel while it draws, besides the texel itself, and a target of at most 16 MiB.
//!
//! # Accuracy
//! Corners are rounded to the rasterizer's grid, of 1/256 texel on most adapters and 1/16,384 on the processor, so that
//! texels on the borders of triangles may be covered by one and not by the other. Heights of texels that both cover differ
//! by rounding.
//!
//! # Why not otherwise
//! A depth buffer for each level would hold texels where no page is stored, up to a gigabyte of them, and its depths would be
//! parts of a range that a low sun makes long.

mod caster_calls;
mod constants;
pub(crate) mod drawer;
pub(crate) mod maker;
mod pipelines;
pub mod read_back;

use crate::adapter::Gpu;

/// Who draws shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadowMaker {
    /// The processor, with all threads.
    Processor,
    /// The adapter, where it can and the maps fit its buffers; else the processor.
    Adapter,
}

impl ShadowMaker {
    /// The adapter, unless that is the processor itself behind a driver: Mesa's takes one and a half to four times as long as
    /// the processor's own way.
    pub fn of(gpu: &Gpu) -> Self {
        if gpu.is_software() { Self::Processor } else { Self::Adapter }
    }
}

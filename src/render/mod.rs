//! Renders draw lists to pictures, by the processor or by a graphics adapter.
//!
//! `cpu/` is deterministic and needs nothing but the processor. `gpu/` needs an adapter and the Cargo feature `gpu`.
//! Both draw the same list by the same formulas, read far ground and far textures from the same coarser levels, and
//! shadows from the same maps.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
mod mip_levels;
pub mod picture;
mod shadow;

use crate::draw::list::DrawList;
use crate::render::cpu::{CpuRenderError, RenderQuality};
use crate::render::picture::Rendering;
use crate::view::camera::Camera;

/// The renderer to draw with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RenderBackend {
    /// The processor: the same bytes on every machine.
    #[default]
    Cpu,
    /// A graphics adapter; needs the Cargo feature `gpu`.
    Gpu,
}

/// Why a draw list cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The CPU renderer failed.
    #[error(transparent)]
    Cpu(#[from] CpuRenderError),
    /// The GPU renderer failed.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] gpu::error::GpuError),
    /// The GPU renderer is not built in.
    #[error(
        "this program is built without the Cargo feature `gpu`; run `cargo run --release --features gpu -- …`, or draw with --backend cpu, the default"
    )]
    NoGpuFeature,
}

/// The picture of `list` as `camera` sees it, by the chosen renderer at its default quality.
///
/// # Errors
/// See [`RenderError`].
pub fn render(list: &DrawList, camera: &Camera, backend: RenderBackend) -> Result<Rendering, RenderError> {
    match backend {
        RenderBackend::Cpu => Ok(cpu::render(list, camera, &RenderQuality::default())?),
        #[cfg(feature = "gpu")]
        RenderBackend::Gpu => Ok(gpu::render(list, camera)?),
        #[cfg(not(feature = "gpu"))]
        RenderBackend::Gpu => Err(RenderError::NoGpuFeature),
    }
}

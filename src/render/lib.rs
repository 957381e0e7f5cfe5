//! Renders draw lists to pictures, by the processor or by a graphics adapter.
//!
//! `cpu/` is deterministic and needs nothing but the processor. `gpu/` needs an adapter and the Cargo feature `gpu`.
//! Both draw the same list by the same formulas, read far ground and far textures from the same coarser levels, and
//! shadows from the same maps.

pub mod backend_name;
pub mod cpu;
pub mod drawn_rows;
pub mod mip_levels;
pub mod picture;
pub mod shadow;

use std::error::Error;

use crate::cpu::{CpuRenderError, RenderQuality};
use crate::drawn_rows::DrawnRows;
use crate::picture::Rendering;
use sandtable_draw::list::DrawList;
use sandtable_view::camera::Camera;

/// Draws a list elsewhere than on the processor: the same picture up to rounding. It is told what to call with the name of each
/// step as it begins.
pub type OtherRenderer =
    fn(&DrawList, &Camera, &dyn Fn(&'static str)) -> Result<Rendering, Box<dyn Error + Send + Sync>>;

/// The renderer to draw with.
#[derive(Clone, Copy, Debug, Default)]
pub enum RenderBackend {
    /// The processor: the same bytes on every machine.
    #[default]
    Cpu,
    /// A graphics adapter, by a renderer of the crate `sandtable-gpu`.
    Gpu(OtherRenderer),
}

/// Why a draw list cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The CPU renderer failed.
    #[error(transparent)]
    Cpu(#[from] CpuRenderError),
    /// The GPU renderer failed.
    #[error(transparent)]
    Gpu(Box<dyn Error + Send + Sync>),
}

/// The picture of `list` as `camera` sees it, by the chosen renderer at its default quality. `progress` is called with the name
/// of each step as it begins.
///
/// # Errors
/// See [`RenderError`].
pub fn render(
    list: &DrawList,
    camera: &Camera,
    backend: RenderBackend,
    progress: &dyn Fn(&'static str),
) -> Result<Rendering, RenderError> {
    render_counted(list, camera, backend, progress, &DrawnRows::default())
}

/// [`render`]; the processor counts in `drawn` the rows that it has drawn.
///
/// # Errors
/// See [`RenderError`].
pub fn render_counted(
    list: &DrawList,
    camera: &Camera,
    backend: RenderBackend,
    progress: &dyn Fn(&'static str),
    drawn: &DrawnRows,
) -> Result<Rendering, RenderError> {
    match backend {
        RenderBackend::Cpu => Ok(cpu::render_counted(list, camera, &RenderQuality::default(), drawn)?),
        RenderBackend::Gpu(render) => render(list, camera, progress).map_err(RenderError::Gpu),
    }
}

//! The GPU renderer: a draw list through `wgpu`, as a picture or frame after frame.
//!
//! ```text
//! DrawList ─ plan ─► order and depth rule of every draw call, what is merged into one
//!            │ geometry, materials, frame ─► buffers and textures ┐
//!            │ pipelines ─► shader and its variants               ├─ passes ─► readback ─► picture_renderer
//!            │ adapter ─► device, errors as values                ┘        └─► live ─► a window's frame
//! ```
//!
//! Shadow maps are planned by the processor, for both renderers alike. The adapter draws them (`shadow_maps`) where it can
//! and is not the processor itself; else the processor does, and they are uploaded as textures.
//!
//! It draws the same list by the same formulas as the CPU renderer, but rounds as the driver does: pictures differ
//! slightly from machine to machine. Where the exact bytes matter, use the CPU renderer.
//!
//! # Cost
//! A handful of draw calls for all ground, drapes and solids; one for each set of instances and for each transparent solid.
//! Memory: 44 bytes a vertex and 12 a triangle, 16 a post of the ground map and a third more for its coarser levels, 72 an
//! instance, all of a scene at most two gibibytes.

pub mod adapter;
mod buffer_writes;
mod compute;
mod culling;
mod draped_vertex;
mod draw_call;
pub mod error;
mod formats;
mod frame;
mod geometry;
mod ground;
mod instance_culling;
mod layouts;
pub mod live;
mod materials;
mod memory;
mod merged_vertex;
pub mod painting;
mod parts;
pub mod pass_timer;
mod passes;
pub mod picture_renderer;
mod pipeline_key;
mod pipelines;
mod plan;
pub mod readback;
mod shadow;
pub mod shadow_maps;
#[cfg(test)]
mod test_device;
mod tiled_picture;
mod tiles;
mod uniforms;
mod windows;

use std::sync::{Mutex, PoisonError};

use crate::adapter::{Gpu, GpuApi};
use crate::error::GpuError;
use crate::picture_renderer::PictureRenderer;
use sandtable_draw::list::DrawList;
use sandtable_render::picture::Rendering;
use sandtable_view::camera::Camera;

/// The renderer of the pictures before; `None` before the first, and after one that failed.
static KEPT: Mutex<Option<PictureRenderer>> = Mutex::new(None);

/// The picture of `list` as `camera` sees it, drawn by the first adapter found: Vulkan's, else OpenGL's. The adapter stays open
/// for the next picture, until the program ends. `progress` is called with the name of each step as it begins.
///
/// # Errors
/// See [`GpuError`].
pub fn render(
    list: &DrawList,
    camera: &Camera,
    progress: &dyn Fn(&'static str),
) -> Result<Rendering, GpuError> {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    let mut renderer = match kept.take() {
        Some(renderer) => renderer,
        None => {
            progress("opening the adapter");
            let gpu = Gpu::open(&[GpuApi::Vulkan, GpuApi::Gl])?;
            progress("translating shaders");
            PictureRenderer::new(&gpu)?
        }
    };
    let picture = renderer.render(list, camera, progress)?;
    *kept = Some(renderer);
    Ok(picture)
}

/// The picture of `list` as `camera` sees it, drawn by `gpu`; nothing stays on the device afterward.
///
/// # Errors
/// As [`render`], except that there is an adapter.
pub fn render_on(gpu: &Gpu, list: &DrawList, camera: &Camera) -> Result<Rendering, GpuError> {
    PictureRenderer::new(gpu)?.render(list, camera, &|_| ())
}

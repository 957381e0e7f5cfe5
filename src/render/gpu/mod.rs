//! The GPU renderer: a draw list through `wgpu`, without a window.
//!
//! ```text
//! DrawList ─ plan ─► order and depth rule of every draw call
//!          ─ upload ─► buffers and textures       ┐
//!            pipelines ─► shader and its variants ├─ passes ─► readback ─► Picture
//!            adapter ─► device, errors as values  ┘
//! ```
//!
//! Shadow maps are made by the processor, for both renderers alike, and uploaded as textures.
//!
//! It draws the same list by the same formulas as the CPU renderer, but rounds as the driver does: pictures differ
//! slightly from machine to machine. Where the exact bytes matter, use the CPU renderer.

pub mod adapter;
pub mod error;
mod ground;
mod memory;
mod passes;
mod pipelines;
mod plan;
mod readback;
mod shadow;
mod uniforms;
mod upload;

use crate::draw::list::DrawList;
use crate::render::gpu::adapter::{Gpu, GpuApi};
use crate::render::gpu::error::GpuError;
use crate::render::gpu::passes::Recording;
use crate::render::gpu::pipelines::{Layouts, Pipelines};
use crate::render::gpu::plan::Plan;
use crate::render::gpu::readback::Targets;
use crate::render::gpu::upload::Resources;
use crate::render::picture::Rendering;
use crate::render::shadow::Shadows;
use crate::view::camera::Camera;

/// The picture of `list` as `camera` sees it, drawn by the first adapter found: Vulkan's, else OpenGL's.
///
/// # Errors
/// See [`GpuError`].
pub fn render(list: &DrawList, camera: &Camera) -> Result<Rendering, GpuError> {
    render_on(&Gpu::open(&[GpuApi::Vulkan, GpuApi::Gl])?, list, camera)
}

/// The picture of `list` as `camera` sees it, drawn by `gpu`; nothing stays on the device afterward.
///
/// # Errors
/// As [`render`], except that there is an adapter.
pub fn render_on(gpu: &Gpu, list: &DrawList, camera: &Camera) -> Result<Rendering, GpuError> {
    list.check()?;
    let plan = Plan::new(list, camera);
    let shadows = Shadows::new(list, camera);
    let (layouts, pipelines) = gpu.guarded("building its shaders", || {
        let layouts = Layouts::new(gpu);
        let pipelines = Pipelines::new(gpu, &layouts, &plan);
        Ok((layouts, pipelines))
    })?;
    let (resources, targets) = gpu.guarded("loading the scene", || {
        let targets = Targets::new(gpu, camera.size())?;
        Ok((Resources::upload(gpu, &layouts, list, camera, &shadows)?, targets))
    })?;
    gpu.guarded("drawing the picture", || {
        let recording = Recording {
            gpu,
            list,
            plan: &plan,
            pipelines: &pipelines,
            resources: &resources,
            targets: &targets,
        };
        targets.read(gpu, recording.record())
    })
}

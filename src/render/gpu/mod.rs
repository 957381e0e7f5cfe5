//! The GPU renderer: a draw list through `wgpu`, without a window.
//!
//! ```text
//! DrawList ─ plan ─► order and rule of every draw call
//!          ─ upload ─► buffers and textures       ┐
//!            pipelines ─► shader and its variants ├─ passes ─► readback ─► Picture
//!            adapter ─► device, errors as values  ┘
//! ```
//!
//! It draws the same list by the same formulas as the CPU renderer, but its rounding is the driver's:
//! pictures differ from machine to machine by a little. Where the very bytes matter, use the CPU.

use crate::draw::list::DrawList;
use crate::draw::material::{Albedo, NormalSource};
use crate::render::gpu::adapter::{GpuApi, Gpu};
use crate::render::gpu::error::GpuError;
use crate::render::gpu::passes::Recording;
use crate::render::gpu::pipelines::{Layouts, Pipelines};
use crate::render::gpu::plan::Plan;
use crate::render::gpu::readback::Targets;
use crate::render::gpu::upload::Resources;
use crate::render::picture::Picture;
use crate::view::camera::Camera;

pub mod adapter;
pub mod error;
mod ground;
mod mips;
mod passes;
mod pipelines;
mod plan;
mod readback;
mod uniforms;
mod upload;

/// The picture of `list` seen by `camera`, drawn by the first adapter found: Vulkan's, else OpenGL's.
///
/// # Errors
/// [`GpuError`]: no adapter, a list that contradicts itself, a scene or picture the adapter cannot hold, or
/// a driver that fails. Every message names the CPU renderer as the way out.
pub fn render(list: &DrawList, camera: &Camera) -> Result<Picture, GpuError> {
    render_on(&Gpu::open(&[GpuApi::Vulkan, GpuApi::Gl])?, list, camera)
}

/// The picture of `list` seen by `camera`, drawn by `gpu`; nothing stays on the device afterward.
///
/// # Errors
/// As [`render`], except that there is an adapter.
pub fn render_on(gpu: &Gpu, list: &DrawList, camera: &Camera) -> Result<Picture, GpuError> {
    check(list)?;
    let plan = Plan::of(list, camera);
    let (layouts, pipelines) = gpu.guarded("building its shaders", || {
        let layouts = Layouts::new(gpu);
        let pipelines = Pipelines::new(gpu, &layouts, &plan);
        Ok((layouts, pipelines))
    })?;
    let (resources, targets) = gpu.guarded("taking the scene in", || {
        let targets = Targets::new(gpu, camera.size())?;
        Ok((Resources::upload(gpu, &layouts, list, camera)?, targets))
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

/// What the draw list's own check leaves to the renderer.
fn check(list: &DrawList) -> Result<(), GpuError> {
    list.check().map_err(GpuError::List)?;
    let needs_ground = list.items.iter().position(|item| {
        let material = &list.materials[item.material.0 as usize];
        material.albedo == Albedo::GroundMap || material.normals == NormalSource::Ground
    });
    match needs_ground {
        Some(item) if list.ground.is_none() => Err(GpuError::List(format!(
            "item {item} takes its color or normals from the ground map, but there is none"
        ))),
        _ => Ok(()),
    }
}

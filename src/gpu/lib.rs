//! The GPU renderer: a draw list through `wgpu`, as a picture or frame after frame.
//!
//! ```text
//! DrawList ─ plan ─► order and depth rule of every draw call, what is merged into one
//!            │ geometry, materials, frame ─► buffers and textures ┐
//!            │ pipelines ─► shader and its variants               ├─ passes ─► readback ─► Picture
//!            │ adapter ─► device, errors as values                ┘        └─► live ─► a window's frame
//! ```
//!
//! Shadow maps are made by the processor, for both renderers alike, and uploaded as textures.
//!
//! It draws the same list by the same formulas as the CPU renderer, but rounds as the driver does: pictures differ
//! slightly from machine to machine. Where the exact bytes matter, use the CPU renderer.
//!
//! # Cost
//! A handful of draw calls for all ground, drapes and solids; one for each set of instances and for each transparent solid.
//! Memory: 44 bytes a vertex and 12 a triangle, 16 a post of the ground map and a third more for its coarser levels, 72 an
//! instance, all of a scene at most two gibibytes.

pub mod adapter;
pub mod error;
mod formats;
mod frame;
mod geometry;
mod ground;
mod layouts;
pub mod live;
mod materials;
mod memory;
mod merged_vertex;
mod parts;
pub mod pass_timer;
mod passes;
mod pipeline_key;
mod pipelines;
mod plan;
pub mod readback;
mod shadow;
mod uniforms;
mod windows;

use crate::adapter::{Gpu, GpuApi};
use crate::error::GpuError;
use crate::formats::{COLOR, FEATURE};
use crate::frame::{FrameGroup, FrameTextures};
use crate::geometry::GpuGeometry;
use crate::ground::row_bits;
use crate::layouts::Layouts;
use crate::materials::{GpuMaterials, TexturePlaces, TextureScope};
use crate::memory::{Loader, view};
use crate::parts::ShaderParts;
use crate::passes::{PassStage, PassViews, ScenePass};
use crate::pipeline_key::PipelineKey;
use crate::pipelines::{GpuPass, PassTarget, Pipelines, shader};
use crate::plan::Plan;
use crate::readback::Targets;
use crate::shadow::ShadowView;
use crate::uniforms::{FrameScene, FrameUniforms};
use sandtable_draw::list::DrawList;
use sandtable_render::picture::Rendering;
use sandtable_render::shadow::Shadows;
use sandtable_view::camera::Camera;

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
    let places = TexturePlaces::new(list, TextureScope::Items, &gpu.limits);
    let plan = Plan::new(list, &places, |_| true);
    let shadows = Shadows::new(list, camera)?;
    let has_shadows = [&shadows.sun, &shadows.sky].map(Option::is_some);
    let parts = ShaderParts::of_picture(list.ground.as_deref(), &list.lighting, has_shadows);
    let (layouts, color, feature) = gpu.guarded("building its shaders", || {
        let layouts = Layouts::new(gpu);
        let shader = shader(gpu);
        let target = |pass, format, samples| {
            Pipelines::new(gpu, &layouts, &shader, PassTarget { pass, format, samples })
        };
        let mut color = target(GpuPass::Color, COLOR, gpu.samples);
        let mut feature = target(GpuPass::Feature, FEATURE, 1);
        let [color_keys, feature_keys] = plan.keys(parts);
        color.make(gpu, color_keys.into_iter().chain([PipelineKey::SKY]));
        feature.make(gpu, feature_keys);
        Ok((layouts, color, feature))
    })?;
    let loaded = gpu.guarded("loading the scene", || {
        let loader = Loader::new(gpu);
        let targets = Targets::new(&loader, camera.size())?;
        let textures = FrameTextures::upload(&loader, list.ground.as_deref(), &shadows)?;
        let frame = FrameGroup::new(&loader, &layouts, &textures)?;
        let shadows = ShadowView::both(&shadows);
        let ground = list.ground.as_deref();
        let row_bits = row_bits(gpu.limits.max_texture_dimension_2d);
        let scene = FrameScene { ground, windows: &[], lighting: &list.lighting, shadows, row_bits };
        frame.write(gpu, &FrameUniforms::new(scene, camera));
        let materials = GpuMaterials::upload(&loader, &layouts, list, &places)?;
        Ok((targets, frame, materials, GpuGeometry::upload(&loader, list, &plan, Some(camera))?))
    });
    let (targets, frame, materials, geometry) = loaded?;
    gpu.guarded("drawing the picture", || {
        let mut encoder = gpu.encoder("picture");
        let is_multisampled = gpu.samples > 1;
        let [samples, resolved, sample_depth, seen, depth] =
            [&targets.samples, &targets.color, &targets.sample_depth, &targets.feature, &targets.depth]
                .map(view);
        let colors = PassViews {
            stage: PassStage::Whole,
            label: "colors",
            color: if is_multisampled { &samples } else { &resolved },
            resolved: is_multisampled.then_some(&resolved),
            depth: &sample_depth,
            timer: None,
        };
        let mut pass = ScenePass::new(colors.begin(&mut encoder, &frame.group), &color, &materials);
        pass.sky();
        pass.draw(&geometry, plan.color.iter().chain(plan.transparent(camera)), parts);
        drop(pass);
        let stage = PassStage::Whole;
        let features =
            PassViews { stage, label: "features", color: &seen, resolved: None, depth: &depth, timer: None };
        let mut pass = ScenePass::new(features.begin(&mut encoder, &frame.group), &feature, &materials);
        pass.draw(&geometry, &plan.features, parts);
        drop(pass);
        targets.read(gpu, encoder)
    })
}

//! Recording the passes of a picture.
//!
//! Colors and features need separate passes: a pixel's color is the mean of its samples, and a mean of two feature
//! numbers is a third feature. Where the ground is shaded pixel by pixel, colors take three passes ([`PassStage`]).

use crate::draw_call::DrawCall;
use crate::geometry::GpuGeometry;
use crate::instance_culling::CulledInstances;
use crate::materials::{ArrayId, GpuMaterials};
use crate::parts::ShaderParts;
use crate::pass_timer::PassTimer;
use crate::pipeline_key::PipelineKey;
use crate::pipelines::Pipelines;

/// The part of a picture that a pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PassStage {
    /// All, over the color black and nothing, and the farthest depth.
    Whole,
    /// Depths, over the farthest one.
    Depths,
    /// Colors, over black and nothing, of what has drawn its depth, which shaders may read meanwhile.
    Pixels,
    /// All else, over both.
    Rest,
}

/// The textures that a pass draws to.
#[derive(Clone, Copy)]
pub struct PassViews<'a> {
    pub stage: PassStage,
    pub label: &'static str,
    pub color: &'a wgpu::TextureView,
    /// Where the samples of `color` are averaged, if it has several.
    pub resolved: Option<&'a wgpu::TextureView>,
    pub depth: &'a wgpu::TextureView,
    /// What times it.
    pub timer: Option<&'a PassTimer>,
}

/// A pass that draws scenes: remembers what is set.
pub struct ScenePass<'e, 'a> {
    pub pass: wgpu::RenderPass<'e>,
    pipelines: &'a Pipelines,
    materials: &'a GpuMaterials,
    pipeline: Option<PipelineKey>,
    array: Option<ArrayId>,
}

impl PassViews<'_> {
    /// Another pass over the same textures.
    pub fn of(self, stage: PassStage, label: &'static str) -> Self {
        Self { stage, label, ..self }
    }

    /// Begins the pass. The farthest depth is zero.
    pub fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
    ) -> wgpu::RenderPass<'e> {
        use wgpu::{LoadOp, StoreOp};
        let store = if self.resolved.is_some() { StoreOp::Discard } else { StoreOp::Store };
        let (color_load, depth_ops) = match self.stage {
            PassStage::Whole => {
                (Some(LoadOp::Clear(wgpu::Color::TRANSPARENT)), Some((LoadOp::Clear(0.0), StoreOp::Discard)))
            }
            PassStage::Depths => (None, Some((LoadOp::Clear(0.0), StoreOp::Store))),
            PassStage::Pixels => (Some(LoadOp::Clear(wgpu::Color::TRANSPARENT)), None),
            PassStage::Rest => (Some(LoadOp::Load), Some((LoadOp::Load, StoreOp::Discard))),
        };
        let color = color_load.map(|load| wgpu::RenderPassColorAttachment {
            view: self.color,
            depth_slice: None,
            resolve_target: self.resolved,
            ops: wgpu::Operations { load, store },
        });
        let depth_ops = depth_ops.map(|(load, store)| wgpu::Operations { load, store });
        let depth = wgpu::RenderPassDepthStencilAttachment { view: self.depth, depth_ops, stencil_ops: None };
        let colors = [color];
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.label),
            color_attachments: if self.stage == PassStage::Depths { &[] } else { &colors },
            depth_stencil_attachment: Some(depth),
            timestamp_writes: self.timer.and_then(|timer| timer.writes(self.label)),
            ..Default::default()
        });
        pass.set_bind_group(0, frame, &[]);
        pass
    }
}

impl<'e, 'a> ScenePass<'e, 'a> {
    pub fn new(pass: wgpu::RenderPass<'e>, pipelines: &'a Pipelines, materials: &'a GpuMaterials) -> Self {
        Self { pass, pipelines, materials, pipeline: None, array: None }
    }

    /// Draws the backdrop.
    pub fn sky(&mut self) {
        if let Some(sky) = self.pipelines.get(PipelineKey::SKY) {
            self.pass.set_pipeline(sky);
            self.pass.draw(0..3, 0..1);
            self.pipeline = None;
        }
    }

    /// Shades the ground whose depths are drawn and read as group 2.
    pub fn ground_pixels(&mut self, key: PipelineKey, depths: &wgpu::BindGroup) {
        if let Some(pixels) = self.pipelines.get(key) {
            self.pass.set_pipeline(pixels);
            self.pass.set_bind_group(2, depths, &[]);
            self.pass.draw(0..3, 0..1);
            self.pipeline = None;
        }
    }

    /// Draws calls of a picture that has the parts `picture`.
    pub fn draw<'c>(
        &mut self,
        geometry: &GpuGeometry,
        calls: impl IntoIterator<Item = &'c DrawCall>,
        picture: ShaderParts,
    ) {
        for call in calls {
            if self.set(call.key(picture), call.array) {
                geometry.draw(&mut self.pass, &call.shape);
            }
        }
    }

    /// Draws what `culled` has found to be seen of the culled runs of a plan, in their order.
    pub fn draw_seen(
        &mut self,
        geometry: &GpuGeometry,
        (runs, culled): (&[DrawCall], &CulledInstances),
        picture: ShaderParts,
    ) {
        for (run, call) in runs.iter().enumerate() {
            if self.set(call.key(picture), call.array) {
                geometry.draw_seen(&mut self.pass, (run, &call.shape), culled);
            }
        }
    }

    /// Sets what draws with `key` and the textures of `array`; false where there is no such pipeline.
    pub fn set(&mut self, key: PipelineKey, array: ArrayId) -> bool {
        if self.pipeline != Some(key) {
            let Some(pipeline) = self.pipelines.get(key) else { return false };
            self.pass.set_pipeline(pipeline);
            self.pipeline = Some(key);
        }
        if self.array != Some(array) {
            self.pass.set_bind_group(1, self.materials.group(array), &[]);
            self.array = Some(array);
        }
        true
    }
}

//! Recording the two passes of a picture.
//!
//! Colors and features need separate passes: a pixel's color is the mean of its samples, and a mean of two feature
//! numbers is a third feature.

use crate::render::gpu::geometry::GpuGeometry;
use crate::render::gpu::materials::{ArrayId, GpuMaterials};
use crate::render::gpu::parts::ShaderParts;
use crate::render::gpu::pipelines::Pipelines;
use crate::render::gpu::plan::{DrawCall, PipelineKey};

/// The textures that a pass draws to.
pub struct PassViews<'a> {
    pub label: &'static str,
    pub color: &'a wgpu::TextureView,
    /// Where the samples of `color` are averaged, if it has several.
    pub resolved: Option<&'a wgpu::TextureView>,
    pub depth: &'a wgpu::TextureView,
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
    /// Begins the pass, with the color black and nothing, and the depth cleared to zero: the farthest.
    pub fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
    ) -> wgpu::RenderPass<'e> {
        let store = if self.resolved.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
        let color = wgpu::RenderPassColorAttachment {
            view: self.color,
            depth_slice: None,
            resolve_target: self.resolved,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store },
        };
        let depth_ops =
            Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard });
        let depth = wgpu::RenderPassDepthStencilAttachment { view: self.depth, depth_ops, stencil_ops: None };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.label),
            color_attachments: &[Some(color)],
            depth_stencil_attachment: Some(depth),
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

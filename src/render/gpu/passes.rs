//! Recording the two passes of a picture.
//!
//! Colors and features need separate passes: a pixel's color is the mean of its samples, and a mean of two feature
//! numbers is a third feature.

use crate::draw::list::DrawList;
use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::memory::view;
use crate::render::gpu::pipelines::{GpuPass, Pipelines};
use crate::render::gpu::plan::{DrawCall, PipelineKey, Plan};
use crate::render::gpu::readback::Targets;
use crate::render::gpu::uniforms::Instance;
use crate::render::gpu::upload::Resources;

pub struct Recording<'a> {
    pub gpu: &'a Gpu,
    pub list: &'a DrawList,
    pub plan: &'a Plan,
    pub pipelines: &'a Pipelines,
    pub resources: &'a Resources,
    pub targets: &'a Targets,
}

impl Recording<'_> {
    pub fn record(&self) -> wgpu::CommandEncoder {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.colors(&mut encoder);
        self.features(&mut encoder);
        encoder
    }

    fn colors(&self, encoder: &mut wgpu::CommandEncoder) {
        let (samples, color) = (view(&self.targets.samples), view(&self.targets.color));
        let is_multisampled = self.gpu.samples > 1;
        let attachment = wgpu::RenderPassColorAttachment {
            view: if is_multisampled { &samples } else { &color },
            depth_slice: None,
            resolve_target: is_multisampled.then_some(&color),
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: if is_multisampled { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
            },
        };
        let mut pass = self.begin(encoder, attachment, &self.targets.sample_depth);
        if let Some(sky) = self.pipelines.get(GpuPass::Color, PipelineKey::SKY) {
            pass.set_pipeline(sky);
            pass.draw(0..3, 0..1);
        }
        self.draw(&mut pass, GpuPass::Color, &self.plan.color);
    }

    fn features(&self, encoder: &mut wgpu::CommandEncoder) {
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view(&self.targets.feature),
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        };
        let mut pass = self.begin(encoder, attachment, &self.targets.depth);
        self.draw(&mut pass, GpuPass::Feature, &self.plan.features);
    }

    /// A pass that draws to `color`, with `depth` cleared to zero: the farthest.
    fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        color: wgpu::RenderPassColorAttachment,
        depth: &wgpu::Texture,
    ) -> wgpu::RenderPass<'e> {
        let depth_ops =
            Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard });
        let depth =
            wgpu::RenderPassDepthStencilAttachment { view: &view(depth), depth_ops, stencil_ops: None };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(color)],
            depth_stencil_attachment: Some(depth),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.resources.frame, &[]);
        pass
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, which: GpuPass, calls: &[DrawCall]) {
        let mut bound = None;
        for call in calls {
            let item = &self.list.items[call.items.start];
            let (Some(pipeline), Some(mesh)) =
                (self.pipelines.get(which, call.key), &self.resources.meshes[item.mesh.0 as usize])
            else {
                continue;
            };
            let texture = self.resources.texture_of(&self.list.materials[item.material.0 as usize]);
            let surface = item.material.0 * self.resources.surface_stride;
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, &self.resources.surfaces, &[surface]);
            pass.set_bind_group(2, texture, &[]);
            if bound != Some(item.mesh) {
                pass.set_vertex_buffer(0, mesh.vertices.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
                bound = Some(item.mesh);
            }
            // Bound at the first instance and counted from zero: OpenGL ES has no first instance.
            let first = (call.items.start * size_of::<Instance>()) as u64;
            pass.set_vertex_buffer(1, self.resources.instances.slice(first..));
            let count = call.items.len() as u32;
            pass.draw_indexed(item.triangles.start * 3..item.triangles.end * 3, 0, 0..count);
        }
    }
}

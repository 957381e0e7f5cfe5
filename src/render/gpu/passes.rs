//! Recording the two passes of a picture.
//!
//! Colors and features are separate passes because a pixel's color is an average of samples and its
//! feature must not be: an average of two feature numbers is a third feature.

use crate::draw::list::DrawList;
use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::pipelines::{GpuPass, Pipelines};
use crate::render::gpu::plan::{DrawCall, Plan};
use crate::render::gpu::readback::Targets;
use crate::render::gpu::uniforms::Instance;
use crate::render::gpu::upload::Resources;

/// Everything that recording reads.
pub(in crate::render::gpu) struct Recording<'a> {
    pub gpu: &'a Gpu,
    pub list: &'a DrawList,
    pub plan: &'a Plan,
    pub pipelines: &'a Pipelines,
    pub resources: &'a Resources,
    pub targets: &'a Targets,
}

impl Recording<'_> {
    /// Records both passes.
    pub fn record(&self) -> wgpu::CommandEncoder {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.colors(&mut encoder);
        self.features(&mut encoder);
        encoder
    }

    fn colors(&self, encoder: &mut wgpu::CommandEncoder) {
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let (samples, color, depth) =
            (view(&self.targets.samples), view(&self.targets.color), view(&self.targets.sample_depth));
        let many = self.gpu.samples > 1;
        let attachment = wgpu::RenderPassColorAttachment {
            view: if many { &samples } else { &color },
            depth_slice: None,
            resolve_target: many.then_some(&color),
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: if many { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
            },
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("colors"),
            color_attachments: &[Some(attachment)],
            depth_stencil_attachment: Some(cleared_depth(&depth)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.resources.frame, &[]);
        pass.set_pipeline(&self.pipelines.sky);
        pass.draw(0..3, 0..1);
        self.draw(&mut pass, GpuPass::Color, &self.plan.color);
    }

    fn features(&self, encoder: &mut wgpu::CommandEncoder) {
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let (feature, depth) = (view(&self.targets.feature), view(&self.targets.depth));
        let attachment = wgpu::RenderPassColorAttachment {
            view: &feature,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("features"),
            color_attachments: &[Some(attachment)],
            depth_stencil_attachment: Some(cleared_depth(&depth)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.resources.frame, &[]);
        self.draw(&mut pass, GpuPass::Feature, &self.plan.features);
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, which: GpuPass, steps: &[DrawCall]) {
        let mut bound = None;
        for step in steps {
            let item = &self.list.items[step.items.start];
            let (Some(pipeline), Some(mesh)) =
                (self.pipelines.get(which, step), &self.resources.meshes[item.mesh.0 as usize])
            else {
                continue;
            };
            let texture = self.resources.texture_of(&self.list.materials[item.material.0 as usize]);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(
                1,
                &self.resources.surfaces,
                &[item.material.0 * self.resources.surface_stride],
            );
            pass.set_bind_group(2, texture, &[]);
            if bound != Some(item.mesh) {
                pass.set_vertex_buffer(0, mesh.vertices.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
                bound = Some(item.mesh);
            }
            // Bound at the first instance and counted from zero: OpenGL ES knows no other way.
            let first = (step.items.start * size_of::<Instance>()) as u64;
            pass.set_vertex_buffer(1, self.resources.instances.slice(first..));
            let count = step.items.len() as u32;
            pass.draw_indexed(item.triangles.start * 3..item.triangles.end * 3, 0, 0..count);
        }
    }
}

/// Cleared to zero, which is the farthest there is.
fn cleared_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
        stencil_ops: None,
    }
}

//! Encoding colors for a window whose texture does not do it.

use crate::adapter::Gpu;
use crate::memory::bind;
use crate::painting::{Painting, PaintingPipeline};
use crate::pass_timer::PassTimer;

pub const ENCODE_SHADER: &str =
    concat!(include_str!("../whole_picture.wgsl"), "\n", include_str!("../encode.wgsl"));

/// Encodes linear colors as sRGB.
#[derive(Debug)]
pub struct Encoder(PaintingPipeline);

impl Encoder {
    /// An encoder for a window's texture of `format`.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let painting = Painting {
            label: "encode colors",
            shader: ENCODE_SHADER,
            vertex: "whole_picture",
            fragment: "encode_color",
            reads: &[wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            }],
        };
        Self(painting.pipeline(&gpu.device, format))
    }

    /// Records the encoding of a texture of linear colors to another one of the same size.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (linear, target): (&wgpu::TextureView, &wgpu::TextureView),
        timer: Option<&PassTimer>,
    ) {
        let label = "encode colors";
        let group = bind(gpu, label, &self.0.layout, [wgpu::BindingResource::TextureView(linear)]);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            timestamp_writes: timer.and_then(|timer| timer.writes(label)),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.0.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

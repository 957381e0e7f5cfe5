//! The scene's picture among the panels, by a shader of its own.
//!
//! Mesa's Vulkan on the processor paints bytes instead of floats, several times as fast, where two triangles are a rectangle, the
//! shader does nothing but read a texture at places between its corners, and that texture and the target have blue first. It
//! knows such places where they are parts of a vector of four.

use egui::{PaintCallbackInfo, Rect, Shape};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait};

use sandtable_gpu::adapter::{Gpu, GpuApi};
use sandtable_gpu::painting::{Painting, PaintingPipeline};

/// The corners of two triangles.
const CORNERS: u32 = 6;

/// The name of what paints in the messages of drivers and debuggers.
const LABEL: &str = "picture of the scene";

/// What paints the picture; among the resources of the panels' painter.
pub struct PicturePaint {
    painting: PaintingPipeline,
    /// For a picture that has all pixels of its place, and for one that has fewer.
    samplers: [wgpu::Sampler; 2],
    /// The picture; `None` before the first.
    shown: Option<wgpu::BindGroup>,
}

/// The place of the picture among the panels.
struct PicturePlace;

/// The shape that shows the picture in a place of the window; nothing where there is no picture.
pub fn picture_shape(place: Rect) -> Shape {
    Callback::new_paint_callback(place, PicturePlace).into()
}

impl PicturePaint {
    /// What paints on textures of `format`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let painting = Painting {
            label: LABEL,
            shader: include_str!("picture_paint.wgsl"),
            vertex: "whole_view",
            fragment: if format.is_srgb() { "linear_color" } else { "encoded_color" },
            reads: &[texture, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)],
        };
        let samplers = [wgpu::FilterMode::Nearest, wgpu::FilterMode::Linear].map(|filter| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(LABEL),
                mag_filter: filter,
                min_filter: filter,
                ..Default::default()
            })
        });
        Self { painting: painting.pipeline(device, format), samplers, shown: None }
    }

    /// Shows `picture`, whose pixels and those of its place go together by `fit`.
    pub fn show(&mut self, device: &wgpu::Device, picture: &wgpu::TextureView, fit: PictureFit) {
        let sampler = &self.samplers[fit as usize];
        self.shown = Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(LABEL),
            layout: &self.painting.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(picture) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
            ],
        }));
    }
}

/// The format of colors as they are shown in which a device paints the picture fastest.
pub fn blended_format(gpu: &Gpu) -> wgpu::TextureFormat {
    match (gpu.is_software(), gpu.api()) {
        (true, GpuApi::Vulkan) => wgpu::TextureFormat::Bgra8Unorm,
        _ => wgpu::TextureFormat::Rgba8Unorm,
    }
}

/// How the pixels of a picture and those of its place go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFit {
    /// One to one.
    Whole = 0,
    /// The picture has fewer.
    Stretched = 1,
}

impl CallbackTrait for PicturePlace {
    fn paint(
        &self,
        _: PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        let paint = resources.get::<PicturePaint>();
        let Some((paint, shown)) = paint.and_then(|paint| Some((paint, paint.shown.as_ref()?))) else {
            return;
        };
        pass.set_pipeline(&paint.painting.pipeline);
        pass.set_bind_group(0, shown, &[]);
        pass.draw(0..CORNERS, 0..1);
    }
}

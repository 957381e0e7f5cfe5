//! The fixed part of drawing: shaders and one pipeline for each kind of draw call.

use std::collections::BTreeMap;

use crate::adapter::{Gpu, GpuApi};
use crate::draped_vertex::DrapedVertex;
use crate::formats::DEPTH;
use crate::layouts::{Layouts, pipeline_layout};
use crate::merged_vertex::MergedVertex;
use crate::pipeline_key::{DepthRule, PipelineKey, VertexSource};
use crate::uniforms::Instance;
use sandtable_draw::list::{DRAPE_TOLERANCE, DrawVertex};
use sandtable_draw::shader_constants::{ShaderLanguage, shader_constants};
use sandtable_render::shadow::filter;

/// The factor by which a drape counts as nearer than it is.
const DRAPE_NEARER: f64 = 1.0 + DRAPE_TOLERANCE;

/// The factor by which lines along the ground count as nearer: a line passes the centers of pixels at up to half a pixel's
/// distance, where slopes are nearer or farther than it is.
const LINES_NEARER: f64 = 1.0 + 1.0 / 1000.0;

/// The same as a part of a pixel. Hardware snaps corners to a grid of 1/256 pixel, moving each by up to 0.7 of half a
/// step. A drape has corners that the ground lacks; four times that covers both.
const DRAPE_NEARER_PX: f32 = 1.0 / 128.0;

/// The shaders, with the constants that they share with the renderer on the processor.
pub fn shader_text() -> String {
    let constants = [shader_constants(), filter::shader_constants()].concat();
    ShaderLanguage::Wgsl.declarations(&constants) + SHADER
}

const SHADER: &str = concat!(
    include_str!("items.wgsl"),
    "\n",
    include_str!("shadow_pages.wgsl"),
    "\n",
    include_str!("shader.wgsl"),
    "\n",
    include_str!("area.wgsl"),
    "\n",
    include_str!("ground_windows.wgsl"),
    "\n",
    include_str!("ground_pixels.wgsl"),
    "\n",
    include_str!("whole_picture.wgsl"),
    "\n",
    include_str!("sky.wgsl")
);

/// Corners with their owners.
pub const MERGED_BUFFERS: [Option<wgpu::VertexBufferLayout>; 1] = [Some(wgpu::VertexBufferLayout {
    array_stride: size_of::<MergedVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Unorm8x4, 4 => Uint32, 5 => Uint32,
    ],
})];

/// Corners of what lies on the ground.
const DRAPED_BUFFERS: [Option<wgpu::VertexBufferLayout>; 1] = [Some(wgpu::VertexBufferLayout {
    array_stride: size_of::<DrapedVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32x2, 2 => Unorm16x4, 3 => Snorm8x4, 4 => Uint32,
    ],
})];

/// Corners, and instances.
pub const PLACED_BUFFERS: [Option<wgpu::VertexBufferLayout>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<DrawVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Unorm8x4,
        ],
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<Instance>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![
            4 => Uint32, 5 => Uint32, 6 => Float32x4, 7 => Float32x4, 8 => Float32x4, 9 => Float32x4,
        ],
    }),
];

/// Positions.
const PATCH_BUFFERS: [Option<wgpu::VertexBufferLayout>; 1] = [Some(wgpu::VertexBufferLayout {
    array_stride: size_of::<[f32; 3]>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3],
})];

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GpuPass {
    /// Colors, several samples per pixel.
    Color,
    /// Features and depths at pixels' centers.
    Feature,
}

/// The targets that pipelines draw to.
#[derive(Clone, Copy, Debug)]
pub struct PassTarget {
    pub pass: GpuPass,
    pub format: wgpu::TextureFormat,
    pub samples: u32,
}

/// The pipelines of a pass, each made at first use.
#[derive(Clone, Debug)]
pub struct Pipelines {
    target: PassTarget,
    shader: wgpu::ShaderModule,
    items: wgpu::PipelineLayout,
    sky: wgpu::PipelineLayout,
    pixels: wgpu::PipelineLayout,
    by_key: BTreeMap<PipelineKey, wgpu::RenderPipeline>,
}

impl Pipelines {
    pub fn new(gpu: &Gpu, layouts: &Layouts, shader: &wgpu::ShaderModule, target: PassTarget) -> Self {
        let layout = |label, groups: &[_]| pipeline_layout(gpu, label, groups);
        Self {
            target,
            shader: shader.clone(),
            items: layout("items", &[Some(&layouts.frame), Some(&layouts.materials)]),
            sky: layout("sky", &[Some(&layouts.frame)]),
            pixels: layout("pixels", &[Some(&layouts.frame), None, Some(&layouts.depths)]),
            by_key: BTreeMap::new(),
        }
    }

    /// Makes those pipelines that are missing.
    pub fn make(&mut self, gpu: &Gpu, keys: impl IntoIterator<Item = PipelineKey>) {
        for key in keys {
            if !self.by_key.contains_key(&key) {
                let made = self.pipeline(gpu, key);
                self.by_key.insert(key, made);
            }
        }
    }

    /// Whether those of all these keys are made.
    pub fn has_all(&self, keys: &[PipelineKey]) -> bool {
        keys.iter().all(|key| self.by_key.contains_key(key))
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.by_key.len()
    }

    /// Takes over pipelines that were made elsewhere for the same target.
    pub fn adopt(&mut self, made: Self) {
        self.by_key.extend(made.by_key);
    }

    /// Whether the ground of a window is shaded pixel by pixel, once its depths are drawn, rather than triangle by triangle:
    /// where a pixel has one sample, so that its depth is that of all of it. OpenGL's shaders cannot read depths.
    pub fn shade_pixels(&self, gpu: &Gpu) -> bool {
        self.target.samples == 1 && gpu.api() == GpuApi::Vulkan
    }

    /// The pipeline of a key; `None` before it is made.
    pub fn get(&self, key: PipelineKey) -> Option<&wgpu::RenderPipeline> {
        self.by_key.get(&key)
    }

    fn pipeline(&self, gpu: &Gpu, key: PipelineKey) -> wgpu::RenderPipeline {
        let Self { target, shader, .. } = self;
        let nearer = match key.rule {
            DepthRule::Drape => DRAPE_NEARER,
            DepthRule::Lines => LINES_NEARER,
            DepthRule::Solid | DepthRule::Blend | DepthRule::Sky | DepthRule::DepthOnly | DepthRule::Seen => {
                1.0
            }
        };
        let nearer_px = if key.rule == DepthRule::Drape { f64::from(DRAPE_NEARER_PX) } else { 0.0 };
        let vertex_constants = [("nearer", nearer)];
        let textured = f64::from(u8::from(key.textured));
        let parts = f64::from(key.parts.0);
        let fragment_constants =
            [("nearer", nearer), ("nearer_px", nearer_px), ("textured", textured), ("parts", parts)];
        let is_sky = key.rule == DepthRule::Sky;
        let layout = match key.rule {
            DepthRule::Sky => &self.sky,
            DepthRule::Seen => &self.pixels,
            _ => &self.items,
        };
        let (vertex, buffers) = match key.source {
            VertexSource::Merged => ("merged_vertex", &MERGED_BUFFERS[..]),
            VertexSource::Draped => ("draped_vertex", &DRAPED_BUFFERS[..]),
            VertexSource::Placed => ("placed_vertex", &PLACED_BUFFERS[..]),
            VertexSource::Patch if key.rule == DepthRule::DepthOnly => ("patch_depth", &PATCH_BUFFERS[..]),
            VertexSource::Patch => ("patch_vertex", &PATCH_BUFFERS[..]),
            VertexSource::None => ("whole_picture", &[][..]),
        };
        let fragment = match (target.pass, gpu.api()) {
            _ if is_sky => "sky_color",
            _ if key.rule == DepthRule::Seen => "ground_pixel",
            _ if key.rule == DepthRule::Lines => "line_color",
            (GpuPass::Feature, _) => "feature",
            (GpuPass::Color, GpuApi::Gl) => "color_and_depth",
            (GpuPass::Color, GpuApi::Vulkan) if key.masked && target.samples == 4 => "masked_color",
            (GpuPass::Color, GpuApi::Vulkan) => "color",
        };
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&format!("{vertex}, {fragment}, {:?}", key.rule)),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module: shader,
                entry_point: Some(vertex),
                compilation_options: options(if buffers.is_empty() { &[] } else { &vertex_constants }),
                buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology: match key.rule {
                    DepthRule::Lines => wgpu::PrimitiveTopology::LineList,
                    _ => wgpu::PrimitiveTopology::TriangleList,
                },
                cull_mode: (!key.two_sided).then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: Some(depth_state(key.rule)),
            multisample: wgpu::MultisampleState { count: target.samples, ..Default::default() },
            fragment: (key.rule != DepthRule::DepthOnly).then_some(wgpu::FragmentState {
                module: shader,
                entry_point: Some(fragment),
                compilation_options: options(if is_sky { &[] } else { &fragment_constants }),
                targets: &[Some(color_target(target, key.rule))],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// The shaders, compiled by the driver where a pipeline uses them.
pub fn shader(gpu: &Gpu) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("sandtable"),
        source: wgpu::ShaderSource::Wgsl(shader_text().into()),
    })
}

pub fn options<'a>(constants: &'a [(&'a str, f64)]) -> wgpu::PipelineCompilationOptions<'a> {
    wgpu::PipelineCompilationOptions { constants, ..Default::default() }
}

/// Depth is reversed: greater is nearer.
fn depth_state(rule: DepthRule) -> wgpu::DepthStencilState {
    let (writes, compare) = match rule {
        // What covers the picture is as far as can be.
        DepthRule::Sky => (false, wgpu::CompareFunction::GreaterEqual),
        DepthRule::Solid | DepthRule::DepthOnly => (true, wgpu::CompareFunction::Greater),
        DepthRule::Seen => (false, wgpu::CompareFunction::Less),
        DepthRule::Blend => (false, wgpu::CompareFunction::Greater),
        DepthRule::Drape | DepthRule::Lines => (false, wgpu::CompareFunction::GreaterEqual),
    };
    // Where the shader writes the depth this has no effect, and `nearer_px` does the same.
    let slope_scale = if rule == DepthRule::Drape { DRAPE_NEARER_PX } else { 0.0 };
    wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(writes),
        depth_compare: Some(compare),
        stencil: Default::default(),
        bias: wgpu::DepthBiasState { slope_scale, ..Default::default() },
    }
}

fn color_target(target: &PassTarget, rule: DepthRule) -> wgpu::ColorTargetState {
    let blends = matches!(rule, DepthRule::Blend | DepthRule::Drape | DepthRule::Lines)
        && target.pass == GpuPass::Color;
    wgpu::ColorTargetState {
        format: target.format,
        blend: blends.then_some(wgpu::BlendState::ALPHA_BLENDING),
        write_mask: wgpu::ColorWrites::ALL,
    }
}

#[cfg(test)]
mod tests {
    use wgpu::naga;

    use super::*;
    use crate::uniforms::{FrameUniforms, SurfaceConstants};

    #[test]
    fn the_shader_is_valid_without_any_gpu() {
        let text = shader_text();
        let module = naga::front::wgsl::parse_str(&text)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
        let flags = naga::valid::ValidationFlags::all();
        naga::valid::Validator::new(flags, naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
        let names: Vec<&str> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "merged_vertex",
                "draped_vertex",
                "placed_vertex",
                "patch_vertex",
                "patch_depth",
                "line_color",
                "color",
                "masked_color",
                "color_and_depth",
                "feature",
                "ground_pixel",
                "whole_picture",
                "sky_color",
            ]
        );
    }

    #[test]
    fn the_constants_are_laid_out_as_the_shader_declares_them() {
        let module = naga::front::wgsl::parse_str(&shader_text()).expect("valid, by the test above");
        let size_of_struct = |name: &str| {
            let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
            match found.map(|(_, ty)| &ty.inner) {
                Some(naga::TypeInner::Struct { span, .. }) => *span as usize,
                other => panic!("{name} is {other:?}"),
            }
        };
        assert_eq!(size_of_struct("Frame"), size_of::<FrameUniforms>());
        // The numbers of an area's texture lie behind it.
        let area = size_of::<[[f32; 4]; 9]>();
        assert_eq!(size_of_struct("Surface") + area, size_of::<SurfaceConstants>());
    }
}

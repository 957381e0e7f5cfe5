//! The fixed part of drawing: shader, bindings and one pipeline for each kind of draw call.

use std::collections::BTreeMap;

use crate::draw::list::{DRAPE_TOLERANCE, DrawVertex};
use crate::render::gpu::adapter::{Gpu, GpuApi};
use crate::render::gpu::plan::{DepthRule, PipelineKey, Plan};
use crate::render::gpu::uniforms::{FrameUniforms, Instance, SurfaceConstants};

pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// The format of depth. Reversed depth needs floats: their resolution near zero is why it is reversed.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Feature numbers and the bits of depths in meters: integers, because OpenGL ES need not draw to floats.
pub const FEATURE: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// The factor by which a drape counts as nearer than it is.
const DRAPE_NEARER: f64 = 1.0 + DRAPE_TOLERANCE;

/// The same as a part of a pixel. Hardware snaps corners to a grid of 1/256 pixel, moving each by up to 0.7 of half a
/// step. A drape has corners that the ground lacks; four times that covers both.
const DRAPE_NEARER_PX: f32 = 1.0 / 128.0;

const SHADER: &str = concat!(include_str!("shader.wgsl"), "\n", include_str!("sky.wgsl"));

/// Vertices and instances.
const VERTEX_BUFFERS: [Option<wgpu::VertexBufferLayout>; 2] = [
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
            4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32x4, 8 => Uint32,
        ],
    }),
];

#[derive(Debug)]
pub struct Layouts {
    /// Group 0: constants, ground posts, ramp, shadows, the draped picture and its sampler.
    pub frame: wgpu::BindGroupLayout,
    /// Group 1: a material's constants, at a dynamic offset.
    pub surface: wgpu::BindGroupLayout,
    /// Group 2: the base color texture and its sampler.
    pub texture: wgpu::BindGroupLayout,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GpuPass {
    /// Colors, several samples per pixel.
    Color,
    /// Features and depths at pixels' centers.
    Feature,
}

#[derive(Debug)]
pub struct Pipelines {
    by_key: BTreeMap<(GpuPass, PipelineKey), wgpu::RenderPipeline>,
}

impl Layouts {
    pub fn new(gpu: &Gpu) -> Self {
        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let texture = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let uniform = |size: usize, has_dynamic_offset| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: wgpu::BufferSize::new(size as u64),
        };
        let group = |bindings: &[(wgpu::ShaderStages, wgpu::BindingType)]| {
            let entry = |(binding, &(visibility, ty))| wgpu::BindGroupLayoutEntry {
                binding,
                visibility,
                ty,
                count: None,
            };
            let entries: Vec<_> = (0..).zip(bindings).map(entry).collect();
            let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries };
            gpu.device.create_bind_group_layout(&descriptor)
        };
        Self {
            frame: group(&[
                (both, uniform(size_of::<FrameUniforms>(), false)),
                (fragment, texture(wgpu::TextureSampleType::Uint)),
                (fragment, texture(wgpu::TextureSampleType::Uint)),
                (fragment, texture(wgpu::TextureSampleType::Float { filterable: false })),
                (fragment, texture(wgpu::TextureSampleType::Uint)),
                (fragment, texture(wgpu::TextureSampleType::Float { filterable: false })),
                (fragment, texture(wgpu::TextureSampleType::Float { filterable: true })),
                (fragment, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ]),
            surface: group(&[(both, uniform(size_of::<SurfaceConstants>(), true))]),
            texture: group(&[
                (fragment, texture(wgpu::TextureSampleType::Float { filterable: true })),
                (fragment, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ]),
        }
    }
}

impl Pipelines {
    pub fn new(gpu: &Gpu, layouts: &Layouts, plan: &Plan) -> Self {
        let shader = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("sandtable"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let layout = |bind_group_layouts: &[Option<&wgpu::BindGroupLayout>]| {
            let immediate_size = 0;
            let descriptor =
                wgpu::PipelineLayoutDescriptor { label: None, bind_group_layouts, immediate_size };
            gpu.device.create_pipeline_layout(&descriptor)
        };
        let items = layout(&[Some(&layouts.frame), Some(&layouts.surface), Some(&layouts.texture)]);
        let sky = layout(&[Some(&layouts.frame)]);
        let mut by_key = BTreeMap::new();
        by_key.insert(
            (GpuPass::Color, PipelineKey::SKY),
            pipeline(gpu, &sky, &shader, GpuPass::Color, PipelineKey::SKY),
        );
        let color = plan.color.iter().map(|call| (GpuPass::Color, call.key));
        let features = plan.features.iter().map(|call| (GpuPass::Feature, call.key));
        for (pass, key) in color.chain(features) {
            by_key.entry((pass, key)).or_insert_with(|| pipeline(gpu, &items, &shader, pass, key));
        }
        Self { by_key }
    }

    pub fn get(&self, pass: GpuPass, key: PipelineKey) -> Option<&wgpu::RenderPipeline> {
        self.by_key.get(&(pass, key))
    }
}

fn pipeline(
    gpu: &Gpu,
    layout: &wgpu::PipelineLayout,
    shader: &wgpu::ShaderModule,
    pass: GpuPass,
    key: PipelineKey,
) -> wgpu::RenderPipeline {
    let (nearer, nearer_px) =
        if key.rule.is_drape_color() { (DRAPE_NEARER, f64::from(DRAPE_NEARER_PX)) } else { (1.0, 0.0) };
    let vertex_constants = [("nearer", nearer)];
    let fragment_constants = [("nearer", nearer), ("nearer_px", nearer_px)];
    let is_sky = key.rule == DepthRule::Sky;
    let entry_point = match (pass, gpu.api()) {
        _ if is_sky => "sky_color",
        (GpuPass::Feature, _) => "feature",
        (GpuPass::Color, GpuApi::Gl) => "color_and_depth",
        (GpuPass::Color, GpuApi::Vulkan) if key.masked && gpu.samples == 4 => "masked_color",
        (GpuPass::Color, GpuApi::Vulkan) => "color",
    };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(entry_point),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some(if is_sky { "sky_vertex" } else { "vertex" }),
            compilation_options: options(if is_sky { &[] } else { &vertex_constants }),
            buffers: if is_sky { &[] } else { &VERTEX_BUFFERS },
        },
        primitive: wgpu::PrimitiveState {
            cull_mode: (!key.two_sided).then_some(wgpu::Face::Back),
            ..Default::default()
        },
        depth_stencil: Some(depth_state(key.rule)),
        multisample: wgpu::MultisampleState {
            count: if pass == GpuPass::Color { gpu.samples } else { 1 },
            ..Default::default()
        },
        fragment: Some(wgpu::FragmentState {
            module: shader,
            entry_point: Some(entry_point),
            compilation_options: options(if is_sky { &[] } else { &fragment_constants }),
            targets: &target(pass, key.rule),
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn options<'a>(constants: &'a [(&'a str, f64)]) -> wgpu::PipelineCompilationOptions<'a> {
    wgpu::PipelineCompilationOptions { constants, ..Default::default() }
}

/// Depth is reversed: greater is nearer.
fn depth_state(rule: DepthRule) -> wgpu::DepthStencilState {
    let (writes, compare) = match rule {
        DepthRule::Sky => (false, wgpu::CompareFunction::Always),
        DepthRule::Solid => (true, wgpu::CompareFunction::Greater),
        DepthRule::Blend => (false, wgpu::CompareFunction::Greater),
        DepthRule::Drape | DepthRule::DrapeBlend => (false, wgpu::CompareFunction::GreaterEqual),
        DepthRule::DrapeDepth => (true, wgpu::CompareFunction::GreaterEqual),
    };
    // Where the shader writes the depth this has no effect, and `nearer_px` does the same.
    let slope_scale = if rule.is_drape_color() { DRAPE_NEARER_PX } else { 0.0 };
    wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(writes),
        depth_compare: Some(compare),
        stencil: Default::default(),
        bias: wgpu::DepthBiasState { slope_scale, ..Default::default() },
    }
}

fn target(pass: GpuPass, rule: DepthRule) -> [Option<wgpu::ColorTargetState>; 1] {
    let write_mask = match rule {
        DepthRule::DrapeDepth => wgpu::ColorWrites::empty(),
        _ => wgpu::ColorWrites::ALL,
    };
    let blends = matches!(rule, DepthRule::Blend | DepthRule::DrapeBlend) && pass == GpuPass::Color;
    let blend = blends.then_some(wgpu::BlendState::ALPHA_BLENDING);
    let format = match pass {
        GpuPass::Color => COLOR,
        GpuPass::Feature => FEATURE,
    };
    [Some(wgpu::ColorTargetState { format, blend, write_mask })]
}

#[cfg(test)]
mod tests {
    use wgpu::naga;

    use super::*;

    #[test]
    fn the_shader_is_valid_without_any_gpu() {
        let module = naga::front::wgsl::parse_str(SHADER)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(SHADER)));
        let flags = naga::valid::ValidationFlags::all();
        naga::valid::Validator::new(flags, naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(SHADER)));
        let names: Vec<&str> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(
            names,
            ["vertex", "color", "masked_color", "color_and_depth", "feature", "sky_vertex", "sky_color",]
        );
    }

    #[test]
    fn the_constants_are_laid_out_as_the_shader_declares_them() {
        let module = naga::front::wgsl::parse_str(SHADER).expect("valid, by the test above");
        let size_of_struct = |name: &str| {
            let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
            match found.map(|(_, ty)| &ty.inner) {
                Some(naga::TypeInner::Struct { span, .. }) => *span as usize,
                other => panic!("{name} is {other:?}"),
            }
        };
        assert_eq!(size_of_struct("Frame"), size_of::<FrameUniforms>());
        assert_eq!(size_of_struct("Surface"), size_of::<SurfaceConstants>());
    }
}

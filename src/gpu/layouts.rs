//! The bindings of shaders: what each group holds, for all pipelines alike.

use crate::adapter::Gpu;
use crate::uniforms::FrameUniforms;

#[derive(Debug)]
pub struct Layouts {
    /// Group 0: constants, ground posts, ramp, shadows, the draped picture and its sampler, windows of finer posts.
    pub frame: wgpu::BindGroupLayout,
    /// Group 1: the table of materials, an array of textures and its sampler.
    pub materials: wgpu::BindGroupLayout,
    /// Group 2 where the ground is shaded pixel by pixel: its depths.
    pub depths: wgpu::BindGroupLayout,
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
        let uniform = |size: usize| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(size as u64),
        };
        let group = |label, bindings: &[_]| group_layout(gpu, label, bindings);
        Self {
            frame: group(
                "frame",
                &[
                    (both, uniform(size_of::<FrameUniforms>())),
                    (fragment, texture(wgpu::TextureSampleType::Uint)),
                    (fragment, texture(wgpu::TextureSampleType::Float { filterable: false })),
                    (fragment, texture(wgpu::TextureSampleType::Uint)),
                    (fragment, texture(wgpu::TextureSampleType::Float { filterable: false })),
                    (fragment, texture(wgpu::TextureSampleType::Float { filterable: true })),
                    (fragment, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
                    (fragment, texture(wgpu::TextureSampleType::Uint)),
                ],
            ),
            materials: group(
                "materials",
                &[
                    (fragment, texture(wgpu::TextureSampleType::Uint)),
                    (
                        fragment,
                        wgpu::BindingType::Texture {
                            sample_type: wgpu::TextureSampleType::Float { filterable: true },
                            view_dimension: wgpu::TextureViewDimension::D2Array,
                            multisampled: false,
                        },
                    ),
                    (fragment, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
                ],
            ),
            depths: group("depths", &[(fragment, texture(wgpu::TextureSampleType::Depth))]),
        }
    }
}

/// A layout of bindings that are numbered from 0.
pub fn group_layout(
    gpu: &Gpu,
    label: &'static str,
    bindings: &[(wgpu::ShaderStages, wgpu::BindingType)],
) -> wgpu::BindGroupLayout {
    let entry =
        |(binding, &(visibility, ty))| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let entries: Vec<_> = (0..).zip(bindings).map(entry).collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries };
    gpu.device.create_bind_group_layout(&descriptor)
}

/// A layout of pipelines that bind these groups.
pub fn pipeline_layout(
    gpu: &Gpu,
    label: &'static str,
    groups: &[Option<&wgpu::BindGroupLayout>],
) -> wgpu::PipelineLayout {
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: groups,
        immediate_size: 0,
    })
}

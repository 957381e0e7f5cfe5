//! Pipelines that compute.

use crate::adapter::Gpu;
use crate::layouts::pipeline_layout;
use crate::pipelines::options;

/// The pipelines of a shader's entry points, which bind `group` alone.
pub fn compute_pipelines<const N: usize>(
    gpu: &Gpu,
    (label, shader): (&'static str, &'static str),
    group: &wgpu::BindGroupLayout,
    constants: &[(&str, f64)],
    entries: [&'static str; N],
) -> [wgpu::ComputePipeline; N] {
    let source = wgpu::ShaderSource::Wgsl(shader.into());
    let descriptor = wgpu::ShaderModuleDescriptor { label: Some(label), source };
    let module = gpu.device.create_shader_module(descriptor);
    let layout = pipeline_layout(gpu, label, &[Some(group)]);
    entries.map(|entry| {
        gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: options(constants),
            cache: None,
        })
    })
}

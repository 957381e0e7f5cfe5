//! Pipelines that paint a whole target with a few triangles, whose corners the vertex shader makes.

/// A shader that paints whole targets, and what it reads.
#[derive(Clone, Copy, Debug)]
pub struct Painting<'a> {
    /// The name of its objects in the messages of drivers and debuggers.
    pub label: &'a str,
    /// The shader, WGSL.
    pub shader: &'a str,
    /// The vertex shader, which makes corners of their indices.
    pub vertex: &'a str,
    /// The fragment shader.
    pub fragment: &'a str,
    /// What the fragment shader reads, bindings of group 0 in order.
    pub reads: &'a [wgpu::BindingType],
}

/// A pipeline that paints, and the layout of its group 0.
#[derive(Debug)]
pub struct PaintingPipeline {
    /// The layout of group 0.
    pub layout: wgpu::BindGroupLayout,
    /// The pipeline; it draws as many vertices as the vertex shader makes.
    pub pipeline: wgpu::RenderPipeline,
}

impl Painting<'_> {
    /// The pipeline that paints targets of `format`. Errors of the device go to its error scopes.
    pub fn pipeline(&self, device: &wgpu::Device, format: wgpu::TextureFormat) -> PaintingPipeline {
        let label = Some(self.label);
        let entry = |(binding, ty): (u32, &wgpu::BindingType)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: *ty,
            count: None,
        };
        let entries: Vec<_> = (0..).zip(self.reads).map(entry).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label, entries: &entries };
        let layout = device.create_bind_group_layout(&descriptor);
        let source = wgpu::ShaderSource::Wgsl(self.shader.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label,
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(self.vertex),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(self.fragment),
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        PaintingPipeline { layout, pipeline }
    }
}

//! The shaders and bindings that draw shadow maps.

use std::collections::BTreeMap;

use crate::adapter::Gpu;
use crate::compute::compute_pipelines;
use crate::layouts::{Layouts, group_layout, pipeline_layout};
use crate::pipeline_key::VertexSource;
use crate::pipelines::{MERGED_BUFFERS, PLACED_BUFFERS, options};
use crate::shadow::{TABLE_FORMAT, TEXEL_FORMAT};
use crate::shadow_maps::caster_calls::CasterKey;
use crate::shadow_maps::constants::LevelConstants;

/// The format of the texture that passes draw to, of which they write nothing: a pass must have one.
pub const TARGET_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Storage buffers and textures of the stage that has most of them.
pub const STORAGE_BUFFERS: u32 = 3;
pub const STORAGE_TEXTURES: u32 = 2;

/// Invocations of the largest workgroup.
pub const WORKGROUP: u32 = 256;

/// Entries of the table that a workgroup finishes.
pub const TABLE_WORKGROUP: u32 = 64;

const DRAW_SHADER: &str = concat!(
    include_str!("../items.wgsl"),
    "\n",
    include_str!("../shadow_pages.wgsl"),
    "\n",
    include_str!("../shadow_level.wgsl"),
    "\n",
    include_str!("../shadow_draw.wgsl")
);

const FINISH_SHADER: &str = concat!(
    include_str!("../shadow_pages.wgsl"),
    "\n",
    include_str!("../shadow_level.wgsl"),
    "\n",
    include_str!("../shadow_finish.wgsl")
);

/// What draws levels, and what turns them to textures.
#[derive(Debug)]
pub struct ShadowPipelines {
    /// Group 0 while levels are drawn: constants, numbers of pages, heights.
    pub drawn: wgpu::BindGroupLayout,
    /// Group 0 while they are finished: the same, the highest of each page, both textures.
    pub finished: wgpu::BindGroupLayout,
    pub finish_page: wgpu::ComputePipeline,
    pub finish_table: wgpu::ComputePipeline,
    shader: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    by_key: BTreeMap<CasterKey, wgpu::RenderPipeline>,
}

impl ShadowPipelines {
    pub fn new(gpu: &Gpu, layouts: &Layouts) -> Self {
        let (fragment, compute) = (wgpu::ShaderStages::FRAGMENT, wgpu::ShaderStages::COMPUTE);
        let storage = |read_only| buffer(wgpu::BufferBindingType::Storage { read_only }, None);
        let constants = buffer(wgpu::BufferBindingType::Uniform, Some(size_of::<LevelConstants>() as u64));
        let texture = |format| wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let drawn = [
            (wgpu::ShaderStages::VERTEX_FRAGMENT, constants),
            (fragment, storage(true)),
            (fragment, storage(false)),
        ];
        let finished = [
            (compute, constants),
            (compute, storage(true)),
            (compute, storage(true)),
            (compute, storage(false)),
            (compute, texture(TEXEL_FORMAT)),
            (compute, texture(TABLE_FORMAT)),
        ];
        let drawn = group_layout(gpu, "drawing of shadows", &drawn);
        let finished = group_layout(gpu, "finishing of shadows", &finished);
        let label = "drawing of shadows";
        let source = wgpu::ShaderSource::Wgsl(DRAW_SHADER.into());
        let descriptor = wgpu::ShaderModuleDescriptor { label: Some(label), source };
        let [finish_page, finish_table] = compute_pipelines(
            gpu,
            ("finishing of shadows", FINISH_SHADER),
            &finished,
            &[],
            ["finish_page", "finish_table"],
        );
        Self {
            finish_page,
            finish_table,
            shader: gpu.device.create_shader_module(descriptor),
            layout: pipeline_layout(gpu, label, &[Some(&drawn), Some(&layouts.materials)]),
            drawn,
            finished,
            by_key: BTreeMap::new(),
        }
    }

    /// Makes those pipelines that are missing.
    pub fn make(&mut self, gpu: &Gpu, keys: impl IntoIterator<Item = CasterKey>) {
        for key in keys {
            if !self.by_key.contains_key(&key) {
                let made = self.pipeline(gpu, key);
                self.by_key.insert(key, made);
            }
        }
    }

    /// The pipeline of a key; `None` before it is made.
    pub fn get(&self, key: CasterKey) -> Option<&wgpu::RenderPipeline> {
        self.by_key.get(&key)
    }

    fn pipeline(&self, gpu: &Gpu, key: CasterKey) -> wgpu::RenderPipeline {
        let Self { shader, layout, .. } = self;
        let (vertex, buffers) = match key.source {
            VertexSource::Placed => ("placed_cast", &PLACED_BUFFERS[..]),
            _ => ("merged_cast", &MERGED_BUFFERS[..]),
        };
        let number = |is_set: bool| f64::from(u8::from(is_set));
        let constants = [("on_ground", number(key.on_ground)), ("masked", number(key.masked))];
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&format!("shadows, {vertex}")),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module: shader,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers,
            },
            primitive: wgpu::PrimitiveState {
                // Rows run down the target: what faces the light runs clockwise.
                front_face: wgpu::FrontFace::Cw,
                cull_mode: None,
                ..Default::default()
            },
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: shader,
                entry_point: Some("cast_shadow"),
                compilation_options: options(&constants),
                targets: &[Some(wgpu::ColorTargetState {
                    format: TARGET_FORMAT,
                    blend: None,
                    write_mask: wgpu::ColorWrites::empty(),
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// A buffer; with a size, one of many constants that lie behind each other.
fn buffer(ty: wgpu::BufferBindingType, size: Option<u64>) -> wgpu::BindingType {
    let min_binding_size = size.and_then(wgpu::BufferSize::new);
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: size.is_some(), min_binding_size }
}

#[cfg(test)]
mod tests {
    use wgpu::naga;

    use super::*;

    #[test]
    fn the_constants_of_a_level_are_laid_out_as_both_shaders_declare_them() {
        for text in [DRAW_SHADER, FINISH_SHADER] {
            let module = naga::front::wgsl::parse_str(text)
                .unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
            let level = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Level"));
            match level.map(|(_, ty)| &ty.inner) {
                Some(naga::TypeInner::Struct { span, .. }) => {
                    assert_eq!(*span as usize, size_of::<LevelConstants>());
                }
                other => panic!("{other:?}"),
            }
        }
        assert!(FINISH_SHADER.contains(&format!("@workgroup_size({WORKGROUP})")));
        assert!(FINISH_SHADER.contains(&format!("@workgroup_size({TABLE_WORKGROUP})")));
    }
}

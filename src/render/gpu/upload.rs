//! A draw list as buffers and textures on the device. Only what items use goes up.

use bytemuck::{Zeroable, bytes_of, cast_slice};
use rayon::prelude::*;
use wgpu::util::align_to;

use crate::draw::color::Srgba;
use crate::draw::ground::GroundMap;
use crate::draw::list::{DrawList, DrawMesh};
use crate::draw::material::{AlphaMode, Material};
use crate::draw::pixels::Pixels;
use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::error::GpuError;
use crate::render::gpu::ground::GroundTextures;
use crate::render::gpu::mips::{levels, premultiplied};
use crate::render::gpu::pipelines::Layouts;
use crate::render::gpu::uniforms::{FrameUniforms, Instance, RAMP_COLUMNS, SurfaceConstants};
use crate::view::camera::Camera;

/// A mesh on the device.
#[derive(Debug)]
pub(in crate::render::gpu) struct MeshBuffers {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
}

/// A draw list on the device.
#[derive(Debug)]
pub(in crate::render::gpu) struct Resources {
    /// One a mesh; `None` for one that no item draws.
    pub meshes: Vec<Option<MeshBuffers>>,
    /// Camera, light and ground.
    pub frame: wgpu::BindGroup,
    /// Place and feature of every item.
    pub instances: wgpu::Buffer,
    /// The constants of all materials, to be bound at a material's offset.
    pub surfaces: wgpu::BindGroup,
    /// Bytes from one material's constants to the next.
    pub surface_stride: u32,
    textures: Vec<TextureForms>,
    white: wgpu::BindGroup,
}

/// A texture in the forms that some item shows it in; an empty one has none.
#[derive(Debug, Default)]
struct TextureForms {
    /// As it is, for opaque materials.
    straight: Option<wgpu::BindGroup>,
    /// Colors multiplied by alpha, for all others: filtering must not mix in what is not seen.
    premultiplied: Option<wgpu::BindGroup>,
}

impl Resources {
    /// Sends `list`, which has passed its own check, to the device.
    ///
    /// # Errors
    /// [`GpuError`] where something is too large for the adapter.
    pub fn upload(gpu: &Gpu, layouts: &Layouts, list: &DrawList, camera: &Camera) -> Result<Self, GpuError> {
        let mut mesh_used = vec![false; list.meshes.len()];
        for item in list.items.iter().filter(|item| !item.triangles.is_empty()) {
            mesh_used[item.mesh.0 as usize] = true;
        }
        let meshes = list.meshes.iter().zip(mesh_used).enumerate();
        let (surfaces, surface_stride) = surfaces(gpu, layouts, list)?;
        let sampler = sampler(gpu);
        let white = [Pixels::filled(1, 1, Srgba::WHITE)];
        Ok(Self {
            meshes: meshes
                .map(|(index, (mesh, used))| used.then(|| upload_mesh(gpu, index, mesh)).transpose())
                .collect::<Result<_, _>>()?,
            frame: frame(gpu, layouts, list, camera)?,
            instances: instances(gpu, list)?,
            surfaces,
            surface_stride,
            textures: textures(gpu, layouts, &sampler, list),
            white: bind_texture(gpu, layouts, &sampler, &white),
        })
    }

    /// What an item with `material` binds as its texture: white where it has none.
    pub fn texture_of(&self, material: &Material) -> &wgpu::BindGroup {
        let forms = material.texture.map(|id| &self.textures[id.0 as usize]);
        let form = forms.and_then(|forms| match material.alpha {
            AlphaMode::Opaque => forms.straight.as_ref(),
            AlphaMode::Mask(_) | AlphaMode::Blend => forms.premultiplied.as_ref(),
        });
        form.unwrap_or(&self.white)
    }
}

fn upload_mesh(gpu: &Gpu, index: usize, mesh: &DrawMesh) -> Result<MeshBuffers, GpuError> {
    let indices: Vec<[u32; 3]> = mesh.triangles.iter().map(|corners| corners.map(|id| id.0)).collect();
    let what = || format!("mesh {index}");
    Ok(MeshBuffers {
        vertices: buffer(gpu, what, wgpu::BufferUsages::VERTEX, cast_slice(&mesh.vertices))?,
        indices: buffer(gpu, what, wgpu::BufferUsages::INDEX, cast_slice(&indices))?,
    })
}

/// A buffer holding `bytes`, whose length is a multiple of four.
fn buffer(
    gpu: &Gpu,
    what: impl Fn() -> String,
    usage: wgpu::BufferUsages,
    bytes: &[u8],
) -> Result<wgpu::Buffer, GpuError> {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: gpu.fitting(what, bytes.len() as u64)?,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

fn instances(gpu: &Gpu, list: &DrawList) -> Result<wgpu::Buffer, GpuError> {
    let what = || format!("the placement of {} items", list.items.len());
    gpu.fitting(what, (list.items.len() * size_of::<Instance>()) as u64)?;
    let mut instances: Vec<Instance> = list.items.par_iter().map(Instance::of).collect();
    if instances.is_empty() {
        instances.push(Instance::zeroed());
    }
    buffer(gpu, what, wgpu::BufferUsages::VERTEX, cast_slice(&instances))
}

fn surfaces(gpu: &Gpu, layouts: &Layouts, list: &DrawList) -> Result<(wgpu::BindGroup, u32), GpuError> {
    let size = size_of::<SurfaceConstants>();
    let stride = align_to(size as u32, gpu.limits.min_uniform_buffer_offset_alignment);
    let what = || format!("{} materials", list.materials.len());
    let total = gpu.fitting(what, list.materials.len().max(1) as u64 * u64::from(stride))?;
    let mut bytes = vec![0; total as usize];
    for (slot, material) in bytes.chunks_exact_mut(stride as usize).zip(&list.materials) {
        slot[..size].copy_from_slice(bytes_of(&SurfaceConstants::of(material)));
    }
    let buffer = buffer(gpu, what, wgpu::BufferUsages::UNIFORM, &bytes)?;
    let window = wgpu::BufferBinding { buffer: &buffer, offset: 0, size: wgpu::BufferSize::new(size as u64) };
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layouts.surface,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(window) }],
    });
    Ok((group, stride))
}

fn frame(
    gpu: &Gpu,
    layouts: &Layouts,
    list: &DrawList,
    camera: &Camera,
) -> Result<wgpu::BindGroup, GpuError> {
    let constants = FrameUniforms::of(list, camera);
    let what = || "the camera".into();
    let buffer = buffer(gpu, what, wgpu::BufferUsages::UNIFORM, bytes_of(&constants))?;
    let ground = GroundTextures::upload(gpu, list.ground.as_deref())?;
    let ramp = ramp_stops(gpu, list.ground.as_deref());
    let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
    let views = [view(&ground.posts), view(&ground.coarse), view(&ramp)];
    let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }];
    entries.extend((1..).zip(&views).map(|(binding, view)| wgpu::BindGroupEntry {
        binding,
        resource: wgpu::BindingResource::TextureView(view),
    }));
    Ok(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layouts.frame,
        entries: &entries,
    }))
}

/// Every stop as linear red, green, blue and its height, in rows of [`RAMP_COLUMNS`].
fn ramp_stops(gpu: &Gpu, map: Option<&GroundMap>) -> wgpu::Texture {
    let white = [(0.0, Srgba::WHITE)];
    let stops = map.map_or(&white[..], |map| map.ramp.stops());
    let mut texels: Vec<[f32; 4]> =
        stops.iter().map(|&(height, color)| color.linear().extend(height).to_array()).collect();
    let rows = texels.len().div_ceil(RAMP_COLUMNS as usize);
    texels.resize(rows * RAMP_COLUMNS as usize, [0.0; 4]);
    let size = wgpu::Extent3d { width: RAMP_COLUMNS, height: rows as u32, depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("ramp"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(RAMP_COLUMNS * size_of::<[f32; 4]>() as u32),
        rows_per_image: None,
    };
    gpu.queue.write_texture(texture.as_image_copy(), cast_slice(&texels), layout, size);
    texture
}

/// Repeats both ways and blends between the two nearest levels.
fn sampler(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        anisotropy_clamp: gpu.anisotropy,
        ..Default::default()
    })
}

fn textures(gpu: &Gpu, layouts: &Layouts, sampler: &wgpu::Sampler, list: &DrawList) -> Vec<TextureForms> {
    let mut wanted = vec![[false; 2]; list.textures.len()];
    for item in list.items.iter().filter(|item| !item.triangles.is_empty()) {
        let material = &list.materials[item.material.0 as usize];
        if let Some(id) = material.texture {
            wanted[id.0 as usize][usize::from(material.alpha != AlphaMode::Opaque)] = true;
        }
    }
    let limit = gpu.limits.max_texture_dimension_2d;
    let bind = |levels: &[Pixels]| bind_texture(gpu, layouts, sampler, levels);
    let forms = |(texture, [straight, multiplied]): (&Pixels, [bool; 2])| {
        let levels = if straight || multiplied { levels(texture, limit) } else { Vec::new() };
        if levels.is_empty() {
            return TextureForms::default();
        }
        TextureForms {
            straight: straight.then(|| bind(&levels)),
            premultiplied: multiplied
                .then(|| bind(&levels.par_iter().map(premultiplied).collect::<Vec<_>>())),
        }
    };
    list.textures.iter().zip(wanted).map(forms).collect()
}

fn bind_texture(gpu: &Gpu, layouts: &Layouts, sampler: &wgpu::Sampler, levels: &[Pixels]) -> wgpu::BindGroup {
    let size =
        wgpu::Extent3d { width: levels[0].width(), height: levels[0].height(), depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (mip_level, level) in levels.iter().enumerate() {
        let to = wgpu::TexelCopyTextureInfo { mip_level: mip_level as u32, ..texture.as_image_copy() };
        let (width, height) = (level.width(), level.height());
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: None };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        gpu.queue.write_texture(to, level.bytes(), layout, size);
    }
    let view = texture.create_view(&Default::default());
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layouts.texture,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
        ],
    })
}

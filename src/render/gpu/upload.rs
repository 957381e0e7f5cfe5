//! A draw list as buffers and textures on the device.
//!
//! Only what items use goes up. The ground map becomes a texture of integers holding the bits of its
//! floats: every adapter can read one, none may filter it, so that what the shader interpolates by hand is
//! the same everywhere.

use bytemuck::{bytes_of, cast_slice};
use wgpu::util::align_to;

use crate::draw::color::Srgba;
use crate::draw::ground::{GroundMap, GroundPost};
use crate::draw::list::{DrawList, DrawMesh};
use crate::draw::pixels::Pixels;
use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::error::GpuError;
use crate::render::gpu::mips::levels;
use crate::render::gpu::pipelines::Layouts;
use crate::render::gpu::uniforms::{Frame, ItemConstants, RAMP_COLUMNS};
use crate::view::camera::Camera;

/// Rows of the ground map are sent in portions of about this many bytes, so that a large map is never held
/// three times over.
const PORTION_BYTES: usize = 16 << 20;

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
    /// The constants of all items, to be bound at an item's offset.
    pub items: wgpu::BindGroup,
    /// Bytes from one item's constants to the next.
    pub item_stride: u32,
    /// One a texture; `None` for one that no item shows.
    pub textures: Vec<Option<wgpu::BindGroup>>,
    /// What an item without a texture binds.
    pub white: wgpu::BindGroup,
}

impl Resources {
    /// Sends `list`, which has passed its own check, to the device.
    ///
    /// # Errors
    /// [`GpuError`] where something is too large for the adapter.
    pub fn upload(gpu: &Gpu, layouts: &Layouts, list: &DrawList, camera: &Camera) -> Result<Self, GpuError> {
        let mut mesh_used = vec![false; list.meshes.len()];
        let mut texture_used = vec![false; list.textures.len()];
        for item in list.items.iter().filter(|item| !item.triangles.is_empty()) {
            mesh_used[item.mesh.0 as usize] = true;
            if let Some(texture) = list.materials[item.material.0 as usize].texture {
                texture_used[texture.0 as usize] = true;
            }
        }
        let meshes = list.meshes.iter().zip(mesh_used).enumerate();
        let textures = list.textures.iter().zip(texture_used);
        let (items, item_stride) = items(gpu, layouts, list)?;
        let sampler = sampler(gpu);
        let white = Pixels::filled(1, 1, Srgba::WHITE);
        Ok(Self {
            meshes: meshes
                .map(|(index, (mesh, used))| used.then(|| upload_mesh(gpu, index, mesh)).transpose())
                .collect::<Result<_, _>>()?,
            frame: frame(gpu, layouts, list, camera)?,
            items,
            item_stride,
            textures: textures
                .map(|(pixels, used)| if used { texture(gpu, layouts, &sampler, pixels) } else { None })
                .collect(),
            white: bind_texture(gpu, layouts, &sampler, &[white]),
        })
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

fn items(gpu: &Gpu, layouts: &Layouts, list: &DrawList) -> Result<(wgpu::BindGroup, u32), GpuError> {
    let size = size_of::<ItemConstants>();
    let stride = align_to(size as u32, gpu.limits.min_uniform_buffer_offset_alignment);
    let what = || format!("the placement of {} items", list.items.len());
    let total = gpu.fitting(what, list.items.len().max(1) as u64 * u64::from(stride))?;
    let mut bytes = vec![0; total as usize];
    for (slot, item) in bytes.chunks_exact_mut(stride as usize).zip(&list.items) {
        let constants = ItemConstants::of(item, &list.materials[item.material.0 as usize], list);
        slot[..size].copy_from_slice(bytes_of(&constants));
    }
    let buffer = buffer(gpu, what, wgpu::BufferUsages::UNIFORM, &bytes)?;
    let window = wgpu::BufferBinding { buffer: &buffer, offset: 0, size: wgpu::BufferSize::new(size as u64) };
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layouts.item,
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
    let constants = Frame::of(list, camera);
    let what = || "the camera".into();
    let buffer = buffer(gpu, what, wgpu::BufferUsages::UNIFORM, bytes_of(&constants))?;
    let posts = match &list.ground {
        Some(map) => ground_posts(gpu, map)?,
        None => {
            let level = GroundPost { sun_visibility: 1.0, sky_visibility: 1.0, ..Default::default() };
            let texture = data_texture(gpu, (1, 1), wgpu::TextureFormat::Rgba32Uint);
            write_rows(gpu, &texture, 0..1, 1, bytes_of(&packed(&level)));
            texture
        }
    };
    let ramp = ramp_stops(gpu, list.ground.as_deref());
    let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
    let (posts, ramp) = (view(&posts), view(&ramp));
    Ok(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layouts.frame,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&posts) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&ramp) },
        ],
    }))
}

/// Height and slopes as bits, both visibilities as 16 bits each.
fn packed(post: &GroundPost) -> [u32; 4] {
    let sixteen = |share: f32| (share.clamp(0.0, 1.0) * 65535.0 + 0.5) as u32;
    [
        post.height_m.to_bits(),
        post.slope_east.to_bits(),
        post.slope_north.to_bits(),
        sixteen(post.sun_visibility) | sixteen(post.sky_visibility) << 16,
    ]
}

fn ground_posts(gpu: &Gpu, map: &GroundMap) -> Result<wgpu::Texture, GpuError> {
    let limit = gpu.limits.max_texture_dimension_2d;
    let (columns, rows) = (map.columns, map.rows);
    if columns > limit || rows > limit {
        return Err(GpuError::GroundSize { columns, rows, limit, adapter: gpu.name().into() });
    }
    let texture = data_texture(gpu, (columns, rows), wgpu::TextureFormat::Rgba32Uint);
    let stride = columns as usize;
    let portion = (PORTION_BYTES / (stride * size_of::<[u32; 4]>())).max(1);
    let mut first = 0;
    for posts in map.posts.chunks(portion * stride) {
        let texels: Vec<[u32; 4]> = posts.iter().map(packed).collect();
        let last = first + (posts.len() / stride) as u32;
        write_rows(gpu, &texture, first..last, columns, cast_slice(&texels));
        first = last;
    }
    Ok(texture)
}

/// Every stop as linear red, green, blue and its height, in rows of [`RAMP_COLUMNS`].
fn ramp_stops(gpu: &Gpu, map: Option<&GroundMap>) -> wgpu::Texture {
    let white = [(0.0, Srgba::WHITE)];
    let stops = map.map_or(&white[..], |map| map.ramp.stops());
    let mut texels: Vec<[f32; 4]> =
        stops.iter().map(|&(height, color)| color.linear().extend(height).to_array()).collect();
    let rows = texels.len().div_ceil(RAMP_COLUMNS as usize);
    texels.resize(rows * RAMP_COLUMNS as usize, [0.0; 4]);
    let texture = data_texture(gpu, (RAMP_COLUMNS, rows as u32), wgpu::TextureFormat::Rgba32Float);
    write_rows(gpu, &texture, 0..rows as u32, RAMP_COLUMNS, cast_slice(&texels));
    texture
}

fn data_texture(gpu: &Gpu, (width, height): (u32, u32), format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// Fills `rows` of a texture whose texels are 16 bytes.
fn write_rows(gpu: &Gpu, texture: &wgpu::Texture, rows: std::ops::Range<u32>, width: u32, bytes: &[u8]) {
    let mut to = texture.as_image_copy();
    to.origin.y = rows.start;
    let height = rows.end - rows.start;
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 16), rows_per_image: None };
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    gpu.queue.write_texture(to, bytes, layout, size);
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

/// `None` for a texture without texels, which then shows as white.
fn texture(
    gpu: &Gpu,
    layouts: &Layouts,
    sampler: &wgpu::Sampler,
    pixels: &Pixels,
) -> Option<wgpu::BindGroup> {
    let levels = levels(pixels, gpu.limits.max_texture_dimension_2d);
    (!levels.is_empty()).then(|| bind_texture(gpu, layouts, sampler, &levels))
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

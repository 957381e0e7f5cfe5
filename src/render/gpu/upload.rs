//! A draw list as buffers and textures on the device. Only what items use is sent.

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
use crate::render::gpu::memory::{texture, view};
use crate::render::gpu::pipelines::Layouts;
use crate::render::gpu::shadow::ShadowTextures;
use crate::render::gpu::uniforms::{FrameUniforms, Instance, RAMP_COLUMNS, SurfaceConstants};
use crate::render::mip_levels::smaller_levels;
use crate::render::shadow::Shadows;
use crate::view::camera::Camera;

#[derive(Debug)]
pub struct MeshBuffers {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
}

#[derive(Debug)]
pub struct Resources {
    /// One per mesh; `None` for one that no item draws.
    pub meshes: Vec<Option<MeshBuffers>>,
    pub frame: wgpu::BindGroup,
    pub instances: wgpu::Buffer,
    /// The constants of all materials, to be bound at a material's offset.
    pub surfaces: wgpu::BindGroup,
    /// Bytes from one material's constants to the next.
    pub surface_stride: u32,
    /// Each texture as stored, for opaque materials, and with colors multiplied by alpha, for all others: filtering
    /// must not mix in transparent colors.
    textures: Vec<[Option<wgpu::BindGroup>; 2]>,
    white: wgpu::BindGroup,
}

/// Which form of a texture `material` shows.
fn form(material: &Material) -> usize {
    usize::from(material.alpha != AlphaMode::Opaque)
}

impl Resources {
    pub fn upload(
        gpu: &Gpu,
        layouts: &Layouts,
        list: &DrawList,
        camera: &Camera,
        shadows: &Shadows,
    ) -> Result<Self, GpuError> {
        let mut mesh_used = vec![false; list.meshes.len()];
        for item in list.items.iter().filter(|item| !item.triangles.is_empty()) {
            mesh_used[item.mesh.0 as usize] = true;
        }
        let meshes = list.meshes.iter().zip(mesh_used).enumerate();
        let meshes =
            meshes.map(|(index, (mesh, used))| used.then(|| upload_mesh(gpu, index, mesh)).transpose());
        let (surfaces, surface_stride) = surfaces(gpu, layouts, list)?;
        let sampler = sampler(gpu);
        let white = [Pixels::filled(1, 1, Srgba::WHITE)];
        Ok(Self {
            meshes: meshes.collect::<Result<_, _>>()?,
            frame: frame(gpu, layouts, &sampler, list, camera, shadows)?,
            instances: instances(gpu, list)?,
            surfaces,
            surface_stride,
            textures: textures(gpu, layouts, &sampler, list),
            white: bind_texture(gpu, layouts, &sampler, &white),
        })
    }

    /// The texture of `material`: white where it has none.
    pub fn texture_of(&self, material: &Material) -> &wgpu::BindGroup {
        let texture = material.texture.and_then(|id| self.textures[id.0 as usize][form(material)].as_ref());
        texture.unwrap_or(&self.white)
    }
}

fn upload_mesh(gpu: &Gpu, index: usize, mesh: &DrawMesh) -> Result<MeshBuffers, GpuError> {
    let indices: Vec<[u32; 3]> = mesh.triangles.iter().map(|corners| corners.map(|id| id.0)).collect();
    let what = || format!("mesh {index}");
    Ok(MeshBuffers {
        vertices: gpu.filled_buffer(what, wgpu::BufferUsages::VERTEX, cast_slice(&mesh.vertices))?,
        indices: gpu.filled_buffer(what, wgpu::BufferUsages::INDEX, cast_slice(&indices))?,
    })
}

fn instances(gpu: &Gpu, list: &DrawList) -> Result<wgpu::Buffer, GpuError> {
    let what = || format!("the placement of {} items", list.items.len());
    gpu.check_size(what, (list.items.len() * size_of::<Instance>()) as u64)?;
    let mut instances: Vec<Instance> = list.items.par_iter().map(Instance::new).collect();
    if instances.is_empty() {
        instances.push(Instance::zeroed());
    }
    gpu.filled_buffer(what, wgpu::BufferUsages::VERTEX, cast_slice(&instances))
}

fn surfaces(gpu: &Gpu, layouts: &Layouts, list: &DrawList) -> Result<(wgpu::BindGroup, u32), GpuError> {
    let size = size_of::<SurfaceConstants>();
    let stride = align_to(size as u32, gpu.limits.min_uniform_buffer_offset_alignment);
    let what = || format!("{} materials", list.materials.len());
    let total = list.materials.len().max(1) as u64 * u64::from(stride);
    gpu.check_size(what, total)?;
    let mut bytes = vec![0; total as usize];
    for (slot, material) in bytes.chunks_exact_mut(stride as usize).zip(&list.materials) {
        slot[..size].copy_from_slice(bytes_of(&SurfaceConstants::new(material)));
    }
    let buffer = gpu.filled_buffer(what, wgpu::BufferUsages::UNIFORM, &bytes)?;
    let window = wgpu::BufferBinding { buffer: &buffer, offset: 0, size: wgpu::BufferSize::new(size as u64) };
    Ok((bind(gpu, &layouts.surface, [wgpu::BindingResource::Buffer(window)]), stride))
}

fn frame(
    gpu: &Gpu,
    layouts: &Layouts,
    sampler: &wgpu::Sampler,
    list: &DrawList,
    camera: &Camera,
    shadows: &Shadows,
) -> Result<wgpu::BindGroup, GpuError> {
    let constants = FrameUniforms::new(list, camera, shadows);
    let what = || "the camera".into();
    let buffer = gpu.filled_buffer(what, wgpu::BufferUsages::UNIFORM, bytes_of(&constants))?;
    let ground = GroundTextures::upload(gpu, list.ground.as_deref())?;
    let ramp = ramp_stops(gpu, list.ground.as_deref());
    let shadows = ShadowTextures::upload(gpu, shadows)?;
    let imagery = imagery_texture(gpu, list.ground.as_deref());
    let views = [&ground.posts, &ground.coarse, &ramp, &shadows.pages, &shadows.texels, &imagery].map(view);
    let [posts, coarse, ramp, pages, texels, imagery] =
        views.each_ref().map(wgpu::BindingResource::TextureView);
    let sampler = wgpu::BindingResource::Sampler(sampler);
    let constants = buffer.as_entire_binding();
    Ok(bind(gpu, &layouts.frame, [constants, posts, coarse, ramp, pages, texels, imagery, sampler]))
}

/// The picture draped over the ground, colors multiplied by alpha; without one, a texel that nothing reads.
fn imagery_texture(gpu: &Gpu, map: Option<&GroundMap>) -> wgpu::Texture {
    let pixels = map.and_then(|map| map.imagery.as_deref()).map(|imagery| &imagery.pixels);
    let largest = gpu.limits.max_texture_dimension_2d;
    let levels: Vec<Pixels> = pixels
        .map_or_else(Vec::new, |pixels| levels(pixels, largest).par_iter().map(premultiplied).collect());
    let none = [Pixels::filled(1, 1, Srgba::WHITE)];
    mipmapped(gpu, if levels.is_empty() { &none } else { &levels })
}

/// Every stop as linear red, green, blue and its height, in rows of [`RAMP_COLUMNS`].
fn ramp_stops(gpu: &Gpu, map: Option<&GroundMap>) -> wgpu::Texture {
    let stops = map.map_or(&[][..], |map| map.ramp.stops());
    let mut texels: Vec<[f32; 4]> =
        stops.iter().map(|&(height, color)| color.extend(height).to_array()).collect();
    let rows = texels.len().div_ceil(RAMP_COLUMNS as usize).max(1);
    texels.resize(rows * RAMP_COLUMNS as usize, [0.0; 4]);
    let descriptor = texture(RAMP_COLUMNS, rows as u32, wgpu::TextureFormat::Rgba32Float);
    let texture = gpu.device.create_texture(&descriptor);
    gpu.write(texture.as_image_copy(), RAMP_COLUMNS, rows as u32, cast_slice(&texels));
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

fn textures(
    gpu: &Gpu,
    layouts: &Layouts,
    sampler: &wgpu::Sampler,
    list: &DrawList,
) -> Vec<[Option<wgpu::BindGroup>; 2]> {
    let mut used = vec![[false; 2]; list.textures.len()];
    for item in list.items.iter().filter(|item| !item.triangles.is_empty()) {
        let material = &list.materials[item.material.0 as usize];
        if let Some(id) = material.texture {
            used[id.0 as usize][form(material)] = true;
        }
    }
    let bind = |levels: &[Pixels]| bind_texture(gpu, layouts, sampler, levels);
    let forms = |(texture, [stored, multiplied]): (&Pixels, [bool; 2])| {
        let is_used = stored || multiplied;
        let levels = if is_used { levels(texture, gpu.limits.max_texture_dimension_2d) } else { Vec::new() };
        let is_shown = !levels.is_empty();
        let multiplied = (multiplied && is_shown).then(|| levels.par_iter().map(premultiplied).collect());
        [(stored && is_shown).then(|| bind(&levels)), multiplied.map(|levels: Vec<Pixels>| bind(&levels))]
    };
    list.textures.iter().zip(used).map(forms).collect()
}

fn bind_texture(gpu: &Gpu, layouts: &Layouts, sampler: &wgpu::Sampler, levels: &[Pixels]) -> wgpu::BindGroup {
    let texture = mipmapped(gpu, levels);
    let resources =
        [wgpu::BindingResource::TextureView(&view(&texture)), wgpu::BindingResource::Sampler(sampler)];
    bind(gpu, &layouts.texture, resources)
}

fn mipmapped(gpu: &Gpu, levels: &[Pixels]) -> wgpu::Texture {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        mip_level_count: levels.len() as u32,
        ..texture(levels[0].width(), levels[0].height(), wgpu::TextureFormat::Rgba8UnormSrgb)
    });
    for (mip_level, level) in (0..).zip(levels) {
        let to = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
        gpu.write(to, level.width(), level.height(), level.bytes());
    }
    texture
}

/// `resources` as a group, numbered from binding 0.
fn bind<const N: usize>(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    resources: [wgpu::BindingResource; N],
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// `texture` and every smaller level down to a single texel; none where a side is zero. Levels larger than `limit` a
/// side are left out, so that a texture too large for the adapter is drawn coarser.
fn levels(texture: &Pixels, limit: u32) -> Vec<Pixels> {
    let fits = |level: &Pixels| (1..=limit).contains(&level.width()) && (1..=limit).contains(&level.height());
    let largest = fits(texture).then(|| texture.clone());
    largest.into_iter().chain(smaller_levels(texture).into_iter().filter(fits)).collect()
}

/// `level` with colors multiplied by alpha, in linear light.
fn premultiplied(level: &Pixels) -> Pixels {
    Pixels::from_fn(level.width(), level.height(), |x, y| {
        let texel = level.at(x, y);
        let Srgba([red, green, blue, _]) = Srgba::from_linear(texel.linear() * texel.alpha());
        Srgba([red, green, blue, texel.0[3]])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transparent_texels_are_black_when_multiplied() {
        let leaf = Srgba([20, 120, 30, 255]);
        let edge = Pixels::from_fn(2, 1, |x, _| if x == 0 { leaf } else { Srgba([255, 0, 255, 0]) });
        assert_eq!(premultiplied(&edge).data(), [leaf, Srgba([0, 0, 0, 0])]);
    }

    #[test]
    fn a_texture_too_large_for_the_adapter_starts_at_a_smaller_level() {
        let widths = |width, height, limit| -> Vec<u32> {
            levels(&Pixels::filled(width, height, Srgba::WHITE), limit).iter().map(Pixels::width).collect()
        };
        assert_eq!(widths(64, 8, 16), [16, 8, 4, 2, 1]);
        assert_eq!(widths(4, 4, 8192), [4, 2, 1]);
        assert!(widths(0, 8, 16).is_empty());
    }
}

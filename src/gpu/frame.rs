//! The resources that a whole picture shares: camera, light, ground map, shadow maps and the draped picture, as group
//! 0.

use bytemuck::{bytes_of, cast_slice};
use rayon::prelude::*;

use crate::adapter::Gpu;
use crate::buffer_writes::BufferWrites;
use crate::error::GpuError;
use crate::ground::GroundTextures;
use crate::layouts::Layouts;
use crate::materials::{levels, premultiplied};
use crate::memory::{Loader, bind, texture, view};
use crate::shadow::ShadowTextures;
use crate::uniforms::{FrameUniforms, RAMP_COLUMNS};
use crate::windows::WindowTexture;
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::GroundMap;
use sandtable_draw::pixels::Pixels;

/// The textures of group 0.
#[derive(Debug)]
pub struct FrameTextures {
    ground: GroundTextures,
    ramp: wgpu::Texture,
    imagery: wgpu::Texture,
    shadows: ShadowTextures,
    windows: WindowTexture,
}

/// Group 0 and the constants in it.
#[derive(Debug)]
pub struct FrameGroup {
    pub group: wgpu::BindGroup,
    constants: wgpu::Buffer,
}

impl FrameTextures {
    /// Sends a checked map, beside the maps of shadows.
    pub fn upload(
        loader: &Loader<'_>,
        map: Option<&GroundMap>,
        shadows: ShadowTextures,
    ) -> Result<Self, GpuError> {
        Ok(Self {
            ground: GroundTextures::upload(loader, map)?,
            ramp: ramp_stops(loader, map)?,
            imagery: imagery_texture(loader, map)?,
            shadows,
            windows: WindowTexture::upload(loader, &[])?,
        })
    }

    /// The maps of shadows on the device.
    pub fn shadows(&self) -> &ShadowTextures {
        &self.shadows
    }

    /// The ground map on the device.
    pub fn ground(&self) -> &GroundTextures {
        &self.ground
    }

    /// Windows of finer posts.
    pub fn windows(&self) -> &WindowTexture {
        &self.windows
    }

    /// Replaces the windows of finer posts.
    pub fn replace_windows(&mut self, windows: WindowTexture) {
        self.windows = windows;
    }

    /// Replaces the maps of shadows.
    pub fn replace_shadows(&mut self, shadows: ShadowTextures) {
        self.shadows = shadows;
    }
}

impl FrameGroup {
    /// The group of `textures`; its constants are still to be written.
    pub fn new(loader: &Loader<'_>, layouts: &Layouts, textures: &FrameTextures) -> Result<Self, GpuError> {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let constants = loader.buffer(|| "the camera".into(), usage, size_of::<FrameUniforms>() as u64)?;
        let FrameTextures { ground, ramp, imagery, shadows, windows } = textures;
        let views =
            [&ground.posts, ramp, &shadows.pages, &shadows.texels, imagery, windows.posts()].map(view);
        let [posts, ramp, pages, texels, imagery, windows] =
            views.each_ref().map(wgpu::BindingResource::TextureView);
        let sampler = sampler(loader.gpu);
        let sampler = wgpu::BindingResource::Sampler(&sampler);
        let resources =
            [constants.as_entire_binding(), posts, ramp, pages, texels, imagery, sampler, windows];
        let group = bind(loader.gpu, "frame", &layouts.frame, resources);
        Ok(Self { group, constants })
    }

    /// Replaces the constants.
    pub fn write(&self, writes: &mut BufferWrites<'_>, constants: &FrameUniforms) {
        writes.write(&self.constants, 0, bytes_of(constants));
    }
}

/// The picture draped over the ground, colors multiplied by alpha; without one, a texel that nothing reads.
fn imagery_texture(loader: &Loader<'_>, map: Option<&GroundMap>) -> Result<wgpu::Texture, GpuError> {
    let pixels = map.and_then(|map| map.imagery.as_deref()).map(|imagery| &imagery.pixels);
    let largest = loader.gpu.limits.max_texture_dimension_2d;
    let levels: Vec<Pixels> = pixels
        .map_or_else(Vec::new, |pixels| levels(pixels, largest).par_iter().map(premultiplied).collect());
    let none = [Pixels::filled(1, 1, Srgba::WHITE)];
    let levels = if levels.is_empty() { &none[..] } else { &levels };
    let [width, height] = [levels[0].width(), levels[0].height()];
    let texture = loader.texture(
        || format!("the {width}×{height} texels of the draped picture"),
        &wgpu::TextureDescriptor {
            mip_level_count: levels.len() as u32,
            ..texture("draped picture", width, height, wgpu::TextureFormat::Rgba8UnormSrgb)
        },
    )?;
    for (mip_level, level) in (0..).zip(levels) {
        let to = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
        loader.gpu.write(to, level.width(), level.height(), level.bytes());
    }
    Ok(texture)
}

/// Every stop as linear red, green, blue and its height, in rows of [`RAMP_COLUMNS`].
fn ramp_stops(loader: &Loader<'_>, map: Option<&GroundMap>) -> Result<wgpu::Texture, GpuError> {
    let stops = map.map_or(&[][..], |map| map.ramp.stops());
    let mut texels: Vec<[f32; 4]> =
        stops.iter().map(|&(height, color)| color.extend(height).to_array()).collect();
    let rows = texels.len().div_ceil(RAMP_COLUMNS as usize).max(1);
    texels.resize(rows * RAMP_COLUMNS as usize, [0.0; 4]);
    let descriptor = texture("ramp", RAMP_COLUMNS, rows as u32, wgpu::TextureFormat::Rgba32Float);
    let texture = loader.texture(|| format!("the {} stops of the ramp", stops.len()), &descriptor)?;
    loader.gpu.write(texture.as_image_copy(), RAMP_COLUMNS, rows as u32, cast_slice(&texels));
    Ok(texture)
}

/// Reads the draped picture between its texels and its levels.
fn sampler(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("draped picture"),
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        anisotropy_clamp: gpu.anisotropy,
        ..Default::default()
    })
}

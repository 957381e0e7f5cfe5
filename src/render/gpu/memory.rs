//! Buffers and textures of the device.

use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::error::GpuError;

impl Gpu {
    /// A buffer of `bytes` bytes, which must be a multiple of four.
    pub(super) fn buffer(
        &self,
        what: impl FnOnce() -> String,
        usage: wgpu::BufferUsages,
        bytes: u64,
    ) -> Result<wgpu::Buffer, GpuError> {
        self.check_size(what, bytes)?;
        let (size, mapped_at_creation) = (bytes, false);
        Ok(self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage,
            mapped_at_creation,
        }))
    }

    /// A buffer that holds `contents`, whose length is a multiple of four.
    pub(super) fn filled_buffer(
        &self,
        what: impl FnOnce() -> String,
        usage: wgpu::BufferUsages,
        contents: &[u8],
    ) -> Result<wgpu::Buffer, GpuError> {
        let buffer = self.buffer(what, usage | wgpu::BufferUsages::COPY_DST, contents.len() as u64)?;
        self.queue.write_buffer(&buffer, 0, contents);
        Ok(buffer)
    }

    /// Checks that one buffer can hold `bytes` bytes.
    pub(super) fn check_size(&self, what: impl FnOnce() -> String, bytes: u64) -> Result<(), GpuError> {
        // Offsets into buffers are 32 bits wide, however large a buffer may be.
        let limit = self.limits.max_buffer_size.min(u64::from(u32::MAX));
        let what = || format!("the {bytes} bytes of {}", what());
        if bytes <= limit { Ok(()) } else { Err(self.too_large(what(), limit, "bytes per buffer")) }
    }

    /// Checks that one texture can be `sides` texels wide and high.
    pub(super) fn check_sides(&self, what: impl FnOnce() -> String, sides: [u32; 2]) -> Result<(), GpuError> {
        let limit = self.limits.max_texture_dimension_2d;
        if sides.into_iter().all(|side| side <= limit) {
            return Ok(());
        }
        Err(self.too_large(what(), limit.into(), "per side"))
    }

    fn too_large(&self, what: String, limit: u64, unit: &'static str) -> GpuError {
        GpuError::TooLarge { what, limit, unit, adapter: self.name().into() }
    }

    /// Writes `width` × `height` texels, row by row.
    pub(super) fn write(&self, to: wgpu::TexelCopyTextureInfo<'_>, width: u32, height: u32, texels: &[u8]) {
        let bytes_per_row = Some(texels.len() as u32 / height);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        self.queue.write_texture(to, texels, layout, size);
    }
}

/// A texture of one level and one sample per texel, to be written and then read by shaders.
pub fn texture(width: u32, height: u32, format: wgpu::TextureFormat) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    }
}

pub fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}

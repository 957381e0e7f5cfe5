//! Buffers and textures of the device, within its limits and within a bound of our own.

use std::cell::Cell;

use crate::adapter::Gpu;
use crate::error::GpuError;

/// The most that one scene may take of a device's memory, in bytes: 2 GiB, since drivers that share the processor's memory
/// would rather end the program than refuse. A scene of 16,000 roads takes a quarter of it.
pub const MOST_BYTES: u64 = 2 << 30;

/// Bytes sent after which the device must have taken them: until then they are held a second time.
const SENT_BYTES: u64 = 64 << 20;

/// Makes the buffers and textures of one scene.
#[derive(Debug)]
pub struct Loader<'a> {
    pub gpu: &'a Gpu,
    taken: Cell<u64>,
    sent: Cell<u64>,
}

impl<'a> Loader<'a> {
    pub fn new(gpu: &'a Gpu) -> Self {
        Self { gpu, taken: Cell::new(0), sent: Cell::new(0) }
    }

    /// Counts `bytes` that stay on the device from before, for `what`.
    pub fn keep(&self, what: &str, bytes: u64) -> Result<(), GpuError> {
        self.take(what, bytes)
    }

    /// The bytes of all that was made and kept.
    pub fn taken(&self) -> u64 {
        self.taken.get()
    }

    /// A buffer of `bytes` bytes, which must be a multiple of four.
    pub fn buffer(
        &self,
        what: impl FnOnce() -> String,
        usage: wgpu::BufferUsages,
        bytes: u64,
    ) -> Result<wgpu::Buffer, GpuError> {
        let name = what();
        self.gpu.check_size(|| name.clone(), bytes)?;
        self.take(&name, bytes)?;
        Ok(self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(&name),
            size: bytes,
            usage,
            mapped_at_creation: false,
        }))
    }

    /// A buffer that holds `contents`, whose length is a multiple of four.
    pub fn filled_buffer(
        &self,
        what: impl FnOnce() -> String,
        usage: wgpu::BufferUsages,
        contents: &[u8],
    ) -> Result<wgpu::Buffer, GpuError> {
        let buffer = self.buffer(what, usage | wgpu::BufferUsages::COPY_DST, contents.len() as u64)?;
        self.gpu.queue.write_buffer(&buffer, 0, contents);
        self.count_sent(contents.len() as u64)?;
        Ok(buffer)
    }

    /// A texture; what it is to hold is yet to be written.
    pub fn texture(
        &self,
        what: impl FnOnce() -> String,
        descriptor: &wgpu::TextureDescriptor<'_>,
    ) -> Result<wgpu::Texture, GpuError> {
        let name = what();
        let wgpu::Extent3d { width, height, depth_or_array_layers } = descriptor.size;
        self.gpu.check_sides(|| name.clone(), [width, height])?;
        let texel = u64::from(descriptor.format.block_copy_size(None).unwrap_or(4));
        let level = u64::from(width) * u64::from(height) * u64::from(depth_or_array_layers) * texel;
        let levels = if descriptor.mip_level_count > 1 { level / 3 } else { 0 };
        self.take(&name, level * u64::from(descriptor.sample_count) + levels)?;
        Ok(self.gpu.device.create_texture(descriptor))
    }

    /// Counts bytes of a texture as sent.
    pub fn count_sent(&self, bytes: u64) -> Result<(), GpuError> {
        self.sent.set(self.sent.get() + bytes);
        if self.sent.get() > SENT_BYTES {
            self.sent.set(0);
            self.gpu.finish_sending()?;
        }
        Ok(())
    }

    fn take(&self, what: &str, bytes: u64) -> Result<(), GpuError> {
        self.taken.set(self.taken.get().saturating_add(bytes));
        self.gpu.check_total(what, self.taken.get())
    }
}

impl Gpu {
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

    /// Checks that a scene may take `total` bytes, the last of them for `what`.
    pub(super) fn check_total(&self, what: &str, total: u64) -> Result<(), GpuError> {
        if total <= MOST_BYTES {
            return Ok(());
        }
        let what = format!("the {} MiB of the scene up to {what}", total >> 20);
        Err(self.too_large(what, MOST_BYTES >> 20, "MiB for a scene"))
    }

    pub(super) fn too_large(&self, what: String, limit: u64, unit: &'static str) -> GpuError {
        GpuError::TooLarge { what, limit, unit, adapter: self.name().into() }
    }

    /// Writes `width` × `height` texels, row by row.
    pub(super) fn write(&self, to: wgpu::TexelCopyTextureInfo<'_>, width: u32, height: u32, texels: &[u8]) {
        let bytes_per_row = Some(texels.len() as u32 / height);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        self.queue.write_texture(to, texels, layout, size);
    }

    /// Waits until the device has taken what was written.
    pub(super) fn finish_sending(&self) -> Result<(), GpuError> {
        let submission_index = Some(self.queue.submit([]));
        let wait = wgpu::PollType::Wait { submission_index, timeout: None };
        let done = self.device.poll(wait);
        done.map(drop).map_err(|error| self.driver_error("sending the scene", error))
    }
}

/// A texture of one level and one sample per texel, to be written and then read by shaders.
pub fn texture(
    label: &'static str,
    width: u32,
    height: u32,
    format: wgpu::TextureFormat,
) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some(label),
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

/// `resources` as a group, numbered from binding 0.
pub fn bind<const N: usize>(
    gpu: &Gpu,
    label: &'static str,
    layout: &wgpu::BindGroupLayout,
    resources: [wgpu::BindingResource; N],
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

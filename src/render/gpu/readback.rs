//! The textures a picture is drawn to, and their way back to the processor.
//!
//! Rows of a copy must start at multiples of 256 bytes; the padding is dropped while reading.

// From `core`, which has spans of time but no clock.
use core::time::Duration;
use std::sync::mpsc;

use crate::draw::color::Srgba;
use crate::draw::list::FeatureId;
use crate::draw::pixels::Pixels;
use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::error::GpuError;
use crate::render::gpu::pipelines::{COLOR, DEPTH, FEATURE};
use crate::render::picture::Picture;

/// How long a picture may take before the device counts as hung. A software adapter needs a second for
/// millions of triangles; ten minutes leaves room for a far slower machine, and nobody waits longer.
const PATIENCE: Duration = Duration::from_secs(600);

/// The textures of one picture.
#[derive(Debug)]
pub(in crate::render::gpu) struct Targets {
    /// Several samples a pixel; drawn to and resolved where the adapter can, else unused.
    pub samples: wgpu::Texture,
    /// The depth of those samples.
    pub sample_depth: wgpu::Texture,
    /// One color a pixel.
    pub color: wgpu::Texture,
    /// One feature a pixel and the bits of its depth in meters; both zero where there is nothing.
    pub feature: wgpu::Texture,
    /// The depth buffer of features.
    pub depth: wgpu::Texture,
    size: (u32, u32),
}

/// A copy of one texture that the processor can read.
struct Copy {
    buffer: wgpu::Buffer,
    /// With padding.
    bytes_per_row: u32,
    /// Without.
    row_bytes: u32,
}

impl Targets {
    /// Textures for a picture of `size`.
    ///
    /// # Errors
    /// [`GpuError`] where the adapter cannot hold it.
    pub fn new(gpu: &Gpu, size: (u32, u32)) -> Result<Self, GpuError> {
        let (width, height) = size;
        let limit = gpu.limits.max_texture_dimension_2d;
        if width > limit || height > limit {
            return Err(GpuError::PictureSize { width, height, limit, adapter: gpu.name().into() });
        }
        let texture = |format, sample_count, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let (kept, read) = (wgpu::TextureUsages::empty(), wgpu::TextureUsages::COPY_SRC);
        Ok(Self {
            samples: texture(COLOR, gpu.samples, kept),
            sample_depth: texture(DEPTH, gpu.samples, kept),
            color: texture(COLOR, 1, read),
            feature: texture(FEATURE, 1, read),
            depth: texture(DEPTH, 1, kept),
            size,
        })
    }

    /// Finishes `encoder`, waits for the device and reads the picture.
    ///
    /// # Errors
    /// [`GpuError`] where a copy does not fit a buffer or the device fails.
    pub fn read(&self, gpu: &Gpu, mut encoder: wgpu::CommandEncoder) -> Result<Picture, GpuError> {
        let copies =
            [self.copy(gpu, &mut encoder, &self.color)?, self.copy(gpu, &mut encoder, &self.feature)?];
        gpu.queue.submit([encoder.finish()]);
        let (sender, arrived) = mpsc::channel();
        for copy in &copies {
            let sender = sender.clone();
            copy.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
                // A receiver that is gone has already reported why.
                let _ = sender.send(result);
            });
        }
        drop(sender);
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) };
        gpu.device.poll(wait).map_err(|error| self.failed(gpu, &error))?;
        for _ in &copies {
            let result = arrived.recv().map_err(|error| self.failed(gpu, &error))?;
            result.map_err(|error| self.failed(gpu, &error))?;
        }
        self.picture(gpu, &copies[0], &copies[1])
    }

    fn failed(&self, gpu: &Gpu, reason: &dyn std::fmt::Display) -> GpuError {
        GpuError::Failed {
            doing: "reading the picture back",
            adapter: gpu.name().into(),
            reason: reason.to_string(),
        }
    }

    fn copy(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
    ) -> Result<Copy, GpuError> {
        let (width, height) = self.size;
        let row_bytes = width * texture.format().block_copy_size(None).unwrap_or(16);
        let bytes_per_row = wgpu::util::align_to(row_bytes, wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let size = u64::from(bytes_per_row) * u64::from(height);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: gpu.fitting(|| format!("a picture of {width}×{height} pixels"), size)?,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes_per_row),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
        Ok(Copy { buffer, bytes_per_row, row_bytes })
    }

    fn picture(&self, gpu: &Gpu, color: &Copy, feature: &Copy) -> Result<Picture, GpuError> {
        let (width, height) = self.size;
        let colors = self.texels::<4>(gpu, color)?;
        let colors = colors.into_iter().map(|[red, green, blue, _]| Srgba::opaque(red, green, blue));
        let pixels = Pixels::from_data(width, height, colors.collect())
            .ok_or_else(|| self.failed(gpu, &"the driver returned too few pixels"))?;
        let (features, depth_m) = self.texels::<8>(gpu, feature)?.into_iter().map(feature_and_depth).unzip();
        Ok(Picture { pixels, depth_m, features })
    }

    /// The texels of `copy`, of `N` bytes each, without padding.
    fn texels<const N: usize>(&self, gpu: &Gpu, copy: &Copy) -> Result<Vec<[u8; N]>, GpuError> {
        let view = copy.buffer.get_mapped_range(..).map_err(|error| self.failed(gpu, &error))?;
        let rows = view.chunks_exact(copy.bytes_per_row as usize);
        Ok(rows.flat_map(|row| row[..copy.row_bytes as usize].as_chunks().0).copied().collect())
    }
}

/// What a texel of the feature texture says; nothing lies infinitely far.
fn feature_and_depth([a, b, c, d, e, f, g, h]: [u8; 8]) -> (FeatureId, f32) {
    let depth_m = f32::from_ne_bytes([e, f, g, h]);
    let feature = FeatureId(u32::from_ne_bytes([a, b, c, d]));
    (feature, if depth_m > 0.0 { depth_m } else { f32::INFINITY })
}

//! The textures a picture is drawn to, and reading them back.
//!
//! Rows of a copy must start at multiples of 256 bytes; the padding is dropped while reading.

// From `core`, which has durations but no clock.
use core::time::Duration;
use std::sync::mpsc;

use crate::adapter::Gpu;
use crate::error::{DriverError, GpuError};
use crate::formats::{COLOR, DEPTH, FEATURE};
use crate::memory::{Loader, texture};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_draw::pixels::Pixels;
use sandtable_render::picture::Rendering;

/// How long a picture may take before the device counts as hung. A software adapter needs a second for millions of
/// triangles; ten minutes allow for a far slower machine.
const TIMEOUT: Duration = Duration::from_secs(600);

#[derive(Debug)]
pub(crate) struct Targets {
    /// Several samples per pixel; drawn to and resolved where the adapter can, else unused.
    pub samples: wgpu::Texture,
    pub sample_depth: wgpu::Texture,
    /// One color per pixel.
    pub color: wgpu::Texture,
    /// One feature per pixel and the bits of its depth in meters; both zero where there is nothing.
    pub feature: wgpu::Texture,
    pub depth: wgpu::Texture,
}

pub(crate) struct TextureCopy {
    buffer: wgpu::Buffer,
    /// Bytes from row to row, with padding.
    bytes_per_row: u32,
    /// Bytes in a row, without padding.
    row_bytes: u32,
}

impl Targets {
    pub fn new(loader: &Loader<'_>, (width, height): (u32, u32)) -> Result<Self, GpuError> {
        let what = || format!("the {width}×{height} pixels of the picture");
        let create = |label, format, sample_count, usage| {
            let descriptor = wgpu::TextureDescriptor {
                sample_count,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                ..texture(label, width, height, format)
            };
            loader.texture(what, &descriptor)
        };
        let samples = loader.gpu.samples;
        let (kept, read) = (wgpu::TextureUsages::empty(), wgpu::TextureUsages::COPY_SRC);
        Ok(Self {
            samples: create("color samples", COLOR, samples, kept)?,
            sample_depth: create("depth samples", DEPTH, samples, kept)?,
            color: create("colors", COLOR, 1, read)?,
            feature: create("features", FEATURE, 1, read)?,
            depth: create("depths", DEPTH, 1, kept)?,
        })
    }

    /// Color samples, colors, depths of samples, features and depths.
    pub fn all(&self) -> [&wgpu::Texture; 5] {
        [&self.samples, &self.color, &self.sample_depth, &self.feature, &self.depth]
    }

    /// The size of the picture, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.color.width(), self.color.height())
    }

    /// Submits commands that draw to the textures, and then the copying of what they drew.
    pub fn submit(&self, gpu: &Gpu, mut encoder: wgpu::CommandEncoder) -> Result<DrawnTile, GpuError> {
        let color = TextureCopy::record(gpu, &mut encoder, &self.color)?;
        let feature = TextureCopy::record(gpu, &mut encoder, &self.feature)?;
        let submission = gpu.queue.submit([encoder.finish()]);
        Ok(DrawnTile { color, feature, size: self.size(), submission })
    }
}

/// What was drawn to the textures, on its way back.
pub(crate) struct DrawnTile {
    color: TextureCopy,
    feature: TextureCopy,
    size: (u32, u32),
    submission: wgpu::SubmissionIndex,
}

impl DrawnTile {
    /// Waits until it is drawn, and reads it. What was submitted after it may still be drawn.
    pub fn read(self, gpu: &Gpu, progress: &dyn Fn(&'static str)) -> Result<Rendering, GpuError> {
        let Self { color, feature, size, submission } = self;
        let read = || -> Result<Rendering, DriverError> {
            wait(gpu, &[&color, &feature], Some(submission))?;
            progress("reading the picture back");
            let pixels = color.pixels(size)?;
            let (features, depth_m) = feature.texels::<8>()?.into_iter().map(feature_and_depth).unzip();
            Ok(Rendering { pixels, depth_m, features })
        };
        read().map_err(|error| gpu.driver_error("reading the picture back", error))
    }
}

/// The pixels of a texture of four bytes a pixel, red or blue first, that can be copied from; waits for the commands before.
///
/// # Errors
/// See [`GpuError`].
pub fn read_pixels(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Pixels, GpuError> {
    gpu.guarded("reading a frame back", || {
        let mut encoder = gpu.encoder("copy of a frame");
        let copy = TextureCopy::record(gpu, &mut encoder, texture)?;
        gpu.queue.submit([encoder.finish()]);
        let read = || -> Result<Pixels, DriverError> {
            wait(gpu, &[&copy], None)?;
            let mut pixels = copy.pixels((texture.width(), texture.height()))?;
            if texture.format().remove_srgb_suffix() == wgpu::TextureFormat::Bgra8Unorm {
                pixels.data_mut().iter_mut().for_each(|Srgba([blue, _, red, _])| std::mem::swap(blue, red));
            }
            Ok(pixels)
        };
        read().map_err(|error| gpu.driver_error("reading a frame back", error))
    })
}

/// Waits until the processor can read `copies`, which were submitted then, or before now.
pub(crate) fn wait(
    gpu: &Gpu,
    copies: &[&TextureCopy],
    submission_index: Option<wgpu::SubmissionIndex>,
) -> Result<(), DriverError> {
    let (sender, mapped) = mpsc::channel();
    for copy in copies {
        let sender = sender.clone();
        copy.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // A receiver that is gone has already reported why.
            let _ = sender.send(result);
        });
    }
    drop(sender);
    gpu.device.poll(wgpu::PollType::Wait { submission_index, timeout: Some(TIMEOUT) })?;
    for _ in copies {
        mapped.recv().map_err(|_| DriverError::Crash)??;
    }
    Ok(())
}

impl TextureCopy {
    /// Records the copying of a texture.
    pub fn record(
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
    ) -> Result<Self, GpuError> {
        let (width, height) = (texture.width(), texture.height());
        let row_bytes = width * texture.format().block_copy_size(None).unwrap_or(16);
        let bytes_per_row = wgpu::util::align_to(row_bytes, wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let size = u64::from(bytes_per_row) * u64::from(height);
        gpu.check_size(|| format!("a picture of {width}×{height} pixels"), size)?;
        let label = Some("copy of a picture");
        let descriptor = wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false };
        let buffer = gpu.device.create_buffer(&descriptor);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes_per_row),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
        Ok(Self { buffer, bytes_per_row, row_bytes })
    }

    /// Opaque pixels of texels of four bytes, red first.
    fn pixels(&self, (width, height): (u32, u32)) -> Result<Pixels, DriverError> {
        let colors = self.texels::<4>()?.into_iter();
        let colors = colors.map(|[red, green, blue, _]| Srgba::opaque(red, green, blue)).collect();
        Pixels::from_data(width, height, colors).ok_or(DriverError::TooFewPixels)
    }

    /// The texels, of `N` bytes each, without padding.
    pub fn texels<const N: usize>(&self) -> Result<Vec<[u8; N]>, wgpu::MapRangeError> {
        let view = self.buffer.get_mapped_range(..)?;
        let rows = view.chunks_exact(self.bytes_per_row as usize);
        Ok(rows.flat_map(|row| row[..self.row_bytes as usize].as_chunks().0).copied().collect())
    }
}

/// The content of a texel of the feature texture; a depth of 0 is infinite.
pub(crate) fn feature_and_depth([a, b, c, d, e, f, g, h]: [u8; 8]) -> (FeatureId, f32) {
    let depth_m = f32::from_ne_bytes([e, f, g, h]);
    let feature = FeatureId(u32::from_ne_bytes([a, b, c, d]));
    (feature, if depth_m > 0.0 { depth_m } else { f32::INFINITY })
}

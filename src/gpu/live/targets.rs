//! The targets that frames are drawn to before they are shown: samples, depths, and colors where the window's texture
//! cannot hold them.

use crate::error::GpuError;
use crate::formats::{COLOR, DEPTH};
use crate::layouts::Layouts;
use crate::memory::{Loader, bind, texture, view};

/// The textures for frames of one size.
#[derive(Debug)]
pub struct LiveTargets {
    pub size: (u32, u32),
    /// Where there are several samples per pixel.
    pub samples: Option<wgpu::TextureView>,
    /// Colors to be encoded, where the window's texture does not encode them.
    pub linear: Option<wgpu::TextureView>,
    pub depth: wgpu::TextureView,
    /// The depths as a binding for shaders, where the ground is shaded pixel by pixel.
    pub depths_read: Option<wgpu::BindGroup>,
}

/// The properties that the textures of frames depend on.
#[derive(Clone, Copy, Debug)]
pub struct LiveFormat {
    /// The format of the window's texture.
    pub window: wgpu::TextureFormat,
    pub samples: u32,
    /// Whether the ground is shaded pixel by pixel.
    pub shade_pixels: bool,
}

impl LiveFormat {
    /// The format that scenes are drawn in: always one that encodes, since light adds up before it is encoded.
    pub fn drawn(self) -> wgpu::TextureFormat {
        if self.window.is_srgb() { self.window } else { COLOR }
    }
}

impl LiveTargets {
    pub fn new(
        loader: &Loader<'_>,
        layouts: &Layouts,
        format: LiveFormat,
        size: (u32, u32),
    ) -> Result<Self, GpuError> {
        let (width, height) = size;
        let what = || format!("the {width}×{height} pixels of the window");
        let create = |label, texels, sample_count, usage| {
            let descriptor = wgpu::TextureDescriptor {
                sample_count,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                ..texture(label, width, height, texels)
            };
            Ok::<_, GpuError>(view(&loader.texture(what, &descriptor)?))
        };
        let (kept, read) = (wgpu::TextureUsages::empty(), wgpu::TextureUsages::TEXTURE_BINDING);
        let drawn = format.drawn();
        let samples = (format.samples > 1).then(|| create("color samples", drawn, format.samples, kept));
        let linear = (drawn != format.window).then(|| create("colors to encode", drawn, 1, read));
        let depth = create("depths", DEPTH, format.samples, if format.shade_pixels { read } else { kept })?;
        let depths_read = format.shade_pixels.then(|| {
            bind(loader.gpu, "depths", &layouts.depths, [wgpu::BindingResource::TextureView(&depth)])
        });
        Ok(Self { size, samples: samples.transpose()?, linear: linear.transpose()?, depth, depths_read })
    }
}

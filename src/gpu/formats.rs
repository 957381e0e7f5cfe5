//! The formats of the textures that are drawn to.

pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// The format of depth. Reversed depth needs floats: their resolution near zero is why it is reversed.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Feature numbers and the bits of depths in meters: integers, because OpenGL ES need not draw to floats.
pub const FEATURE: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

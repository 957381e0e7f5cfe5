//! The renderer of graphics adapters, where it is built in (feature `gpu`): all pictures of a process are drawn on one device.

use sandtable_render::OtherRenderer;

#[cfg(feature = "gpu")]
pub const GPU: Option<OtherRenderer> =
    Some(|list, camera, progress| Ok(sandtable_gpu::render(list, camera, progress)?));

#[cfg(not(feature = "gpu"))]
pub const GPU: Option<OtherRenderer> = None;

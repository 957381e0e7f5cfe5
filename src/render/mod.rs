//! Draw lists to pictures: `cpu/` is deterministic and needs nothing but the processor, `gpu/` needs an
//! adapter; both draw the same list, and
//! read far ground and far textures from the same smaller levels.

pub mod cpu;
pub mod gpu;
mod ground_levels;
mod mip_levels;
pub mod picture;

//! Draw lists to pictures: `cpu/` is deterministic and needs nothing but the processor, `gpu/` needs an
//! adapter; both draw the same list.

pub mod cpu;
pub mod gpu;
pub mod picture;

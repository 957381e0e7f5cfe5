//! Pictures by a graphics adapter, and its shaders.

#[path = "../common/adapters.rs"]
mod adapters;
#[path = "../common/mod.rs"]
mod common;

mod render_gpu;
mod render_live;
mod render_live_culling;
mod render_parity;
mod shaders;
mod shadow_maps;

//! The types that `lib.rs` re-exports, for programs that use this crate as a library.

pub mod analysis;
pub mod dem;
pub mod elevation;
pub mod error;
pub mod gpu_renderer;
pub mod plan;
#[cfg(feature = "cli")]
pub mod program;
pub mod scene;
pub mod scene_data;
pub mod scene_files;
pub mod symbol;
pub mod terrain;

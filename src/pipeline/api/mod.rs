//! The types that `lib.rs` offers: a few over the modules below, for programs that use this crate as a library.

pub mod dem;
pub mod error;
pub mod scene;
pub mod terrain;

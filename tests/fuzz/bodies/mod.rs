//! What the fuzz targets do with bytes: each reads or builds something that strangers write, and asks the product's own
//! `check()` whether what came of it is sound. Errors are answers; panics, hangs and unsound results are finds.
//!
//! `cargo test` runs each of them on seeds and on mutants of these (`tests/fuzz/main.rs`).

#![allow(dead_code, reason = "a fuzz target runs one of them")]

mod byte_source;
mod readers;
mod scenes;
mod walks;

pub use readers::{elevation, expressions, models_3ds, models_gltf, models_obj, points, scene_text, vectors};
pub use scenes::{scene_build, scene_picture};
pub use walks::walk;

/// A target: its name, and what it does.
pub type Target = (&'static str, fn(&[u8]));

/// All of them.
pub const TARGETS: &[Target] = &[
    ("elevation", elevation),
    ("points", points),
    ("vectors", vectors),
    ("models_3ds", models_3ds),
    ("models_obj", models_obj),
    ("models_gltf", models_gltf),
    ("scene_text", scene_text),
    ("expressions", expressions),
    ("scene_build", scene_build),
    ("scene_picture", scene_picture),
    ("walk", walk),
];

//! Pictures: golden pictures, both renderers, annotations.

#[path = "../common/mod.rs"]
mod common;

mod annotate;
mod gallery;
mod grid;
mod grid_numbers;
mod level_ground;
mod overlaps;
mod panorama;
mod print;
mod render_cpu;
mod symbols;

//! Scene files, models and what a scene shows.

#[path = "../common/mod.rs"]
mod common;

mod analyses;
mod analysis_pages;
mod assets;
mod buffers;
mod clearance;
mod detail;
mod dtm;
mod editing;
mod flights;
mod graphics;
mod imagery;
mod instances;
mod labels;
mod military;
mod models;
mod odd_scenes;
mod own_models;
mod parallel;
mod parallel_shadows;
mod placement;
mod recut;
mod scatter;
mod scene_file;
mod symbols;
mod walk;

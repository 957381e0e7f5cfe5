//! From files to results: open, build, draw, annotate, write.
//!
//! ```text
//! files ─► dem ─► ground ─► dataset ──► profile, sight, viewshed     answers about the ground
//!   │                          ▲   └──► viewshed_map, charts         and their pictures
//!   └────► scene_file ─────────┴──────► picture ◄── labels           pictures of scenes
//! ```
//!
//! Programs share these steps. No step reads arguments or the clock, and none prints: a step returns values, notes
//! for the user and typed errors.

pub mod addressed_files;
pub mod api;
pub mod bounded_mesh;
pub mod choice;
mod contour_marks;
pub mod convert;
pub mod csv;
pub mod dataset;
pub mod dem;
pub mod editing;
pub mod error;
pub mod export;
pub mod files;
pub mod fingerprint;
pub mod fly;
pub mod graphic_texts;
pub mod grid;
pub mod gridding;
pub mod ground;
pub mod heights_above;
pub mod labels;
pub mod legend;
mod legend_overlay;
mod legend_symbols;
mod line_labels;
pub mod lint;
pub mod lod;
pub mod look;
pub mod margin;
pub mod military;
pub mod model_file;
pub mod new_scene;
pub mod output_files;
pub mod outside_note;
pub mod page;
mod page_symbols;
pub mod paged_elevation;
pub mod part_file;
pub mod part_name;
pub mod parted_elevation;
pub mod picture;
pub mod picture_buffers;
pub mod picture_statistics;
pub mod positions;
pub mod post_raster;
pub mod print_ink;
pub mod print_model;
pub mod profile;
pub mod raster_file;
pub mod rim;
pub mod scene_file;
pub mod service;
pub mod set_record;
pub mod shards;
pub mod sheet_file;
pub mod sidecar;
pub mod sight;
pub mod view_snapshot;
pub mod viewing;
pub mod viewshed;
pub mod viewshed_map;
pub mod walk;
pub mod windowed_elevation;

//! Annotated pictures of scenes: a view is drawn, its names, legend, grid and margin are laid out, and the sheet is written.
//!
//! ```text
//! scene, view ─► picture ─► labels, legend, grid, margin, rim ─► sheet_file     PNG, PDF, SVG
//!                   ├─────► panorama, with peaks_in_sight
//!                   └─────► picture_buffers, picture_statistics, sidecar       what the pixels show
//! in_order              several pictures at once
//! ```

pub mod analysis_map;
mod contour_marks;
pub mod graphic_texts;
pub mod grid;
pub mod in_order;
pub mod labels;
pub mod legend;
pub mod legend_overlay;
mod legend_symbols;
mod line_end;
mod line_labels;
pub mod look;
pub mod margin;
pub mod military;
pub mod panorama;
pub mod peaks_in_sight;
pub mod picture;
pub mod picture_buffers;
pub mod picture_middle;
pub mod picture_statistics;
pub mod print_ink;
pub mod relief;
pub mod rim;
mod rock_hachures;
pub mod sheet_file;
mod shown_elevation;
pub mod sidecar;
pub mod step_watch;
pub mod viewshed_map;

//! Names, heights and furniture painted on a finished picture; charts and map sheets.
//!
//! [`paint::annotate`] takes a picture and [`annotation::Annotations`] in picture coordinates, paints them, and returns
//! a [`report::AnnotationReport`] of the annotations that were drawn and those that were left out.
//!
//! ```text
//! Annotations ──► furniture (title, north, scale_bar, legend, credit) ──► Drawing ─┬─► canvas ──► Pixels
//!             ├─► margin, on a sheet_frame (the same, norths, locator) ─► Drawing ─┼─► pdf
//!             ├─► azimuth_scale, skyline_names, of a panorama ─────────► Drawing ─┤
//!             ├─► rim, grid, figure ───────────────────────────────────► Drawing ─┼─► svg
//!             └─► labels ──► positions ──► place (pure, two dimensions) ─► Drawing ─┘
//! ```
//!
//! Every mark is a filled path, so that the box with which a thing is laid out is the box that it paints. Type is set
//! in the fonts embedded in the program and never in the machine's: the same input gives the same bytes everywhere.

pub mod annotation;
mod azimuth_scale;
mod canvas;
pub mod chart;
pub mod chart_ground;
pub mod chart_profile;
pub mod chart_sight;
pub mod class_legend;
mod composer;
pub mod contact_sheet;
mod contour_label;
pub mod cover;
mod credit;
mod drawing;
pub mod figure;
mod fixed_text;
pub mod fonts;
pub mod grid;
mod halo;
mod label_style;
mod labels;
pub mod legend;
pub mod letter_course;
mod line_label;
pub mod locator;
pub mod map;
pub mod margin;
pub mod margin_table;
pub mod nice;
pub mod north;
pub mod norths;
mod occupied;
pub mod paint;
mod paragraph;
pub mod pdf;
mod pdf_font;
mod pdf_stream;
mod pixel_box;
mod place;
pub mod placed_figure;
mod point_label;
mod positions;
pub mod report;
pub mod rim;
pub mod scale_bar;
mod sheet;
pub mod sheet_frame;
mod shield;
mod skyline_names;
pub mod svg;
mod symbol_drawing;
mod symbol_field;
mod symbol_list;
pub mod symbol_picture;
mod symbol_stack;
mod symbols;
mod tapered;
mod text;
mod title;

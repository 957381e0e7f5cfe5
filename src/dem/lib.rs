//! Elevation files: one file per format, pictures of the ground, scattered points and grids of them. What is read is a
//! raster of `sandtable-raster`.

pub mod companion;
mod dem_file;
pub mod dem_format;
mod file_name;
pub mod formats;
pub mod gridding;
pub mod hints;
pub mod imagery;
mod lerc;
mod point_text;
pub mod points;
pub mod read;
#[cfg(test)]
mod small_raster;
pub mod tiff;
pub mod vrt;
mod vrt_fault;
mod vrt_frame;
pub mod vrt_source;
pub mod write;
pub mod written;
mod wrong_lines;

/// The program of the README runs as a test.
#[cfg(doctest)]
#[doc = include_str!("README.md")]
pub struct DemReadme;

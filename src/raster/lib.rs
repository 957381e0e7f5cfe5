//! Elevation values: rasters in memory and in windows, mosaics, statistics, voids, other systems and cells. No file format is
//! known here.
//!
//! ```
//! use glam::DVec2;
//! use sandtable_raster::raster::{Raster, Samples, north_up_nodes};
//! use sandtable_raster::sample::bilinear;
//!
//! let place = north_up_nodes(DVec2::new(500_000.0, 4_000_030.0), DVec2::splat(30.0));
//! let raster = Raster::new(2, Samples::F32(vec![1.0, 2.0, 3.0, 4.0])).placed(place);
//! assert_eq!(bilinear(&raster, DVec2::new(500_015.0, 4_000_015.0)).height_m(), Some(2.5));
//! ```

pub mod answer;
pub mod cache;
pub mod cell_grid;
pub mod content;
pub mod crop;
pub mod error;
pub mod georef;
pub mod height_datum;
pub mod largest_rectangle;
pub mod limits;
pub mod mosaic;
pub mod mosaic_windows;
mod north_up;
pub mod outliers;
pub mod raster;
pub mod read_ahead;
pub mod reduced;
pub mod reduced_windows;
pub mod sample;
pub mod sample_type;
pub mod stats;
pub mod stored;
pub mod undeclared;
pub mod units;
pub mod vertical;
pub mod void_counts;
pub mod voids;
pub mod warp;
pub mod windows;

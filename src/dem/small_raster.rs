//! A small raster for unit tests.

use glam::DVec2;

use sandtable_raster::raster::{Raster, Samples, north_up};

/// A raster in meters, ten apart, whose south-west outer corner is at (1000, 2000).
pub(crate) fn small(width: u32, height: u32, values: Vec<f32>) -> Raster {
    assert_eq!(values.len(), (width * height) as usize);
    let corner = DVec2::new(1000.0, 2000.0 + 10.0 * f64::from(height));
    Raster::new(width, Samples::F32(values)).placed(north_up(corner, DVec2::splat(10.0)))
}

//! An elevation raster as a file holds it.

use glam::{DAffine2, DVec2};

use crate::geom::crs::Crs;

/// Elevations row by row from the raster's first sample, with their georeference.
///
/// A value is the elevation at its sample's centre: sample (column, row) stands at grid position
/// (column + 0.5, row + 0.5), as GDAL counts. Formats whose values stand on grid nodes are shifted by half
/// a sample to meet this.
#[derive(Clone, Debug)]
pub struct Raster {
    /// The format it was read from, as GDAL names its drivers: `GTiff`, `AAIGrid`, `PNG`, …
    pub driver: &'static str,
    /// Samples per row; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// Elevations in the file's vertical unit with scale and offset applied, NaN where there is no data.
    pub samples: Samples,
    /// Grid position (column, row) to map coordinates.
    pub map_from_grid: DAffine2,
    /// The coordinate reference system; `None` where the file names none.
    pub crs: Option<Crs>,
    /// The value that stood for no data in the file, before it became NaN.
    pub nodata: Option<f64>,
}

/// Elevations in the precision that keeps the file's values exact.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// From integers of up to 16 bits and 32-bit floats.
    F32(Vec<f32>),
    /// From 32-bit integers and 64-bit floats.
    F64(Vec<f64>),
}

impl Samples {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at `index`, NaN where there is no data. Panics out of range.
    pub fn get(&self, index: usize) -> f64 {
        match self {
            Self::F32(values) => f64::from(values[index]),
            Self::F64(values) => values[index],
        }
    }
}

impl Raster {
    /// The value at `column`, `row`, NaN where there is no data. Panics outside the raster.
    pub fn at(&self, column: u32, row: u32) -> f64 {
        assert!(column < self.width && row < self.height, "sample ({column}, {row}) is outside the raster");
        self.samples.get(row as usize * self.width as usize + column as usize)
    }

    /// Grid position (column, row) of a point in the raster's own coordinates; NaN where the georeference
    /// cannot be inverted.
    pub fn grid_from_map(&self, at: DVec2) -> DVec2 {
        self.map_from_grid.inverse().transform_point2(at)
    }
}

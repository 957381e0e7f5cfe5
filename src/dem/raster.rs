//! An elevation raster as a file holds it.

use glam::{DAffine2, DMat2, DVec2};

use crate::geom::crs::Crs;
use crate::geom::rect::Rect;

/// Elevations row by row from the raster's first sample, with their georeference.
///
/// A value is the elevation at its sample's center: sample (column, row) stands at grid position
/// (column + 0.5, row + 0.5), as GDAL counts. Formats whose values stand on grid nodes are shifted by half
/// a sample to meet this.
#[derive(Clone, Debug)]
pub struct Raster {
    /// The format it was read from, as GDAL names its drivers: `GTiff`, `AAIGrid`, `PNG`, `BT`, `SRTMHGT`.
    pub driver: &'static str,
    /// The type of a stored sample, as GDAL names its types: `Byte`, `Int8`, `UInt16`, `Int16`, `UInt32`, `Int32`,
    /// `UInt64`, `Int64`, `Float32`, `Float64`. What text holds is told by its values.
    pub data_type: &'static str,
    /// Samples per row; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// Elevations in the file's vertical unit with scale and offset applied, NaN where there is no data.
    pub samples: Samples,
    /// Meters in the vertical unit: 1, or 0.3048 and the like where the file states feet.
    pub meters_per_z: f64,
    /// Grid position (column, row) to map coordinates; can be inverted.
    pub map_from_grid: DAffine2,
    /// Whether `map_from_grid` was stated by the file, a companion or the caller; where not, samples were set
    /// 1 apart with the center of the south-west sample at (0, 0).
    pub georeferenced: bool,
    /// The coordinate reference system; `None` where the file names none.
    pub crs: Option<Crs>,
    /// The value that stood for no data in the file, before it became NaN and before scale and offset.
    pub nodata: Option<f64>,
    /// What heights are counted from, in the file's words (`NAVD88`, `EGM96 geoid`); `None` where it does not say.
    /// Carried along and printed, never computed with.
    pub vertical_datum: Option<String>,
}

/// Elevations in the precision that keeps the file's values exact.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// From integers of up to 16 bits, 32-bit floats and text.
    F32(Vec<f32>),
    /// From wider integers, 64-bit floats, and whatever a scale or an offset was applied to.
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

    /// All values in order, NaN where there is no data.
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// Makes the value at `index` no data; nothing beyond the end.
    pub(crate) fn clear(&mut self, index: usize) {
        match self {
            Self::F32(values) => values.get_mut(index).map_or((), |value| *value = f32::NAN),
            Self::F64(values) => values.get_mut(index).map_or((), |value| *value = f64::NAN),
        }
    }

    /// Puts `value`, NaN for no data, at `index`; nothing beyond the end.
    pub(crate) fn set(&mut self, index: usize, value: f64) {
        match self {
            Self::F32(values) => values.get_mut(index).map_or((), |old| *old = value as f32),
            Self::F64(values) => values.get_mut(index).map_or((), |old| *old = value),
        }
    }

    /// These values times `factor` plus `offset`, in 64 bits; unchanged where that changes nothing.
    pub(crate) fn scaled(self, factor: f64, offset: f64) -> Self {
        if factor == 1.0 && offset == 0.0 {
            return self;
        }
        Self::F64(self.iter().map(|value| scaled(value, factor, offset)).collect())
    }
}

/// A value times `factor` plus `offset`; the value itself where that changes nothing.
pub(crate) fn scaled(value: f64, factor: f64, offset: f64) -> f64 {
    if factor == 1.0 && offset == 0.0 { value } else { value * factor + offset }
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
        // The large map coordinates cancel before the small cell divides them.
        self.map_from_grid.matrix2.inverse() * (at - self.map_from_grid.translation)
    }

    /// Distance between neighboring samples along a row and along a column, in map units.
    pub fn spacing(&self) -> DVec2 {
        let axes = self.map_from_grid.matrix2;
        DVec2::new(axes.x_axis.length(), axes.y_axis.length())
    }

    /// Whether rows run east and columns run south, as maps are printed.
    pub fn is_north_up(&self) -> bool {
        let DMat2 { x_axis, y_axis } = self.map_from_grid.matrix2;
        x_axis.y == 0.0 && y_axis.x == 0.0 && x_axis.x > 0.0 && y_axis.y < 0.0
    }

    /// Map coordinates of the center of the raster.
    pub fn center(&self) -> DVec2 {
        self.map_from_grid.transform_point2(self.grid_size() * 0.5)
    }

    /// The smallest map rectangle around all samples, out to their outer edges.
    pub fn extent(&self) -> Rect {
        let size = self.grid_size();
        let corners = [DVec2::ZERO, DVec2::new(size.x, 0.0), DVec2::new(0.0, size.y), size];
        Rect::around(corners.map(|corner| self.map_from_grid.transform_point2(corner)))
    }

    /// The georeference in GDAL's order: x of the corner, x per column, x per row, y of the corner, y per
    /// column, y per row.
    pub fn geotransform(&self) -> [f64; 6] {
        let DAffine2 { matrix2: DMat2 { x_axis, y_axis }, translation } = self.map_from_grid;
        [translation.x, x_axis.x, y_axis.x, translation.y, x_axis.y, y_axis.y]
    }

    fn grid_size(&self) -> DVec2 {
        DVec2::new(f64::from(self.width), f64::from(self.height))
    }
}

/// The map position of a grid whose rows run east and columns south: `corner` is the outer north-west corner.
pub(crate) fn north_up(corner: DVec2, cell: DVec2) -> DAffine2 {
    DAffine2 { matrix2: DMat2::from_diagonal(DVec2::new(cell.x, -cell.y)), translation: corner }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A raster in meters, ten apart, whose south-west outer corner is at (1000, 2000).
    pub(crate) fn small(width: u32, height: u32, values: Vec<f32>) -> Raster {
        assert_eq!(values.len(), (width * height) as usize);
        Raster {
            driver: "test",
            data_type: "Float32",
            width,
            height,
            samples: Samples::F32(values),
            meters_per_z: 1.0,
            map_from_grid: north_up(
                DVec2::new(1000.0, 2000.0 + 10.0 * f64::from(height)),
                DVec2::splat(10.0),
            ),
            georeferenced: true,
            crs: None,
            nodata: None,
            vertical_datum: None,
        }
    }

    #[test]
    fn grid_and_map_are_each_others_inverse() {
        let raster = small(3, 2, vec![0.0; 6]);
        assert_eq!(raster.grid_from_map(DVec2::new(1000.0, 2020.0)), DVec2::ZERO);
        assert_eq!(raster.grid_from_map(DVec2::new(1030.0, 2000.0)), DVec2::new(3.0, 2.0));
        assert_eq!(
            raster.extent(),
            Rect { min: DVec2::new(1000.0, 2000.0), max: DVec2::new(1030.0, 2020.0) }
        );
        assert_eq!(raster.geotransform(), [1000.0, 10.0, 0.0, 2020.0, 0.0, -10.0]);
        assert!(raster.is_north_up());
    }
}

//! Elevation rasters in memory.

use std::borrow::Cow;
use std::fmt::Display;
use std::ops::Range;

use glam::{DAffine2, DMat2, DVec2};
use rayon::iter::repeat_n;
use rayon::prelude::*;

use crate::file_bands::FileBands;
use crate::nodata_span::NoDataSpan;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;

/// Elevations row by row from the raster's first sample, with their georeference.
///
/// A value is the elevation at its sample's center: sample (column, row) has its center at grid position
/// (column + 0.5, row + 0.5), as in GDAL. Formats whose values lie on grid nodes are shifted by half a sample.
#[derive(Clone, Debug)]
pub struct Raster {
    /// The format it was read from, as GDAL names its drivers: `GTiff`, `AAIGrid`, `PNG`, `BT`, `SRTMHGT`.
    pub driver: &'static str,
    /// The type of a stored sample, as GDAL names its types: `Byte`, `Int8`, `UInt16`, `Int16`, `UInt32`, `Int32`,
    /// `UInt64`, `Int64`, `Float32`, `Float64`. The type of text follows from its values.
    pub data_type: &'static str,
    /// Samples per row; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// Elevations in the file's vertical unit with scale and offset applied, NaN where there is no data.
    pub samples: Samples,
    /// Meters in the vertical unit: 1, or 0.3048 and the like where the file states feet.
    pub meters_per_z: f64,
    /// Whether the file, a companion or the format itself states that unit; where not, meters are taken.
    pub states_z_unit: bool,
    /// Grid position (column, row) to map coordinates; can be inverted.
    pub map_from_grid: DAffine2,
    /// Whether the file, a companion or the caller stated `map_from_grid`; where not, samples are 1 apart and the
    /// center of the south-west one is at (0, 0).
    pub georeferenced: bool,
    /// The coordinate reference system; `None` where the file names none.
    pub crs: Option<Crs>,
    /// The file's value for no data, before scale and offset.
    pub nodata: Option<f64>,
    /// The vertical datum in the file's words (`NAVD88`); `None` where not stated.
    pub vertical_datum: Option<String>,
    /// The bands of the file, of which the samples are the first.
    pub bands: FileBands,
    /// What was guessed or left out where the file was read, a sentence each, for the user.
    pub notes: Vec<String>,
}

/// Elevations in the precision that keeps the file's values exact.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// From integers of up to 16 bits, 32-bit floats and text.
    F32(Vec<f32>),
    /// From wider integers, 64-bit floats, and values with a scale or an offset.
    F64(Vec<f64>),
}

/// Samples up to which one thread fills memory sooner than all: some milliseconds.
const FILLED_ALONE: usize = 1 << 20;

/// A float type of [`Samples`].
pub trait SampleFloat: Copy + Default + Display + Into<f64> + PartialOrd + Send + Sync {
    /// The value without data: NaN.
    const NODATA: Self;

    /// The nearest value of this type.
    fn from_f64(value: f64) -> Self;

    /// Values as samples of this type.
    fn into_samples(values: Vec<Self>) -> Samples;

    /// The values of samples of this type.
    fn values(samples: &Samples) -> Option<&[Self]>;
}

macro_rules! sample_floats {
    ($($float:ident: $samples:ident),*) => {$(
        impl SampleFloat for $float {
            const NODATA: Self = Self::NAN;

            #[inline]
            fn from_f64(value: f64) -> Self {
                value as Self
            }

            #[inline]
            fn into_samples(values: Vec<Self>) -> Samples {
                Samples::$samples(values)
            }

            #[inline]
            fn values(samples: &Samples) -> Option<&[Self]> {
                match samples {
                    Samples::$samples(values) => Some(values),
                    _ => None,
                }
            }
        }
    )*};
}

sample_floats!(f32: F32, f64: F64);

impl Samples {
    /// The number of samples.
    #[inline]
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
        }
    }

    /// Whether there is none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at `index`, NaN where there is no data. Panics out of range.
    #[inline]
    pub fn get(&self, index: usize) -> f64 {
        match self {
            Self::F32(values) => f64::from(values[index]),
            Self::F64(values) => values[index],
        }
    }

    /// All values in order, NaN where there is no data.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// All values that are data, in order.
    #[inline]
    pub fn valid(&self) -> impl Iterator<Item = f64> + '_ {
        self.iter().filter(|value| !value.is_nan())
    }

    /// Samples without data, of 64 bits where `is_wide`.
    pub fn absent(count: usize, is_wide: bool) -> Self {
        // Of a large raster the first touch of the memory takes longer than the filling: all threads do it.
        match (is_wide, count > FILLED_ALONE) {
            (true, true) => Self::F64(repeat_n(f64::NAN, count).collect()),
            (false, true) => Self::F32(repeat_n(f32::NAN, count).collect()),
            (true, false) => Self::F64(vec![f64::NAN; count]),
            (false, false) => Self::F32(vec![f32::NAN; count]),
        }
    }

    /// Whether they take 64 bits.
    #[inline]
    pub fn is_wide(&self) -> bool {
        matches!(self, Self::F64(_))
    }

    /// Copies the samples `range` of others, which have this precision or a lower one, to `to`. Panics out of range.
    pub fn copy_from(&mut self, to: Range<usize>, from: &Self, range: Range<usize>) {
        match (self, from) {
            (Self::F32(values), Self::F32(from)) => values[to].copy_from_slice(&from[range]),
            (Self::F64(values), Self::F64(from)) => values[to].copy_from_slice(&from[range]),
            (Self::F64(values), Self::F32(from)) => {
                values[to].iter_mut().zip(&from[range]).for_each(|(to, &from)| *to = from.into());
            }
            (Self::F32(_), Self::F64(_)) => panic!("samples of 64 bits are copied to 32"),
        }
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        match self {
            Self::F32(values) => size_of_val(values.as_slice()),
            Self::F64(values) => size_of_val(values.as_slice()),
        }
    }

    /// Sets the value at `index`, NaN for no data. Panics out of range.
    #[inline]
    pub fn set(&mut self, index: usize, value: f64) {
        match self {
            Self::F32(values) => values[index] = value as f32,
            Self::F64(values) => values[index] = value,
        }
    }

    /// Makes every sample one without data that a stated no-data value means ([`NoDataSpan`]).
    pub fn clear(&mut self, stated: f64) {
        fn clear<T: SampleFloat>(values: &mut [T], stated: f64) {
            let (low, high) = NoDataSpan::around(stated).ends::<T>();
            values.iter_mut().filter(|at| **at >= low && **at <= high).for_each(|at| *at = T::NODATA);
        }
        match self {
            Self::F32(values) => clear(values, stated),
            Self::F64(values) => clear(values, stated),
        }
    }

    /// These values times `factor` plus `offset`, in 64 bits; unchanged where that changes nothing.
    pub fn scaled(self, factor: f64, offset: f64) -> Self {
        if factor == 1.0 && offset == 0.0 {
            return self;
        }
        Self::F64(self.iter().map(|value| scaled(value, factor, offset)).collect())
    }
}

/// A value times `factor` plus `offset`; the value itself where that changes nothing.
#[inline]
pub fn scaled(value: f64, factor: f64, offset: f64) -> f64 {
    if factor == 1.0 && offset == 0.0 { value } else { value * factor + offset }
}

impl Raster {
    /// The samples west, east, north and south of a sample, by index; `None` beyond the border.
    pub(crate) fn beside(&self, at: usize) -> [Option<usize>; 4] {
        let (width, height) = (self.width as usize, self.height as usize);
        let (column, row) = (at % width, at / width);
        [
            (column > 0).then(|| at - 1),
            (column + 1 < width).then_some(at + 1),
            (row > 0).then(|| at - width),
            (row + 1 < height).then_some(at + width),
        ]
    }

    /// The samples along the border, by index: rows first, then columns with the corners again.
    pub(crate) fn border(&self) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.width as usize, self.height as usize);
        let columns = (0..height).flat_map(move |row| [row * width, row * width + width - 1]);
        (0..width).chain((height - 1) * width..height * width).chain(columns)
    }

    /// A raster in memory of rows of `width` samples, in meters, without a georeference.
    ///
    /// # Panics
    /// `samples` are not a whole number of rows, or none.
    ///
    /// ```
    /// use sandtable_raster::raster::{Raster, Samples};
    /// let raster = Raster::new(2, Samples::F32(vec![1.0, 2.0, 3.0, 4.0]));
    /// assert_eq!((raster.height, raster.at(1, 0)), (2, 2.0));
    /// ```
    pub fn new(width: u32, samples: Samples) -> Self {
        let count = samples.len();
        assert!(
            width > 0 && count > 0 && count.is_multiple_of(width as usize),
            "{count} samples, {width} a row"
        );
        let height = (count / width as usize) as u32;
        let data_type = if samples.is_wide() { "Float64" } else { "Float32" };
        Self { data_type, samples, ..Self::without_place(width, height) }
    }

    /// A raster in memory without its samples and without a georeference.
    pub fn without_place(width: u32, height: u32) -> Self {
        Self {
            driver: "MEM",
            data_type: "Float32",
            width,
            height,
            samples: Samples::F32(Vec::new()),
            meters_per_z: 1.0,
            states_z_unit: false,
            map_from_grid: north_up_nodes(DVec2::new(0.0, f64::from(height - 1)), DVec2::ONE),
            georeferenced: false,
            crs: None,
            nodata: None,
            vertical_datum: None,
            bands: FileBands::default(),
            notes: Vec::new(),
        }
    }

    /// This raster as that of a file with these bands; a note says where there are others than elevation.
    pub fn with_bands(mut self, bands: FileBands) -> Self {
        self.notes.extend(bands.note());
        Self { bands, ..self }
    }

    /// This raster with a stated georeference.
    pub fn placed(self, map_from_grid: DAffine2) -> Self {
        Self { map_from_grid, georeferenced: true, ..self }
    }

    /// The value at `column`, `row`, NaN where there is no data. Panics outside the raster.
    pub fn at(&self, column: u32, row: u32) -> f64 {
        assert!(column < self.width && row < self.height, "sample ({column}, {row}) is outside the raster");
        self.samples.get(row as usize * self.width as usize + column as usize)
    }

    /// The raster with its heights in meters; borrowed where they are in meters already.
    pub fn in_meters(&self) -> Cow<'_, Self> {
        if self.meters_per_z == 1.0 {
            return Cow::Borrowed(self);
        }
        Cow::Owned(self.clone().into_meters())
    }

    /// The raster with its heights in meters.
    pub fn into_meters(self) -> Self {
        Self { samples: self.samples.scaled(self.meters_per_z, 0.0), meters_per_z: 1.0, ..self }
    }

    /// All but the samples; their precision stays known.
    pub fn without_samples(&self) -> Self {
        let (crs, vertical_datum, notes) =
            (self.crs.clone(), self.vertical_datum.clone(), self.notes.clone());
        Self { samples: Samples::absent(0, self.samples.is_wide()), crs, vertical_datum, notes, ..*self }
    }

    /// Grid position (column, row) of a map position; NaN where the georeference cannot be inverted.
    #[inline]
    pub fn grid_from_map(&self, at: DVec2) -> DVec2 {
        // The large map coordinates cancel before the small cell divides them.
        self.map_from_grid.matrix2.inverse() * (at - self.map_from_grid.translation)
    }

    /// Distance between neighboring samples along a row and along a column, in map units.
    pub fn spacing(&self) -> DVec2 {
        let axes = self.map_from_grid.matrix2;
        DVec2::new(axes.x_axis.length(), axes.y_axis.length())
    }

    /// Whether rows and columns run along the axes of the map, in either direction.
    pub fn is_axis_aligned(&self) -> bool {
        let axes = self.map_from_grid.matrix2;
        axes.x_axis.y == 0.0 && axes.y_axis.x == 0.0
    }

    /// Whether rows run east and columns run south, as maps are printed.
    pub fn is_north_up(&self) -> bool {
        let axes = self.map_from_grid.matrix2;
        self.is_axis_aligned() && axes.x_axis.x > 0.0 && axes.y_axis.y < 0.0
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

    /// The smallest map rectangle around the centers of all samples of an axis-aligned raster.
    pub fn node_extent(&self) -> Rect {
        let (Rect { min, max }, half) = (self.extent(), self.spacing() * 0.5);
        Rect { min: min + half, max: max - half }
    }

    /// The georeference in GDAL's order: x of the corner, x per column, x per row, then the same of y.
    pub fn geotransform(&self) -> [f64; 6] {
        let DAffine2 { matrix2: DMat2 { x_axis, y_axis }, translation } = self.map_from_grid;
        [translation.x, x_axis.x, y_axis.x, translation.y, x_axis.y, y_axis.y]
    }

    /// Samples per row and rows: the grid position of the corner opposite to the first.
    pub fn grid_size(&self) -> DVec2 {
        DVec2::new(f64::from(self.width), f64::from(self.height))
    }
}

/// The map position of a grid whose rows run east and columns south: `corner` is the outer north-west corner.
#[inline]
pub fn north_up(corner: DVec2, cell: DVec2) -> DAffine2 {
    DAffine2 { matrix2: DMat2::from_diagonal(DVec2::new(cell.x, -cell.y)), translation: corner }
}

/// The map position of a grid whose rows run east and columns south: `node` is the center of the north-west sample.
pub fn north_up_nodes(node: DVec2, cell: DVec2) -> DAffine2 {
    north_up(node + DVec2::new(-0.5, 0.5) * cell, cell)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A raster in meters, ten apart, whose south-west outer corner is at (1000, 2000).
    pub(crate) fn small(width: u32, height: u32, values: Vec<f32>) -> Raster {
        assert_eq!(values.len(), (width * height) as usize);
        let corner = DVec2::new(1000.0, 2000.0 + 10.0 * f64::from(height));
        Raster::new(width, Samples::F32(values)).placed(north_up(corner, DVec2::splat(10.0)))
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

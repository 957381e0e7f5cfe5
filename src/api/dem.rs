//! Elevation models, as files hold them.

use std::path::Path;
use std::sync::Arc;

use crate::api::error::Error;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemOptions;
use sandtable_files::{disk, raster_file};
use sandtable_geom::crs::Crs;
use sandtable_query::dem;
use sandtable_raster::georef;
use sandtable_raster::raster::{Raster, Samples};

/// An elevation model as read: a raster of heights and where it lies.
#[derive(Clone)]
pub struct Dem {
    pub(in crate::api) raster: Arc<Raster>,
}

/// Samples that make no elevation model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SamplesError {
    /// The rows are not full.
    #[error("{samples} samples are not whole rows of {columns}; give at least one row, all of them full")]
    Rows {
        /// All of them.
        samples: usize,
        /// Samples per row, as stated.
        columns: u32,
    },
    /// There are too many.
    #[error(
        "{0} samples are more than the {RASTER_SAMPLES} of a raster in memory; give fewer, or {RASTER_SAMPLES:#}"
    )]
    TooMany(usize),
    /// They have no place.
    #[error(
        "the geotransform {0:?} is not finite, or its cells have no area; give x of the north-west corner, x per column, x per row, and the same of y"
    )]
    Place([f64; 6]),
}

impl Dem {
    /// Reads an elevation file with its sidecars, or joins the tiles in a folder. The content decides the format.
    ///
    /// # Errors
    /// [`Error::OpenDem`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::open_with(path, &DemOptions::default())
    }

    /// [`Dem::open`] with what the file does not state.
    ///
    /// # Errors
    /// [`Error::OpenDem`].
    pub fn open_with(path: impl AsRef<Path>, options: &DemOptions) -> Result<Self, Error> {
        let mosaic = dem::open(path.as_ref(), options)?;
        Ok(Self { raster: Arc::new(mosaic.raster) })
    }

    /// The elevation model of samples in meters, in rows of `columns` from the north-west, NaN for no data, at the place that
    /// [`Dem::geotransform`] states.
    ///
    /// # Errors
    /// [`Error::Samples`].
    ///
    /// ```
    /// use sandtable::{Dem, Samples};
    /// let samples = Samples::F32(vec![1.0, 2.0, 3.0, 4.0]);
    /// let dem = Dem::from_samples(2, samples, [500.0, 10.0, 0.0, 900.0, 0.0, -10.0], None)?;
    /// assert_eq!((dem.size(), dem.sample(0, 1)), ((2, 2), 3.0));
    /// # Ok::<(), sandtable::Error>(())
    /// ```
    pub fn from_samples(
        columns: u32,
        samples: Samples,
        geotransform: [f64; 6],
        crs: Option<Crs>,
    ) -> Result<Self, Error> {
        let count = samples.len();
        if columns == 0 || count == 0 || !count.is_multiple_of(columns as usize) {
            return Err(SamplesError::Rows { samples: count, columns }.into());
        }
        if count as u64 > RASTER_SAMPLES.get() {
            return Err(SamplesError::TooMany(count).into());
        }
        let place = georef::checked(georef::affine(geotransform));
        let place = place.map_err(|_| SamplesError::Place(geotransform))?;
        Ok(Self { raster: Arc::new(Raster { crs, ..Raster::new(columns, samples).placed(place) }) })
    }

    /// Columns and rows.
    pub fn size(&self) -> (u32, u32) {
        (self.raster.width, self.raster.height)
    }

    /// The coordinate system, where the file states one.
    pub fn crs(&self) -> Option<&Crs> {
        self.raster.crs.as_ref()
    }

    /// The georeference in GDAL's order: x of the outer north-west corner, x per column, x per row, and the same of y.
    pub fn geotransform(&self) -> [f64; 6] {
        self.raster.geotransform()
    }

    /// All samples, row by row from the north-west; NaN for no data. The unit is the file's.
    pub fn samples(&self) -> &Samples {
        &self.raster.samples
    }

    /// The nodata value of the file; `None` where it states none.
    pub fn nodata(&self) -> Option<f64> {
        self.raster.nodata
    }

    /// The sample of a column, counted from 0 in the west, and a row, counted from 0 in the north; NaN for no data.
    /// The unit is the file's.
    ///
    /// # Panics
    /// Outside [`Dem::size`].
    pub fn sample(&self, column: u32, row: u32) -> f64 {
        self.raster.at(column, row)
    }

    /// Writes the raster in the format of the path's extension: `.tif`, `.asc`, `.bt`, `.hgt` or `.png`.
    ///
    /// # Errors
    /// [`Error::NoFormat`], or [`Error::WriteRaster`] where the format cannot hold the raster or the system refuses.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        let format = DemFormat::to_write(&extension).ok_or_else(|| Error::NoFormat(path.to_owned()))?;
        disk::check_output::<&Path>(path, &[])?;
        raster_file::write(&self.raster, format, path, &[])?;
        Ok(())
    }
}

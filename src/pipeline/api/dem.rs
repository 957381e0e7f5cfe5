//! Elevation as it is read and written.

use std::path::Path;
use std::sync::Arc;

use crate::dem::formats::DemFormat;
use crate::dem::raster::Raster;
use crate::geom::crs::Crs;
use crate::pipeline::api::error::Error;
use crate::pipeline::dem::{self, DemOptions};
use crate::pipeline::{files, raster_file};

/// An elevation model as read: a raster of heights and where it lies.
#[derive(Clone)]
pub struct Dem {
    pub(in crate::pipeline::api) raster: Arc<Raster>,
}

impl Dem {
    /// Reads an elevation file with its sidecars, or joins the tiles in a folder. The content decides the format.
    ///
    /// # Errors
    /// [`Error::OpenDem`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        let mosaic = dem::open(path.as_ref(), &DemOptions::default())?;
        Ok(Self { raster: Arc::new(mosaic.raster) })
    }

    /// Columns and rows.
    pub fn size(&self) -> (u32, u32) {
        (self.raster.width, self.raster.height)
    }

    /// The coordinate system, where the file states one.
    pub fn crs(&self) -> Option<&Crs> {
        self.raster.crs.as_ref()
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
        files::check_output::<&Path>(path, &[])?;
        raster_file::write(&self.raster, format, path, &[])?;
        Ok(())
    }
}

//! Writes rasters to the bytes of files.
//!
//! A raster that a format cannot hold is refused with a remedy, except where the format always rounds (an SRTM tile has
//! whole meters): then it is done and noted. [`crate::read::read`] returns the raster again, bit for bit where
//! nothing was rounded.

use crate::dem_format::DemFormat;
use crate::written::{WriteError, WrittenDem};
use sandtable_raster::raster::Raster;

/// Writes `raster` in a format. `name` is the file's name: the place of an SRTM tile is its name, and the extension says
/// which of a format's kinds is meant.
///
/// Heights stay in the raster's vertical unit where the format can name it, and are converted to meters where it
/// cannot.
///
/// # Errors
/// [`WriteError`].
///
/// ```
/// use sandtable_dem::dem_format::DemFormat;
/// use sandtable_dem::hints::DemHints;
/// use sandtable_dem::read::read;
/// use sandtable_dem::write::write;
/// let grid = b"ncols 2\nnrows 2\nxllcorner 500000\nyllcorner 4000000\ncellsize 30\n1 2 3 4.5";
/// let raster = read("a.asc", grid, &DemHints::default())?;
/// let written = write(&raster, DemFormat::to_write("tif").expect("a GeoTIFF"), "a.tif")?;
/// assert_eq!(written.stored, "float32");
/// let again = read("a.tif", &written.bytes, &DemHints::default())?;
/// assert_eq!(again.samples, raster.samples);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(raster: &Raster, format: &DemFormat, name: &str) -> Result<WrittenDem, WriteError> {
    let writer = format.writer.ok_or(WriteError::OnlyRead(format.name))?;
    (writer.write)(raster, name)
}

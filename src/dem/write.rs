//! Writes rasters to the bytes of files.
//!
//! A raster that a format cannot hold is refused with a remedy, except where the format always rounds (an SRTM tile has
//! whole meters): then it is done and noted. [`crate::read::read`] returns the raster again, bit for bit where
//! nothing was rounded.

use std::io;

use crate::error::DemErrorKind;
use crate::formats::DemFormat;
use crate::raster::Raster;

/// The bytes of a file and of those that belong beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenDem {
    /// The file.
    pub bytes: Vec<u8>,
    /// Files of the same name with another extension.
    pub companions: Vec<Companion>,
    /// The type of the stored heights: `float32`, `int16`, `text`.
    pub stored: String,
    /// Notes for the user: rounding, and how to read the file.
    pub notes: Vec<String>,
}

/// A file that was written from windows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenWindows {
    /// The type of the stored heights: `float32`, `int16`.
    pub stored: String,
    /// The number of samples with data.
    pub valid: u64,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// A file that cannot be written from windows.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the causes explain themselves")]
pub enum WriteWindowsError {
    #[error(transparent)]
    Read(#[from] DemErrorKind),
    #[error(transparent)]
    Write(#[from] io::Error),
}

/// A file beside another, of the same name with another extension.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Companion {
    /// The extension without its dot.
    pub extension: &'static str,
    /// The content.
    pub bytes: Vec<u8>,
}

impl WrittenDem {
    /// A file alone, without notes.
    pub(crate) fn new(bytes: Vec<u8>, stored: &str) -> Self {
        Self { bytes, companions: Vec::new(), stored: stored.to_ascii_lowercase(), notes: Vec::new() }
    }
}

/// Why a raster cannot be written in a format.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum WriteError {
    #[error("elevation is not written as {0}; write a GeoTIFF")]
    OnlyRead(&'static str),
    #[error(
        "a file of the format {0} has rows that run east, and this elevation is turned against its axes; write a GeoTIFF, or turn it with --crs"
    )]
    NotNorthUp(&'static str),
    #[error(
        "a file of the format {0} states where its samples lie, and this elevation does not; write a GeoTIFF or a PNG"
    )]
    NoPlace(&'static str),
    #[error(
        "a file of the format {format} writes {value} for no data, and {value} is one of the heights; write a GeoTIFF"
    )]
    NoDataTaken { format: &'static str, value: f64 },
    #[error(
        "a file of the format {format} holds heights from {least} to {greatest} and this elevation has {found}; write a GeoTIFF"
    )]
    OutOfRange { format: &'static str, least: f64, greatest: f64, found: f64 },
    #[error("a file of the format {format} has {wanted}, not {found}; write a GeoTIFF")]
    Shape { format: &'static str, wanted: &'static str, found: String },
    /// The file's name states another place than the raster's; the right name, without its extension.
    #[error("an SRTM tile is named by its south-west corner: name this one {0}.hgt")]
    Name(String),
    #[error("a PNG needs at least one height to choose its scale by, and all samples are no data")]
    Empty,
}

/// Writes `raster` in a format. `stem` is the file's name without its extension: the place of an SRTM tile is its name.
///
/// Heights stay in the raster's vertical unit where the format can name it, and are converted to meters where it
/// cannot.
///
/// # Errors
/// [`WriteError`].
///
/// ```
/// use sandtable_dem::formats::DemFormat;
/// use sandtable_dem::read::{DemHints, read};
/// use sandtable_dem::write::write;
/// let grid = b"ncols 2\nnrows 2\nxllcorner 500000\nyllcorner 4000000\ncellsize 30\n1 2 3 4.5";
/// let raster = read("a.asc", grid, &DemHints::default())?;
/// let written = write(&raster, DemFormat::to_write("tif").expect("a GeoTIFF"), "a")?;
/// assert_eq!(written.stored, "float32");
/// let again = read("a.tif", &written.bytes, &DemHints::default())?;
/// assert_eq!(again.samples, raster.samples);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(raster: &Raster, format: &DemFormat, stem: &str) -> Result<WrittenDem, WriteError> {
    let writer = format.writer.ok_or(WriteError::OnlyRead(format.name))?;
    writer(raster, stem)
}

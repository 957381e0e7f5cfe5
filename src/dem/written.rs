//! The result of writing an elevation file: the bytes and notes for the user, or the reason why a format cannot hold a
//! raster.

use std::io;

use crate::companion::Companion;
use sandtable_raster::error::DemErrorKind;

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

//! Errors of reading elevation files.

use std::error::Error;
use std::io;

use glam::{U64Vec2, UVec2};

use sandtable_base::archive::ArchiveError;
use sandtable_base::limits::memory::MemoryRefused;
use sandtable_base::limits::work_limit::WorkLimit;
use sandtable_base::limits::{BLOCK_SAMPLES, COMPANION_BYTES, SPARSE_BYTES, UNPACKED_RASTER_BYTES};
use sandtable_geom::crs::CrsError;

/// Why an elevation file was not read.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {kind}")]
pub struct DemError {
    /// The file, as the caller named it.
    pub name: String,
    /// The fault.
    #[source]
    pub kind: DemErrorKind,
}

/// The cause of a [`DemError`].
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum DemErrorKind {
    /// Neither the content nor the extension belongs to a known format.
    #[error(
        "{found}; elevation is read from {known}; convert it, for example with: gdal_translate FILE out.tif"
    )]
    UnknownFormat {
        /// What kind of file it seems to be.
        found: String,
        /// The formats that are read.
        known: String,
    },
    #[error("this {format} uses {what}, which is not read; {remedy}")]
    Unsupported {
        format: &'static str,
        #[source]
        what: Box<dyn Error + Send + Sync>,
        remedy: &'static str,
    },
    #[error("the {format} is broken: {reason}; fetch or export the file again")]
    Broken { format: &'static str, reason: String },
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// It unpacks to more bytes than the limit for a file.
    #[error("{0}, or {UNPACKED_RASTER_BYTES:#}")]
    Unpacked(ArchiveError),
    #[error("the {format} is broken: {source}; fetch or export the file again")]
    Undecodable { format: &'static str, source: Box<dyn Error + Send + Sync> },
    /// The server that holds the content does not deliver it.
    #[error("{0}")]
    Unread(Box<dyn Error + Send + Sync>),
    #[error(
        "{} x {} samples are more than the {most} that are read; cut or coarsen the file, for example with: gdal_translate -outsize 25% 25%, or {most:#}",
        .size.x, .size.y
    )]
    TooLarge {
        /// Samples per row and rows, as stated.
        size: U64Vec2,
        most: &'static WorkLimit,
    },
    /// There is not enough memory for its samples.
    #[error(transparent)]
    Memory(#[from] MemoryRefused),
    #[error("{} x {} samples are none; the header is broken or the file is empty", .0.x, .0.y)]
    NoSamples(U64Vec2),
    #[error(
        "{} x {} samples cannot be held by a file of {file_bytes} bytes; it is cut short or its header is broken",
        .size.x, .size.y
    )]
    Truncated {
        /// Samples per row and rows, as stated.
        size: U64Vec2,
        file_bytes: usize,
    },
    /// A packed file may hold more than its bytes, but not so much.
    #[error(
        "{} x {} samples are more than a file of {file_bytes} bytes is taken to hold, packed as it is; it is cut short or its header is broken; if it is whole, {SPARSE_BYTES:#}",
        .size.x, .size.y
    )]
    Sparse {
        /// Samples per row and rows, as stated.
        size: U64Vec2,
        file_bytes: usize,
    },
    #[error(
        "this GeoTIFF has blocks of {} x {} samples, more than the {BLOCK_SAMPLES} that are read at once; rewrite it in tiles, for example with: gdal_translate -co TILED=YES FILE out.tif, or {BLOCK_SAMPLES:#}",
        .0.x, .0.y
    )]
    LargeBlocks(UVec2),
    /// A companion file unpacks to more bytes than the limit for such files.
    #[error("{name}: {source}, or {COMPANION_BYTES:#}")]
    Companion { name: String, source: ArchiveError },
    #[error("its georeference cannot be used: {reason}; {remedy}")]
    Georeference { reason: String, remedy: &'static str },
    #[error("its coordinate system cannot be used: {0}; or state the right one as crs under [terrain]")]
    Crs(#[source] Box<CrsError>),
    #[error(
        "a PNG holds gray values, not meters: state height_scale (meters per gray value) and, where value 0 is not at 0 m, height_offset, under [terrain], or --height-scale and --height-offset on the command line"
    )]
    NoHeightScale,
    #[error(
        "this PNG uses colors, and nothing in it says what they mean: if it is a map tile of heights, state height_encoding = \"terrain-rgb\" (Mapbox) or \"terrarium\" (Mapzen) under [terrain], or --height-encoding on the command line; if not, give the elevation as 16-bit gray, or as a GeoTIFF"
    )]
    NoHeightEncoding,
    #[error(
        "a RAW file has no header: state raw = \"1201x1201:i16be\" under [terrain], or --raw 1201x1201:i16be on the command line (columns, rows, type and byte order)"
    )]
    NoRawLayout,
    #[error("this {0} needs its header, a file of the same name with .hdr, beside it; put it there")]
    NoHeader(&'static str),
    /// A tile of a mosaic cannot be read.
    #[error("{name}: {source}")]
    Tile {
        name: String,
        #[source]
        source: Box<DemErrorKind>,
    },
    #[error("it has changed since it was opened; run the command again")]
    Changed,
    #[error("{what} is {value}; it must be {wanted}")]
    Hint { what: &'static str, value: f64, wanted: &'static str },
}

impl DemErrorKind {
    /// A file of a format that contradicts itself.
    pub fn broken(format: &'static str, reason: impl Into<String>) -> Self {
        Self::Broken { format, reason: reason.into() }
    }

    /// A file of a format that a decoder or the file system refuses.
    pub fn undecodable(format: &'static str, source: impl Error + Send + Sync + 'static) -> Self {
        Self::Undecodable { format, source: Box::new(source) }
    }

    /// A file of a format that cannot be read: broken, as far as the system reads it.
    pub fn unread(format: &'static str, error: io::Error) -> Self {
        match error.get_ref() {
            Some(_) => Self::Unread(Box::new(error)),
            None => Self::undecodable(format, error),
        }
    }

    /// A file of a format that uses what is not read.
    pub fn unsupported(
        format: &'static str,
        what: impl Into<Box<dyn Error + Send + Sync>>,
        remedy: &'static str,
    ) -> Self {
        Self::Unsupported { format, what: what.into(), remedy }
    }
}

impl From<CrsError> for DemErrorKind {
    fn from(error: CrsError) -> Self {
        Self::Crs(Box::new(error))
    }
}

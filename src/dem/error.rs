//! Errors of reading elevation files.

use glam::U64Vec2;

use crate::archive::ArchiveError;
use crate::dem::formats;
use crate::geom::crs::CrsError;

/// Why an elevation file was not read.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {kind}")]
pub struct DemError {
    /// The file, as the caller named it.
    pub name: String,
    /// What was wrong.
    #[source]
    pub kind: DemErrorKind,
}

/// What was wrong with an elevation file.
#[derive(Debug, thiserror::Error)]
pub enum DemErrorKind {
    /// Neither the content nor the extension belongs to a known format; the text says what the file seems to be.
    #[error(
        "{}; elevation is read from {}; convert it, for example with: gdal_translate FILE out.tif",
        .0, formats::list()
    )]
    UnknownFormat(String),
    /// The file uses a part of its format that is not read.
    #[error("this {format} uses {what}, which is not read; {remedy}")]
    Unsupported {
        /// The format.
        format: &'static str,
        /// The part that is not read.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The file contradicts itself or ends too early.
    #[error("the {format} is broken: {reason}; fetch or export the file again")]
    Broken {
        /// The format.
        format: &'static str,
        /// Where and what.
        reason: String,
    },
    /// Packed content cannot be unpacked.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// A decoder or the file system refuses the file's bytes.
    #[error("the {format} is broken: {source}; fetch or export the file again")]
    Undecodable {
        /// The format.
        format: &'static str,
        /// The decoder's error.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The raster has more samples than are read.
    #[error(
        "{} x {} samples are more than the {most} that are read; cut or coarsen the file, for example with: gdal_translate -outsize 25% 25%",
        .size.x, .size.y
    )]
    TooLarge {
        /// Samples per row and rows, as stated.
        size: U64Vec2,
        /// The cap.
        most: u64,
    },
    /// The header states no sample at all, but these samples per row and rows.
    #[error("{} x {} samples are none; the header is broken or the file is empty", .0.x, .0.y)]
    NoSamples(U64Vec2),
    /// The header states more samples than the file can hold.
    #[error(
        "{} x {} samples cannot be held by a file of {file_bytes} bytes; it is cut short or its header is broken",
        .size.x, .size.y
    )]
    Truncated {
        /// Samples per row and rows, as stated.
        size: U64Vec2,
        /// Bytes of the file.
        file_bytes: usize,
    },
    /// The georeference is not understood.
    #[error("its georeference cannot be used: {reason}; {remedy}")]
    Georeference {
        /// What was found.
        reason: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The coordinate reference system is not understood.
    #[error("its coordinate system cannot be used: {0}; or state the right one as crs under [terrain]")]
    Crs(#[from] CrsError),
    /// A gray PNG without the height of its gray values.
    #[error(
        "a PNG holds gray values, not meters: state height_scale (meters per gray value) and, where value 0 is not at 0 m, height_offset, under [terrain], or --height-scale and --height-offset on the command line"
    )]
    NoHeightScale,
    /// A color PNG without the encoding of its colors.
    #[error(
        "this PNG uses colors, and nothing in it says what they mean: if it is a map tile of heights, state height_encoding = \"terrain-rgb\" (Mapbox) or \"terrarium\" (Mapzen) under [terrain], or --height-encoding on the command line; if not, give the elevation as 16-bit gray, or as a GeoTIFF"
    )]
    NoHeightEncoding,
    /// A RAW file without a stated layout.
    #[error(
        "a RAW file has no header: state raw = \"1201x1201:i16be\" under [terrain], or --raw 1201x1201:i16be on the command line (columns, rows, type and byte order)"
    )]
    NoRawLayout,
    /// The header file that belongs beside a file of this format is missing.
    #[error("this {0} needs its header, a file of the same name with .hdr, beside it; put it there")]
    NoHeader(&'static str),
    /// A hint out of range.
    #[error("{what} is {value}; it must be {wanted}")]
    Hint {
        /// Which hint.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        wanted: &'static str,
    },
}

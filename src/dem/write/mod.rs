//! A raster to the bytes of a file: GeoTIFF, ESRI ASCII grid, VTP terrain, SRTM tile, 16-bit PNG.
//!
//! What a format cannot hold is refused with what can be done, except where rounding is the format's nature (an SRTM
//! tile has whole meters): then it is done and told. What [`crate::dem::read::read`] makes of the bytes is the raster
//! again, bit for bit where nothing was rounded.

pub mod ascii;
pub mod bt;
pub mod geotiff;
pub mod hgt;
pub mod keys;
pub mod png;
pub mod values;

use crate::dem::raster::Raster;
use crate::geom::crs::Crs;
use crate::geom::wkt_writer;

/// A format that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DemFormat {
    /// GeoTIFF, deflated in tiles of 256.
    GeoTiff,
    /// ESRI ASCII grid, with a `.prj` beside it.
    Ascii,
    /// Terrain of the Virtual Terrain Project, version 1.3.
    Bt,
    /// An SRTM tile: whole meters of a whole degree.
    Hgt,
    /// Gray PNG of 16 bits, with a world file beside it.
    Png,
}

impl DemFormat {
    /// By the extension of a name, without its dot and in any case.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "tif" | "tiff" => Some(Self::GeoTiff),
            "asc" => Some(Self::Ascii),
            "bt" => Some(Self::Bt),
            "hgt" => Some(Self::Hgt),
            "png" => Some(Self::Png),
            _ => None,
        }
    }

    /// What messages call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::GeoTiff => "GeoTIFF",
            Self::Ascii => "ESRI ASCII grid",
            Self::Bt => "BT terrain",
            Self::Hgt => "SRTM tile",
            Self::Png => "PNG",
        }
    }
}

/// The bytes of a file and of those that belong beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenDem {
    /// The file.
    pub bytes: Vec<u8>,
    /// Files of the same name with another extension.
    pub companions: Vec<Companion>,
    /// How heights are stored, in words: `float32`, `int16`.
    pub stored: String,
    /// What the user must know of it: what was rounded, how it is to be read.
    pub notes: Vec<String>,
}

/// A file beside another, named as that is but for its extension.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Companion {
    /// Without its dot.
    pub extension: &'static str,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// Why a raster cannot be written in a format.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WriteError {
    /// Rows or columns run in another direction than the format's.
    #[error(
        "a {format} has rows that run east, from the northernmost to the southernmost, and this elevation lies otherwise; write a GeoTIFF, or turn it with --crs"
    )]
    NotNorthUp {
        /// The format.
        format: &'static str,
    },
    /// The format must say where the samples lie, and nobody stated it.
    #[error("a {format} says where its samples lie, and this elevation does not; write a GeoTIFF or a PNG")]
    NoPlace {
        /// The format.
        format: &'static str,
    },
    /// A value that the format keeps for holes is one of the heights.
    #[error(
        "a {format} writes {value} where there is no data, and {value} is one of the heights; write a GeoTIFF"
    )]
    HoleTaken {
        /// The format.
        format: &'static str,
        /// The value.
        value: f64,
    },
    /// A height that the format cannot hold.
    #[error(
        "a {format} holds heights from {least} to {most} and this elevation has {found}; write a GeoTIFF"
    )]
    OutOfRange {
        /// The format.
        format: &'static str,
        /// The lowest that it holds.
        least: f64,
        /// The highest that it holds.
        most: f64,
        /// What was found.
        found: f64,
    },
    /// The raster's shape is none that the format has.
    #[error("{reason}; write a GeoTIFF")]
    Shape {
        /// What the format wants, and what was found.
        reason: String,
    },
    /// The name of the file says where it lies, and says it wrong.
    #[error("an SRTM tile is named by its south-west corner: call this one {wanted}.hgt")]
    Name {
        /// What it must be called, without its extension.
        wanted: String,
    },
    /// There is no height to write.
    #[error("a PNG needs at least one height to choose its scale by, and all samples are no data")]
    Empty,
}

/// Writes `raster` in a format. `stem` is the name that the file will have, without its extension: an SRTM tile's place
/// is its name.
///
/// Heights stay in the raster's vertical unit where the format can name it, and are brought to meters where it cannot.
///
/// # Errors
/// [`WriteError`].
///
/// ```
/// use sandtable::dem::read::{Hints, read};
/// use sandtable::dem::write::{Format, write};
/// let grid = b"ncols 2\nnrows 2\nxllcorner 500000\nyllcorner 4000000\ncellsize 30\n1 2 3 4.5";
/// let raster = read("a.asc", grid, &Hints::default()).unwrap();
/// let written = write(&raster, Format::GeoTiff, "a").unwrap();
/// assert_eq!(written.stored, "float32");
/// let again = read("a.tif", &written.bytes, &Hints::default()).unwrap();
/// assert_eq!(again.samples, raster.samples);
/// ```
pub fn write(raster: &Raster, format: DemFormat, stem: &str) -> Result<WrittenDem, WriteError> {
    match format {
        DemFormat::GeoTiff => Ok(geotiff::write(raster)),
        DemFormat::Ascii => ascii::write(&metric(raster)),
        DemFormat::Bt => bt::write(raster),
        DemFormat::Hgt => hgt::write(&metric(raster), stem),
        DemFormat::Png => png::write(&metric(raster)),
    }
}

/// The raster with its heights in meters.
fn metric(raster: &Raster) -> Raster {
    let mut metric = raster.clone();
    metric.samples = metric.samples.scaled(raster.meters_per_z, 0.0);
    metric.meters_per_z = 1.0;
    metric
}

/// The `.prj` of a system: well-known text, or where its projection is none that is put into words, the text that this
/// program reads. Nothing for a raster without a system.
fn projection_file(crs: Option<&Crs>) -> Option<Companion> {
    let crs = crs.filter(|crs| !crs.proj_text().is_empty())?;
    let text = wkt_writer::write(crs).unwrap_or_else(|| crs.name().to_owned());
    Some(Companion { extension: "prj", bytes: format!("{text}\n").into_bytes() })
}

/// That a raster lies as a format's rows do, and says where.
fn check_place(raster: &Raster, format: &'static str) -> Result<(), WriteError> {
    match (raster.georeferenced, raster.is_north_up()) {
        (false, _) => Err(WriteError::NoPlace { format }),
        (_, false) => Err(WriteError::NotNorthUp { format }),
        _ => Ok(()),
    }
}

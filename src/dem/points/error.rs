//! Errors of reading files of points.

use sandtable_base::limits::GRID_POINTS;
use sandtable_raster::error::DemErrorKind;

/// Why a file of points was not read.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum PointsError {
    #[error("line {line}: found '{found}', each line must hold numbers x, y, z")]
    Line {
        /// The line, from 1.
        line: usize,
        /// Its text, cut where it is long.
        found: String,
    },
    #[error("line {line}: the header '{found}' must name columns x, y and z (or lon, lat and elevation)")]
    Columns {
        /// The line, from 1.
        line: usize,
        /// Its text, cut where it is long.
        found: String,
    },
    #[error("byte {0} is not UTF-8 text; points are read from text (.xyz, .csv, .txt), LAS and LAZ")]
    NotText(usize),
    /// The file holds no points with a height, and this number of points without one.
    #[error("it holds no points{}", if *.0 > 0 { " that have a height" } else { "" })]
    Empty(usize),
    #[error("it holds no points of class {wanted}; it has {found}")]
    NoClass {
        wanted: String,
        /// The classes of the file, with their counts.
        found: String,
    },
    #[error(
        "{0} points are more than the {GRID_POINTS} that are read; thin or cut the file, or {GRID_POINTS:#}"
    )]
    TooMany(u64),
    /// The LAS or LAZ file is broken, or of a kind that is not read.
    #[error(transparent)]
    File(#[from] DemErrorKind),
    #[error(
        "this is a LAS or LAZ file, and this program was built without the feature `las`: build it with --features las, or convert the points to text"
    )]
    WithoutLas,
    #[error("{0}; or state the right one with --crs")]
    Crs(#[source] DemErrorKind),
}

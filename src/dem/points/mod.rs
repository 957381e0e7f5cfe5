//! Scattered points of known height, and their readers: text ([`table`]), LAS and LAZ ([`las`]).
//!
//! A cloud is the result of a survey: points in no order, lines along which the ground breaks, a system for their x and
//! y and a unit for their z. [`crate::gridding`] makes a grid of it.

#[cfg(feature = "las")]
pub mod las;
#[cfg(feature = "las")]
mod las_crs;
#[cfg(feature = "las")]
mod las_header;
#[cfg(feature = "las")]
mod laz;
pub mod table;

use glam::DVec3;

use crate::error::DemErrorKind;
use sandtable_base::limits::GRID_POINTS;
use sandtable_geom::crs::Crs;

/// Points and breaklines in one coordinate system.
#[derive(Clone, Debug)]
pub struct PointCloud {
    /// Easting (or longitude), northing (or latitude) and height; finite.
    pub points: Vec<DVec3>,
    /// Lines along which the ground breaks and which it follows, each of at least two vertices.
    pub breaklines: Vec<Vec<DVec3>>,
    /// The system of x and y; `None` where the file names none.
    pub crs: Option<Crs>,
    /// Meters in one unit of the heights.
    pub meters_per_z: f64,
    /// The vertical datum in the file's words; `None` where it is not stated.
    pub vertical_datum: Option<String>,
    /// Notes for the user on omissions and assumptions.
    pub notes: Vec<String>,
}

impl PointCloud {
    /// Points in meters, in no named system.
    pub fn new(points: Vec<DVec3>) -> Self {
        let (breaklines, notes) = (Vec::new(), Vec::new());
        Self { points, breaklines, crs: None, meters_per_z: 1.0, vertical_datum: None, notes }
    }
}

/// Options for reading a file of points.
#[derive(Clone, Debug, Default)]
pub struct PointHints<'a> {
    /// The system of x and y, in place of the file's.
    pub crs: Option<&'a Crs>,
    /// The classes of LAS points that are taken. Empty: ground (class 2) where the file has any, else all.
    pub classes: &'a [u8],
}

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

fn is_las(bytes: &[u8]) -> bool {
    bytes.starts_with(b"LASF")
}

/// Whether a file is one of points: LAS and LAZ by content, text by its name's extension.
pub fn recognizes(name: &str, bytes: &[u8]) -> bool {
    const TEXT: [&str; 6] = ["xyz", "csv", "txt", "tsv", "dat", "pts"];
    let extension = name.rsplit_once('.').map(|(_, extension)| extension.to_ascii_lowercase());
    is_las(bytes) || extension.is_some_and(|extension| TEXT.contains(&extension.as_str()))
}

/// Reads a file of points: LAS or LAZ by its first bytes, anything else as text.
///
/// # Errors
/// [`PointsError`]; the caller names the file.
pub fn read(bytes: &[u8], hints: &PointHints) -> Result<PointCloud, PointsError> {
    if !is_las(bytes) {
        return table::read(bytes, hints);
    }
    #[cfg(feature = "las")]
    return las::read(bytes, hints);
    #[cfg(not(feature = "las"))]
    Err(PointsError::WithoutLas)
}

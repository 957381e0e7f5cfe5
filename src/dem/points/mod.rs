//! Scattered points of known height, and the readers that bring them: text ([`table`]), LAS and LAZ ([`las`]).
//!
//! A cloud is what a survey hands over before anybody has made a grid of it: points in no order, lines along which
//! the ground breaks, a system for their x and y and a unit for their z. [`crate::dem::gridding`] makes the grid.

pub mod las;
mod las_crs;
mod las_header;
mod laz;
pub mod table;

use glam::DVec3;

use crate::dem::error::DemErrorKind;
use crate::geom::crs::Crs;

/// Points that are taken of one file; more than any flight line holds, and 1.5 GiB of memory.
pub const MOST_POINTS: u64 = 1 << 26;

/// Points and breaklines in one coordinate system.
#[derive(Clone, Debug)]
pub struct PointCloud {
    /// Easting (or longitude), northing (or latitude) and height; finite.
    pub points: Vec<DVec3>,
    /// Lines along which the ground breaks, each of at least two vertices; the ground follows them between their
    /// vertices.
    pub breaklines: Vec<Vec<DVec3>>,
    /// The system of x and y; `None` where the file names none.
    pub crs: Option<Crs>,
    /// Meters in one unit of the heights.
    pub meters_per_z: f64,
    /// What heights are counted from, in the file's words; `None` where it does not say.
    pub vertical_datum: Option<String>,
    /// What the user should know of what was read: what was left out, what was taken for granted.
    pub notes: Vec<String>,
}

/// What the caller knows of a file of points beyond its bytes.
#[derive(Clone, Debug, Default)]
pub struct PointHints<'a> {
    /// The system of x and y, in place of what the file says or where it says nothing.
    pub crs: Option<&'a Crs>,
    /// The classes of LAS points that are taken. Empty: ground (class 2) where the file has any, else all.
    pub classes: &'a [u8],
}

/// Why a file of points was not read.
#[derive(Debug, thiserror::Error)]
pub enum PointsError {
    /// A line that is no point.
    #[error("line {line}: found '{found}', each line must hold {wanted}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// Its text, cut where it is long.
        found: String,
        /// What it should hold.
        wanted: &'static str,
    },
    /// A header without the columns that are needed.
    #[error("line {line}: the header '{found}' must name columns x, y and z (or lon, lat and elevation)")]
    Columns {
        /// The line, from 1.
        line: usize,
        /// Its text, cut where it is long.
        found: String,
    },
    /// Bytes that are no text.
    #[error("byte {at} is not UTF-8 text; points are read from text (.xyz, .csv, .txt), LAS and LAZ")]
    NotText {
        /// Where the text ends.
        at: usize,
    },
    /// Nothing to make a grid of.
    #[error("it holds no points{why}")]
    Empty {
        /// Of which kind, where there are others; starts with a blank or is empty.
        why: String,
    },
    /// More points than are taken.
    #[error("{count} points are more than the {MOST_POINTS} that are taken; thin or cut the file")]
    TooMany {
        /// Points as stated or found.
        count: u64,
    },
    /// A LAS or LAZ file that contradicts itself or ends too early.
    #[error("the {format} file is broken: {reason}; fetch or export it again")]
    Broken {
        /// `LAS` or `LAZ`.
        format: &'static str,
        /// Where and what.
        reason: String,
    },
    /// A LAS or LAZ file of a kind that is not read.
    #[error(
        "this {format} file {what}, which is not read; write it again with another program, for example: pdal translate IN OUT.las"
    )]
    Unsupported {
        /// `LAS` or `LAZ`.
        format: &'static str,
        /// What it is or uses.
        what: String,
    },
    /// The file's coordinate system is not understood.
    #[error("its coordinate system cannot be used: {reason}; state the right one with --crs")]
    Crs {
        /// What was found.
        reason: String,
    },
}

impl From<DemErrorKind> for PointsError {
    fn from(fault: DemErrorKind) -> Self {
        match fault {
            DemErrorKind::Georeference { reason, .. } => Self::Crs { reason },
            DemErrorKind::Crs(error) => Self::Crs { reason: error.to_string() },
            other => Self::Crs { reason: other.to_string() },
        }
    }
}

/// Whether a file is one of points: LAS and LAZ by content, text by its name's extension.
pub fn recognizes(name: &str, bytes: &[u8]) -> bool {
    const TEXT: [&str; 6] = ["xyz", "csv", "txt", "tsv", "dat", "pts"];
    let extension = name.rsplit_once('.').map(|(_, extension)| extension.to_ascii_lowercase());
    las::recognizes(bytes) || extension.is_some_and(|extension| TEXT.contains(&extension.as_str()))
}

/// Reads a file of points: LAS or LAZ by its first bytes, anything else as text.
///
/// # Errors
/// [`PointsError`]; the caller names the file.
pub fn read(bytes: &[u8], hints: &PointHints) -> Result<PointCloud, PointsError> {
    if las::recognizes(bytes) { las::read(bytes, hints) } else { table::read(bytes, hints) }
}

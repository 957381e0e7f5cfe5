//! Scattered points of known height, and their readers: text ([`table`]), LAS and LAZ ([`las`]).

pub mod cloud;
pub mod error;
#[cfg(feature = "las")]
pub mod las;
#[cfg(feature = "las")]
mod las_crs;
#[cfg(feature = "las")]
mod las_header;
#[cfg(feature = "las")]
mod laz;
pub mod table;

use crate::points::cloud::{PointCloud, PointHints};
use crate::points::error::PointsError;

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

//! Tables as vector files: text with separators and sheets of spreadsheets, a feature to a row.
//!
//! ```text
//! CSV, TSV ── text ──────┐
//!                        ├─► rows ─► the row of names ─► columns with a meaning ─► features
//! xlsx, ods, xls ─ workbook ┘
//! ```
//!
//! The names of columns say which hold the place ([`names`]), or the user states it. Columns of the overlay schema become its
//! properties; every column also keeps its own name. A row that states no place is told by its number and left out.

mod cells;
mod columns;
mod compound_file;
mod layer;
mod names;
mod text;
mod wkt;
mod workbook;
mod workbook_97;

#[cfg(test)]
mod tests;

use crate::error::VectorError;
use crate::feature::VectorLayer;
use crate::hints::VectorHints;

pub(super) use compound_file::is_compound;
pub(super) use workbook::{is_workbook, read as read_workbook, read_97 as read_workbook_97};

/// Reads a table of text.
///
/// # Errors
/// [`VectorError`]: no column says where the rows lie, or no row is sound.
pub(super) fn read_text(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    layer::read(&text::rows(bytes), hints)
}

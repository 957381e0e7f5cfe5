//! Heights as CSV: what `height` prints, and what is gathered.

use std::io::{self, Write};

use sandtable_query::positions::WrittenPosition;
use sandtable_raster::answer::Answer;

/// The first line.
pub const HEADER: &str = "x,y,height,status";

/// Writes a line: x and y as they were written, the height where there is one, the status.
///
/// # Errors
/// `out` fails.
pub fn write_row(
    out: &mut (impl Write + ?Sized),
    point: &WrittenPosition<'_>,
    answer: Answer,
) -> io::Result<()> {
    let [x, y] = &point.written;
    match answer.height_m() {
        Some(height) => writeln!(out, "{x},{y},{height},{}", answer.status()),
        None => writeln!(out, "{x},{y},,{}", answer.status()),
    }
}

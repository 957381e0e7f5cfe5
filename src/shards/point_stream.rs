//! A table of positions that is read in batches: of any number of points, in the memory of one batch.
//!
//! ```text
//! bytes ─► batch of whole lines ─► pieces, parsed on all threads ─► positions in the order of the file
//! ```
//!
//! The positions, and the faults that are found, are those of
//! [`parse_positions`](sandtable_query::positions::parse_positions).

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::error::{PlanError, PlanFault, ShardError};
use sandtable_base::limits::INPUT_BYTES;
use sandtable_files::csv::{LineError, numbered_lines};
use sandtable_files::disk::{self, ReadFileCause, ReadFileError, SystemError};
use sandtable_geom::crs::Crs;
use sandtable_query::positions::{PositionColumns, PositionLineFault, PositionsError, WrittenPosition};

/// Bytes that are read at once: enough for all threads to have work.
const BATCH: usize = 8 << 20;
/// Bytes of a piece, which one thread parses.
const PIECE: usize = 128 << 10;
/// The longest line.
const MOST_LINE: usize = 1 << 20;

/// A table of positions while it is read.
pub struct PointStream {
    path: PathBuf,
    file: File,
    /// The system that positions are brought to.
    crs: Crs,
    columns: Option<PositionColumns>,
    /// What is read and not yet handed out.
    bytes: Vec<u8>,
    /// Lines and bytes that were handed out.
    lines: usize,
    passed: usize,
    is_at_end: bool,
}

impl PointStream {
    /// The table at `path`, for positions in `crs`.
    ///
    /// # Errors
    /// It cannot be read, or is too large.
    pub fn open(path: &Path, crs: &Crs) -> Result<Self, ReadFileError> {
        let file = disk::open(path)?;
        let metadata = file.metadata().map_err(|error| ReadFileError::new(path, SystemError::from(error)))?;
        if metadata.len() > INPUT_BYTES.get() {
            return Err(ReadFileError::new(path, ReadFileCause::TooLarge(metadata.len())));
        }
        let (path, crs, bytes) = (path.to_owned(), crs.clone(), Vec::new());
        Ok(Self { path, file, crs, columns: None, bytes, lines: 0, passed: 0, is_at_end: false })
    }

    /// Calls `take` with the positions of each batch, in order.
    ///
    /// # Errors
    /// The file cannot be read, a line holds no position, or `take` fails.
    pub fn each_batch(
        mut self,
        mut take: impl FnMut(&[WrittenPosition<'_>]) -> Result<(), ShardError>,
    ) -> Result<(), ShardError> {
        while let Some(end) = self.fill()? {
            let text = std::str::from_utf8(&self.bytes[..end]).map_err(|error| {
                ReadFileError::new(&self.path, ReadFileCause::NotText(self.passed + error.valid_up_to()))
            })?;
            let (columns, positions) = parse(text, self.columns, &self.crs).map_err(|(line, fault)| {
                let name = disk::display_name(&self.path);
                PositionsError::from(LineError { name, line: self.lines + line, fault })
            })?;
            take(&positions)?;
            self.columns = columns;
            self.lines += text.matches('\n').count();
            self.passed += end;
            self.bytes.drain(..end);
        }
        Ok(())
    }

    /// Reads on until there is a batch; where it ends, or `None` after the last.
    fn fill(&mut self) -> Result<Option<usize>, ShardError> {
        loop {
            let before = self.bytes.len();
            if !self.is_at_end {
                let read = (&mut self.file).take(BATCH as u64).read_to_end(&mut self.bytes);
                read.map_err(|error| ReadFileError::new(&self.path, SystemError::from(error)))?;
                self.is_at_end = self.bytes.len() == before;
            }
            if self.is_at_end {
                return Ok(Some(self.bytes.len()).filter(|&length| length > 0));
            }
            if let Some(last) = self.bytes.iter().rposition(|&byte| byte == b'\n') {
                return Ok(Some(last + 1));
            }
            if self.bytes.len() > MOST_LINE {
                return Err(PlanError::new(&self.path, PlanFault::LongLine(MOST_LINE)).into());
            }
        }
    }
}

/// The columns, as far as they are known after this text, and its positions; or the number of the first wrong line from 1.
type ParsedBatch<'a> = (Option<PositionColumns>, Vec<WrittenPosition<'a>>);

fn parse<'a>(
    text: &'a str,
    columns: Option<PositionColumns>,
    crs: &Crs,
) -> Result<ParsedBatch<'a>, (usize, PositionLineFault)> {
    let (columns, start) = match columns {
        Some(columns) => (columns, 0),
        None => {
            let Some((number, line)) = numbered_lines(text).next() else { return Ok((None, Vec::new())) };
            let columns = PositionColumns::of_first_line(line).map_err(|fault| (number, fault))?;
            // A header is passed over; other lines before the first position hold nothing.
            (columns, if columns.has_header { line_start(text, number) } else { 0 })
        }
    };
    let pieces = pieces(&text[start..]);
    let parse_piece = |piece: &'a str| {
        let lines = numbered_lines(piece);
        let position = |(number, line)| columns.position(line, crs).map_err(|fault| (number, fault));
        lines.map(position).collect::<Result<Vec<_>, (usize, PositionLineFault)>>()
    };
    let parsed: Vec<Result<Vec<_>, _>> = pieces.par_iter().copied().map(parse_piece).collect();
    let mut positions = Vec::new();
    let mut end = start;
    for (piece, parsed) in pieces.iter().zip(parsed) {
        let before = || text[..end].matches('\n').count();
        positions.extend(parsed.map_err(|(number, fault)| (before() + number, fault))?);
        end += piece.len();
    }
    Ok((Some(columns), positions))
}

/// Where the line after the one with a number begins.
fn line_start(text: &str, number: usize) -> usize {
    text.match_indices('\n').nth(number - 1).map_or(text.len(), |(at, _)| at + 1)
}

/// The text in pieces of whole lines.
fn pieces(text: &str) -> Vec<&str> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let from = rest.as_bytes().iter().skip(PIECE).position(|&byte| byte == b'\n');
        let (piece, after) = rest.split_at(from.map_or(rest.len(), |at| PIECE + at + 1));
        pieces.push(piece);
        rest = after;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_query::positions::parse_positions;

    fn long_table() -> String {
        let line = |index: u32| format!("{index};{};{}.5\n", index * 3, index);
        "# made up\n\nid;lat;lon\n".to_owned() + &(0..40_000).map(line).collect::<String>()
    }

    #[test]
    fn pieces_hold_whole_lines_and_all_of_the_text() {
        let text = long_table();
        let pieces = pieces(&text);
        assert!(pieces.len() > 3, "{}", pieces.len());
        assert!(pieces.iter().all(|piece| piece.ends_with('\n')));
        assert_eq!(pieces.concat(), text);
    }

    #[test]
    fn positions_are_those_of_the_table_read_at_once() {
        let references = "mgrs\n".to_owned() + &"16S GF 500 180\n".repeat(20_000);
        let zone = Crs::from_epsg(32616).expect("a zone");
        for text in [
            long_table(),
            "1,2\n3,4".into(),
            String::new(),
            "# only this\n".into(),
            "x,y\n".into(),
            references,
        ] {
            let (_, positions) = parse(&text, None, &zone).expect("sound");
            assert_eq!(positions, parse_positions("p.csv", &text, &zone).expect("sound"));
        }
    }

    #[test]
    fn a_wrong_line_has_the_number_that_it_has_in_the_file() {
        let wrong = long_table() + "here,there\n";
        let (line, _) = parse(&wrong, None, &Crs::local()).expect_err("no numbers");
        let whole = parse_positions("p.csv", &wrong, &Crs::local()).expect_err("no numbers");
        assert_eq!(line, whole.line);
    }
}

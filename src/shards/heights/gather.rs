//! The heights of all shards in the order of the table.
//!
//! Each shard has its answers in the order of its points, and `order.bin` says of every point of the table to which shard it
//! went: so all files are read from front to back, a piece of each at a time.

use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::error::{PlanError, PlanFault, ShardError};
use crate::heights::arguments::HeightsArguments;
use crate::heights::csv::{HEADER, write_row};
use crate::heights::work::{ANSWER_BYTES, EXTENSION, answer_of};
use crate::plan::ShardPlan;
use crate::point_stream::PointStream;
use crate::record::result_path;
use sandtable_files::disk::{self, ReadFileError, SystemError, WriteFileError};
use sandtable_files::output_files::OutputFiles;
use sandtable_geom::crs::Crs;
use sandtable_query::positions::WrittenPosition;
use sandtable_raster::answer::Answer;
use sandtable_terrain::stop_flag::StopFlag;

/// Rows that one thread writes.
const PIECE: usize = 4096;
/// Bytes of answers that are read and not yet written, of all shards together.
const HELD: usize = 64 << 20;

/// Writes the heights of a plan whose shards are all done; `watch` says how many.
///
/// # Errors
/// A file cannot be read or written, or is not the one of the plan.
pub fn gather(
    plan: &ShardPlan,
    arguments: &HeightsArguments,
    path: &Path,
    watch: &StopFlag,
) -> Result<(), ShardError> {
    let order_path = plan.folder.join("order.bin");
    let order = disk::open(&order_path)?;
    let order_bytes = order.metadata().map_or(0, |metadata| metadata.len());
    watch.stretch(0.0..1.0, usize::try_from(order_bytes / 4).unwrap_or(usize::MAX));
    let mut order = BufReader::with_capacity(1 << 20, order);
    let most = (HELD / ANSWER_BYTES / plan.count()).clamp(64, PIECE);
    let shard =
        |id| AnswerStream { path: result_path(plan, id, EXTENSION), next: 0, piece: Vec::new(), at: 0, most };
    let mut shards: Vec<AnswerStream> = (0..plan.count()).map(shard).collect();
    let wrong_order = || {
        let what = "it is not the order of the points that were planned".to_owned();
        ShardError::from(PlanError::new(&order_path, PlanFault::Stale(what)))
    };
    let mut next_answer = || {
        let mut id = [0; 4];
        order.read_exact(&mut id).map_err(|_| wrong_order())?;
        shards.get_mut(u32::from_le_bytes(id) as usize).ok_or_else(wrong_order)?.next()
    };
    // Without a system, the table has no positions but numbers, which are written as they stand there.
    let crs = arguments.dataset.stated_crs(&plan.folder)?.unwrap_or_else(Crs::local);
    let table = PointStream::open(&plan.folder.join(&arguments.points), &crs)?;
    let mut files = OutputFiles::default();
    let mut failure = None;
    let written = files.write_with(path, |out| {
        writeln!(out, "{HEADER}")?;
        let rows = table.each_batch(|positions| {
            let answers: Vec<Answer> = positions.iter().map(|_| next_answer()).collect::<Result<_, _>>()?;
            for piece in rows(positions, &answers) {
                out.write_all(&piece).map_err(|error| WriteFileError::new(path, SystemError::from(error)))?;
            }
            watch.did(positions.len());
            Ok(())
        });
        rows.map_err(|error| {
            failure = Some(error);
            io::Error::other("a row cannot be made")
        })
    });
    failure.map_or(Ok(()), Err)?;
    written?;
    Ok(files.publish()?)
}

/// The lines of some points, in pieces that are made on all threads.
fn rows(positions: &[WrittenPosition<'_>], answers: &[Answer]) -> Vec<Vec<u8>> {
    let piece = |(positions, answers): (&[WrittenPosition], &[Answer])| {
        let mut lines = Vec::new();
        for (position, &answer) in positions.iter().zip(answers) {
            write_row(&mut lines, position, answer).expect("memory takes what is written");
        }
        lines
    };
    positions.par_chunks(PIECE).zip(answers.par_chunks(PIECE)).map(piece).collect()
}

/// The answers of a shard while they are read. The file is closed between pieces: there may be more shards than files that
/// can be open.
struct AnswerStream {
    path: PathBuf,
    /// Where the next piece begins.
    next: u64,
    piece: Vec<u8>,
    at: usize,
    /// The answers of a piece.
    most: usize,
}

impl AnswerStream {
    fn next(&mut self) -> Result<Answer, ShardError> {
        if self.at == self.piece.len() {
            self.read_piece()?;
        }
        let bytes = self.piece.get(self.at..self.at + ANSWER_BYTES).and_then(|bytes| bytes.try_into().ok());
        let answer = bytes.and_then(answer_of);
        self.at += ANSWER_BYTES;
        answer.ok_or_else(|| PlanError::new(&self.path, PlanFault::Result).into())
    }

    fn read_piece(&mut self) -> Result<(), ShardError> {
        let failed = |error| ReadFileError::new(&self.path, SystemError::from(error));
        let mut file = disk::open(&self.path)?;
        file.seek(SeekFrom::Start(self.next)).map_err(failed)?;
        self.piece.clear();
        self.at = 0;
        file.take((self.most * ANSWER_BYTES) as u64).read_to_end(&mut self.piece).map_err(failed)?;
        self.next += self.piece.len() as u64;
        Ok(())
    }
}

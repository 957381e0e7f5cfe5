//! LAZ (LASzip, Isenburg 2013): compressed LAS records, unpacked by the `las` crate after all that it trusts is checked.
//!
//! The crate allocates what a file states: a forged number of chunks asks for 68 GB and ends the process, where no
//! error can be caught. So before it sees a file:
//!
//! - it gets a header made here, with the counts of [`LasHeader`] and no record but LASzip's own;
//! - the items of LASzip's record must be those of the point format, in their order and of its lengths;
//! - the table of chunks must lie in the file and state no more chunks than the points before it have room for;
//! - of layered chunks (formats 6 to 10), each layer's length must lie in the file.
//!
//! What stays is a stream of arithmetic codes, which can be wrong in ways that no check before decoding sees.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::dem::error::bytes_at;
use crate::dem::points::PointsError;
use crate::dem::points::las::check_not_empty;
use crate::dem::points::las_header::{LasHeader, Record};

/// Points that are unpacked at once.
const BATCH: u64 = 1 << 16;

/// Chunks of a number of points that the table of chunks gives, rather than all of one.
const VARIABLE: [u32; 2] = [0, u32::MAX];

/// Unpacks all points and hands their records on, batch by batch.
pub(super) fn unpack(
    bytes: &[u8],
    header: &LasHeader,
    take: &mut dyn FnMut(&[u8]),
) -> Result<(), PointsError> {
    check_not_empty(header)?;
    let records = header.records(bytes);
    let is_laszip = |record: &&Record| record.owner == b"laszip encoded" && record.id == 22204;
    let laszip = records.iter().find(is_laszip).ok_or_else(|| broken("it has no LASzip record"))?;
    let items = Items::read(laszip.content, header)?;
    items.check_chunks(bytes, header)?;
    let file = with_plain_header(bytes, header, laszip.whole)?;
    // The decoder indexes tables by what it decodes and panics where that lies outside. Nothing it leaves behind is
    // used again, so unwinding out of it is safe.
    let decoded = catch_unwind(AssertUnwindSafe(|| decode(file, header, take)));
    decoded.unwrap_or_else(|_| Err(broken("its compressed points contradict each other")))
}

fn decode(file: Vec<u8>, header: &LasHeader, take: &mut dyn FnMut(&[u8])) -> Result<(), PointsError> {
    let unreadable = |error: las::Error| broken(format!("its points cannot be unpacked: {error}"));
    let mut reader = las::Reader::new(Cursor::new(file)).map_err(unreadable)?;
    let mut left = header.count;
    while left > 0 {
        let points = reader.read_points(left.min(BATCH)).map_err(unreadable)?;
        if points.record_len() != header.record || points.is_empty() {
            return Err(broken("its points are not of the length that the header states"));
        }
        take(points.raw_bytes());
        left -= points.len() as u64;
    }
    Ok(())
}

/// What LASzip's record says.
struct Items {
    /// 1: one chunk, 2: chunks, 3: chunks in layers.
    compressor: u16,
    chunk_points: u32,
    /// Layers of a chunk.
    layers: usize,
}

/// LASzip's number for an item, its bytes and its layers.
type LazItem = (u16, usize, usize);

impl Items {
    /// Reads the record and checks that it describes the header's points.
    fn read(content: &[u8], header: &LasHeader) -> Result<Self, PointsError> {
        let short = || broken("its LASzip record is cut short");
        let u16_at = |at: usize| bytes_at(content, at).map(u16::from_le_bytes).ok_or_else(short);
        let compressor = u16_at(0)?;
        let chunk_points = bytes_at(content, 12).map(u32::from_le_bytes).ok_or_else(short)?;
        let wanted = items_of(header);
        let versions = if header.is_extended() { 3..=4 } else { 1..=2 };
        let known = if header.is_extended() { 3..=3 } else { 1..=2 };
        if !known.contains(&compressor) || u16_at(2)? != 0 {
            let format = header.format;
            let what = format!("is packed by compressor {compressor}, for points of format {format}");
            return Err(PointsError::Unsupported { format: "LAZ", what });
        }
        let is_item = |(index, &(kind, bytes, _)): (usize, &LazItem)| {
            let at = 34 + 6 * index;
            let stated = [at, at + 2, at + 4].map(|at| bytes_at(content, at).map(u16::from_le_bytes));
            matches!(stated, [Some(k), Some(b), Some(v)] if k == kind && usize::from(b) == bytes && versions.contains(&v))
        };
        if usize::from(u16_at(32)?) != wanted.len() || !wanted.iter().enumerate().all(is_item) {
            let format = header.format;
            return Err(broken(format!("its LASzip record does not describe points of format {format}")));
        }
        Ok(Self { compressor, chunk_points, layers: wanted.iter().map(|item| item.2).sum() })
    }

    /// Holds the chunks against the file.
    fn check_chunks(&self, bytes: &[u8], header: &LasHeader) -> Result<(), PointsError> {
        if self.compressor == 1 {
            return Ok(());
        }
        let first = header.points_at + 8;
        let offset = |at: Option<usize>| {
            let stored = i64::from_le_bytes(bytes_at(bytes, at?)?);
            usize::try_from(stored).ok().filter(|&offset| offset > header.points_at)
        };
        // A writer that could not go back leaves the offset at the end of the file.
        let table = offset(Some(header.points_at)).or_else(|| offset(bytes.len().checked_sub(8)));
        let table = table.filter(|&table| table >= first && table.saturating_add(8) <= bytes.len());
        let table = table.ok_or_else(|| broken("its table of chunks lies outside of the file"))?;
        let chunks = bytes_at(bytes, table + 4).map_or(0, u32::from_le_bytes);
        let room = (table - first) / header.record;
        let needed = header.count.div_ceil(u64::from(self.chunk_points.max(1)));
        let variable = VARIABLE.contains(&self.chunk_points);
        if chunks as usize > room || (!variable && u64::from(chunks) < needed) || (variable && chunks == 0) {
            return Err(broken(format!(
                "it states {chunks} chunks for {} points, in {} bytes",
                header.count,
                table - first
            )));
        }
        if self.layers > 0 { self.check_layers(&bytes[first..table], header.record) } else { Ok(()) }
    }

    /// Each chunk: its first point, how many points, the length of each layer, the layers.
    fn check_layers(&self, chunks: &[u8], record: usize) -> Result<(), PointsError> {
        let mut at = 0usize;
        while at < chunks.len() {
            let lengths = at + record + 4;
            let mut end = lengths + 4 * self.layers;
            for layer in 0..self.layers {
                let length = bytes_at(chunks, lengths + 4 * layer).map(u32::from_le_bytes);
                end = length.map_or(usize::MAX, |length| end.saturating_add(length as usize));
            }
            if end > chunks.len() {
                return Err(broken(format!(
                    "the layers of a chunk at byte {at} of its points run beyond them"
                )));
            }
            at = end;
        }
        Ok(())
    }
}

/// The items of a point format, in LASzip's order.
fn items_of(header: &LasHeader) -> Vec<LazItem> {
    const POINT10: LazItem = (6, 20, 0);
    const GPS_TIME: LazItem = (7, 8, 0);
    const RGB12: LazItem = (8, 6, 0);
    const WAVE_PACKET13: LazItem = (9, 29, 0);
    const POINT14: LazItem = (10, 30, 9);
    const RGB14: LazItem = (11, 6, 1);
    const RGB_NIR14: LazItem = (12, 8, 2);
    const WAVE_PACKET14: LazItem = (13, 29, 1);
    let mut items = match header.format {
        0 => vec![POINT10],
        1 => vec![POINT10, GPS_TIME],
        2 => vec![POINT10, RGB12],
        3 => vec![POINT10, GPS_TIME, RGB12],
        4 => vec![POINT10, GPS_TIME, WAVE_PACKET13],
        5 => vec![POINT10, GPS_TIME, RGB12, WAVE_PACKET13],
        6 => vec![POINT14],
        7 => vec![POINT14, RGB14],
        8 => vec![POINT14, RGB_NIR14],
        9 => vec![POINT14, WAVE_PACKET14],
        _ => vec![POINT14, RGB_NIR14, WAVE_PACKET14],
    };
    let added = header.record - header.plain_record();
    if added > 0 {
        items.push(if header.is_extended() { (14, added, added) } else { (0, added, 0) });
    }
    items
}

/// The file with a header of counts and places only, LASzip's record right behind it, all else where it was.
fn with_plain_header(bytes: &[u8], header: &LasHeader, laszip: &[u8]) -> Result<Vec<u8>, PointsError> {
    let mut file = bytes.to_vec();
    // Records of an extended kind come after the points and cannot be moved before them.
    let room = header.points_at.checked_sub(header.size).filter(|&room| room >= laszip.len());
    room.ok_or_else(|| broken("its LASzip record does not lie before its points"))?;
    file[4..header.size].fill(0);
    let mut put = |at: usize, value: &[u8]| file[at..at + value.len()].copy_from_slice(value);
    put(24, &[1, header.minor]);
    put(94, &(header.size as u16).to_le_bytes());
    put(96, &(header.points_at as u32).to_le_bytes());
    put(100, &1u32.to_le_bytes());
    put(104, &[header.format | 0x80]);
    put(105, &(header.record as u16).to_le_bytes());
    if !header.is_extended() {
        put(107, &(header.count as u32).to_le_bytes());
    }
    for axis in 0..3 {
        put(131 + 8 * axis, &1f64.to_le_bytes());
    }
    if header.minor == 4 {
        put(247, &header.count.to_le_bytes());
    }
    put(header.size, laszip);
    Ok(file)
}

fn broken(reason: impl Into<String>) -> PointsError {
    PointsError::Broken { format: "LAZ", reason: reason.into() }
}

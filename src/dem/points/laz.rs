//! LAZ (LASzip, Isenburg 2013): compressed LAS records, unpacked by the `laz` crate after all that it trusts is
//! checked.
//!
//! The crate allocates what a file states: a forged number of chunks asks for 68 GB and ends the process, where no
//! error can be caught. So before it sees a file:
//!
//! - the items of LASzip's record must be those of the point format, in their order and of its lengths;
//! - the table of chunks must lie in the file and state no more chunks than the points before it can be;
//! - of layered chunks (formats 6 to 10), each layer's length must lie in the file.
//!
//! The rest is a stream of arithmetic codes, whose errors only decoding finds.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use laz::{LasZipDecompressor, LazItem, LazItemRecordBuilder, LazItemType, LazVlr};

use crate::points::error::PointsError;
use crate::points::las_header::{LasHeader, broken, unsupported};
use sandtable_base::bytes::{ByteFields, bytes_at};
use sandtable_raster::error::DemErrorKind;

const BATCH: u64 = 1 << 16;

/// Unpacks all points and passes their records on, batch by batch.
pub(super) fn unpack(
    bytes: &[u8],
    header: &LasHeader,
    mut take: impl FnMut(&[u8]),
) -> Result<(), PointsError> {
    if header.count == 0 {
        return Err(broken("it states no points"));
    }
    let records = header.records(bytes);
    let is_laszip = |owner: &[u8], id: u16| owner == LazVlr::USER_ID.as_bytes() && id == LazVlr::RECORD_ID;
    let laszip = records.iter().find(|record| is_laszip(record.owner, record.id));
    let laszip = laszip.ok_or_else(|| broken("it has no LASzip record"))?.content;
    let vlr = LazVlr::from_buffer(laszip).map_err(undecodable)?;
    check_items(laszip, &vlr, header)?;
    check_chunks(bytes, laszip, &vlr, header)?;
    // The decoder indexes tables by what it decodes and panics where that lies outside. Nothing that it leaves behind
    // is used again, so unwinding out of it is safe.
    let decoded = catch_unwind(AssertUnwindSafe(|| decode(bytes, header, vlr, &mut take)));
    decoded.unwrap_or_else(|_| Err(broken("its compressed points contradict each other")))
}

fn decode(
    bytes: &[u8],
    header: &LasHeader,
    vlr: LazVlr,
    take: &mut impl FnMut(&[u8]),
) -> Result<(), PointsError> {
    let mut file = Cursor::new(bytes);
    file.set_position(header.points_at as u64);
    let mut decompressor = LasZipDecompressor::new(file, vlr).map_err(undecodable)?;
    let mut points = Vec::new();
    let mut left = header.count;
    while left > 0 {
        let count = left.min(BATCH);
        points.resize(count as usize * header.point_bytes, 0);
        decompressor.decompress_many(&mut points).map_err(|error| undecodable(error.into()))?;
        take(&points);
        left -= count;
    }
    Ok(())
}

/// LASzip's numbers of the ways of packing.
const ONE_CHUNK: u16 = 1;
const CHUNKS: u16 = 2;
const LAYERED_CHUNKS: u16 = 3;

fn compressor(laszip: &[u8]) -> Option<u16> {
    ByteFields::little_endian(laszip).u16(0)
}

/// Checks that LASzip's record describes the header's points.
fn check_items(laszip: &[u8], vlr: &LazVlr, header: &LasHeader) -> Result<(), PointsError> {
    let format = header.format;
    let (compressors, versions) = if header.is_extended() {
        (LAYERED_CHUNKS..=LAYERED_CHUNKS, 3..=4)
    } else {
        (ONE_CHUNK..=CHUNKS, 1..=2)
    };
    let found = compressor(laszip).unwrap_or_default();
    let has_arithmetic_coder = ByteFields::little_endian(laszip).u16(2) == Some(0);
    if !compressors.contains(&found) || !has_arithmetic_coder {
        return Err(unsupported(format!("compressor {found} for points of format {format}")));
    }
    let wanted =
        LazItemRecordBuilder::default_for_point_format_id(format, header.extra_bytes).map_err(undecodable)?;
    let is_wanted = |(found, wanted): (&LazItem, &LazItem)| {
        let is_same = found.item_type() == wanted.item_type() && found.size() == wanted.size();
        is_same && versions.contains(&found.version())
    };
    if vlr.items().len() == wanted.len() && vlr.items().iter().zip(&wanted).all(is_wanted) {
        return Ok(());
    }
    Err(broken(format!("its LASzip record does not describe points of format {format}")))
}

/// Holds the chunks against the file.
fn check_chunks(bytes: &[u8], laszip: &[u8], vlr: &LazVlr, header: &LasHeader) -> Result<(), PointsError> {
    if compressor(laszip) == Some(ONE_CHUNK) {
        return Ok(());
    }
    let fields = ByteFields::little_endian(bytes);
    let first = header.points_at + 8;
    let offset = |at: Option<usize>| {
        let stored = fields.i64(at?)?;
        usize::try_from(stored).ok().filter(|&offset| offset > header.points_at)
    };
    // A writer that could not go back leaves the offset at the end of the file.
    let table = offset(Some(header.points_at)).or_else(|| offset(bytes.len().checked_sub(8)));
    let table = table.filter(|&table| table >= first && table.saturating_add(8) <= bytes.len());
    let table = table.ok_or_else(|| broken("its table of chunks lies outside of the file"))?;
    let chunks = fields.u32(table + 4).unwrap_or(0);
    let most = (table - first) / header.point_bytes;
    let least = match vlr.uses_variable_size_chunks() {
        true => 1,
        false => header.count.div_ceil(vlr.chunk_size().into()),
    };
    if chunks as usize > most || u64::from(chunks) < least {
        let (count, packed) = (header.count, table - first);
        return Err(broken(format!("it states {chunks} chunks for {count} points, in {packed} bytes")));
    }
    let layers = vlr.items().iter().map(|item| layers(item.item_type())).sum();
    if layers > 0 { check_layers(&bytes[first..table], header.point_bytes, layers) } else { Ok(()) }
}

/// Checks each chunk: its first point, how many points, the length of each layer, the layers.
fn check_layers(chunks: &[u8], point_bytes: usize, layers: usize) -> Result<(), PointsError> {
    let mut at = 0usize;
    while at < chunks.len() {
        let lengths = at + point_bytes + 4;
        let mut end = lengths + 4 * layers;
        for layer in 0..layers {
            let length = bytes_at(chunks, lengths + 4 * layer).map(u32::from_le_bytes);
            end = length.map_or(usize::MAX, |length| end.saturating_add(length as usize));
        }
        if end > chunks.len() {
            return Err(broken(format!("the layers of a chunk at byte {at} of its points run beyond them")));
        }
        at = end;
    }
    Ok(())
}

/// The layers of an item in a chunk.
fn layers(item: LazItemType) -> usize {
    match item {
        LazItemType::Point14 => 9,
        LazItemType::RGB14 | LazItemType::WavePacket14 => 1,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(extra) => extra.into(),
        _ => 0,
    }
}

fn undecodable(error: laz::LasZipError) -> PointsError {
    DemErrorKind::Undecodable { format: "LAZ file", source: Box::new(error) }.into()
}

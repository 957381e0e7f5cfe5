//! Blocks of an Erdas Imagine layer: as they are, or packed by runs or by differences to the least value (Esri's GRID
//! compression).
//!
//! ```text
//! table   blocks, … :u32 × 3 │ packed:u16 │ pointer │ file:i16, place:u32, bytes:u32, is valid:u16, is packed:u16 │ …
//! packed  least:i32 │ runs:i32, or −1 │ place of values:u32 │ bits of a value:u8 │ lengths of runs │ values
//! length  of a run: 6, 14, 22 or 30 bits, by the first two bits 0 to 3; the most significant byte first
//! value   of 1, 2 or 4 bits from the least significant bit of a byte on, or 8, 16 or 32 with the most significant byte first
//! ```
//!
//! Values are whole numbers above the least; of floats they are the bits.

use std::ops::Range;

use sandtable_base::bytes::ByteOrder;
use sandtable_base::limits::work_limit::WorkLimit;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::raster::Samples;
use sandtable_raster::sample_type::SampleType;

use crate::formats::hfa::fault::{broken, unsupported};
use crate::formats::hfa::layer::HfaLayer;
use crate::formats::hfa::tree::{HfaNode, HfaTree};
use crate::formats::sample_layout::{NoData, SampleLayout};

/// Bytes of a packed block before the lengths of its runs.
const HEAD_BYTES: usize = 13;

/// The most bytes that one byte of a file stands for: a block of level ground of 256 samples squared takes some forty.
const EXPANSION: u64 = 1 << 14;

/// The largest block in bytes: others have 64 samples squared.
const LARGEST_BLOCK: u64 = 64 << 20;

/// Where blocks lie.
pub(super) struct HfaBlocks(Vec<HfaBlock>);

#[derive(Clone, Copy, Debug)]
struct HfaBlock {
    start: u32,
    bytes: u32,
    is_valid: bool,
    is_packed: bool,
}

impl HfaBlocks {
    /// Reads the table of blocks of a layer, which the file can hold and which has at most `most` samples.
    pub fn read(
        tree: &HfaTree<impl FileContent>,
        state: &HfaNode,
        layer: &HfaLayer,
        most: &'static WorkLimit,
    ) -> Result<Self, DemErrorKind> {
        let mut fields = tree.fields(state)?;
        let (across, down) = layer.blocks_across_and_down();
        let wanted = across * down;
        let (_blocks, _objects, _next, _packed) =
            (fields.u32()?, fields.u32()?, fields.u32()?, fields.u16()?);
        let listed = u64::from(fields.pointer()?);
        // Each block takes an entry of this table, which lies in the file.
        let claim = SizeClaim::new(layer.columns.into(), layer.rows.into(), layer.sample.bytes() as u64);
        let claim = SizeClaim { most_samples: most, ..claim };
        SizeClaim { bytes_per_sample: 0, ..claim }.check(usize::MAX)?;
        if listed < wanted {
            return Err(broken(format!("its table lists {listed} of {wanted} blocks")));
        }
        if layer.block_bytes() > LARGEST_BLOCK {
            let what = format!("blocks of {} x {} samples", layer.block_columns, layer.block_rows);
            return Err(unsupported(what));
        }
        let mut blocks = Vec::new();
        for _ in 0..wanted {
            let (file, start, bytes) = (fields.u16()?, fields.u32()?, fields.u32()?);
            let (is_valid, is_packed) = (fields.u16()? != 0, fields.u16()? != 0);
            if file != 0 {
                return Err(unsupported("blocks in another file"));
            }
            blocks.push(HfaBlock { start, bytes, is_valid, is_packed });
        }
        let block = u64::from(layer.block_columns) * u64::from(layer.block_rows);
        let absent = blocks.iter().filter(|block| !block.is_valid).count() as u64 * block;
        let has_packed = blocks.iter().any(|block| block.is_packed);
        let expansion = if has_packed { EXPANSION } else { 1 };
        let length = usize::try_from(tree.length).unwrap_or(usize::MAX);
        SizeClaim { absent, expansion, ..claim }.check(length)?;
        Ok(Self(blocks))
    }

    /// The bytes of the file that hold a block; `None` for one that was never written.
    pub fn stored(&self, index: usize, layer: &HfaLayer) -> Option<Range<u64>> {
        let block = self.0[index];
        let bytes = if block.is_packed { block.bytes.into() } else { layer.block_bytes() };
        let start = u64::from(block.start);
        block.is_valid.then_some(start..start + bytes)
    }

    /// The samples of a block, those beyond the layer among them, `nodata` as NaN. One that was never written is no data, or 0
    /// where the file states no value for that, as in GDAL.
    pub fn samples(
        &self,
        tree: &HfaTree<impl FileContent>,
        index: usize,
        layer: &HfaLayer,
        nodata: Option<f64>,
    ) -> Result<Samples, DemErrorKind> {
        let count = layer.block_columns as usize * layer.block_rows as usize;
        let Some(stored) = self.stored(index, layer) else {
            let mut samples = Samples::absent(count, layer.sample.is_wide());
            if nodata.is_none() {
                (0..count).for_each(|at| samples.set(at, 0.0));
            }
            return Ok(samples);
        };
        let broken = || broken(format!("block {index} breaks off, or lies beyond its end"));
        let mut bytes = tree.bytes(stored.start, stored.end - stored.start)?.ok_or_else(broken)?;
        if self.0[index].is_packed {
            let mut unpacked = Vec::new();
            unpack(&bytes, layer.sample, count, &mut unpacked).ok_or_else(broken)?;
            bytes = unpacked;
        }
        let sides = (layer.block_columns.into(), layer.block_rows.into());
        let layout = SampleLayout::dense(sides, layer.sample, ByteOrder::Little, 0);
        Ok(layout.samples(&bytes, NoData::Value(nodata)))
    }
}

/// Unpacks `count` samples.
fn unpack(packed: &[u8], sample: SampleType, count: usize, out: &mut Vec<u8>) -> Option<()> {
    let head = packed.first_chunk::<HEAD_BYTES>()?;
    let word = |at: usize| i32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    let (least, runs, values_at, bits) = (word(0), word(4), word(8), u32::from(head[12]));
    if runs == -1 {
        let mut values = PackedValues::new(packed.get(HEAD_BYTES..)?, bits)?;
        for _ in 0..count {
            append(sample, values.next()?.wrapping_add(least), 1, out)?;
        }
        return Some(());
    }
    let mut lengths = packed.get(HEAD_BYTES..)?;
    let mut values = PackedValues::new(packed.get(usize::try_from(values_at).ok()?..)?, bits)?;
    let mut left = count;
    for _ in 0..runs.max(0) {
        if left == 0 {
            break;
        }
        let length = run_length(&mut lengths)?.min(left);
        append(sample, values.next()?.wrapping_add(least), length, out)?;
        left -= length;
    }
    (left == 0).then_some(())
}

/// Appends a value a number of times; `None` for a type whose values are never packed.
fn append(sample: SampleType, value: i32, count: usize, out: &mut Vec<u8>) -> Option<()> {
    let bytes = value.to_le_bytes();
    let bytes = match sample.bytes() {
        length @ (1 | 2 | 4) => &bytes[..length],
        _ => return None,
    };
    for _ in 0..count {
        out.extend(bytes);
    }
    Some(())
}

/// Takes the length of a run.
fn run_length(lengths: &mut &[u8]) -> Option<usize> {
    let (first, rest) = lengths.split_first()?;
    let (more, rest) = rest.split_at_checked(usize::from(first >> 6))?;
    *lengths = rest;
    Some(more.iter().fold(usize::from(first & 0x3f), |length, byte| length << 8 | usize::from(*byte)))
}

/// Values of a few bits each.
struct PackedValues<'a> {
    bytes: &'a [u8],
    bits: u32,
    /// Bits that were taken.
    position: usize,
}

impl<'a> PackedValues<'a> {
    fn new(bytes: &'a [u8], bits: u32) -> Option<Self> {
        matches!(bits, 0 | 1 | 2 | 4 | 8 | 16 | 32).then_some(Self { bytes, bits, position: 0 })
    }

    fn next(&mut self) -> Option<i32> {
        let at = self.position / 8;
        let value = match self.bits {
            0 => 0,
            bits @ 1..8 => i32::from(self.bytes.get(at)? >> (self.position % 8)) & ((1 << bits) - 1),
            8 => i32::from(*self.bytes.get(at)?),
            16 => i32::from(u16::from_be_bytes(*self.bytes.get(at..)?.first_chunk()?)),
            _ => i32::from_be_bytes(*self.bytes.get(at..)?.first_chunk()?),
        };
        self.position += self.bits as usize;
        Some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_runs_take_one_to_four_bytes() {
        let mut lengths = &[0x05, 0x41, 0x00, 0x80, 0x01, 0x02, 0xc0, 0, 1, 0, 0x40][..];
        let taken: Vec<_> = std::iter::from_fn(|| run_length(&mut lengths)).collect();
        assert_eq!(taken, [5, 256, 258, 256]);
    }

    #[test]
    fn values_of_every_width_are_taken() {
        let taken = |bits: u32, bytes: &[u8]| -> Vec<i32> {
            let mut values = PackedValues::new(bytes, bits).expect("a width");
            std::iter::from_fn(|| values.next()).take(4).collect()
        };
        assert_eq!(taken(1, &[0b0000_1010]), [0, 1, 0, 1]);
        assert_eq!(taken(2, &[0b1101_0010]), [2, 0, 1, 3]);
        assert_eq!(taken(4, &[0x21, 0x43]), [1, 2, 3, 4]);
        assert_eq!(taken(8, &[1, 255]), [1, 255]);
        assert_eq!(taken(16, &[1, 2, 0xff, 0]), [258, 0xff00]);
        assert_eq!(taken(32, &[0xff, 0xff, 0xff, 0xfe]), [-2]);
        assert_eq!(taken(0, &[]), [0; 4]);
        assert!(PackedValues::new(&[], 3).is_none());
    }

    #[test]
    fn a_packed_block_that_breaks_off_is_refused() {
        let packed =
            [&(-5_i32).to_le_bytes()[..], &2_i32.to_le_bytes(), &15_i32.to_le_bytes(), &[8, 1, 3, 15, 11]]
                .concat();
        let mut out = Vec::new();
        assert!(unpack(&packed, SampleType::I16, 4, &mut out).is_some());
        assert_eq!(out, [10, 6, 6, 6].map(i16::to_le_bytes).concat());
        for end in 0..packed.len() {
            out.clear();
            assert!(unpack(&packed[..end], SampleType::I16, 4, &mut out).is_none(), "{end}");
        }
        assert!(unpack(&packed, SampleType::I16, 5, &mut out).is_none(), "too few runs");
        assert!(unpack(&packed, SampleType::F64, 4, &mut out).is_none());
        let plain = [&3_i32.to_le_bytes()[..], &(-1_i32).to_le_bytes(), &[0; 4], &[4, 0x21, 0x43]].concat();
        out.clear();
        assert!(unpack(&plain, SampleType::U8, 4, &mut out).is_some());
        assert_eq!(out, [4, 5, 6, 7]);
    }
}

//! The header of a layer: its size, the type of its samples, and its blocks.

use glam::U64Vec2;

use crate::formats::hfa::fault::{broken, unsupported};
use crate::formats::hfa::tree::{HfaNode, HfaTree};
use sandtable_base::limits::WINDOWED_SAMPLES;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::sample_type::SampleType;

/// The types of samples by their numbers, from that of bytes on; below are bits, above complex numbers.
const TYPES: [SampleType; 8] = [
    SampleType::U8,
    SampleType::I8,
    SampleType::U16,
    SampleType::I16,
    SampleType::U32,
    SampleType::I32,
    SampleType::F32,
    SampleType::F64,
];

/// The number of the first of [`TYPES`].
const BYTES: u16 = 3;

/// The header of a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct HfaLayer {
    pub(super) columns: u32,
    pub(super) rows: u32,
    pub(super) sample: SampleType,
    /// Columns of a block; those of the last one reach beyond the layer.
    pub(super) block_columns: u32,
    pub(super) block_rows: u32,
}

impl HfaLayer {
    pub(super) fn read(tree: &HfaTree<impl FileContent>, layer: &HfaNode) -> Result<Self, DemErrorKind> {
        let mut fields = tree.fields(layer)?;
        let (columns, rows, _use, kind) = (fields.u32()?, fields.u32()?, fields.u16()?, fields.u16()?);
        let (block_columns, block_rows) = (fields.u32()?, fields.u32()?);
        if block_columns == 0 || block_rows == 0 {
            return Err(broken(format!("its blocks have {block_columns} x {block_rows} samples")));
        }
        let reach = [(columns, block_columns), (rows, block_rows)];
        if reach.iter().any(|(count, block)| count.checked_next_multiple_of(*block).is_none()) {
            return Err(DemErrorKind::TooLarge {
                size: U64Vec2::new(columns.into(), rows.into()),
                most: &WINDOWED_SAMPLES,
            });
        }
        Ok(Self { columns, rows, sample: sample_type(kind)?, block_columns, block_rows })
    }

    /// Bytes of an unpacked block.
    pub(super) fn block_bytes(&self) -> u64 {
        u64::from(self.block_columns) * u64::from(self.block_rows) * self.sample.bytes() as u64
    }

    /// Blocks side by side, and above each other.
    pub(super) fn blocks_across_and_down(&self) -> (u64, u64) {
        (self.columns.div_ceil(self.block_columns).into(), self.rows.div_ceil(self.block_rows).into())
    }
}

/// The type of samples with a number.
pub(super) fn sample_type(number: u16) -> Result<SampleType, DemErrorKind> {
    let known = number.checked_sub(BYTES).and_then(|index| TYPES.get(usize::from(index)));
    known.copied().ok_or_else(|| {
        let what =
            if number < BYTES { "samples of less than 8 bits" } else { "samples that are no real numbers" };
        unsupported(what)
    })
}

//! Tiles of a LERC block: steps from the least sample of each, in as few bits as they take.
//!
//! ```text
//! bits 0–1: how samples are stored, 2 or 3–5: bits of the column (a check), 2: differences (version 5 on), 6–7: type of the offset
//!     0  samples as they are
//!     1  offset │ numbers of steps    sample = offset + steps · 2 · error
//!     2  all samples are 0            or those of the depth before
//!     3  offset                       all samples are the offset
//! ```

use std::ops::Range;

use sandtable_base::bytes::ByteCursor;
use sandtable_raster::sample_type::SampleType;

use crate::lerc::bits::take_numbers;
use crate::lerc::{LercBlock, LercHeader, TYPES, cast, value};

/// The largest side of a tile in the reference.
const LARGEST_TILE: usize = 32;

/// Takes all tiles; `None` where they break off.
pub(super) fn read(
    cursor: &mut ByteCursor,
    header: &LercHeader,
    greatest: &[f64],
    block: &mut LercBlock,
) -> Option<()> {
    if !(1..=LARGEST_TILE).contains(&header.tile) {
        return None;
    }
    let spans = |length: usize| {
        (0..length).step_by(header.tile).map(move |start| start..length.min(start + header.tile))
    };
    let mut steps = Vec::new();
    for rows in spans(header.rows) {
        for columns in spans(header.columns) {
            for (depth, greatest) in greatest.iter().enumerate().take(header.depth) {
                let tile = LercTile { rows: rows.clone(), columns: columns.clone(), depth };
                tile.read(cursor, header, *greatest, block, &mut steps)?;
            }
        }
    }
    Some(())
}

/// A tile of the values of one depth.
struct LercTile {
    rows: Range<usize>,
    columns: Range<usize>,
    depth: usize,
}

impl LercTile {
    fn read(
        &self,
        cursor: &mut ByteCursor,
        header: &LercHeader,
        greatest: f64,
        block: &mut LercBlock,
        steps: &mut Vec<u32>,
    ) -> Option<()> {
        let flags = cursor.u8()?;
        let has_differences = header.version >= 5 && flags & 4 != 0;
        let checked = if header.version >= 5 { 14 } else { 15 };
        let column = (self.columns.start >> 3) & checked;
        if usize::from(flags >> 2) & checked != column || has_differences && self.depth == 0 {
            return None;
        }
        let way = flags & 3;
        if way == 0 {
            if has_differences {
                return None;
            }
            return self.set(header, block, |_| value(cursor, header.sample));
        }
        // The value of the depth before, where differences to it are stored.
        let base = |before: f64| if has_differences { before } else { 0.0 };
        if way == 2 {
            return self.set(header, block, |before| Some(base(before)));
        }
        let is_integer = !header.sample.is_float();
        let stored = if has_differences && is_integer { SampleType::I32 } else { header.sample };
        let offset = value(cursor, offset_type(stored, flags >> 6)?)?;
        let bounded = |value: f64| cast(header.sample, value.min(greatest));
        if way == 3 {
            return self.set(header, block, |before| {
                Some(if has_differences { bounded(offset + before) } else { cast(header.sample, offset) })
            });
        }
        let size = self.rows.len() * self.columns.len();
        take_numbers(cursor, size, header.version, steps)?;
        let step = 2.0 * header.error;
        let mut steps = steps.iter();
        self.set(header, block, |before| {
            let steps = steps.next()?;
            Some(bounded(offset + f64::from(*steps) * step + base(before)))
        })
    }

    /// Sets the valid values in order; `of` gets the value of the depth before, 0 for the first.
    fn set(
        &self,
        header: &LercHeader,
        block: &mut LercBlock,
        mut of: impl FnMut(f64) -> Option<f64>,
    ) -> Option<()> {
        for row in self.rows.clone() {
            for pixel in self.columns.clone().map(|column| row * header.columns + column) {
                if !block.is_valid(pixel) {
                    continue;
                }
                let at = pixel * header.depth + self.depth;
                let before = if self.depth > 0 { block.values[at - 1] } else { 0.0 };
                block.values[at] = of(before)?;
            }
        }
        Some(())
    }
}

/// The type of an offset among samples of a type: a smaller one where the offset fits it.
fn offset_type(sample: SampleType, reduced: u8) -> Option<SampleType> {
    let number = TYPES.iter().position(|known| *known == sample)?;
    let reduced = usize::from(reduced);
    let number = match sample {
        SampleType::I16 | SampleType::I32 => number.checked_sub(reduced)?,
        SampleType::U16 | SampleType::U32 => number.checked_sub(2 * reduced)?,
        SampleType::F32 => match reduced {
            0 => number,
            1 => 2,
            2 => 1,
            _ => return None,
        },
        SampleType::F64 if reduced > 0 => (number + 1).checked_sub(2 * reduced)?,
        _ => number,
    };
    TYPES.get(number).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_take_a_smaller_type_where_they_fit_it() {
        use SampleType::{F32, F64, I8, I16, I32, U8, U16, U32};
        for (sample, types) in [
            (I16, vec![I16, U8, I8]),
            (U16, vec![U16, U8]),
            (I32, vec![I32, U16, I16, U8]),
            (U32, vec![U32, U16, U8]),
            (F32, vec![F32, I16, U8]),
            (F64, vec![F64, F32, I32, I16]),
            (U8, vec![U8, U8, U8, U8]),
        ] {
            for (reduced, wanted) in types.into_iter().enumerate() {
                assert_eq!(offset_type(sample, reduced as u8), Some(wanted), "{sample:?} {reduced}");
            }
        }
        assert_eq!([offset_type(U16, 2), offset_type(I16, 3), offset_type(F32, 3)], [None; 3]);
    }
}

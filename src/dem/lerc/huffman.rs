//! Bytes of a LERC block by Huffman's codes, one for each value or for each difference to the neighbor before it.
//!
//! ```text
//! version:i32 ≥ 2, values, first, end │ lengths of codes first … end ([`bits`](super::bits)) │ codes │ samples
//! ```
//!
//! The range of values with codes may reach beyond the last and go on from 0. Codes and samples start in the most
//! significant bit of words of 32 bits.

use sandtable_base::bytes::ByteCursor;
use sandtable_raster::sample_type::SampleType;

use crate::lerc::bits::take_numbers;
use crate::lerc::{LercBlock, LercHeader};

/// The values of a byte.
const MOST_VALUES: usize = 256;

/// The longest code.
const MOST_BITS: u32 = 32;

/// A branch that leads nowhere: node 0 is the root, to which none leads.
const NOWHERE: u32 = 0;

/// Added to a value in place of a node.
const LEAF: u32 = 1 << 31;

/// Takes all samples; `None` where they break off.
pub(super) fn read(
    cursor: &mut ByteCursor,
    header: &LercHeader,
    are_differences: bool,
    block: &mut LercBlock,
) -> Option<()> {
    let codes = HuffmanCodes::read(cursor, header.version)?;
    let mut bits = WordBits { bytes: cursor.rest(), position: 0 };
    let offset = if header.sample == SampleType::I8 { 128 } else { 0 };
    let (columns, depths) = (header.columns, header.depth);
    for depth in 0..depths {
        let mut before = 0_u8;
        for pixel in 0..header.pixels() {
            if !block.is_valid(pixel) {
                continue;
            }
            let byte_at = |pixel: usize| block.values[pixel * depths + depth] as i16 as u8;
            let column = pixel % columns;
            let mut byte = (codes.value(&mut bits)? as u8).wrapping_sub(offset);
            if are_differences {
                byte = byte.wrapping_add(if column > 0 && block.is_valid(pixel - 1) {
                    before
                } else if pixel >= columns && block.is_valid(pixel - columns) {
                    byte_at(pixel - columns)
                } else {
                    before
                });
                before = byte;
            }
            let is_signed = header.sample == SampleType::I8;
            block.values[pixel * depths + depth] =
                if is_signed { f64::from(byte as i8) } else { f64::from(byte) };
        }
    }
    Some(())
}

/// Codes as a tree, the branches of each node for the bits 0 and 1.
struct HuffmanCodes(Vec<[u32; 2]>);

impl HuffmanCodes {
    fn read(cursor: &mut ByteCursor, version: u32) -> Option<Self> {
        let [own_version, values, first, end] =
            [cursor.u32_le()?, cursor.u32_le()?, cursor.u32_le()?, cursor.u32_le()?];
        let (values, first, end) = (values as usize, first as usize, end as usize);
        let is_sound = (2..=i32::MAX as u32).contains(&own_version)
            && (1..=MOST_VALUES).contains(&values)
            && first < end
            && end - first <= values
            && first < values;
        if !is_sound {
            return None;
        }
        let mut lengths = Vec::new();
        take_numbers(cursor, end - first, version, &mut lengths)?;
        if lengths.len() != end - first {
            return None;
        }
        let mut codes = Self(vec![[NOWHERE; 2]]);
        let mut bits = WordBits { bytes: cursor.rest(), position: 0 };
        for (value, &length) in (first..end).zip(&lengths).filter(|(_, length)| **length > 0) {
            let code = (length <= MOST_BITS).then(|| bits.take(length))??;
            codes.add(code, length, (value % values) as u32)?;
        }
        cursor.take(bits.position.div_ceil(32) * 4)?;
        Some(codes)
    }

    /// `None` where the code is the start of another, or another is its start.
    fn add(&mut self, code: u32, length: u32, value: u32) -> Option<()> {
        let mut node = 0;
        for shift in (0..length).rev() {
            let bit = (code >> shift & 1) as usize;
            let next = self.0[node][bit];
            if next & LEAF != 0 || shift == 0 && next != NOWHERE {
                return None;
            }
            if shift == 0 {
                self.0[node][bit] = LEAF | value;
            } else if next == NOWHERE {
                self.0.push([NOWHERE; 2]);
                let added = self.0.len() - 1;
                self.0[node][bit] = added as u32;
                node = added;
            } else {
                node = next as usize;
            }
        }
        Some(())
    }

    /// Takes a code: its value.
    fn value(&self, bits: &mut WordBits) -> Option<u32> {
        let mut node = 0;
        loop {
            let next = self.0[node][bits.take(1)? as usize];
            match next {
                NOWHERE => return None,
                leaf if leaf & LEAF != 0 => return Some(leaf & !LEAF),
                next => node = next as usize,
            }
        }
    }
}

/// Bits from the most significant of a word of 32, the least significant byte first, to the least.
struct WordBits<'a> {
    bytes: &'a [u8],
    /// Bits that were taken.
    position: usize,
}

impl WordBits<'_> {
    fn take(&mut self, count: u32) -> Option<u32> {
        let mut taken = 0_u64;
        for _ in 0..count {
            // The bytes of a word lie in the other order.
            let byte = self.bytes.get((self.position / 8) ^ 3)?;
            taken = taken << 1 | u64::from(byte >> (7 - self.position % 8) & 1);
            self.position += 1;
        }
        Some(taken as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_lead_to_values_and_none_is_the_start_of_another() {
        let mut codes = HuffmanCodes(vec![[NOWHERE; 2]]);
        for (code, length, value) in [(0, 1, 9), (0b10, 2, 200), (0b110, 3, 0)] {
            assert!(codes.add(code, length, value).is_some());
        }
        assert!(
            codes.add(0b0, 1, 3).is_none()
                && codes.add(0b11, 2, 3).is_none()
                && codes.add(0b101, 3, 3).is_none()
        );
        // 110 10 0 111 from the highest bit of a word on.
        let bytes = 0b1101_0011_1000_0000_0000_0000_0000_0000_u32.to_le_bytes();
        let mut bits = WordBits { bytes: &bytes, position: 0 };
        assert_eq!([0; 3].map(|_: i32| codes.value(&mut bits)), [Some(0), Some(200), Some(9)]);
        assert_eq!(codes.value(&mut bits), None, "no code starts so");
    }
}

//! Whole numbers of a few bits each, as LERC packs the samples of a tile and the lengths of codes.
//!
//! ```text
//! bits 0–4 of a number, 5: looked up, 6–7: bytes of the count │ count │ numbers
//!                                                             │ count │ values + 1 │ values but for 0 │ places of values
//! ```

use sandtable_base::bytes::ByteCursor;

/// The order of the bits of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BitOrder {
    /// From the least significant bit of the first byte on.
    Ascending,
    /// From the most significant bit of the first word of 32 bits on; of the last word only the upper bytes are stored. So
    /// before version 3.
    Descending,
}

/// Takes at most `most` numbers into `out`, which is cleared; `None` where they break off.
pub(super) fn take_numbers(
    cursor: &mut ByteCursor,
    most: usize,
    version: u32,
    out: &mut Vec<u32>,
) -> Option<()> {
    const LOOKED_UP: u8 = 0x20;
    let order = if version >= 3 { BitOrder::Ascending } else { BitOrder::Descending };
    let first = cursor.u8()?;
    let bits = u32::from(first & 0x1f);
    let count = match first >> 6 {
        0 => cursor.u32_le()? as usize,
        1 => usize::from(u16::from_le_bytes(cursor.array()?)),
        2 => usize::from(cursor.u8()?),
        _ => return None,
    };
    out.clear();
    if count > most {
        return None;
    }
    if first & LOOKED_UP == 0 {
        return unpack(cursor, count, bits, order, out);
    }
    let known = usize::from(cursor.u8()?.checked_sub(1)?);
    if bits == 0 || known == 0 {
        return None;
    }
    let mut values = Vec::with_capacity(known);
    unpack(cursor, known, bits, order, &mut values)?;
    unpack(cursor, count, usize::BITS - known.leading_zeros(), order, out)?;
    for place in out {
        // Place 0 is the value 0, which is not stored.
        *place = match *place {
            0 => 0,
            place => *values.get(place as usize - 1)?,
        };
    }
    Some(())
}

fn unpack(
    cursor: &mut ByteCursor,
    count: usize,
    bits: u32,
    order: BitOrder,
    out: &mut Vec<u32>,
) -> Option<()> {
    if bits == 0 {
        out.resize(count, 0);
        return Some(());
    }
    let length = (count * bits as usize).div_ceil(8);
    let bytes = cursor.take(length)?;
    match order {
        BitOrder::Ascending => {
            let (mut held, mut held_bits, mut bytes) = (0_u64, 0, bytes.iter());
            for _ in 0..count {
                while held_bits < bits {
                    held |= u64::from(*bytes.next()?) << held_bits;
                    held_bits += 8;
                }
                out.push((held & ((1 << bits) - 1)) as u32);
                held >>= bits;
                held_bits -= bits;
            }
        }
        BitOrder::Descending => {
            let (mut held, mut held_bits, mut words) = (0_u64, 0, bytes.chunks(4));
            for _ in 0..count {
                if held_bits < bits {
                    held = held << 32 | u64::from(upper_word(words.next()?));
                    held_bits += 32;
                }
                held_bits -= bits;
                out.push((held >> held_bits) as u32 & ((1_u64 << bits) - 1) as u32);
            }
        }
    }
    Some(())
}

/// A word of up to four bytes, of which the lower ones that are missing are 0.
fn upper_word(bytes: &[u8]) -> u32 {
    let word = bytes.iter().rev().fold(0_u32, |word, byte| word << 8 | u32::from(*byte));
    if bytes.len() == 4 { word } else { word << (8 * (4 - bytes.len())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(bytes: &[u8], version: u32) -> Option<Vec<u32>> {
        let mut out = vec![7];
        take_numbers(&mut ByteCursor::new(bytes), 9, version, &mut out).map(|()| out)
    }

    #[test]
    fn numbers_of_three_bits_come_in_either_order() {
        // 1, 2, 7, 4: from the lowest bit 0b100_111_010_001, from the highest 0b001_010_111_100 in the upper bytes of a word.
        assert_eq!(taken(&[0x83, 4, 0b1101_0001, 0b1001], 3), Some(vec![1, 2, 7, 4]));
        assert_eq!(taken(&[0x83, 4, 0b1100_0000, 0b0010_1011], 2), Some(vec![1, 2, 7, 4]));
        assert_eq!(taken(&[0x40, 3, 0], 3), Some(vec![0, 0, 0]), "no bits are zeros");
    }

    #[test]
    fn numbers_are_looked_up_among_few_values() {
        // Three values, two of which are stored in five bits, 9 and 30, and their places in two: 2, 0, 1.
        let packed = [0x80 | 0x20 | 5, 3, 3, 9 | 30_u8 << 5, 30 >> 3, 0b01_0010];
        assert_eq!(taken(&packed, 3), Some(vec![30, 0, 9]));
        let beyond = [0x80 | 0x20 | 5, 3, 3, 9 | 30_u8 << 5, 30 >> 3, 0b01_0011];
        assert_eq!(taken(&beyond, 3), None, "there is no third value");
        for end in 0..packed.len() {
            assert_eq!(taken(&packed[..end], 3), None, "{end}");
        }
    }

    #[test]
    fn more_numbers_than_are_wanted_are_refused() {
        assert_eq!(taken(&[0x80, 10], 3), None);
        assert_eq!(taken(&[0, 0xff, 0xff, 0xff, 0xff], 3), None);
        assert_eq!(taken(&[0xc0, 1], 3), None, "a count has one, two or four bytes");
    }
}

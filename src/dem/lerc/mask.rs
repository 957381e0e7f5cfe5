//! The mask of a LERC block: a bit for each pixel, packed by runs of bytes.
//!
//! ```text
//! bytes:i32 │ n:i16 > 0, n bytes │ n:i16 ≤ 0, one byte −n times │ … │ −32768
//! ```

use sandtable_base::bytes::ByteCursor;

use crate::lerc::LercHeader;

/// The count that ends a mask.
const END: i16 = i16::MIN;

/// Which pixels have values.
#[derive(Debug)]
pub(super) enum LercMask {
    Full,
    Empty,
    /// A bit for each pixel, from the most significant of the first byte on.
    Bits(Vec<u8>),
}

impl LercMask {
    /// Takes the mask of a block; `None` where it breaks off or shows another number of pixels than the header states.
    pub fn read(cursor: &mut ByteCursor, header: &LercHeader) -> Option<Self> {
        let length = cursor.u32_le()? as usize;
        let mut packed = ByteCursor::new(cursor.take(length)?);
        let pixels = header.pixels();
        match header.valid {
            0 => Some(Self::Empty),
            valid if valid == pixels => Some(Self::Full),
            valid => {
                let bits = unpack(&mut packed, pixels)?;
                let shown: u64 = bits.iter().map(|byte| u64::from(byte.count_ones())).sum();
                let beyond = (8 - pixels % 8) % 8;
                let padding =
                    bits.last().map_or(0, |byte| (byte & ((1_u16 << beyond) - 1) as u8).count_ones());
                (shown - u64::from(padding) == valid as u64).then_some(Self::Bits(bits))
            }
        }
    }

    pub fn shows(&self, pixel: usize) -> bool {
        match self {
            Self::Full => true,
            Self::Empty => false,
            Self::Bits(bits) => bits[pixel / 8] & (0x80 >> (pixel % 8)) != 0,
        }
    }

    pub fn is_full(&self) -> bool {
        matches!(self, Self::Full)
    }
}

fn unpack(packed: &mut ByteCursor, pixels: usize) -> Option<Vec<u8>> {
    let length = pixels.div_ceil(8);
    let mut bits = Vec::with_capacity(length);
    loop {
        let count = i16::from_le_bytes(packed.array()?);
        match count {
            END => break,
            literal @ 1.. => bits.extend(packed.take(literal as usize)?),
            repeated => {
                let byte = packed.u8()?;
                bits.resize(bits.len() + usize::from(repeated.unsigned_abs()), byte);
            }
        }
        if bits.len() > length {
            return None;
        }
    }
    (bits.len() == length).then_some(bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_and_bytes_as_they_are_follow_each_other() {
        let packed = [2, 0, 0xaa, 0xf0, 0xfd, 0xff, 0x0f, 0, 0x80];
        let unpacked = unpack(&mut ByteCursor::new(&packed), 38);
        assert_eq!(unpacked, Some(vec![0xaa, 0xf0, 0x0f, 0x0f, 0x0f]));
        assert_eq!(unpack(&mut ByteCursor::new(&packed), 32), None, "too long");
        assert_eq!(unpack(&mut ByteCursor::new(&packed), 41), None, "too short");
        for end in 0..packed.len() {
            assert_eq!(unpack(&mut ByteCursor::new(&packed[..end]), 38), None, "{end}");
        }
    }
}

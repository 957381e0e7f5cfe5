//! XZ streams, in which libtiff keeps blocks packed by LZMA: blocks of LZMA2, whose bytes may be differences.
//!
//! ```text
//! stream  fd "7zXZ" 0 │ flags 0, check │ CRC-32 │ block … │ index │ footer
//! block   size/4 − 1 │ flags │ packed, unpacked size? │ filters: number, length, properties │ 0 … │ CRC-32
//!         LZMA2 chunks … 0 │ 0 … │ check
//! ```
//!
//! Specification: Lasse Collin and Igor Pavlov, *The .xz File Format* 1.2.1, 2024. libtiff writes one block whose filters
//! are the differences of bytes that lie a sample apart, and LZMA2. Checks are ignored, as libtiff writes none.
//!
//! A stream states how much memory it takes, and may state 4 GiB: the dictionary here is no larger than what is unpacked,
//! since no distance within it can be longer.

use std::io::Read;

use lzma_rust2::Lzma2Reader;

use sandtable_base::bytes::ByteCursor;

const MAGIC: [u8; 6] = *b"\xfd7zXZ\0";

/// The number of the filter that sums differences.
const DELTA: u64 = 0x03;

/// The number of the filter that unpacks.
const LZMA2: u64 = 0x21;

/// The smallest dictionary.
const LEAST_DICTIONARY: usize = 4096;

/// The header of a block: how its bytes become those that were packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct XzBlock {
    /// Bytes from one to that whose difference to it is stored; 0 where bytes are stored as they are.
    distance: usize,
    /// Bytes of the dictionary.
    dictionary: u64,
}

/// Fills `out` from the start of a stream, ignores the rest, and returns the number of bytes.
pub(crate) fn unpack(packed: &[u8], out: &mut [u8]) -> usize {
    let mut cursor = ByteCursor::new(packed);
    let Some(check_bytes) = check_bytes(&mut cursor) else { return 0 };
    let mut written = 0;
    while written < out.len() {
        let Some(block) = XzBlock::read(&mut cursor) else { break };
        let start = written;
        let mut rest = cursor.rest();
        let before = rest.len();
        written += unpack_chunks(&mut rest, block, &mut out[start..]);
        sum_differences(&mut out[start..written], block.distance);
        let taken = before - rest.len();
        if written == start || cursor.take(taken.next_multiple_of(4) + check_bytes).is_none() {
            break;
        }
    }
    written
}

/// Reads the header of a stream: the number of bytes of the check after each block.
fn check_bytes(cursor: &mut ByteCursor) -> Option<usize> {
    let start = cursor.array::<8>()?;
    let &[0, check @ 0..=15] = start.strip_prefix(&MAGIC)? else { return None };
    let _crc = cursor.u32_le()?;
    Some(match check {
        0 => 0,
        1..=3 => 4,
        4..=6 => 8,
        7..=9 => 16,
        10..=12 => 32,
        _ => 64,
    })
}

impl XzBlock {
    /// `None` where no block starts here, or one with other filters.
    fn read(cursor: &mut ByteCursor) -> Option<Self> {
        const PACKED_SIZE: u8 = 0x40;
        const UNPACKED_SIZE: u8 = 0x80;
        let size = usize::from(cursor.u8().filter(|&size| size > 0)?);
        let mut header = ByteCursor::new(cursor.take(4 * size + 3)?);
        let flags = header.u8()?;
        for stated in [PACKED_SIZE, UNPACKED_SIZE] {
            if flags & stated != 0 {
                number(&mut header)?;
            }
        }
        let mut filter = || {
            let (id, length) = (number(&mut header)?, number(&mut header)?);
            Some((id, header.take(usize::try_from(length).ok()?)?))
        };
        match (flags & 3, filter()?) {
            (0, (LZMA2, &[bits])) => Some(Self { distance: 0, dictionary: dictionary(bits)? }),
            (1, (DELTA, &[distance])) => match filter()? {
                (LZMA2, &[bits]) => {
                    Some(Self { distance: usize::from(distance) + 1, dictionary: dictionary(bits)? })
                }
                _ => None,
            },
            _ => None,
        }
    }
}

/// A number in groups of seven bits, the least significant first.
fn number(cursor: &mut ByteCursor) -> Option<u64> {
    const MOST_BYTES: u32 = 9;
    let mut number = 0;
    for group in 0..MOST_BYTES {
        let byte = cursor.u8()?;
        number |= u64::from(byte & 0x7f) << (7 * group);
        if byte & 0x80 == 0 {
            return Some(number);
        }
    }
    None
}

/// The bytes of the dictionary that a block states: 2ⁿ or 3 · 2ⁿ.
fn dictionary(bits: u8) -> Option<u64> {
    match bits {
        40 => Some(u64::from(u32::MAX)),
        0..40 => Some((2 | u64::from(bits & 1)) << (bits / 2 + 11)),
        _ => None,
    }
}

/// Unpacks LZMA2 from the front of `packed`; returns the number of bytes, fewer where it breaks off.
fn unpack_chunks(packed: &mut &[u8], block: XzBlock, out: &mut [u8]) -> usize {
    let most = out.len().max(LEAST_DICTIONARY).next_multiple_of(16) as u64;
    let dictionary = u32::try_from(block.dictionary.min(most)).unwrap_or(u32::MAX);
    let mut reader = Lzma2Reader::new(packed, dictionary, None);
    let mut written = 0;
    while written < out.len() {
        match reader.read(&mut out[written..]) {
            Ok(count @ 1..) => written += count,
            _ => break,
        }
    }
    written
}

/// Adds to each byte the one `distance` before it.
fn sum_differences(bytes: &mut [u8], distance: usize) {
    if distance == 0 {
        return;
    }
    for at in distance..bytes.len() {
        bytes[at] = bytes[at].wrapping_add(bytes[at - distance]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A stream of one block of chunks that are not packed, with differences of bytes 2 apart.
    fn stream(differences: &[u8]) -> Vec<u8> {
        let mut bytes = [&MAGIC[..], &[0, 0], &[0; 4], &[2, 1, 3, 1, 1, 0x21, 1, 0, 0, 0, 0, 0]].concat();
        for (index, chunk) in differences.chunks(5).enumerate() {
            bytes.extend([if index == 0 { 1 } else { 2 }, 0, chunk.len() as u8 - 1]);
            bytes.extend(chunk);
        }
        bytes.push(0);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    }

    #[test]
    fn the_bytes_of_a_stream_are_sums_of_differences() {
        let packed = stream(&[1, 2, 3, 4, 255, 1, 0]);
        let mut out = [0; 7];
        assert_eq!(unpack(&packed, &mut out), 7);
        assert_eq!(out, [1, 2, 4, 6, 3, 7, 3]);
    }

    #[test]
    fn blocks_follow_each_other_in_a_stream() {
        let packed = stream(&[1, 2, 3]);
        let both = [&packed[..], &packed[12..]].concat();
        let mut out = [0; 6];
        assert_eq!(unpack(&both, &mut out), 6);
        assert_eq!(out, [1, 2, 4, 1, 2, 4]);
    }

    #[test]
    fn a_stream_that_breaks_off_gives_no_more_than_it_holds() {
        let packed = stream(&[1, 2, 3, 4, 255, 1, 0]);
        for end in 0..packed.len() - 2 {
            let mut out = [0; 7];
            let written = unpack(&packed[..end], &mut out);
            assert!(written <= 7 && [1, 2, 4, 6, 3, 7, 3].starts_with(&out[..written]), "{end}");
        }
    }

    #[test]
    fn a_dictionary_of_gigabytes_takes_no_more_memory_than_what_is_unpacked() {
        assert_eq!(dictionary(40), Some(u64::from(u32::MAX)));
        assert_eq!([dictionary(0), dictionary(1), dictionary(41)], [Some(4096), Some(6144), None]);
        let mut packed = stream(&[1, 2, 3]);
        packed[19] = 40;
        let mut out = [0; 3];
        assert_eq!((unpack(&packed, &mut out), out), (3, [1, 2, 4]));
    }

    proptest! {
        #[test]
        fn any_bytes_end_within_the_buffer(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            let mut out = [0; 1000];
            prop_assert!(unpack(&bytes, &mut out) <= 1000);
            let start = [&MAGIC[..], &[0, 0], &[0; 4], &[2, 0, 0x21, 1, 22, 0, 0, 0, 0, 0, 0, 0]].concat();
            prop_assert!(unpack(&[start, bytes].concat(), &mut out) <= 1000);
        }
    }
}

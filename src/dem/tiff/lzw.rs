//! LZW as TIFF has it (TIFF 6.0, section 13): codes of 9 to 12 bits, most significant bit first, the width growing one
//! code early.
//!
//! Every string in the table was just written to the output: that of a new code is the string before, and the byte after
//! it. So the table holds places in the output, not strings:
//!
//! ```text
//! output:  … a b c a b c a …        code n   = (start, length) of "abc"
//!            └───┘                  code n+1 = the same start, one longer: it takes the byte that comes next
//! ```
//!
//! The decoder crate's own reader gives up on streams whose last bytes hold more than it was asked for at once, which
//! flat ground in small tiles does; this one unpacks a block in one go.

/// Empties the table.
const CLEAR: usize = 256;

/// Ends the stream.
const END: usize = 257;

/// The first code that stands for a string of the table.
const FIRST: usize = 258;

/// Codes have at most 12 bits.
const CODES: usize = 1 << 12;

/// Codes have at least 9 bits.
const NARROWEST: u32 = 9;

/// Whether a stream is in the order of bits that libtiff wrote before 1991, which is not read.
pub(crate) fn is_ancient(packed: &[u8]) -> bool {
    matches!(packed, [0, second, ..] if second & 1 == 1)
}

/// Unpacks a stream until `out` is full, and returns how many bytes were written: fewer where the stream ends, or goes
/// wrong, before.
pub(crate) fn unpack(packed: &[u8], out: &mut [u8]) -> usize {
    let mut codes = Codes { packed, at: 0, held: 0, bits: 0 };
    let mut places = [(0usize, 0usize); CODES];
    let (mut next, mut width, mut written) = (FIRST, NARROWEST, 0usize);
    let mut before: Option<(usize, usize)> = None;
    while written < out.len() {
        let Some(code) = codes.next(width) else { break };
        if code == CLEAR {
            (next, width, before) = (FIRST, NARROWEST, None);
            continue;
        }
        // The string that the code before begins takes its last byte from this one: it may be this one.
        if let (Some((start, length)), true) = (before, next < CODES) {
            places[next] = (start, length + 1);
        }
        let has_new = before.is_some() && next < CODES;
        let length = if code < CLEAR {
            out[written] = code as u8;
            1
        } else if code != END && code < next + usize::from(has_new) {
            let (start, length) = places[code];
            copy(out, start, written, length)
        } else {
            // The end, or a code that stands for nothing yet.
            break;
        };
        before = Some((written, length));
        written += length;
        next += usize::from(has_new);
        // The width grows when the last code but one is taken; at 12 bits it stays.
        if next + 1 >= 1 << width && width < CODES.ilog2() {
            width += 1;
        }
    }
    written
}

/// Copies what stands at `from` to `to`, as far as there is room, and returns how much. What is copied may reach into
/// what is written.
fn copy(out: &mut [u8], from: usize, to: usize, length: usize) -> usize {
    let length = length.min(out.len() - to);
    if from + length <= to {
        out.copy_within(from..from + length, to);
    } else {
        for at in 0..length {
            out[to + at] = out[from + at];
        }
    }
    length
}

/// The codes of a stream.
struct Codes<'a> {
    packed: &'a [u8],
    at: usize,
    held: u32,
    bits: u32,
}

impl Codes<'_> {
    /// The next code of `width` bits; `None` where the stream ends.
    fn next(&mut self, width: u32) -> Option<usize> {
        while self.bits < width {
            self.held = self.held << 8 | u32::from(*self.packed.get(self.at)?);
            self.at += 1;
            self.bits += 8;
        }
        self.bits -= width;
        Some((self.held >> self.bits) as usize & ((1 << width) - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    /// The stream of `plain`, as libtiff writes it.
    fn packed(plain: &[u8]) -> Vec<u8> {
        let (mut bits, mut table, mut width) = (Vec::new(), BTreeMap::new(), NARROWEST);
        let put = |bits: &mut Vec<bool>, code: usize, width: u32| {
            bits.extend((0..width).rev().map(|bit| code >> bit & 1 == 1));
        };
        put(&mut bits, CLEAR, width);
        let code_of = |table: &BTreeMap<Vec<u8>, usize>, string: &[u8]| match string {
            [byte] => usize::from(*byte),
            _ => table[string],
        };
        let mut string: Vec<u8> = Vec::new();
        for &byte in plain {
            let longer = [&string[..], &[byte]].concat();
            if longer.len() == 1 || table.contains_key(&longer) {
                string = longer;
                continue;
            }
            put(&mut bits, code_of(&table, &string), width);
            table.insert(longer, FIRST + table.len());
            string = vec![byte];
            if FIRST + table.len() == CODES - 2 {
                put(&mut bits, CLEAR, width);
                table.clear();
                width = NARROWEST;
            } else if FIRST + table.len() == 1 << width {
                width += 1;
            }
        }
        if !string.is_empty() {
            put(&mut bits, code_of(&table, &string), width);
            if FIRST + table.len() + 1 == 1 << width {
                width += 1;
            }
        }
        put(&mut bits, END, width);
        bits.chunks(8)
            .map(|byte| byte.iter().enumerate().map(|(at, &bit)| u8::from(bit) << (7 - at)).sum())
            .collect()
    }

    fn unpacked(packed: &[u8], length: usize) -> Vec<u8> {
        let mut out = vec![0xaa; length];
        let written = unpack(packed, &mut out);
        out.truncate(written);
        out
    }

    #[test]
    fn the_example_of_the_specification_comes_out() {
        // TIFF 6.0, section 13: 7 7 7 8 8 7 7 6 6 as codes 256 7 258 8 8 258 6 6 257.
        let plain = [7, 7, 7, 8, 8, 7, 7, 6, 6];
        assert_eq!(unpacked(&packed(&plain), plain.len()), plain);
    }

    #[test]
    fn flat_ground_comes_out_of_a_few_bytes() {
        let plain = vec![0u8; 100_000];
        let stream = packed(&plain);
        assert!(stream.len() < 700, "{}", stream.len());
        assert_eq!(unpacked(&stream, plain.len()), plain);
    }

    #[test]
    fn a_stream_that_breaks_off_gives_what_it_held() {
        let plain: Vec<u8> = (0..5000u32).map(|at| (at * at % 251) as u8).collect();
        let stream = packed(&plain);
        for end in 0..stream.len() - 2 {
            let found = unpacked(&stream[..end], plain.len());
            assert!(found.len() < plain.len() && plain.starts_with(&found), "{end}");
        }
    }

    proptest! {
        #[test]
        fn what_was_packed_comes_out(parts in proptest::collection::vec((any::<u8>(), 1usize..400, 0u8..5), 0..80)) {
            let plain: Vec<u8> = parts
                .into_iter()
                .flat_map(|(byte, count, step)| (0..count).map(move |at| byte.wrapping_add(step.wrapping_mul(at as u8))))
                .collect();
            prop_assert_eq!(unpacked(&packed(&plain), plain.len()), plain);
        }

        #[test]
        fn any_bytes_end_within_the_room(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            prop_assert!(unpacked(&bytes, 1000).len() <= 1000);
        }
    }
}

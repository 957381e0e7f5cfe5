//! The pixels of a PNG packed in strips of rows, in parallel, to the bytes that one thread packs.
//!
//! The fast packer `fdeflate` writes one block of the DEFLATE format (RFC 1951) with codes that never change, and no code
//! depends on what another row has. So strips packed each by itself hold the bits of the whole stream between the same head and
//! the same end, and are joined bit by bit:
//!
//! ```text
//! strip 1   head │ codes 1 │ end, zeros to a byte │ check         Adler-32 (RFC 1950) of its own rows
//! strip 2   head │ codes 2 │ end, zeros to a byte │ check
//! joined    head │ codes 1 │ codes 2 │ end, zeros to a byte │ check of both
//! ```
//!
//! The head and the end are those of an empty stream; the last bits that are 1 in it and in a strip's stream are as far apart as
//! the strip's codes are long.

use std::io::{self, Cursor};
use std::ops::Range;

use fdeflate::{Compressor, StoredOnlyCompressor};
use rayon::prelude::*;

use crate::png_filter::FilteredRow;
use sandtable_draw::pixels::Pixels;

/// Bytes of a strip: enough work for a thread, few enough that 16 threads have some of a picture of 1920×1080 pixels.
const STRIP_BYTES: usize = 1 << 18;

/// Bits before the first code: the two bytes of a ZLIB stream, and the lengths of all codes.
const HEAD_BITS: usize = 53 * 8 + 5;

/// Bits of the code that ends a block.
const END_BITS: usize = 12;

/// Bytes of a check.
const CHECK_BYTES: usize = 4;

/// Bits that are joined at once.
const WORD_BITS: usize = 32;

/// Why no stream fails.
const MEMORY: &str = "memory takes all bytes";

/// The modulus of a check.
const ADLER: u64 = 65_521;

/// The bytes that a pixel has in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PngChannels {
    /// Red, green and blue.
    Opaque,
    /// And alpha.
    WithAlpha,
}

/// A stream of `fdeflate` with what joining needs.
struct PackedStrip {
    stream: Vec<u8>,
    /// Bits of its codes.
    code_bits: usize,
    /// Bytes that were packed.
    packed: u64,
}

impl PngChannels {
    /// Without alpha where all pixels are opaque.
    pub fn of(pixels: &Pixels) -> Self {
        let is_opaque = pixels.data().par_iter().all(|color| color.0[3] == 255);
        if is_opaque { Self::Opaque } else { Self::WithAlpha }
    }

    /// The number of channels.
    pub fn count(self) -> usize {
        match self {
            Self::Opaque => 3,
            Self::WithAlpha => 4,
        }
    }

    /// Copies the channels of a row of pixels, of which `row` has as many.
    fn copy_row(self, pixels: &Pixels, number: u32, row: &mut [u8]) {
        let width = pixels.width() as usize;
        let colors = &pixels.data()[number as usize * width..][..width];
        match self {
            Self::Opaque => {
                for (channels, color) in row.chunks_exact_mut(3).zip(colors) {
                    channels.copy_from_slice(&color.0[..3]);
                }
            }
            Self::WithAlpha => row.copy_from_slice(bytemuck::cast_slice(colors)),
        }
    }
}

/// The pixels as a ZLIB stream of filtered rows. `pixels` must not be empty. The same for any number of threads.
pub(super) fn packed_pixels(pixels: &Pixels, channels: PngChannels) -> Vec<u8> {
    let row_bytes = pixels.width() as usize * channels.count();
    let strip_rows = (STRIP_BYTES / row_bytes).max(1) as u32;
    let firsts: Vec<u32> = (0..pixels.height()).step_by(strip_rows as usize).collect();
    let empty = packed(|_| Ok(()));
    let strip = |first: u32| {
        let rows = first..(first + strip_rows).min(pixels.height());
        let packed = u64::from(rows.end - rows.start) * (row_bytes as u64 + 1);
        let stream = packed_rows(pixels, channels, rows);
        PackedStrip { code_bits: last_bit(&stream) - last_bit(&empty), stream, packed }
    };
    let strips: Vec<PackedStrip> = firsts.into_par_iter().map(strip).collect();
    let joined = joined(&empty, strips);
    let rows_bytes = pixels.height() as usize * (row_bytes + 1);
    // Noise packs to more than it is.
    let is_small = joined.len() <= StoredOnlyCompressor::<()>::compressed_size(rows_bytes);
    if is_small { joined } else { stored_rows(pixels, channels) }
}

/// A stream of some rows of pixels.
fn packed_rows(pixels: &Pixels, channels: PngChannels, rows: Range<u32>) -> Vec<u8> {
    let row_bytes = pixels.width() as usize * channels.count();
    let [mut previous, mut current] = [(); 2].map(|()| vec![0; row_bytes]);
    if rows.start > 0 {
        channels.copy_row(pixels, rows.start - 1, &mut previous);
    }
    let mut filtered = FilteredRow::new(row_bytes);
    packed(|packer| {
        for row in rows {
            channels.copy_row(pixels, row, &mut current);
            packer.write_data(filtered.filter(&previous, &current, channels.count()))?;
            std::mem::swap(&mut previous, &mut current);
        }
        Ok(())
    })
}

/// The stream of what `write` writes.
fn packed(write: impl FnOnce(&mut Compressor<Vec<u8>>) -> io::Result<()>) -> Vec<u8> {
    let stream = Compressor::new(Vec::new()).and_then(|mut packer| {
        write(&mut packer)?;
        packer.finish()
    });
    stream.expect(MEMORY)
}

/// The stream of all rows, neither filtered nor packed.
fn stored_rows(pixels: &Pixels, channels: PngChannels) -> Vec<u8> {
    let mut row = vec![0; pixels.width() as usize * channels.count()];
    let stream = StoredOnlyCompressor::new(Cursor::new(Vec::new())).and_then(|mut packer| {
        for number in 0..pixels.height() {
            channels.copy_row(pixels, number, &mut row);
            packer.write_data(&[0])?;
            packer.write_data(&row)?;
        }
        packer.finish()
    });
    stream.expect(MEMORY).into_inner()
}

/// The number of the last bit that is 1 before a stream's check.
fn last_bit(stream: &[u8]) -> usize {
    let block = &stream[..stream.len() - CHECK_BYTES];
    let last = block.iter().rposition(|&byte| byte > 0).expect("a head is not zero");
    last * 8 + 7 - block[last].leading_zeros() as usize
}

/// One stream of the codes of all strips. Each is moved on to its first bit in a byte by itself, on all threads.
fn joined(empty: &[u8], strips: Vec<PackedStrip>) -> Vec<u8> {
    let check = strips.iter().fold(1, |check, strip| {
        let (_, own) = strip.stream.split_at(strip.stream.len() - CHECK_BYTES);
        let own = own.iter().fold(0, |value, &byte| value << 8 | u32::from(byte));
        joined_check(check, own, strip.packed)
    });
    let mut end = HEAD_BITS;
    let placed: Vec<(usize, PackedStrip)> = strips
        .into_iter()
        .map(|strip| {
            let first = end;
            end += strip.code_bits;
            (first, strip)
        })
        .collect();
    let codes = |(first, strip): (usize, PackedStrip)| {
        (first, moved(&strip.stream, HEAD_BITS..HEAD_BITS + strip.code_bits, first))
    };
    let parts: Vec<(usize, Vec<u8>)> = placed.into_par_iter().map(codes).collect();
    let mut stream = Vec::with_capacity((end + END_BITS).div_ceil(8) + CHECK_BYTES);
    add_bits(&mut stream, 0, moved(empty, 0..HEAD_BITS, 0));
    parts.into_iter().for_each(|(first, part)| add_bits(&mut stream, first, part));
    add_bits(&mut stream, end, moved(empty, HEAD_BITS..HEAD_BITS + END_BITS, end));
    stream.extend(check.to_be_bytes());
    stream
}

/// Bits of `from` in bytes, the first at the place in its byte of bit `first` of a stream, with zeros before it.
fn moved(from: &[u8], bits: Range<usize>, first: usize) -> Vec<u8> {
    let bytes = Vec::with_capacity(bits.len() / 8 + WORD_BITS / 8);
    let mut sink = BitSink { bytes, kept: 0, count: first % 8 };
    sink.append(from, bits);
    sink.finish()
}

/// Adds [`moved`] bits, of which the first is number `first`, to a stream that ends before it, in the same byte or at its end.
fn add_bits(stream: &mut Vec<u8>, first: usize, bytes: Vec<u8>) {
    match (stream.last_mut(), &bytes[..]) {
        (Some(last), [shared, rest @ ..]) if !first.is_multiple_of(8) => {
            *last |= shared;
            stream.extend(rest);
        }
        _ => stream.extend(bytes),
    }
}

/// The Adler-32 of some bytes with the check `before` and `count` more with the check `own`.
fn joined_check(before: u32, own: u32, count: u64) -> u32 {
    let parts = |check: u32| [u64::from(check & 0xffff), u64::from(check >> 16)];
    let ([sum, sums], [own_sum, own_sums]) = (parts(before), parts(own));
    let less_one = |sum: u64| (sum + ADLER - 1) % ADLER;
    let sums = (sums + own_sums + count % ADLER * less_one(sum)) % ADLER;
    let sum = (sum + less_one(own_sum)) % ADLER;
    (sums << 16 | sum) as u32
}

/// Bytes of bits, the first of which is the lowest of the first byte.
struct BitSink {
    bytes: Vec<u8>,
    /// Bits that fill no four bytes yet.
    kept: u64,
    count: usize,
}

impl BitSink {
    /// Adds bits of `from`, which is longer by a check than they need.
    fn append(&mut self, from: &[u8], bits: Range<usize>) {
        for at in bits.clone().step_by(WORD_BITS) {
            let count = WORD_BITS.min(bits.end - at);
            // Bytes past the last one hold none of the bits.
            let bytes = from[at / 8..].iter().take(WORD_BITS / 8 + 1);
            let read = bytes.rev().fold(0, |value, &byte| value << 8 | u64::from(byte));
            self.kept |= (read >> (at % 8) & ((1 << count) - 1)) << self.count;
            self.count += count;
            if self.count >= WORD_BITS {
                self.bytes.extend((self.kept as u32).to_le_bytes());
                (self.kept, self.count) = (self.kept >> WORD_BITS, self.count - WORD_BITS);
            }
        }
    }

    /// All bytes; the last one is filled with zeros.
    fn finish(mut self) -> Vec<u8> {
        let bytes = self.kept.to_le_bytes();
        self.bytes.extend(&bytes[..self.count.div_ceil(8)]);
        self.bytes
    }
}

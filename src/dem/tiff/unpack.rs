//! Decompresses the blocks of a TIFF to the bytes of their rows.
//!
//! The `tiff` crate reads the directory, but not blocks: it refuses valid LZW streams of small flat tiles, changes
//! values by their photometric meaning, and unpacks Zstandard through C. So blocks go straight to the crates that
//! unpack: `flate2`, `weezl`, `ruzstd`, `lzma-rust2` and `zune-jpeg`, each in one call from memory into a buffer that is
//! kept.

use std::borrow::Cow;
use std::io::Read;
use std::ops::Range;

use flate2::{Decompress, FlushDecompress, Status};
use ruzstd::decoding::{FrameDecoder, StreamingDecoder};
use weezl::decode::Decoder as LzwDecoder;
use weezl::{BitOrder, LzwStatus};

use crate::tiff::fault::{self, TO_DEFLATE};
use crate::tiff::jpeg_block::{self, JpegBlock};
use crate::tiff::lerc_block;
use crate::tiff::storage::{LercPacking, Packing, Storage, TiffBlock};
use crate::tiff::xz;
use sandtable_raster::error::DemErrorKind;

/// Packed bytes beyond twice what a block unpacks to are ignored; no packing needs more.
const MOST_GROWTH: usize = 2;

/// The photometric interpretation of one band from dark to light; it says nothing of the meaning of three.
const BLACK_IS_ZERO: u16 = 1;

/// Bytes that even an empty stream may take.
const SLACK: usize = 1 << 10;

/// A file that blocks are read from.
pub(crate) trait BlockBytes {
    fn length(&self) -> usize;

    /// The bytes in a range within the file; fewer where the file has shrunk.
    fn bytes(&mut self, range: Range<usize>) -> std::io::Result<Cow<'_, [u8]>>;

    /// The bytes in a range, where they are in memory.
    fn held(&self, _range: Range<usize>) -> Option<&[u8]> {
        None
    }

    /// [`BlockBytes::bytes`] into memory that is used again.
    fn read_into(&mut self, range: Range<usize>, out: &mut Vec<u8>) -> std::io::Result<()> {
        out.clear();
        out.extend_from_slice(&self.bytes(range)?);
        Ok(())
    }
}

impl BlockBytes for &[u8] {
    fn length(&self) -> usize {
        self.len()
    }

    fn bytes(&mut self, range: Range<usize>) -> std::io::Result<Cow<'_, [u8]>> {
        Ok(Cow::Borrowed(&self[range]))
    }

    fn held(&self, range: Range<usize>) -> Option<&[u8]> {
        self.get(range)
    }
}

pub(crate) struct Unpacker<'a> {
    storage: &'a Storage,
    /// None where blocks are as their rows.
    decompressor: Option<Decompressor>,
}

enum Decompressor {
    Deflate(Decompress),
    Lzw(weezl::decode::Decoder),
    PackBits,
    Zstd(Box<FrameDecoder>),
    Lzma,
    Jpeg,
    /// What unpacks to a LERC block; none where blocks are such.
    Lerc(Option<LercWrapping>),
}

/// What LERC blocks are packed by again.
enum LercWrapping {
    Deflate(Decompress),
    Zstd(Box<FrameDecoder>),
}

impl<'a> Unpacker<'a> {
    pub fn new(storage: &'a Storage) -> Self {
        let decompressor = match storage.packing {
            Packing::Plain => return Self { storage, decompressor: None },
            Packing::Deflate => Decompressor::Deflate(Decompress::new(true)),
            Packing::Lzw => Decompressor::Lzw(LzwDecoder::with_tiff_size_switch(BitOrder::Msb, 8)),
            Packing::PackBits => Decompressor::PackBits,
            Packing::Zstd => Decompressor::Zstd(Box::default()),
            Packing::Lzma => Decompressor::Lzma,
            Packing::Jpeg => Decompressor::Jpeg,
            Packing::Lerc(LercPacking::Plain) => Decompressor::Lerc(None),
            Packing::Lerc(LercPacking::Deflate) => {
                Decompressor::Lerc(Some(LercWrapping::Deflate(Decompress::new(true))))
            }
            Packing::Lerc(LercPacking::Zstd) => Decompressor::Lerc(Some(LercWrapping::Zstd(Box::default()))),
        };
        Self { storage, decompressor: Some(decompressor) }
    }

    /// The rows of a block that lie in the image, where they are in memory as they are stored.
    pub fn stored<'f>(&self, file: &'f impl BlockBytes, block: TiffBlock) -> Option<&'f [u8]> {
        if self.decompressor.is_some() {
            return None;
        }
        let needed = self.storage.row_bytes() * block.window.height as usize;
        let Range { start, end } = packed_range(self.storage, block, file.length()).ok()?;
        file.held(start..end.min(start.saturating_add(needed))).filter(|rows| rows.len() == needed)
    }

    /// Unpacks the rows of a block that lie in the image into `rows`, which is resized.
    ///
    /// # Errors
    /// The tables do not list the block, it cannot be read, or its stream is broken or ends before its last row.
    pub fn unpack(
        &mut self,
        file: &mut impl BlockBytes,
        block: TiffBlock,
        rows: &mut Vec<u8>,
    ) -> Result<(), DemErrorKind> {
        let needed = self.storage.row_bytes() * block.window.height as usize;
        let Some(decompressor) = &mut self.decompressor else {
            let Range { start, end } = packed_range(self.storage, block, file.length())?;
            let range = start..end.min(start.saturating_add(needed));
            file.read_into(range, rows).map_err(fault::unread)?;
            return whole(block, rows.len(), needed);
        };
        let packed = packed(self.storage, file, block)?;
        rows.resize(needed, 0);
        let unpacked = match decompressor {
            Decompressor::Deflate(inflater) => inflate(inflater, &packed, rows),
            Decompressor::Lzw(_) if is_ancient_lzw(&packed) => {
                return Err(fault::unsupported("LZW in the bit order of before 1991", TO_DEFLATE));
            }
            Decompressor::Lzw(decoder) => unpack_lzw(decoder, &packed, rows),
            Decompressor::PackBits => unpack_bits(&packed, rows),
            Decompressor::Zstd(decoder) => unpack_zstd(decoder, &packed, rows),
            Decompressor::Lzma => xz::unpack(&packed, rows),
            Decompressor::Lerc(wrapping) => {
                let blob = match wrapping {
                    None => packed,
                    Some(wrapping) => {
                        Cow::Owned(unwrapped(wrapping, &packed, most_packed(self.storage, block)))
                    }
                };
                lerc_block::decode(&blob, self.storage, block, rows)?;
                needed
            }
            Decompressor::Jpeg => {
                let JpegBlock { samples, row_bytes } =
                    jpeg_block::decode(&packed, self.storage, block, BLACK_IS_ZERO)?;
                let kept = self.storage.row_bytes().min(row_bytes);
                let from = samples.chunks_exact(row_bytes.max(1));
                for (from, to) in from.zip(rows.chunks_exact_mut(self.storage.row_bytes().max(1))) {
                    to[..kept].copy_from_slice(&from[..kept]);
                }
                needed
            }
        };
        whole(block, unpacked, needed)
    }
}

/// The packed bytes of a block.
///
/// # Errors
/// The tables do not list the block, or it cannot be read.
pub(crate) fn packed<'f, F: BlockBytes>(
    storage: &Storage,
    file: &'f mut F,
    block: TiffBlock,
) -> Result<Cow<'f, [u8]>, DemErrorKind> {
    let range = packed_range(storage, block, file.length())?;
    file.bytes(range).map_err(fault::unread)
}

fn whole(block: TiffBlock, unpacked: usize, needed: usize) -> Result<(), DemErrorKind> {
    if unpacked == needed {
        return Ok(());
    }
    let index = block.index;
    Err(fault::broken(format!("block {index} holds {unpacked} of the {needed} bytes of its rows")))
}

/// The most bytes that a block is packed to: those of all rows that it was packed with.
fn most_packed(storage: &Storage, block: TiffBlock) -> usize {
    let unpacked = storage.row_bytes() * storage.stored_rows(block) as usize;
    unpacked.saturating_mul(MOST_GROWTH).saturating_add(SLACK)
}

/// The LERC block that is packed again, of at most `most` bytes.
fn unwrapped(wrapping: &mut LercWrapping, packed: &[u8], most: usize) -> Vec<u8> {
    let mut blob = vec![0; most];
    let length = match wrapping {
        LercWrapping::Deflate(inflater) => inflate(inflater, packed, &mut blob),
        LercWrapping::Zstd(decoder) => unpack_zstd(decoder, packed, &mut blob),
    };
    blob.truncate(length);
    blob
}

/// Where the packed bytes of a block lie in a file; empty beyond its end.
///
/// # Errors
/// The tables do not list the block.
pub(crate) fn packed_range(
    storage: &Storage,
    block: TiffBlock,
    file_bytes: usize,
) -> Result<Range<usize>, DemErrorKind> {
    let unlisted = || fault::broken(format!("its tables do not state where block {} lies", block.index));
    let (start, bytes) = storage.place(block.index).ok_or_else(unlisted)?;
    let most = most_packed(storage, block);
    let start = usize::try_from(start).unwrap_or(usize::MAX).min(file_bytes);
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX).min(most);
    Ok(start..start.saturating_add(bytes).min(file_bytes))
}

// Each of these fills `out` from the start of a stream, ignores the rest, and returns the number of bytes.

fn copy(packed: &[u8], out: &mut [u8]) -> usize {
    let length = packed.len().min(out.len());
    out[..length].copy_from_slice(&packed[..length]);
    length
}

fn inflate(inflater: &mut Decompress, packed: &[u8], out: &mut [u8]) -> usize {
    inflater.reset(true);
    loop {
        let before = (inflater.total_in() as usize, inflater.total_out() as usize);
        let status = inflater.decompress(&packed[before.0..], &mut out[before.1..], FlushDecompress::Finish);
        let after = (inflater.total_in() as usize, inflater.total_out() as usize);
        if after.1 == out.len() || after == before || !matches!(status, Ok(Status::Ok | Status::BufError)) {
            return after.1;
        }
    }
}

/// Whether a stream is in the bit order that libtiff wrote before 1991.
fn is_ancient_lzw(packed: &[u8]) -> bool {
    matches!(packed, [0, second, ..] if second & 1 == 1)
}

fn unpack_lzw(decoder: &mut LzwDecoder, packed: &[u8], out: &mut [u8]) -> usize {
    decoder.reset();
    let (mut read, mut written) = (0, 0);
    loop {
        let step = decoder.decode_bytes(&packed[read..], &mut out[written..]);
        read += step.consumed_in;
        written += step.consumed_out;
        let is_stuck = step.consumed_in + step.consumed_out == 0;
        if written == out.len() || is_stuck || !matches!(step.status, Ok(LzwStatus::Ok)) {
            return written;
        }
    }
}

fn unpack_bits(packed: &[u8], out: &mut [u8]) -> usize {
    let (mut rest, mut written) = (packed, 0);
    while let ([count, tail @ ..], true) = (rest, written < out.len()) {
        let left = out.len() - written;
        let length = match *count as i8 {
            -128 => {
                rest = tail;
                continue;
            }
            literal @ 0.. => {
                let length = (literal as usize + 1).min(tail.len());
                written += copy(&tail[..length], &mut out[written..]);
                length
            }
            repeated => {
                let Some(byte) = tail.first() else { break };
                let length = (1 - isize::from(repeated)) as usize;
                out[written..][..length.min(left)].fill(*byte);
                written += length.min(left);
                1
            }
        };
        rest = &tail[length..];
    }
    written
}

fn unpack_zstd(decoder: &mut FrameDecoder, packed: &[u8], out: &mut [u8]) -> usize {
    let Ok(mut stream) = StreamingDecoder::new_with_decoder(packed, decoder) else { return 0 };
    let mut written = 0;
    while written < out.len() {
        match stream.read(&mut out[written..]) {
            Ok(count @ 1..) => written += count,
            _ => break,
        }
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn packed_by_lzw(plain: &[u8]) -> Vec<u8> {
        let mut encoder = weezl::encode::Encoder::with_tiff_size_switch(BitOrder::Msb, 8);
        encoder.encode(plain).expect("bytes are codes")
    }

    fn unpacked_by_lzw(packed: &[u8], length: usize) -> Vec<u8> {
        let mut out = vec![0xaa; length];
        let mut decoder = LzwDecoder::with_tiff_size_switch(BitOrder::Msb, 8);
        let written = unpack_lzw(&mut decoder, packed, &mut out);
        out.truncate(written);
        out
    }

    #[test]
    fn the_lzw_example_of_the_specification_comes_out() {
        // TIFF 6.0, section 13: 7 7 7 8 8 7 7 6 6 as codes of 9 bits, 256 7 258 8 8 258 6 6 257.
        let codes = [256u32, 7, 258, 8, 8, 258, 6, 6, 257];
        let bits: Vec<u32> =
            codes.iter().flat_map(|code| (0..9).rev().map(move |bit| code >> bit & 1)).collect();
        let bytes: Vec<u8> = bits
            .chunks(8)
            .map(|byte| byte.iter().enumerate().map(|(at, bit)| (*bit as u8) << (7 - at)).sum())
            .collect();
        assert_eq!(unpacked_by_lzw(&bytes, 9), [7, 7, 7, 8, 8, 7, 7, 6, 6]);
    }

    #[test]
    fn flat_ground_comes_out_of_a_few_bytes_of_lzw() {
        let plain = vec![0u8; 100_000];
        let stream = packed_by_lzw(&plain);
        assert!(stream.len() < 700, "{}", stream.len());
        assert_eq!(unpacked_by_lzw(&stream, plain.len()), plain);
    }

    #[test]
    fn an_lzw_stream_that_breaks_off_gives_what_it_held() {
        let plain: Vec<u8> = (0..5000u32).map(|at| (at * at % 251) as u8).collect();
        let stream = packed_by_lzw(&plain);
        for end in 0..stream.len() - 2 {
            let found = unpacked_by_lzw(&stream[..end], plain.len());
            assert!(found.len() < plain.len() && plain.starts_with(&found), "{end}");
        }
    }

    #[test]
    fn the_packbits_example_of_the_specification_comes_out() {
        // Apple, Technical Note TN1023.
        let packed =
            [0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x80, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7, 0xaa];
        let plain = [
            0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22, 0xaa, 0xaa,
            0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa,
        ];
        for length in 0..plain.len() {
            let mut out = vec![0; length];
            assert_eq!(unpack_bits(&packed, &mut out), length);
            assert_eq!(out, plain[..length]);
        }
        let mut out = [0; 24];
        for end in 0..packed.len() {
            let written = unpack_bits(&packed[..end], &mut out);
            assert!(plain.starts_with(&out[..written]) && written < plain.len(), "{end}");
        }
    }

    proptest! {
        #[test]
        fn what_was_packed_by_lzw_comes_out(
            parts in proptest::collection::vec((any::<u8>(), 1usize..400, 0u8..5), 0..80),
        ) {
            let plain: Vec<u8> = parts
                .into_iter()
                .flat_map(|(byte, count, step)| (0..count).map(move |at| byte.wrapping_add(step.wrapping_mul(at as u8))))
                .collect();
            prop_assert_eq!(unpacked_by_lzw(&packed_by_lzw(&plain), plain.len()), plain);
        }

        #[test]
        fn any_bytes_end_within_the_buffer(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            let mut out = [0; 1000];
            prop_assert!(unpacked_by_lzw(&bytes, 1000).len() <= 1000);
            prop_assert!(unpack_bits(&bytes, &mut out) <= 1000);
            prop_assert!(unpack_zstd(&mut FrameDecoder::new(), &bytes, &mut out) <= 1000);
            prop_assert!(inflate(&mut Decompress::new(true), &bytes, &mut out) <= 1000);
        }
    }
}

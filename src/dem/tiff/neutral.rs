//! Makes a TIFF's values come out as they are stored.
//!
//! The photometric tag says how values become colors, and the decoder acts on it: it inverts "white is zero"
//! and refuses palettes and masks. For elevations the stored numbers are what counts, so the tag is rewritten
//! to "black is zero" in a copy of the file before it is decoded; most files carry that already and are not
//! copied.

use std::borrow::Cow;
use std::io::{Read, Seek, SeekFrom};

use crate::dem::error::bytes_at;

const PHOTOMETRIC: u16 = 262;
const SHORT: u16 = 3;
const BLACK_IS_ZERO: u16 = 1;

/// White is zero, RGB, palette, mask, CMYK: values that are stored one by one. The others (YCbCr, Lab) mix
/// their channels and stay as they are.
const REWRITTEN: [u16; 5] = [0, 2, 3, 4, 5];

/// More images than this are not looked at.
const MOST_IMAGES: usize = 64;

/// Directories with more tags than this are not looked at: a classic TIFF cannot count further.
const MOST_TAGS: usize = 65_535;

/// The bytes of a file, in memory or not.
trait Bytes {
    /// How many there are.
    fn length(&self) -> usize;
    /// The first `N` bytes from `at`; `None` beyond the end.
    fn at<const N: usize>(&mut self, at: usize) -> Option<[u8; N]>;
}

impl Bytes for &[u8] {
    fn length(&self) -> usize {
        self.len()
    }

    fn at<const N: usize>(&mut self, at: usize) -> Option<[u8; N]> {
        bytes_at(self, at)
    }
}

/// A file that is not in memory, with its length.
struct TiffInput<'a, R>(&'a mut R, usize);

impl<R: Read + Seek> Bytes for TiffInput<'_, R> {
    fn length(&self) -> usize {
        self.1
    }

    fn at<const N: usize>(&mut self, at: usize) -> Option<[u8; N]> {
        let mut bytes = [0; N];
        self.0.seek(SeekFrom::Start(at as u64)).ok()?;
        self.0.read_exact(&mut bytes).ok().map(|()| bytes)
    }
}

/// Where the photometric tags of a file of `length` bytes are to be rewritten, and to what.
pub(crate) fn rewritten<R: Read + Seek>(file: &mut R, length: usize) -> Vec<(usize, [u8; 2])> {
    let mut bytes = TiffInput(file, length);
    let layout = TiffLayout::of(&mut bytes);
    layout.map(|layout| layout.photometric_tags(&mut bytes)).unwrap_or_default()
}

/// The file with the photometric tag of every image rewritten.
pub(crate) fn neutralised(bytes: &[u8]) -> Cow<'_, [u8]> {
    let mut whole = bytes;
    let layout = TiffLayout::of(&mut whole);
    let places = layout.map(|layout| layout.photometric_tags(&mut whole)).unwrap_or_default();
    if places.is_empty() {
        return Cow::Borrowed(bytes);
    }
    let mut copy = bytes.to_vec();
    for (at, value) in places {
        copy[at..at + 2].copy_from_slice(&value);
    }
    Cow::Owned(copy)
}

/// Byte order and field widths.
#[derive(Clone, Copy)]
struct TiffLayout {
    little: bool,
    big_tiff: bool,
}

impl TiffLayout {
    fn of(bytes: &mut impl Bytes) -> Option<Self> {
        match &bytes.at::<4>(0)? {
            b"II*\0" => Some(Self { little: true, big_tiff: false }),
            b"MM\0*" => Some(Self { little: false, big_tiff: false }),
            b"II+\0" => Some(Self { little: true, big_tiff: true }),
            b"MM\0+" => Some(Self { little: false, big_tiff: true }),
            _ => None,
        }
    }

    fn short(self, bytes: &mut impl Bytes, at: usize) -> Option<u16> {
        bytes.at(at).map(if self.little { u16::from_le_bytes } else { u16::from_be_bytes })
    }

    /// An offset or a count of the file's own width.
    fn word(self, bytes: &mut impl Bytes, at: usize) -> Option<usize> {
        let wide = if self.big_tiff {
            bytes.at(at).map(if self.little { u64::from_le_bytes } else { u64::from_be_bytes })?
        } else {
            bytes.at(at).map(if self.little { u32::from_le_bytes } else { u32::from_be_bytes })?.into()
        };
        usize::try_from(wide).ok()
    }

    /// Where the tags that are to be rewritten stand, with their new bytes.
    fn photometric_tags(self, bytes: &mut impl Bytes) -> Vec<(usize, [u8; 2])> {
        let mut found = Vec::new();
        let mut next = self.word(bytes, if self.big_tiff { 8 } else { 4 });
        for _ in 0..MOST_IMAGES {
            let Some(directory) = next.filter(|&at| at > 0 && at < bytes.length()) else { break };
            next = self.scan(bytes, directory, &mut found);
        }
        found
    }

    /// Looks through one directory and returns the offset of the next.
    fn scan(
        self,
        bytes: &mut impl Bytes,
        directory: usize,
        found: &mut Vec<(usize, [u8; 2])>,
    ) -> Option<usize> {
        let (count, first, entry, value) = if self.big_tiff {
            (self.word(bytes, directory)?, directory.checked_add(8)?, 20, 12)
        } else {
            (usize::from(self.short(bytes, directory)?), directory.checked_add(2)?, 12, 8)
        };
        let end = first.checked_add(count.checked_mul(entry)?)?;
        if end > bytes.length() || count > MOST_TAGS {
            return None;
        }
        for at in (first..end).step_by(entry) {
            if self.short(bytes, at)? == PHOTOMETRIC && self.short(bytes, at + 2)? == SHORT {
                let old = self.short(bytes, at + value)?;
                let new = if self.little { BLACK_IS_ZERO.to_le_bytes() } else { BLACK_IS_ZERO.to_be_bytes() };
                if REWRITTEN.contains(&old) {
                    found.push((at + value, new));
                }
            }
        }
        self.word(bytes, end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_white_zero_becomes_one_of_black_zero() {
        let file = [b'I', b'I', 42, 0, 8, 0, 0, 0, 1, 0, 6, 1, 3, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let neutral = neutralised(&file);
        assert_eq!(neutral[18], 1);
        assert!(matches!(neutralised(&neutral), Cow::Borrowed(_)));
        for end in 0..file.len() {
            neutralised(&file[..end]);
        }
    }

    #[test]
    fn directories_in_a_circle_end() {
        let file = [b'M', b'M', 0, 42, 0, 0, 0, 8, 0, 0, 0, 0, 0, 8];
        assert!(matches!(neutralised(&file), Cow::Borrowed(_)));
    }
}

//! Files that arrive compressed: gzip (`.bt.gz`, `.btz`, `.hgt.gz`) and the zip archives that SRTM tiles and
//! national grids are handed out in.

use std::io::Read;

use flate2::read::{DeflateDecoder, MultiGzDecoder};

use crate::dem::bytes::bytes_at;
use crate::dem::error::DemErrorKind;

/// The most bytes that are unpacked: a file of the largest raster.
const MOST_BYTES: u64 = 1 << 30;

/// Deflate turns one byte into at most this many.
const DEFLATE_EXPANSION: u64 = 1032;

/// Whether the content is gzip.
pub(crate) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b, 8])
}

/// Whether the content is a zip archive.
pub(crate) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// The content of a gzip file.
pub(crate) fn gunzip(bytes: &[u8]) -> Result<Vec<u8>, DemErrorKind> {
    inflate(MultiGzDecoder::new(bytes), bytes.len(), "gzip file")
}

fn broken(format: &'static str, reason: impl Into<String>) -> DemErrorKind {
    DemErrorKind::Broken { format, reason: reason.into() }
}

fn inflate(decoder: impl Read, packed: usize, format: &'static str) -> Result<Vec<u8>, DemErrorKind> {
    let limit = MOST_BYTES.min((packed as u64).saturating_mul(DEFLATE_EXPANSION) + 1);
    let mut unpacked = Vec::new();
    let read = decoder.take(limit + 1).read_to_end(&mut unpacked);
    read.map_err(|error| broken(format, error.to_string()))?;
    if unpacked.len() as u64 > limit {
        return Err(broken(format, format!("it unpacks to more than {limit} bytes")));
    }
    Ok(unpacked)
}

/// The first member of a zip archive whose name is `wanted`, with its name.
///
/// `None` where there is no such member. Members are found by the central directory (APPNOTE 6.3, sections
/// 4.3.12 and 4.3.16); stored and deflated ones are read.
pub(crate) fn unzip_first(
    bytes: &[u8],
    wanted: impl Fn(&str) -> bool,
) -> Result<Option<(String, Vec<u8>)>, DemErrorKind> {
    const FORMAT: &str = "zip archive";
    let cut = || broken(FORMAT, "it ends before its directory does");
    let end = find_end(bytes).ok_or_else(cut)?;
    let members = u16::from_le_bytes(bytes_at(bytes, end + 10).ok_or_else(cut)?);
    let mut at = u32::from_le_bytes(bytes_at(bytes, end + 16).ok_or_else(cut)?) as usize;
    for _ in 0..members {
        let member = ZipMember::at(bytes, at).ok_or_else(cut)?;
        at = member.next;
        if wanted(&member.name) {
            let data = member.data(bytes).ok_or_else(cut)?;
            let content = match member.method {
                0 => data.to_vec(),
                8 => inflate(DeflateDecoder::new(data), data.len(), FORMAT)?,
                other => {
                    return Err(DemErrorKind::Unsupported {
                        format: FORMAT,
                        what: format!("compression method {other}"),
                        remedy: "unpack it first",
                    });
                }
            };
            return Ok(Some((member.name, content)));
        }
    }
    Ok(None)
}

/// One entry of the central directory.
struct ZipMember {
    name: String,
    method: u16,
    packed: usize,
    local: usize,
    next: usize,
}

impl ZipMember {
    fn at(bytes: &[u8], at: usize) -> Option<Self> {
        let short = |offset: usize| bytes_at(bytes, at.checked_add(offset)?).map(u16::from_le_bytes);
        let long = |offset: usize| bytes_at(bytes, at.checked_add(offset)?).map(u32::from_le_bytes);
        if long(0)? != 0x0201_4b50 {
            return None;
        }
        let name_end = at + 46 + usize::from(short(28)?);
        Some(Self {
            name: String::from_utf8_lossy(bytes.get(at + 46..name_end)?).into_owned(),
            method: short(10)?,
            packed: long(20)? as usize,
            local: long(42)? as usize,
            next: name_end + usize::from(short(30)?) + usize::from(short(32)?),
        })
    }

    /// The packed bytes, behind the local header.
    fn data<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let name = u16::from_le_bytes(bytes_at(bytes, self.local + 26)?);
        let extra = u16::from_le_bytes(bytes_at(bytes, self.local + 28)?);
        let start = self.local + 30 + usize::from(name) + usize::from(extra);
        bytes.get(start..start.checked_add(self.packed)?)
    }
}

/// Where the end-of-directory record starts; it lies in the last 64 KiB.
fn find_end(bytes: &[u8]) -> Option<usize> {
    let last = bytes.len().checked_sub(22)?;
    (last.saturating_sub(65_535)..=last).rev().find(|&at| bytes[at..].starts_with(b"PK\x05\x06"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn what_was_packed_comes_back() {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(b"binterr").expect("memory");
        let packed = encoder.finish().expect("memory");
        assert!(is_gzip(&packed));
        assert_eq!(gunzip(&packed).expect("intact"), b"binterr");
        assert!(gunzip(&packed[..packed.len() - 9]).is_err());
    }

    #[test]
    fn an_archive_cut_anywhere_is_an_error_or_empty() {
        let zip = b"PK\x03\x04 nothing PK\x05\x06\0\0\0\0\x01\0\x01\0\0\0\0\0\0\0\0\0\0\0";
        for end in 0..=zip.len() {
            assert!(!matches!(unzip_first(&zip[..end], |_| true), Ok(Some(_))));
        }
    }
}

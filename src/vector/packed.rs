//! Vector files that arrive packed: gzip (`.osm.gz`, `.geojson.gz`) and zip archives (`.kmz`, zipped shapefiles).
//!
//! Unpacking is bounded, by what deflate can do and by [`MOST_BYTES`]: a small file cannot fill the memory.

use std::io::Read;

use flate2::read::{DeflateDecoder, MultiGzDecoder, ZlibDecoder};

use crate::vector::cursor::ByteCursor;
use crate::vector::error::VectorError;

/// The most bytes that one member is unpacked to. A city's OpenStreetMap as XML is a tenth of it.
pub(crate) const MOST_BYTES: usize = 512 << 20;

/// Deflate turns one byte into at most this many.
const DEFLATE_EXPANSION: usize = 1032;

/// The most members of an archive that are looked at.
const MOST_MEMBERS: u16 = 10_000;

const ZIP: &str = "zip archive";

/// Whether the content is gzip.
pub(crate) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b, 8])
}

/// Whether the content is a zip archive.
pub(crate) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// The content of a gzip file.
///
/// # Errors
/// It is broken, or unpacks to more than is taken.
pub(crate) fn gunzip(bytes: &[u8]) -> Result<Vec<u8>, VectorError> {
    unpack(MultiGzDecoder::new(bytes), bytes.len(), MOST_BYTES, "gzip file")
}

/// What zlib packed, which is to be no more than `limit` bytes.
///
/// # Errors
/// It is broken, or unpacks to more.
pub(crate) fn inflate_zlib(bytes: &[u8], limit: usize, format: &'static str) -> Result<Vec<u8>, VectorError> {
    unpack(ZlibDecoder::new(bytes), bytes.len(), limit, format)
}

fn unpack(
    decoder: impl Read,
    packed: usize,
    most: usize,
    format: &'static str,
) -> Result<Vec<u8>, VectorError> {
    let limit = most.min(packed.saturating_mul(DEFLATE_EXPANSION).saturating_add(1));
    let mut unpacked = Vec::new();
    let read = decoder.take(limit as u64 + 1).read_to_end(&mut unpacked);
    read.map_err(|error| VectorError::broken(format, "its packed data", error.to_string()))?;
    if unpacked.len() > limit {
        let reason = format!("it unpacks to more than {limit} bytes");
        return Err(VectorError::broken(format, "its packed data", reason));
    }
    Ok(unpacked)
}

/// A zip archive's directory (PKWARE APPNOTE 6.3, sections 4.3.12 and 4.3.16).
pub(crate) struct Zip<'a> {
    bytes: &'a [u8],
    members: Vec<PackedMember>,
}

struct PackedMember {
    name: String,
    method: u16,
    packed: usize,
    local: usize,
}

impl<'a> Zip<'a> {
    /// The archive that `bytes` are.
    ///
    /// # Errors
    /// Its directory is not there or broken.
    pub fn open(bytes: &'a [u8]) -> Result<Self, VectorError> {
        let cut = || VectorError::broken(ZIP, "its directory", "the archive ends before it does");
        let end = find_end(bytes).ok_or_else(cut)?;
        let mut record = ByteCursor::new(bytes.get(end + 10..).unwrap_or_default());
        let count = record.array().map(u16::from_le_bytes).ok_or_else(cut)?;
        record.take(4).ok_or_else(cut)?;
        let at = record.u32_le().ok_or_else(cut)? as usize;
        let mut directory = ByteCursor::new(bytes.get(at..).unwrap_or_default());
        let members = (0..count.min(MOST_MEMBERS)).map(|_| PackedMember::read(&mut directory));
        Ok(Self { bytes, members: members.collect::<Option<_>>().ok_or_else(cut)? })
    }

    /// The names of its members, in its order; those that a Macintosh adds are left out.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.members.iter().map(|member| member.name.as_str()).filter(|name| !name.starts_with("__MACOSX"))
    }

    /// The content of the member with this name, in any case; `None` where there is none.
    ///
    /// # Errors
    /// It is broken, unpacks to more than is taken, or is packed in a way that is not read.
    pub fn member(&self, name: &str) -> Result<Option<Vec<u8>>, VectorError> {
        let is_wanted = |member: &&PackedMember| member.name.eq_ignore_ascii_case(name);
        self.members.iter().find(is_wanted).map(|member| member.content(self.bytes)).transpose()
    }
}

impl PackedMember {
    fn read(directory: &mut ByteCursor<'_>) -> Option<Self> {
        let fixed: [u8; 46] = directory.array()?;
        let short = |at: usize| u16::from_le_bytes([fixed[at], fixed[at + 1]]);
        let long = |at: usize| u32::from(short(at)) | u32::from(short(at + 2)) << 16;
        if long(0) != 0x0201_4b50 {
            return None;
        }
        let name = String::from_utf8_lossy(directory.take(short(28).into())?).into_owned();
        directory.take(usize::from(short(30)) + usize::from(short(32)))?;
        Some(Self { name, method: short(10), packed: long(20) as usize, local: long(42) as usize })
    }

    fn content(&self, bytes: &[u8]) -> Result<Vec<u8>, VectorError> {
        let cut =
            || VectorError::broken(ZIP, format!("its member {}", self.name), "the archive ends within it");
        let data = self.data(bytes).ok_or_else(cut)?;
        match self.method {
            0 => Ok(data.to_vec()),
            8 => unpack(DeflateDecoder::new(data), data.len(), MOST_BYTES, ZIP),
            other => Err(VectorError::Unsupported {
                format: ZIP,
                what: format!("a member packed by method {other}"),
                remedy: "unpack it first".into(),
            }),
        }
    }

    /// The packed bytes, behind the local header.
    fn data<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let mut at = ByteCursor::new(bytes.get(self.local..)?);
        at.take(26)?;
        let name = u16::from_le_bytes(at.array()?);
        let extra = u16::from_le_bytes(at.array()?);
        at.take(usize::from(name) + usize::from(extra))?;
        at.take(self.packed)
    }
}

/// Where the end-of-directory record starts; it lies in the last 64 KiB.
fn find_end(bytes: &[u8]) -> Option<usize> {
    let last = bytes.len().checked_sub(22)?;
    (last.saturating_sub(65_535)..=last).rev().find(|&at| bytes[at..].starts_with(b"PK\x05\x06"))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::io::Write;

    /// A zip archive of stored members.
    pub(crate) fn stored(members: &[(&str, &[u8])]) -> Vec<u8> {
        let (mut out, mut directory) = (Vec::new(), Vec::new());
        for (name, content) in members {
            let at = out.len() as u32;
            let length = (content.len() as u32).to_le_bytes();
            let name_length = (name.len() as u16).to_le_bytes();
            out.extend(b"PK\x03\x04\x14\0\0\0\0\0\0\0\0\0\0\0\0\0");
            out.extend([length, length].concat());
            out.extend([name_length, [0; 2]].concat());
            out.extend([name.as_bytes(), content].concat());
            directory.extend(b"PK\x01\x02\x14\0\x14\0\0\0\0\0\0\0\0\0\0\0\0\0");
            directory.extend([length, length].concat());
            directory.extend(name_length);
            directory.extend([0; 12]);
            directory.extend(at.to_le_bytes());
            directory.extend(name.as_bytes());
        }
        let (at, length) = (out.len() as u32, directory.len() as u32);
        out.extend(directory);
        out.extend(b"PK\x05\x06\0\0\0\0");
        out.extend([(members.len() as u16).to_le_bytes(); 2].concat());
        out.extend([length.to_le_bytes(), at.to_le_bytes()].concat());
        out.extend([0; 2]);
        out
    }

    #[test]
    fn what_was_packed_comes_back_whole_or_not_at_all() {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(b"<osm>").expect("memory");
        let packed = encoder.finish().expect("memory");
        assert!(is_gzip(&packed));
        assert_eq!(gunzip(&packed).expect("intact"), b"<osm>");
        assert!(gunzip(&packed[..packed.len() - 9]).is_err());
    }

    #[test]
    fn an_archive_is_read_by_its_directory_and_cut_anywhere_is_an_error() {
        let archive = stored(&[("a.txt", b"one"), ("folder/B.KML", b"two")]);
        let zip = Zip::open(&archive).expect("intact");
        assert_eq!(zip.names().collect::<Vec<_>>(), ["a.txt", "folder/B.KML"]);
        assert_eq!(zip.member("folder/b.kml").expect("intact").as_deref(), Some(&b"two"[..]));
        assert_eq!(zip.member("c").expect("no such member"), None);
        for end in 0..archive.len() {
            assert!(Zip::open(&archive[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn unpacking_stops_at_the_limit() {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(&vec![0; 1 << 20]).expect("memory");
        let packed = encoder.finish().expect("memory");
        assert!(inflate_zlib(&packed, 1 << 20, "blob").is_ok());
        let error = inflate_zlib(&packed, (1 << 20) - 1, "blob").expect_err("too much").to_string();
        assert!(error.contains("more than 1048575 bytes"), "{error}");
    }
}

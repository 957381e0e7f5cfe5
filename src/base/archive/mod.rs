//! Zip archives, gzip files and zlib streams, unpacked in memory within limits; zip archives made of members.
//!
//! The `zip` and `flate2` crates decode. This module bounds their work: the members of an archive are counted
//! before its directory is read, and no content grows past the caller's limit or past what deflate can make of the
//! packed bytes. All limits stand here.

use std::io::{self, Cursor, Read, Write};

use flate2::read::{MultiGzDecoder, ZlibDecoder};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{DateTime, ZipArchive, ZipWriter};

/// Most members of an archive: as many as fit without the zip64 extension.
const MAX_MEMBERS: usize = 65_535;
/// The greatest expansion by deflate.
const DEFLATE_EXPANSION: u64 = 1032;
/// Bytes of a directory entry without name and extra fields (APPNOTE 6.3, section 4.3.12), and its signature.
const ENTRY_BYTES: usize = 46;
const ENTRY_SIGNATURE: [u8; 4] = *b"PK\x01\x02";

/// A member in messages.
const MEMBER: &str = "zip archive's member";

/// Why packed content cannot be read.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ArchiveError {
    #[error("the zip archive cannot be read: {0}; unpack it first, or fetch it again")]
    Zip(#[from] ZipError),
    #[error("the {format} is broken: {source}; fetch or pack it again")]
    Corrupt { format: &'static str, source: io::Error },
    #[error("the {format} unpacks to more than {limit} bytes; unpack it and cut the content down")]
    TooLarge {
        format: &'static str,
        /// Most bytes that are unpacked.
        limit: u64,
    },
    #[error("the zip archive has more than {MAX_MEMBERS} members; pack fewer files")]
    TooManyMembers,
}

/// A zip archive of `members`, names with contents, deflated; the same bytes at any time.
///
/// # Errors
/// A name or a content is longer than the format holds.
pub fn zip(members: &[(&str, &[u8])]) -> io::Result<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().last_modified_time(DateTime::default());
    for (name, content) in members {
        archive.start_file(*name, options.large_file(content.len() as u64 >= u64::from(u32::MAX)))?;
        archive.write_all(content)?;
    }
    Ok(archive.finish()?.into_inner())
}

/// Whether `bytes` start as a gzip file.
pub fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b, 8])
}

/// Whether `bytes` start as a zip archive.
pub fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

/// Unpacks a gzip file.
///
/// # Errors
/// [`ArchiveError`] where it is broken or unpacks to more than `limit` bytes.
pub fn gunzip(bytes: &[u8], limit: u64) -> Result<Vec<u8>, ArchiveError> {
    read_within("gzip file", MultiGzDecoder::new(bytes), bytes.len() as u64, limit)
}

/// The first `most` bytes of an unpacked gzip file, or fewer where it has fewer.
///
/// # Errors
/// [`ArchiveError`] where it is broken up to there.
pub fn gunzip_head(bytes: &[u8], most: u64) -> Result<Vec<u8>, ArchiveError> {
    read_head("gzip file", MultiGzDecoder::new(bytes), most)
}

/// Unpacks a zlib stream.
///
/// # Errors
/// [`ArchiveError`] where it is broken or unpacks to more than `limit` bytes.
pub fn inflate_zlib(bytes: &[u8], limit: u64) -> Result<Vec<u8>, ArchiveError> {
    read_within("zlib data", ZlibDecoder::new(bytes), bytes.len() as u64, limit)
}

fn read_within(
    format: &'static str,
    decoder: impl Read,
    packed_bytes: u64,
    limit: u64,
) -> Result<Vec<u8>, ArchiveError> {
    let limit = limit.min(packed_bytes.saturating_mul(DEFLATE_EXPANSION).saturating_add(1));
    let mut content = Vec::new();
    let read = decoder.take(limit + 1).read_to_end(&mut content);
    read.map_err(|source| ArchiveError::Corrupt { format, source })?;
    if content.len() as u64 > limit { Err(ArchiveError::TooLarge { format, limit }) } else { Ok(content) }
}

fn read_head(format: &'static str, decoder: impl Read, most: u64) -> Result<Vec<u8>, ArchiveError> {
    let mut head = Vec::new();
    let read = decoder.take(most).read_to_end(&mut head);
    read.map(|_| head).map_err(|source| ArchiveError::Corrupt { format, source })
}

/// A zip archive in memory.
pub struct ZipReader<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    names: Vec<String>,
}

impl<'a> ZipReader<'a> {
    /// Reads the directory of the archive `bytes`.
    ///
    /// # Errors
    /// [`ArchiveError`] where the directory is broken or has more than 65,535 entries.
    pub fn open(bytes: &'a [u8]) -> Result<Self, ArchiveError> {
        if has_too_many_members(bytes) {
            return Err(ArchiveError::TooManyMembers);
        }
        let archive = ZipArchive::new(Cursor::new(bytes))?;
        // Lossy: most writers store UTF-8 without setting its flag.
        let names = archive.file_names_raw().map(|name| String::from_utf8_lossy(name).into_owned()).collect();
        Ok(Self { archive, names })
    }

    /// Returns the members' names in the order of the directory, without the resource forks that macOS adds.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str).filter(|name| !name.starts_with("__MACOSX/"))
    }

    /// Unpacks the member `name`, in any case, to at most `limit` bytes.
    ///
    /// # Errors
    /// [`ArchiveError`] where there is no such member, or where it is broken, encrypted, too large or not deflated.
    pub fn read(&self, name: &str, limit: u64) -> Result<Vec<u8>, ArchiveError> {
        let mut archive = self.archive.clone();
        let member = archive.by_index(self.index(name)?)?;
        if member.size() > limit {
            return Err(ArchiveError::TooLarge { format: MEMBER, limit });
        }
        let packed_bytes = member.compressed_size();
        read_within(MEMBER, member, packed_bytes, limit)
    }

    /// The first `most` bytes of the member `name`, in any case, or fewer where it has fewer.
    ///
    /// # Errors
    /// As [`ZipReader::read`], up to there.
    pub fn read_head(&self, name: &str, most: u64) -> Result<Vec<u8>, ArchiveError> {
        let mut archive = self.archive.clone();
        read_head(MEMBER, archive.by_index(self.index(name)?)?, most)
    }

    fn index(&self, name: &str) -> Result<usize, ArchiveError> {
        let is_wanted = |member: &String| member.eq_ignore_ascii_case(name);
        Ok(self.names.iter().position(is_wanted).ok_or(ZipError::FileNotFound)?)
    }
}

/// Whether more directory entries may lie in `bytes` than are read. The `zip` crate would allocate for all of them.
fn has_too_many_members(bytes: &[u8]) -> bool {
    bytes.len() / ENTRY_BYTES > MAX_MEMBERS
        && bytes.windows(4).filter(|window| *window == ENTRY_SIGNATURE).count() > MAX_MEMBERS
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    use flate2::Compression;
    use flate2::write::{GzEncoder, ZlibEncoder};

    /// A zip archive of deflated members.
    pub(crate) fn zipped(members: &[(&str, &[u8])]) -> Vec<u8> {
        zip(members).expect("memory")
    }

    fn deflated(content: &[u8]) -> Vec<u8> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(content).expect("memory");
        encoder.finish().expect("memory")
    }

    #[test]
    fn a_gzip_file_comes_back_in_full_or_is_refused() {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(b"binterr").expect("memory");
        let packed = encoder.finish().expect("memory");
        assert!(is_gzip(&packed));
        assert_eq!(gunzip(&packed, 1 << 30).expect("intact"), b"binterr");
        assert!(gunzip(&packed[..packed.len() - 9], 1 << 30).is_err());
    }

    #[test]
    fn the_head_is_unpacked_without_the_rest() {
        let archive = zipped(&[("a", &vec![7; 1 << 20])]);
        let zip = ZipReader::open(&archive).expect("intact");
        assert_eq!(zip.read_head("a", 5).expect("intact"), [7; 5]);
        assert_eq!(zip.read_head("a", u64::MAX).expect("intact").len(), 1 << 20);
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(&vec![7; 1 << 20]).expect("memory");
        let packed = encoder.finish().expect("memory");
        assert_eq!(gunzip_head(&packed[..packed.len() / 2], 5).expect("intact"), [7; 5]);
        assert!(gunzip_head(&packed[..packed.len() / 2], u64::MAX).is_err());
    }

    #[test]
    fn members_are_found_by_name_in_any_case() {
        let archive = zipped(&[("a.txt", b"one"), ("__MACOSX/a.txt", b"fork"), ("folder/B.KML", b"two")]);
        assert!(is_zip(&archive));
        let zip = ZipReader::open(&archive).expect("intact");
        assert_eq!(zip.names().collect::<Vec<_>>(), ["a.txt", "folder/B.KML"]);
        assert_eq!(zip.read("folder/b.kml", 3).expect("intact"), b"two");
        assert!(matches!(zip.read("c", 3), Err(ArchiveError::Zip(ZipError::FileNotFound))));
    }

    #[test]
    fn an_archive_cut_anywhere_is_refused() {
        let archive = zipped(&[("a.txt", b"one"), ("folder/B.KML", b"two")]);
        for end in 0..archive.len() {
            assert!(ZipReader::open(&archive[..end]).is_err(), "{end}");
        }
        let hollow = b"PK\x03\x04 nothing PK\x05\x06\0\0\0\0\x01\0\x01\0\0\0\0\0\0\0\0\0\0\0";
        for end in 0..=hollow.len() {
            let zip = ZipReader::open(&hollow[..end]);
            assert!(!zip.is_ok_and(|zip| zip.names().next().is_some()), "{end}");
        }
    }

    #[test]
    fn a_member_with_a_byte_turned_is_refused() {
        let archive = zipped(&[("a.txt", &[b'x'; 900])]);
        let mut turned = archive.clone();
        turned[40] ^= 0xff;
        let zip = ZipReader::open(&turned).expect("the directory is intact");
        assert!(zip.read("a.txt", 1000).is_err());
    }

    #[test]
    fn unpacking_stops_at_the_limit() {
        let packed = deflated(&vec![0; 1 << 20]);
        assert!(inflate_zlib(&packed, 1 << 20).is_ok());
        let error = inflate_zlib(&packed, (1 << 20) - 1).expect_err("too much").to_string();
        assert!(error.contains("more than 1048575 bytes"), "{error}");
        let archive = zipped(&[("a", &vec![0; 1 << 20])]);
        let zip = ZipReader::open(&archive).expect("intact");
        assert!(zip.read("a", 1000).expect_err("too much").to_string().contains("more than 1000 bytes"));
    }

    #[test]
    fn a_forged_size_does_not_lift_the_limit() {
        let mut archive = zipped(&[("a", &vec![0; 1 << 20])]);
        let stated = (1u32 << 20).to_le_bytes();
        for at in 0..archive.len() - 4 {
            if archive[at..at + 4] == stated {
                archive[at..at + 4].copy_from_slice(&7u32.to_le_bytes());
            }
        }
        let zip = ZipReader::open(&archive).expect("intact");
        assert!(zip.read("a", 1000).is_err());
    }

    #[test]
    fn a_directory_of_too_many_entries_is_refused_unread() {
        let entries = [&ENTRY_SIGNATURE[..], &[0; ENTRY_BYTES - 4]].concat().repeat(MAX_MEMBERS + 1);
        let error = ZipReader::open(&entries).err().expect("too many");
        assert!(matches!(error, ArchiveError::TooManyMembers));
    }
}

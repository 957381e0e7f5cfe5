//! Streams of compound files (MS-CFB), in which Excel kept its workbooks until 2007. Every chain is as long as the file at most.

const SIGNATURE: [u8; 8] = [0xd0, 0xcf, 0x11, 0xe0, 0xa1, 0xb1, 0x1a, 0xe1];
/// Numbers of sectors from this one on are marks: the end of a chain, a free sector.
const FIRST_MARK: u32 = 0xffff_fffa;
const HEADER_BYTES: usize = 512;
/// The numbers of sectors of the allocation table that the header holds.
const HEADER_SECTORS: usize = 109;
const ENTRY_BYTES: usize = 128;

/// The number of two bytes, little-endian; `None` beyond the end.
pub(super) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at.checked_add(2)?)?.try_into().ok()?))
}

/// The number of four bytes.
pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

/// The float of eight bytes.
pub(super) fn f64_at(bytes: &[u8], at: usize) -> Option<f64> {
    Some(f64::from_le_bytes(bytes.get(at..at.checked_add(8)?)?.try_into().ok()?))
}

/// Whether bytes start as a compound file.
pub(in super::super) fn is_compound(bytes: &[u8]) -> bool {
    bytes.starts_with(&SIGNATURE)
}

/// A compound file with its table of sectors.
struct CompoundFile<'a> {
    bytes: &'a [u8],
    sector_bytes: usize,
    /// Where sector 0 begins.
    first_at: usize,
    /// The sector after each.
    next: Vec<u32>,
}

/// The first stream with one of the names; `None` where there is none, or the file is broken before it.
pub(super) fn stream(bytes: &[u8], names: &[&str]) -> Option<Vec<u8>> {
    if !is_compound(bytes) || bytes.len() < HEADER_BYTES {
        return None;
    }
    let shift = u16_at(bytes, 30)?;
    let sector_bytes = match shift {
        9 | 12 => 1usize << shift,
        _ => return None,
    };
    let mut file = CompoundFile { bytes, sector_bytes, first_at: sector_bytes, next: Vec::new() };
    file.next = file.allocation()?;
    let directory = file.chain(u32_at(bytes, 48)?, usize::MAX)?;
    let entry = |index: usize| directory.get(index * ENTRY_BYTES..(index + 1) * ENTRY_BYTES);
    let count = directory.len() / ENTRY_BYTES;
    let root = (0..count).filter_map(entry).find(|entry| entry[66] == 5)?;
    let found = names.iter().find_map(|name| {
        (0..count).filter_map(entry).find(|entry| entry[66] == 2 && name_of(entry).eq_ignore_ascii_case(name))
    })?;
    let (start, size) = (u32_at(found, 116)?, u32_at(found, 120)? as usize);
    if size >= u32_at(bytes, 56)? as usize {
        return file.chain(start, size);
    }
    // Short streams lie in sectors of 64 bytes of the root's stream.
    let container = file.chain(u32_at(root, 116)?, usize::MAX)?;
    let table = file.chain(u32_at(bytes, 60)?, usize::MAX)?;
    let next = (0..table.len() / 4).filter_map(|index| u32_at(&table, index * 4)).collect();
    CompoundFile { bytes: &container, sector_bytes: 64, first_at: 0, next }.chain(start, size)
}

/// The name of an entry of the directory.
fn name_of(entry: &[u8]) -> String {
    let length = usize::from(u16::from_le_bytes([entry[64], entry[65]])).clamp(2, 64) - 2;
    let units: Vec<u16> =
        entry[..length].chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
    String::from_utf16_lossy(&units)
}

impl CompoundFile<'_> {
    fn sector(&self, number: u32) -> Option<&[u8]> {
        let start = (number as usize).checked_mul(self.sector_bytes)?.checked_add(self.first_at)?;
        // The last sector of a file may be cut short.
        self.bytes.get(start..).map(|rest| &rest[..rest.len().min(self.sector_bytes)])
    }

    fn sectors(&self) -> usize {
        self.bytes.len() / self.sector_bytes + 1
    }

    /// The allocation table: its sectors are listed in the header and, of large files, in sectors of their own.
    fn allocation(&self) -> Option<Vec<u32>> {
        let mut listed: Vec<u32> =
            (0..HEADER_SECTORS).filter_map(|index| u32_at(self.bytes, 76 + index * 4)).collect();
        let mut more = u32_at(self.bytes, 68)?;
        let last = self.sector_bytes / 4 - 1;
        for _ in 0..self.sectors() {
            if more >= FIRST_MARK {
                break;
            }
            let sector = self.sector(more)?;
            listed.extend((0..last).filter_map(|index| u32_at(sector, index * 4)));
            more = u32_at(sector, last * 4)?;
        }
        let mut next = Vec::new();
        for number in listed.into_iter().filter(|number| *number < FIRST_MARK).take(self.sectors()) {
            let sector = self.sector(number)?;
            next.extend((0..self.sector_bytes / 4).filter_map(|index| u32_at(sector, index * 4)));
        }
        Some(next)
    }

    /// The bytes of a chain of sectors, `most` at most; `None` where it runs in a circle.
    fn chain(&self, start: u32, most: usize) -> Option<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut number = start;
        for _ in 0..=self.sectors() {
            if number >= FIRST_MARK || bytes.len() >= most {
                bytes.truncate(most);
                return Some(bytes);
            }
            bytes.extend_from_slice(self.sector(number)?);
            number = *self.next.get(number as usize)?;
        }
        None
    }
}

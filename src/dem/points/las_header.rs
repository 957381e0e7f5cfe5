//! The header of a LAS file (ASPRS LAS 1.0 to 1.4 R15), every count and offset in it held against the file.
//!
//! ```text
//!   0 LASF   6 flags   25 version   94 header size   96 offset of points   100 records   104 format   105 length
//! 107 count (32 bits)  131 scales   155 offsets      235 extended records and 247 count (64 bits): 1.4 only
//! ── header size ── variable length records ── offset of points ── points ── extended records
//! ```

use glam::DVec3;

use crate::dem::error::bytes_at;
use crate::dem::points::{MOST_POINTS, PointsError};

/// Bytes of the header of each version from 1.0 on.
const HEADER_BYTES: [usize; 5] = [227, 227, 227, 235, 375];

/// Bytes of a point of each format; a file may state more, of bytes that its writer added.
const POINT_BYTES: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];

/// The first format with 16 flags and 256 classes.
const EXTENDED: u8 = 6;

/// Set in the format of a compressed file.
const COMPRESSED: u8 = 0x80;

/// A header whose promises the file can hold.
#[derive(Debug)]
pub(super) struct LasHeader {
    /// 0 to 4 of version 1.
    pub minor: u8,
    /// Where variable length records start.
    pub size: usize,
    /// Where points start.
    pub points_at: usize,
    /// The format of a point, 0 to 10.
    pub format: u8,
    /// Whether points are compressed.
    pub compressed: bool,
    /// Bytes of a point.
    pub record: usize,
    /// Points.
    pub count: u64,
    /// What stored coordinates are multiplied by.
    pub scale: DVec3,
    /// What is added then.
    pub offset: DVec3,
    /// Whether the system is stated as WKT.
    pub says_wkt: bool,
    /// Variable length records.
    records: u32,
    /// Extended records: where and how many.
    extended: (u64, u32),
}

/// A variable length record.
pub(super) struct Record<'a> {
    /// Who defined it.
    pub owner: &'a [u8],
    /// Its number among those of the same owner.
    pub id: u16,
    /// The record with its own header.
    pub whole: &'a [u8],
    /// Its content.
    pub content: &'a [u8],
}

impl LasHeader {
    /// Reads and checks a header.
    pub fn read(bytes: &[u8]) -> Result<Self, PointsError> {
        let format = u8_at(bytes, 104)?;
        let header = Self {
            minor: version(bytes)?,
            size: u16_at(bytes, 94)?.into(),
            points_at: u32_at(bytes, 96)? as usize,
            format: format & !COMPRESSED,
            compressed: format & COMPRESSED != 0,
            record: u16_at(bytes, 105)?.into(),
            count: 0,
            scale: vector_at(bytes, 131)?,
            offset: vector_at(bytes, 155)?,
            says_wkt: u16_at(bytes, 6)? & 0x10 != 0,
            records: u32_at(bytes, 100)?,
            extended: (0, 0),
        };
        let header = header.with_version_4(bytes)?;
        header.check(bytes)?;
        Ok(header)
    }

    fn with_version_4(self, bytes: &[u8]) -> Result<Self, PointsError> {
        let legacy = u64::from(u32_at(bytes, 107)?);
        if self.minor < 4 {
            return Ok(Self { count: legacy, ..self });
        }
        let count = u64_at(bytes, 247)?;
        let extended = (u64_at(bytes, 235)?, u32_at(bytes, 243)?);
        Ok(Self { count: if count == 0 { legacy } else { count }, extended, ..self })
    }

    fn check(&self, bytes: &[u8]) -> Result<(), PointsError> {
        let least = HEADER_BYTES[usize::from(self.minor)];
        if self.size < least || self.points_at < self.size || self.points_at > bytes.len() {
            return Err(broken(format!(
                "its header of {} bytes (version 1.{} has {least}) is followed by points at byte {}, in a file of {}",
                self.size,
                self.minor,
                self.points_at,
                bytes.len()
            )));
        }
        let Some(&least) = POINT_BYTES.get(usize::from(self.format)) else {
            return Err(PointsError::Unsupported {
                format: "LAS",
                what: format!("has points of format {} (0 to 10 are known)", self.format),
            });
        };
        if self.record < least {
            let record = self.record;
            return Err(broken(format!("points of format {} in {record} bytes need {least}", self.format)));
        }
        if self.count > MOST_POINTS {
            return Err(PointsError::TooMany { count: self.count });
        }
        let room = (bytes.len() - self.points_at) as u64;
        if !self.compressed && self.count * self.record as u64 > room {
            return Err(broken(format!(
                "it promises {} points of {} bytes and has room for {}",
                self.count,
                self.record,
                room / self.record as u64
            )));
        }
        if self.scale.is_finite() && self.offset.is_finite() && self.scale.cmpne(DVec3::ZERO).all() {
            return Ok(());
        }
        Err(broken(format!("its scales are {} and its offsets {}", self.scale, self.offset)))
    }

    /// Bytes of a point of the format itself, without bytes that the writer added.
    pub fn plain_record(&self) -> usize {
        POINT_BYTES[usize::from(self.format)]
    }

    /// Whether points have the layout of formats 6 to 10.
    pub fn is_extended(&self) -> bool {
        self.format >= EXTENDED
    }

    /// All records that lie whole before the points, then the extended ones after them. Some writers count more
    /// records than there are; what runs into the points is no record.
    pub fn records<'a>(&self, bytes: &'a [u8]) -> Vec<Record<'a>> {
        let mut found = Vec::new();
        let before = &bytes[..self.points_at];
        let mut at = self.size;
        for _ in 0..self.records {
            let Some(record) = record(before, at, Length::Short) else { break };
            at += record.whole.len();
            found.push(record);
        }
        let mut at = usize::try_from(self.extended.0).unwrap_or(usize::MAX);
        for _ in 0..self.extended.1 {
            let Some(record) = record(bytes, at, Length::Long) else { break };
            at += record.whole.len();
            found.push(record);
        }
        found
    }
}

/// How a record states its length: in 16 bits, or in 64 where it is extended.
#[derive(Clone, Copy)]
enum Length {
    Short,
    Long,
}

fn record(bytes: &[u8], at: usize, length: Length) -> Option<Record<'_>> {
    let (header, length) = match length {
        Length::Short => (54, u16::from_le_bytes(bytes_at(bytes, at.checked_add(20)?)?).into()),
        Length::Long => (60, u64::from_le_bytes(bytes_at(bytes, at.checked_add(20)?)?)),
    };
    let end = at.checked_add(header)?.checked_add(usize::try_from(length).ok()?)?;
    let whole = bytes.get(at..end)?;
    let owner = &whole[2..18];
    let owner = &owner[..owner.iter().position(|&byte| byte == 0).unwrap_or(owner.len())];
    Some(Record { owner, id: u16::from_le_bytes(bytes_at(whole, 18)?), whole, content: &whole[header..] })
}

fn version(bytes: &[u8]) -> Result<u8, PointsError> {
    match (u8_at(bytes, 24)?, u8_at(bytes, 25)?) {
        (1, minor @ 0..=4) => Ok(minor),
        (major, minor) => Err(PointsError::Unsupported {
            format: "LAS",
            what: format!("is of version {major}.{minor} (1.0 to 1.4 are known)"),
        }),
    }
}

/// A [`PointsError::Broken`] LAS file.
pub(super) fn broken(reason: impl Into<String>) -> PointsError {
    PointsError::Broken { format: "LAS", reason: reason.into() }
}

fn u8_at(bytes: &[u8], at: usize) -> Result<u8, PointsError> {
    field(bytes, at).map(|[byte]| byte)
}

fn u16_at(bytes: &[u8], at: usize) -> Result<u16, PointsError> {
    field(bytes, at).map(u16::from_le_bytes)
}

fn u32_at(bytes: &[u8], at: usize) -> Result<u32, PointsError> {
    field(bytes, at).map(u32::from_le_bytes)
}

fn u64_at(bytes: &[u8], at: usize) -> Result<u64, PointsError> {
    field(bytes, at).map(u64::from_le_bytes)
}

fn vector_at(bytes: &[u8], at: usize) -> Result<DVec3, PointsError> {
    let number = |index: usize| field(bytes, at + 8 * index).map(f64::from_le_bytes);
    Ok(DVec3::new(number(0)?, number(1)?, number(2)?))
}

fn field<const N: usize>(bytes: &[u8], at: usize) -> Result<[u8; N], PointsError> {
    bytes_at(bytes, at)
        .ok_or_else(|| broken(format!("it ends after {} bytes, inside its header", bytes.len())))
}

//! LERC, *Limited Error Raster Compression*: a block of samples, each within a stated error, as Esri's library packs them.
//!
//! ```text
//! "Lerc2 " │ version │ checksum (3 on) │ rows, columns, depth (4 on), valid, tile side, bytes, type │ error, least, greatest
//! mask bytes │ mask │ one of:
//!     nothing                          no sample is valid, or all are alike
//!     least, greatest of each depth    (4 on) then one of the following
//!     1 │ samples                      as they are
//!     0 │ way (bytes without loss) │   tiles ([`tiles`]), or Huffman's codes of all samples ([`huffman`])
//! ```
//!
//! Specification: Esri, *LERC* (github.com/Esri/lerc, `doc/MORE.md` and the reference decoder, US patent 8,908,982, licensed
//! by Apache 2.0). All numbers have the least significant byte first. Versions 1 to 6 are read, but for the lossless floats
//! of version 6, which no GeoTIFF holds: libtiff writes version 4.
//!
//! A block is hostile until it is read: its size, its type and its depth must be those that the caller knows, so nothing is
//! allocated that the caller does not want, and its checksum must be right.

mod bits;
mod huffman;
mod mask;
mod tiles;

use sandtable_base::bytes::ByteCursor;
use sandtable_raster::sample_type::SampleType;

use crate::lerc::mask::LercMask;

const MAGIC: &[u8] = b"Lerc2 ";

/// The types of samples by their numbers.
const TYPES: [SampleType; 8] = [
    SampleType::I8,
    SampleType::U8,
    SampleType::I16,
    SampleType::U16,
    SampleType::I32,
    SampleType::U32,
    SampleType::F32,
    SampleType::F64,
];

/// The versions that are read.
const VERSIONS: std::ops::RangeInclusive<u32> = 1..=6;

/// The bytes before those that the checksum is of.
const BEFORE_SUM: usize = MAGIC.len() + 8;

/// What is known of a block before it is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LercShape {
    pub columns: usize,
    pub rows: usize,
    pub sample: SampleType,
    /// The most values of a pixel.
    pub depth: usize,
}

/// The samples of a block.
#[derive(Debug)]
pub(crate) struct LercBlock {
    /// Row by row, the values of a pixel side by side; 0 where the mask hides it.
    pub values: Vec<f64>,
    /// Values of a pixel.
    pub depth: usize,
    mask: LercMask,
}

/// Why a block cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub(crate) enum LercError {
    #[error("it does not start with 'Lerc2 '")]
    NotLerc,
    #[error("LERC of version {0}")]
    Version(u32),
    #[error("LERC of version 6 with floats packed without loss")]
    Lossless,
    #[error("it holds {columns} x {rows} pixels of {depth} values of type {kind}")]
    Shape { columns: u32, rows: u32, depth: u32, kind: u32 },
    #[error("its checksum is wrong")]
    Checksum,
    #[error("it breaks off, or contradicts itself")]
    Broken,
}

impl LercError {
    /// Whether the block may be sound.
    pub fn is_unsupported(self) -> bool {
        matches!(self, Self::Version(_) | Self::Lossless)
    }
}

/// The facts that a block starts with.
#[derive(Clone, Copy, Debug)]
struct LercHeader {
    version: u32,
    rows: usize,
    columns: usize,
    depth: usize,
    /// Pixels that the mask shows.
    valid: usize,
    /// Columns and rows of a tile.
    tile: usize,
    /// Bytes of the block.
    bytes: usize,
    sample: SampleType,
    /// The most that a sample is off.
    error: f64,
    least: f64,
    greatest: f64,
}

impl LercBlock {
    /// Whether a pixel, by its number from the first row on, has a value.
    pub fn is_valid(&self, pixel: usize) -> bool {
        self.mask.shows(pixel)
    }

    /// Whether every pixel has a value.
    pub fn is_whole(&self) -> bool {
        self.mask.is_full()
    }
}

/// Reads a block of a known shape from the start of `bytes`.
pub(crate) fn decode(bytes: &[u8], shape: LercShape) -> Result<LercBlock, LercError> {
    let mut cursor = ByteCursor::new(bytes);
    let header = LercHeader::read(&mut cursor, bytes, shape)?;
    let start = cursor.position();
    let mut cursor = ByteCursor::new(bytes.get(start..header.bytes).ok_or(LercError::Broken)?);
    let mask = LercMask::read(&mut cursor, &header).ok_or(LercError::Broken)?;
    let values = vec![0.0; header.pixels() * header.depth];
    let mut block = LercBlock { values, depth: header.depth, mask };
    block.fill(&mut cursor, &header)?;
    Ok(block)
}

impl LercHeader {
    fn read(cursor: &mut ByteCursor, bytes: &[u8], shape: LercShape) -> Result<Self, LercError> {
        if cursor.take(MAGIC.len()) != Some(MAGIC) {
            return Err(LercError::NotLerc);
        }
        let version = cursor.u32_le().ok_or(LercError::Broken)?;
        if !VERSIONS.contains(&version) {
            return Err(LercError::Version(version));
        }
        let mut number = || cursor.u32_le().ok_or(LercError::Broken);
        let sum = if version >= 3 { Some(number()?) } else { None };
        let (rows, columns) = (number()?, number()?);
        let depth = if version >= 4 { number()? } else { 1 };
        let [valid, tile, length, kind] = [number()?, number()?, number()?, number()?];
        let sample = TYPES.get(kind as usize).copied();
        let is_wanted = columns as usize == shape.columns
            && rows as usize == shape.rows
            && (1..=shape.depth).contains(&(depth as usize))
            && sample == Some(shape.sample);
        if !is_wanted {
            return Err(LercError::Shape { columns, rows, depth, kind });
        }
        if version >= 6 {
            // More blocks; whether a value means no data, whether all are whole, and two bytes that mean nothing.
            let _more = number()?;
            let [passes_nodata, ..] = cursor.array::<4>().ok_or(LercError::Broken)?;
            if passes_nodata != 0 {
                return Err(LercError::Version(version));
            }
        }
        let mut real = || cursor.f64_le().ok_or(LercError::Broken);
        let [error, least, greatest] = [real()?, real()?, real()?];
        if version >= 6 {
            let _nodata = [real()?, real()?];
        }
        let length = length as usize;
        let stored = bytes.get(..length).ok_or(LercError::Broken)?;
        let is_right = |sum: u32| stored.get(BEFORE_SUM..).is_some_and(|summed| checksum(summed) == sum);
        if sum.is_some_and(|sum| !is_right(sum)) {
            return Err(LercError::Checksum);
        }
        let header = Self {
            version,
            rows: shape.rows,
            columns: shape.columns,
            depth: depth as usize,
            valid: valid as usize,
            tile: tile as usize,
            bytes: length,
            sample: shape.sample,
            error,
            least,
            greatest,
        };
        if header.valid > header.pixels() || !(error >= 0.0 && error.is_finite()) {
            return Err(LercError::Broken);
        }
        Ok(header)
    }

    fn pixels(&self) -> usize {
        self.rows * self.columns
    }
}

impl LercBlock {
    fn fill(&mut self, cursor: &mut ByteCursor, header: &LercHeader) -> Result<(), LercError> {
        if header.valid == 0 {
            return Ok(());
        }
        if header.least == header.greatest {
            self.fill_alike(&vec![cast(header.sample, header.least); header.depth]);
            return Ok(());
        }
        let mut greatest = vec![header.greatest; header.depth];
        if header.version >= 4 {
            let mut all =
                || (0..header.depth).map(|_| value(cursor, header.sample)).collect::<Option<Vec<_>>>();
            let least = all().ok_or(LercError::Broken)?;
            greatest = all().ok_or(LercError::Broken)?;
            if least == greatest {
                self.fill_alike(&least);
                return Ok(());
            }
        }
        match cursor.u8().ok_or(LercError::Broken)? {
            0 => self.fill_packed(cursor, header, &greatest),
            _ => self.fill_plain(cursor, header.sample).ok_or(LercError::Broken),
        }
    }

    /// Every valid pixel has these values.
    fn fill_alike(&mut self, values: &[f64]) {
        for (pixel, at) in self.values.chunks_exact_mut(self.depth).enumerate() {
            if self.mask.shows(pixel) {
                at.copy_from_slice(values);
            }
        }
    }

    fn fill_plain(&mut self, cursor: &mut ByteCursor, sample: SampleType) -> Option<()> {
        for (pixel, at) in self.values.chunks_exact_mut(self.depth).enumerate() {
            if self.mask.shows(pixel) {
                for at in at {
                    *at = value(cursor, sample)?;
                }
            }
        }
        Some(())
    }

    fn fill_packed(
        &mut self,
        cursor: &mut ByteCursor,
        header: &LercHeader,
        greatest: &[f64],
    ) -> Result<(), LercError> {
        let is_byte = matches!(header.sample, SampleType::U8 | SampleType::I8);
        let has_way = is_byte && header.version >= 2 && header.error == 0.5
            || header.sample.is_float() && header.version >= 6 && header.error == 0.0;
        let way = if has_way { cursor.u8().ok_or(LercError::Broken)? } else { 0 };
        let done = match way {
            0 => tiles::read(cursor, header, greatest, self),
            1 | 2 if is_byte => huffman::read(cursor, header, way == 1, self),
            3 if header.version >= 6 && !is_byte => return Err(LercError::Lossless),
            _ => None,
        };
        done.ok_or(LercError::Broken)
    }
}

/// Takes a value of a type.
fn value(cursor: &mut ByteCursor, sample: SampleType) -> Option<f64> {
    Some(match sample {
        SampleType::I8 => f64::from(cursor.u8()? as i8),
        SampleType::U8 => f64::from(cursor.u8()?),
        SampleType::I16 => f64::from(i16::from_le_bytes(cursor.array()?)),
        SampleType::U16 => f64::from(u16::from_le_bytes(cursor.array()?)),
        SampleType::I32 => f64::from(i32::from_le_bytes(cursor.array()?)),
        SampleType::U32 => f64::from(cursor.u32_le()?),
        SampleType::F32 => f64::from(f32::from_le_bytes(cursor.array()?)),
        SampleType::F64 => cursor.f64_le()?,
        SampleType::F16 | SampleType::I64 | SampleType::U64 => return None,
    })
}

/// The value as the type keeps it: integers without what is behind the point, floats rounded.
fn cast(sample: SampleType, value: f64) -> f64 {
    match sample {
        SampleType::F64 => value,
        SampleType::F32 => f64::from(value as f32),
        _ => {
            let (least, greatest) = sample.range();
            value.trunc().clamp(least, greatest)
        }
    }
}

/// Fletcher's sum of 32 bits over words of 16, the most significant byte first (Fletcher 1982).
fn checksum(bytes: &[u8]) -> u32 {
    /// Words after which the sums could overflow.
    const WORDS: usize = 359;
    let fold = |sum: u32| (sum & 0xffff) + (sum >> 16);
    let (mut first, mut second) = (0xffff_u32, 0xffff_u32);
    let words = bytes.chunks_exact(2);
    let rest = words.remainder();
    for words in bytes[..bytes.len() - rest.len()].chunks(2 * WORDS) {
        for word in words.chunks_exact(2) {
            first += u32::from(word[0]) << 8 | u32::from(word[1]);
            second += first;
        }
        (first, second) = (fold(first), fold(second));
    }
    if let [last] = rest {
        first += u32::from(*last) << 8;
        second += first;
    }
    fold(second) << 16 | fold(first)
}

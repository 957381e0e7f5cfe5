//! How the first band of a TIFF image is stored: what its tags say, held against what the file can hold.
//!
//! Everything that a header can claim is checked here, before anything is allocated for it: the size of the image, of
//! one tile, and the number of blocks.
//!
//! ```text
//!  block 0     block 1      blocks are tiles, or strips as wide as the image; those at the right border and at
//! ┌─────────┬─────────┐     the bottom hold rows and columns beyond it: tiles in full (their rows are as long as
//! │ row 0   │         │     any other's), strips only the rows that are there
//! │ row 1   │   ┌─────┼─ the image ends here
//! ```

use std::io::{Read, Seek};

use tiff::TiffError;
use tiff::decoder::{ChunkType, Decoder};
use tiff::tags::{ByteOrder, Tag};

use crate::dem::error::{DemErrorKind, check_size, check_size_within};

pub(crate) const FORMAT: &str = "GeoTIFF";

/// What an image says of how it is stored.
#[derive(Clone, Debug)]
pub(crate) struct Storage {
    /// Samples per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Bits of one sample.
    pub bits: u16,
    /// What the bits of a sample mean.
    pub kind: SampleKind,
    /// How blocks are packed.
    pub packing: Packing,
    /// What was done to rows before they were packed.
    pub predictor: Predictor,
    /// The order of a sample's bytes.
    pub order: ByteOrder,
    /// Bands that lie side by side in one block.
    pub bands_per_block: u16,
    /// Columns and rows of a block; the last ones may reach beyond the image.
    pub block_size: (u32, u32),
    /// How rows beyond the image are kept.
    shape: ChunkType,
    /// Where each block starts in the file.
    block_starts: Vec<u64>,
    /// Packed bytes of each block; 0 for one that was never written.
    block_bytes: Vec<u64>,
}

/// What the bits of a sample mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleKind {
    /// An integer from 0 on.
    Unsigned,
    /// An integer in two's complement.
    Signed,
    /// An IEEE 754 number.
    Float,
    /// Something else, or not the same in all bands.
    Other,
}

/// How blocks are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    /// Not at all.
    Plain,
    /// A zlib stream (RFC 1950).
    Deflate,
    /// LZW (TIFF 6.0, section 13).
    Lzw,
    /// PackBits, ZSTD: what the decoder unpacks.
    Other,
}

/// What was done to rows before they were packed (TIFF 6.0, section 14; Adobe's Technical Note 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Predictor {
    /// Nothing.
    Plain,
    /// Samples are differences to their neighbors on the left.
    Differences,
    /// The bytes of samples are sorted by significance, and those are differences.
    FloatBytes,
    /// Another one.
    Other,
}

/// A block and the part of it that lies within the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TiffBlock {
    /// Its number among the first band's.
    pub index: u32,
    /// The image's column that it starts at.
    pub column: u32,
    /// The image's row that it starts at.
    pub row: u32,
    /// Its columns within the image.
    pub width: u32,
    /// Its rows within the image.
    pub height: u32,
}

impl Storage {
    /// Reads and checks the tags of the decoder's current image, of at most `most` samples.
    pub fn of<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        file_bytes: usize,
        most: u64,
    ) -> Result<Self, DemErrorKind> {
        let (width, height) = decoder.dimensions().map_err(fault)?;
        let mut shorts = |tag: Tag, default: u16| {
            let found = decoder.find_tag_unsigned_vec::<u16>(tag).map_err(fault)?;
            Ok::<_, DemErrorKind>(found.filter(|values| !values.is_empty()).unwrap_or_else(|| vec![default]))
        };
        let compression = shorts(Tag::Compression, 1)?[0];
        let expansion = expansion(compression)?;
        let depths = shorts(Tag::BitsPerSample, 1)?;
        let bands = shorts(Tag::SamplesPerPixel, 1)?[0];
        if bands == 0 {
            return Err(DemErrorKind::broken(FORMAT, "it has no band"));
        }
        let planar = shorts(Tag::PlanarConfiguration, 1)?[0] == 2;
        let formats = shorts(Tag::SampleFormat, 1)?;
        let predictor = predictor(shorts(Tag::Predictor, 1)?[0]);
        let (across, down) = decoder.chunk_dimensions();
        let shape = decoder.get_chunk_type();
        let (starts, bytes) = match shape {
            ChunkType::Strip => (Tag::StripOffsets, Tag::StripByteCounts),
            ChunkType::Tile => (Tag::TileOffsets, Tag::TileByteCounts),
        };
        let mut table =
            |tag: Tag| decoder.find_tag_unsigned_vec(tag).map_err(fault).map(Option::unwrap_or_default);
        let (block_starts, block_bytes) = (table(starts)?, table(bytes)?);
        let storage = Self {
            width,
            height,
            bits: depths[0],
            kind: if alike(&depths) && alike(&formats) { kind(formats[0]) } else { SampleKind::Other },
            packing: packing(compression),
            predictor,
            order: decoder.byte_order(),
            bands_per_block: if planar { 1 } else { bands },
            block_size: match shape {
                ChunkType::Strip => (width.max(1), down.clamp(1, height.max(1))),
                ChunkType::Tile => (across.max(1), down.max(1)),
            },
            shape,
            block_starts,
            block_bytes,
        };
        storage.check((file_bytes, expansion), most)?;
        Ok(storage)
    }

    fn check(&self, (file, expansion): (usize, u64), most: u64) -> Result<(), DemErrorKind> {
        // Blocks that were never written take no bytes: such a file may claim more than it holds.
        let sparse = self.block_bytes.contains(&0);
        let held = (file, if sparse { expansion.max(2) } else { expansion });
        let bytes = u64::from(self.bits.div_ceil(8)) * u64::from(self.bands_per_block);
        let size = (self.width.into(), self.height.into());
        check_size_within(most, size, if self.bits < 8 { 0 } else { bytes }, held)?;
        if self.shape == ChunkType::Tile {
            let (across, down) = self.block_size;
            check_size((across.into(), down.into()), bytes, (file, expansion.max(2)))?;
        }
        Ok(())
    }

    /// How many bytes a block of `samples` samples decodes to.
    pub fn decoded_bytes(&self, samples: u64) -> u64 {
        samples * u64::from(self.bits) * u64::from(self.bands_per_block) / 8
    }

    /// How many bytes one row of a block decodes to.
    pub fn row_bytes(&self) -> usize {
        self.decoded_bytes(self.block_size.0.into()) as usize
    }

    /// The type of a sample, as GDAL names it.
    pub fn data_type(&self) -> &'static str {
        match (self.kind, self.bits) {
            (SampleKind::Float, ..=32) => "Float32",
            (SampleKind::Float, _) => "Float64",
            (SampleKind::Signed, ..=8) => "Int8",
            (SampleKind::Signed, ..=16) => "Int16",
            (SampleKind::Signed, ..=32) => "Int32",
            (SampleKind::Signed, _) => "Int64",
            // What is neither is refused before anybody asks.
            (SampleKind::Unsigned | SampleKind::Other, ..=8) => "Byte",
            (SampleKind::Unsigned | SampleKind::Other, ..=16) => "UInt16",
            (SampleKind::Unsigned | SampleKind::Other, ..=32) => "UInt32",
            (SampleKind::Unsigned | SampleKind::Other, _) => "UInt64",
        }
    }

    /// Whether samples need 64 bits to stay exact.
    pub fn is_wide(&self) -> bool {
        self.bits == 64 || (self.bits == 32 && self.kind != SampleKind::Float)
    }

    /// A no-data value as a sample can equal it; NaN, which nothing equals, where there is none.
    pub fn comparable(&self, nodata: Option<f64>) -> f64 {
        match nodata {
            Some(value) if self.kind == SampleKind::Float && self.bits <= 32 => f64::from(value as f32),
            Some(value) => value,
            None => f64::NAN,
        }
    }

    /// Whether samples of this kind are read.
    pub fn check_samples(&self) -> Result<(), DemErrorKind> {
        let is_float = self.kind == SampleKind::Float;
        if [8, 16, 32, 64].contains(&self.bits) && !(is_float && self.bits == 8) {
            return Ok(());
        }
        Err(DemErrorKind::Unsupported {
            format: FORMAT,
            what: format!("{}-bit {}", self.bits, if is_float { "floats" } else { "samples" }),
            remedy: "convert it, for example with: gdal_translate -ot Float32 FILE out.tif",
        })
    }

    /// Blocks side by side, and above each other.
    pub fn blocks_across_and_down(&self) -> (u32, u32) {
        (self.width.div_ceil(self.block_size.0), self.height.div_ceil(self.block_size.1))
    }

    /// The block at a column and a row of blocks.
    pub fn block(&self, across: u32, down: u32) -> TiffBlock {
        let (width, height) = self.block_size;
        let (column, row) = (across * width, down * height);
        TiffBlock {
            index: (u64::from(down) * u64::from(self.width.div_ceil(width)) + u64::from(across)) as u32,
            column,
            row,
            width: width.min(self.width - column),
            height: height.min(self.height - row),
        }
    }

    /// All blocks of the first band, in the order of their numbers.
    pub fn blocks(&self) -> impl Iterator<Item = TiffBlock> + '_ {
        let (across, down) = self.blocks_across_and_down();
        (0..down).flat_map(move |y| (0..across).map(move |x| self.block(x, y)))
    }

    /// Whether a block was written at all.
    pub fn is_written(&self, index: u32) -> bool {
        self.block_bytes.get(index as usize).is_none_or(|&bytes| bytes > 0)
    }

    /// Where a block lies in the file: its start and its packed bytes; `None` where the tables do not list it.
    pub fn place(&self, index: u32) -> Option<(u64, u64)> {
        Some((*self.block_starts.get(index as usize)?, *self.block_bytes.get(index as usize)?))
    }
}

fn alike(values: &[u16]) -> bool {
    values.iter().all(|value| *value == values[0])
}

fn kind(format: u16) -> SampleKind {
    match format {
        1 => SampleKind::Unsigned,
        2 => SampleKind::Signed,
        3 => SampleKind::Float,
        _ => SampleKind::Other,
    }
}

fn packing(compression: u16) -> Packing {
    match compression {
        1 => Packing::Plain,
        5 => Packing::Lzw,
        8 | 32946 => Packing::Deflate,
        _ => Packing::Other,
    }
}

fn predictor(code: u16) -> Predictor {
    match code {
        1 => Predictor::Plain,
        2 => Predictor::Differences,
        3 => Predictor::FloatBytes,
        _ => Predictor::Other,
    }
}

/// How many bytes one packed byte can become, by compression scheme.
fn expansion(compression: u16) -> Result<u64, DemErrorKind> {
    let what = match compression {
        1 => return Ok(1),
        // A code of 12 bits stands for up to 4 KiB.
        5 => return Ok(2731),
        8 | 32946 => return Ok(1032),
        32773 => return Ok(64),
        // A block of 128 KiB that repeats one byte takes four (RFC 8878).
        50000 => return Ok(32_768),
        2..=4 => "fax compression".into(),
        6 | 7 => "JPEG compression".into(),
        34712 => "JPEG 2000 compression".into(),
        34887 => "LERC compression".into(),
        34925 => "LZMA compression".into(),
        50001 => "WebP compression".into(),
        50002 | 52546 => "JPEG XL compression".into(),
        other => format!("compression scheme {other}"),
    };
    Err(DemErrorKind::Unsupported {
        format: FORMAT,
        what,
        remedy: "convert it, for example with: gdal_translate -co COMPRESS=DEFLATE FILE out.tif",
    })
}

/// The decoder's error in our words.
pub(crate) fn fault(error: TiffError) -> DemErrorKind {
    match error {
        TiffError::UnsupportedError(what) => DemErrorKind::Unsupported {
            format: FORMAT,
            what: what.to_string(),
            remedy: "convert it, for example with: gdal_translate -co COMPRESS=DEFLATE FILE out.tif",
        },
        TiffError::LimitsExceeded => {
            DemErrorKind::broken(FORMAT, "a tag or a block claims more than the file holds")
        }
        other => DemErrorKind::broken(FORMAT, other.to_string()),
    }
}

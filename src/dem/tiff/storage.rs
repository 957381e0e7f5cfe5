//! The storage of a TIFF image's first band: its tags, checked against the size of the file.
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

use tiff::decoder::{ChunkType, Decoder};
use tiff::tags::Tag;

use crate::tiff::fault::{self, TO_DEFLATE, decode_error};
use sandtable_base::bytes::ByteOrder;
use sandtable_base::limits::work_limit::WorkLimit;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::sample_type::{NumberKind, SampleType};
use sandtable_raster::windows::RasterWindow;

#[derive(Clone, Debug)]
pub(crate) struct Storage {
    pub width: u32,
    pub height: u32,
    pub bits: u16,
    /// The type of samples; `None` where they are not read as elevation, or not alike in all bands.
    pub sample: Option<SampleType>,
    pub packing: Packing,
    pub predictor: Predictor,
    pub order: ByteOrder,
    /// All bands of the image.
    pub bands: u16,
    /// The band, from 1 on, that states how opaque each pixel is: alpha, by the tag ExtraSamples; `None` where none does.
    pub alpha: Option<u16>,
    /// Bands that lie side by side in one block.
    pub bands_per_block: u16,
    /// Columns of a block; the last one may reach beyond the image.
    pub block_width: u32,
    /// Rows of a block; the last one may reach beyond the image.
    pub block_height: u32,
    /// The tables of JPEG blocks; empty where each has its own.
    pub jpeg_tables: Vec<u8>,
    /// Whether blocks are tiles: as large at the border as anywhere.
    is_tiled: bool,
    /// Where each block starts in the file.
    block_starts: Vec<u64>,
    /// Packed bytes of each block; 0 for one that was never written.
    block_bytes: Vec<u64>,
}

/// How blocks are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    Plain,
    /// A zlib stream (RFC 1950).
    Deflate,
    /// LZW (TIFF 6.0, section 13).
    Lzw,
    /// PackBits (TIFF 6.0, section 9).
    PackBits,
    /// A Zstandard frame (RFC 8878).
    Zstd,
    /// An XZ stream.
    Lzma,
    /// A LERC block, which may be packed again.
    Lerc(LercPacking),
    /// A JPEG stream (Adobe's Technical Note 2): pictures, and heights of one band and 8 bits.
    Jpeg,
}

/// How LERC blocks are packed again (the tag `LercParameters` of libtiff).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LercPacking {
    Plain,
    Deflate,
    Zstd,
}

/// The tag in which libtiff keeps the version of LERC and how its blocks are packed again.
const LERC_PARAMETERS: Tag = Tag::Unknown(50674);

/// How rows were transformed before they were packed (TIFF 6.0, section 14; Adobe's Technical Note 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Predictor {
    Plain,
    /// Samples are differences to their neighbors on the left.
    Differences,
    /// The bytes of samples are sorted by significance, and those are differences.
    FloatBytes,
}

/// A block and the part of it that lies within the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TiffBlock {
    /// Its number among the first band's.
    pub index: u32,
    /// The part within the image.
    pub window: RasterWindow,
}

impl Storage {
    /// Reads and checks the tags of the decoder's current image, of at most `most` samples.
    pub fn read<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        file_bytes: usize,
        most: &'static WorkLimit,
    ) -> Result<Self, DemErrorKind> {
        let (width, height) = decoder.dimensions().map_err(decode_error)?;
        let mut shorts = |tag: Tag, default: u16| {
            let found = decoder.find_tag_unsigned_vec::<u16>(tag).map_err(decode_error)?;
            Ok::<_, DemErrorKind>(found.filter(|values| !values.is_empty()).unwrap_or_else(|| vec![default]))
        };
        let packing = match shorts(Tag::Compression, 1)?[0] {
            34887 => Packing::Lerc(lerc_packing(shorts(LERC_PARAMETERS, 0)?.get(1).copied())?),
            compression => packing(compression)?,
        };
        let depths = shorts(Tag::BitsPerSample, 1)?;
        let bands = shorts(Tag::SamplesPerPixel, 1)?[0];
        let is_planar = shorts(Tag::PlanarConfiguration, 1)?[0] == 2;
        let formats = shorts(Tag::SampleFormat, 1)?;
        let predictor = match packing {
            // Neither holds differences, whatever the tag says.
            Packing::Lerc(_) | Packing::Jpeg => Predictor::Plain,
            _ => predictor(shorts(Tag::Predictor, 1)?[0])?,
        };
        // A tag of the wrong type counts as absent, as in GDAL.
        let extra = shorts(Tag::ExtraSamples, 0).unwrap_or_default();
        let is_tiled = decoder.get_chunk_type() == ChunkType::Tile;
        let (across, down) = decoder.chunk_dimensions();
        let (starts, bytes) = match is_tiled {
            false => (Tag::StripOffsets, Tag::StripByteCounts),
            true => (Tag::TileOffsets, Tag::TileByteCounts),
        };
        let mut table = |tag: Tag| {
            decoder.find_tag_unsigned_vec(tag).map_err(decode_error).map(Option::unwrap_or_default)
        };
        let (block_starts, block_bytes) = (table(starts)?, table(bytes)?);
        let jpeg_tables = match packing {
            Packing::Jpeg => decoder.find_tag(Tag::JPEGTables).map_err(decode_error)?,
            _ => None,
        };
        let are_alike = |values: &[u16]| values.iter().all(|value| *value == values[0]);
        let kind = number_kind(formats[0]).filter(|_| are_alike(&depths) && are_alike(&formats));
        let storage = Self {
            width,
            height,
            bits: depths[0],
            sample: kind.and_then(|kind| SampleType::new(kind, depths[0].into())),
            packing,
            predictor,
            order: match decoder.byte_order() {
                tiff::tags::ByteOrder::LittleEndian => ByteOrder::Little,
                tiff::tags::ByteOrder::BigEndian => ByteOrder::Big,
            },
            bands,
            alpha: alpha_band(bands, &extra),
            bands_per_block: if is_planar { 1 } else { bands },
            block_width: if is_tiled { across.max(1) } else { width.max(1) },
            block_height: if is_tiled { down.max(1) } else { down.clamp(1, height.max(1)) },
            jpeg_tables: jpeg_tables.and_then(|tables| tables.into_u8_vec().ok()).unwrap_or_default(),
            is_tiled,
            block_starts,
            block_bytes,
        };
        storage.check(file_bytes, most)?;
        Ok(storage)
    }

    fn check(&self, file_bytes: usize, most_samples: &'static WorkLimit) -> Result<(), DemErrorKind> {
        if self.bands_per_block == 0 {
            return Err(fault::broken("it has no band"));
        }
        let expansion = expansion(self.packing);
        let bytes = u64::from(self.bits.div_ceil(8)) * u64::from(self.bands_per_block);
        let claim =
            SizeClaim::new(self.width.into(), self.height.into(), if self.bits < 8 { 0 } else { bytes });
        SizeClaim { expansion, most_samples, absent: self.absent_samples(), ..claim }.check(file_bytes)?;
        if self.is_tiled && self.block_bytes.iter().any(|&bytes| bytes > 0) {
            let tile = SizeClaim::new(self.block_width.into(), self.block_height.into(), bytes);
            SizeClaim { expansion, ..tile }.check(file_bytes)?;
        }
        Ok(())
    }

    /// Samples of the first band in blocks that were never written: they take no bytes of the file.
    fn absent_samples(&self) -> u64 {
        let (across, down) = self.blocks_across_and_down();
        let listed = (u64::from(across) * u64::from(down)).min(self.block_bytes.len() as u64) as u32;
        let absent = (0..listed).filter(|&index| !self.is_written(index));
        absent.map(|index| self.block(index % across, index / across).window.samples() as u64).sum()
    }

    /// Whether no block of the first band was ever written.
    pub fn is_all_absent(&self) -> bool {
        self.absent_samples() == u64::from(self.width) * u64::from(self.height)
    }

    /// Bytes that `samples` of a block decode to.
    pub fn decoded_bytes(&self, samples: u64) -> u64 {
        (samples * u64::from(self.bits) * u64::from(self.bands_per_block)).div_ceil(8)
    }

    pub fn row_bytes(&self) -> usize {
        self.decoded_bytes(self.block_width.into()) as usize
    }

    /// The rows that a block was packed with: all of a tile, those within the image of a strip.
    pub fn stored_rows(&self, block: TiffBlock) -> u32 {
        if self.is_tiled { self.block_height } else { block.window.height }
    }

    /// The type of samples that are read as elevation.
    pub fn elevation_type(&self) -> Result<SampleType, DemErrorKind> {
        if self.packing == Packing::Jpeg && self.bands_per_block != 1 {
            return Err(fault::unsupported("JPEG compression of colors", TO_DEFLATE));
        }
        let remedy = "convert it, for example with: gdal_translate -ot Float32 FILE out.tif";
        let sample =
            self.sample.ok_or_else(|| fault::unsupported(format!("{}-bit samples", self.bits), remedy))?;
        if self.predictor == Predictor::FloatBytes && !sample.is_float() {
            return Err(fault::unsupported("the floating-point predictor on integers", TO_DEFLATE));
        }
        Ok(sample)
    }

    /// Blocks side by side, and above each other.
    pub fn blocks_across_and_down(&self) -> (u32, u32) {
        (self.width.div_ceil(self.block_width), self.height.div_ceil(self.block_height))
    }

    /// The block at a column and a row of blocks.
    pub fn block(&self, across: u32, down: u32) -> TiffBlock {
        let (column, row) = (across * self.block_width, down * self.block_height);
        let blocks_across = u64::from(self.width.div_ceil(self.block_width));
        let (width, height) =
            (self.block_width.min(self.width - column), self.block_height.min(self.height - row));
        TiffBlock {
            index: (u64::from(down) * blocks_across + u64::from(across)) as u32,
            window: RasterWindow { column, row, width, height },
        }
    }

    /// The block of another band, from 0 on, over the same pixels: the same one where bands lie side by side. `None` where
    /// there can be none of that number.
    pub fn block_of_band(&self, block: TiffBlock, band: u16) -> Option<TiffBlock> {
        if self.bands_per_block > 1 {
            return Some(block);
        }
        let (across, down) = self.blocks_across_and_down();
        let before = across.checked_mul(down)?.checked_mul(band.into())?;
        Some(TiffBlock { index: block.index.checked_add(before)?, ..block })
    }

    /// The blocks of the first band that meet a window, row by row.
    pub fn blocks_meeting(&self, window: RasterWindow) -> impl Iterator<Item = TiffBlock> + '_ {
        let span = |first: u32, count: u32, block: u32| first / block..(first + count).div_ceil(block);
        let columns = span(window.column, window.width, self.block_width);
        span(window.row, window.height, self.block_height)
            .flat_map(move |down| columns.clone().map(move |across| self.block(across, down)))
    }

    pub fn is_written(&self, index: u32) -> bool {
        self.block_bytes.get(index as usize).is_none_or(|&bytes| bytes > 0)
    }

    /// The place of a block in the file: its start and its packed bytes; `None` where the tables do not list it.
    pub fn place(&self, index: u32) -> Option<(u64, u64)> {
        Some((*self.block_starts.get(index as usize)?, *self.block_bytes.get(index as usize)?))
    }
}

/// The first band that ExtraSamples calls alpha; the bands that it describes are the last.
fn alpha_band(bands: u16, extra: &[u16]) -> Option<u16> {
    /// Associated and unassociated alpha (TIFF 6.0, section 18).
    const ALPHA: [u16; 2] = [1, 2];
    let first = usize::from(bands).checked_sub(extra.len())?;
    let at = extra.iter().position(|meaning| ALPHA.contains(meaning))?;
    u16::try_from(first + at).ok().filter(|&band| band > 0)
}

fn number_kind(format: u16) -> Option<NumberKind> {
    match format {
        1 => Some(NumberKind::Unsigned),
        2 => Some(NumberKind::Signed),
        3 => Some(NumberKind::Float),
        _ => None,
    }
}

fn predictor(code: u16) -> Result<Predictor, DemErrorKind> {
    match code {
        1 => Ok(Predictor::Plain),
        2 => Ok(Predictor::Differences),
        3 => Ok(Predictor::FloatBytes),
        other => Err(fault::unsupported(format!("predictor {other}"), TO_DEFLATE)),
    }
}

fn lerc_packing(again: Option<u16>) -> Result<LercPacking, DemErrorKind> {
    match again.unwrap_or(0) {
        0 => Ok(LercPacking::Plain),
        1 => Ok(LercPacking::Deflate),
        2 => Ok(LercPacking::Zstd),
        other => Err(fault::unsupported(format!("LERC packed by scheme {other}"), TO_DEFLATE)),
    }
}

fn packing(compression: u16) -> Result<Packing, DemErrorKind> {
    let what = match compression {
        1 => return Ok(Packing::Plain),
        5 => return Ok(Packing::Lzw),
        8 | 32946 => return Ok(Packing::Deflate),
        32773 => return Ok(Packing::PackBits),
        34925 => return Ok(Packing::Lzma),
        50000 => return Ok(Packing::Zstd),
        2..=4 => "fax compression".into(),
        7 => return Ok(Packing::Jpeg),
        6 => "old JPEG compression".into(),
        34712 => "JPEG 2000 compression".into(),
        50001 => "WebP compression".into(),
        50002 | 52546 => "JPEG XL compression".into(),
        other => format!("compression scheme {other}"),
    };
    Err(fault::unsupported(what, TO_DEFLATE))
}

/// The most bytes that one packed byte becomes.
fn expansion(packing: Packing) -> u64 {
    match packing {
        Packing::Plain => 1,
        // A code of 12 bits is a string of up to 4 KiB.
        Packing::Lzw => 2731,
        Packing::Deflate => 1032,
        Packing::PackBits => 64,
        // A block of 128 KiB that repeats one byte takes four.
        Packing::Zstd => 32_768,
        // A match of 273 bytes takes a third of a bit at least.
        Packing::Lzma => 7090,
        // Level ground of any size takes a hundred bytes: the largest block of windows, 32 MiB, is so many times larger.
        Packing::Lerc(_) => 1 << 18,
        // A macroblock of 16 × 16 pixels takes six codes of two bits at least.
        Packing::Jpeg => 512,
    }
}

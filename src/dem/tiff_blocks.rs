//! Strips and tiles of a TIFF's first band to rows of elevations.
//!
//! Everything that a header can claim is held against the file's length here, before the decoder allocates
//! for it: the size of the image, of one tile, and the number of blocks. Blocks are decoded one at a time, so
//! a file that breaks off costs no more than the block in hand.

use std::io::{Read, Seek};

use tiff::TiffError;
use tiff::decoder::{ChunkType, Decoder, DecodingResult};
use tiff::tags::Tag;

use crate::dem::fault::{Fault, check_size, check_size_within};
use crate::dem::raster::Samples;

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
    is_float: bool,
    is_signed: bool,
    /// Bands that lie side by side in one block.
    bands_per_block: u16,
    /// Compressed bytes of each block; 0 for one that was never written.
    block_bytes: Vec<u64>,
}

impl Storage {
    /// Reads and checks the tags of the decoder's current image, of at most `most` samples.
    pub fn of<R: Read + Seek>(decoder: &mut Decoder<R>, file_bytes: usize, most: u64) -> Result<Self, Fault> {
        let (width, height) = decoder.dimensions().map_err(fault)?;
        let short = |decoder: &mut Decoder<R>, tag: Tag, default: u16| {
            decoder
                .find_tag_unsigned_vec::<u16>(tag)
                .map_err(fault)
                .map(|found| found.and_then(|values| values.first().copied()).unwrap_or(default))
        };
        let expansion = expansion(short(decoder, Tag::Compression, 1)?)?;
        let bits = short(decoder, Tag::BitsPerSample, 1)?;
        let bands = short(decoder, Tag::SamplesPerPixel, 1)?;
        if bands == 0 {
            return Err(Fault::broken(FORMAT, "it has no band"));
        }
        let planar = short(decoder, Tag::PlanarConfiguration, 1)? == 2;
        let format = short(decoder, Tag::SampleFormat, 1)?;
        let (is_float, is_signed) = (format == 3, format == 2);
        let counts_tag = match decoder.get_chunk_type() {
            ChunkType::Strip => Tag::StripByteCounts,
            ChunkType::Tile => Tag::TileByteCounts,
        };
        let block_bytes = decoder.find_tag_unsigned_vec(counts_tag).map_err(fault)?.unwrap_or_default();
        let bands_per_block = if planar { 1 } else { bands };
        let storage = Self { width, height, bits, is_float, is_signed, bands_per_block, block_bytes };
        storage.check(decoder, (file_bytes, expansion), most)?;
        Ok(storage)
    }

    fn check<R: Read + Seek>(
        &self,
        decoder: &Decoder<R>,
        (file, expansion): (usize, u64),
        most: u64,
    ) -> Result<(), Fault> {
        // Blocks that were never written take no bytes: such a file may claim more than it holds.
        let sparse = self.block_bytes.contains(&0);
        let held = (file, if sparse { expansion.max(2) } else { expansion });
        let bytes = u64::from(self.bits.div_ceil(8)) * u64::from(self.bands_per_block);
        let size = (self.width.into(), self.height.into());
        check_size_within(most, size, if self.bits < 8 { 0 } else { bytes }, held)?;
        if decoder.get_chunk_type() == ChunkType::Tile {
            let (across, down) = decoder.chunk_dimensions();
            check_size((across.into(), down.into()), bytes, (file, expansion.max(2)))?;
        }
        Ok(())
    }

    /// How many bytes a block of `samples` samples decodes to.
    pub fn decoded_bytes(&self, samples: u64) -> u64 {
        samples * u64::from(self.bits) * u64::from(self.bands_per_block) / 8
    }

    /// The type of a sample, as GDAL names it.
    pub fn data_type(&self) -> &'static str {
        match (self.is_float, self.is_signed, self.bits) {
            (true, _, ..=32) => "Float32",
            (true, ..) => "Float64",
            (_, true, ..=8) => "Int8",
            (_, true, ..=16) => "Int16",
            (_, true, ..=32) => "Int32",
            (_, true, _) => "Int64",
            (.., ..=8) => "Byte",
            (.., ..=16) => "UInt16",
            (.., ..=32) => "UInt32",
            _ => "UInt64",
        }
    }

    /// Whether samples need 64 bits to stay exact.
    pub fn is_wide(&self) -> bool {
        self.bits == 64 || (self.bits == 32 && !self.is_float)
    }

    /// A no-data value as a sample can equal it.
    fn comparable(&self, nodata: Option<f64>) -> f64 {
        match nodata {
            Some(value) if self.is_float && self.bits <= 32 => f64::from(value as f32),
            Some(value) => value,
            None => f64::NAN,
        }
    }

    /// Whether samples of this kind are read.
    pub fn check_samples(&self) -> Result<(), Fault> {
        if [8, 16, 32, 64].contains(&self.bits) && !(self.is_float && self.bits == 8) {
            return Ok(());
        }
        Err(Fault::Unsupported {
            format: FORMAT,
            what: format!("{}-bit {}", self.bits, if self.is_float { "floats" } else { "samples" }),
            remedy: "convert it, for example with: gdal_translate -ot Float32 FILE out.tif",
        })
    }

    /// Where each block of the first band starts in the image: index, column, row.
    pub fn blocks<R: Read + Seek>(
        &self,
        decoder: &Decoder<R>,
    ) -> impl Iterator<Item = (u32, u32, u32)> + use<R> {
        let (across, down) = decoder.chunk_dimensions();
        let (across, down) = (across.max(1), down.max(1));
        let columns = self.width.div_ceil(across);
        let blocks = u64::from(columns) * u64::from(self.height.div_ceil(down));
        (0..blocks).map(move |index| {
            let (row, column) = (index / u64::from(columns), index % u64::from(columns));
            (index as u32, column as u32 * across, row as u32 * down)
        })
    }

    /// Whether a block was written at all.
    pub fn is_written(&self, index: u32) -> bool {
        self.block_bytes.get(index as usize).is_none_or(|&bytes| bytes > 0)
    }
}

/// The elevations of the current image's first band, `nodata` as NaN.
pub(crate) fn decode<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    storage: &Storage,
    nodata: Option<f64>,
) -> Result<Samples, Fault> {
    storage.check_samples()?;
    let count = storage.width as usize * storage.height as usize;
    let blank = blank(nodata);
    if storage.is_wide() {
        let mut values = vec![blank; count];
        fill(decoder, storage, nodata, &mut values, |value| value)?;
        return Ok(Samples::F64(values));
    }
    let mut values = vec![blank as f32; count];
    fill(decoder, storage, nodata, &mut values, |value| value as f32)?;
    Ok(Samples::F32(values))
}

fn fill<R: Read + Seek, T>(
    decoder: &mut Decoder<R>,
    storage: &Storage,
    nodata: Option<f64>,
    values: &mut [T],
    narrow: impl Fn(f64) -> T + Copy,
) -> Result<(), Fault> {
    for (index, column, row) in storage.blocks(decoder) {
        if storage.is_written(index) {
            let (width, height) = decoder.chunk_data_dimensions(index);
            let bands = usize::from(storage.bands_per_block);
            let image_width = storage.width as usize;
            let place = Place { bands, image_width, column, row, width, height };
            decode_block(decoder, storage, nodata, index, values, &place, narrow)?;
        }
    }
    Ok(())
}

/// The elevations of block `index` alone, row by row, `nodata` as NaN; blank where it was never written.
pub(crate) fn block<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    storage: &Storage,
    nodata: Option<f64>,
    index: u32,
) -> Result<Vec<f64>, Fault> {
    let (width, height) = decoder.chunk_data_dimensions(index);
    let mut values = vec![blank(nodata); width as usize * height as usize];
    if storage.is_written(index) {
        let bands = usize::from(storage.bands_per_block);
        let place = Place { bands, image_width: width as usize, column: 0, row: 0, width, height };
        decode_block(decoder, storage, nodata, index, &mut values, &place, |value| value)?;
    }
    Ok(values)
}

/// What stands where nothing was written: no data where the file knows such a value, else 0, as GDAL has it.
fn blank(nodata: Option<f64>) -> f64 {
    if nodata.is_some() { f64::NAN } else { 0.0 }
}

fn decode_block<R: Read + Seek, T>(
    decoder: &mut Decoder<R>,
    storage: &Storage,
    nodata: Option<f64>,
    index: u32,
    values: &mut [T],
    place: &Place,
    narrow: impl Fn(f64) -> T + Copy,
) -> Result<(), Fault> {
    let hole = storage.comparable(nodata);
    let elevation =
        move |value: f64| narrow(if value == hole || !value.is_finite() { f64::NAN } else { value });
    let placed = match &decoder.read_chunk(index).map_err(fault)? {
        DecodingResult::U8(v) => place.copy(values, v, |x| elevation(x.into())),
        DecodingResult::I8(v) => place.copy(values, v, |x| elevation(x.into())),
        DecodingResult::U16(v) => place.copy(values, v, |x| elevation(x.into())),
        DecodingResult::I16(v) => place.copy(values, v, |x| elevation(x.into())),
        DecodingResult::U32(v) => place.copy(values, v, |x| elevation(x.into())),
        DecodingResult::I32(v) => place.copy(values, v, |x| elevation(x.into())),
        DecodingResult::U64(v) => place.copy(values, v, |x| elevation(x as f64)),
        DecodingResult::I64(v) => place.copy(values, v, |x| elevation(x as f64)),
        DecodingResult::F16(v) => place.copy(values, v, |x| elevation(x.to_f64())),
        DecodingResult::F32(v) => place.copy(values, v, |x| elevation(x.into())),
        DecodingResult::F64(v) => place.copy(values, v, elevation),
    };
    placed.ok_or_else(|| Fault::broken(FORMAT, format!("block {index} does not fit its image")))
}

/// Where a block lies in the image it is copied to, and how many bands it holds.
struct Place {
    bands: usize,
    image_width: usize,
    column: u32,
    row: u32,
    width: u32,
    height: u32,
}

impl Place {
    /// Copies the first band of a block; `None` where the two do not fit.
    fn copy<S: Copy, T>(&self, image: &mut [T], block: &[S], to: impl Fn(S) -> T) -> Option<()> {
        let (bands, width, image_width) = (self.bands, self.width as usize, self.image_width);
        for row in 0..self.height as usize {
            let source = block.get(row * width * bands..(row + 1) * width * bands)?;
            let start = (self.row as usize + row) * image_width + self.column as usize;
            let target = image.get_mut(start..start + width)?;
            for (target, source) in target.iter_mut().zip(source.chunks_exact(bands)) {
                *target = to(source[0]);
            }
        }
        Some(())
    }
}

/// How many bytes one compressed byte can become, by compression scheme.
fn expansion(compression: u16) -> Result<u64, Fault> {
    let what = match compression {
        1 => return Ok(1),
        // A code of 12 bits stands for up to 4 KiB.
        5 => return Ok(2731),
        8 | 32946 => return Ok(1032),
        32773 => return Ok(64),
        2..=4 => "fax compression".into(),
        6 | 7 => "JPEG compression".into(),
        34712 => "JPEG 2000 compression".into(),
        34887 => "LERC compression".into(),
        34925 => "LZMA compression".into(),
        50000 => "ZSTD compression".into(),
        50001 => "WebP compression".into(),
        50002 | 52546 => "JPEG XL compression".into(),
        other => format!("compression scheme {other}"),
    };
    Err(Fault::Unsupported {
        format: FORMAT,
        what,
        remedy: "convert it, for example with: gdal_translate -co COMPRESS=DEFLATE FILE out.tif",
    })
}

/// The decoder's error in our words.
pub(crate) fn fault(error: TiffError) -> Fault {
    match error {
        TiffError::UnsupportedError(what) => Fault::Unsupported {
            format: FORMAT,
            what: what.to_string(),
            remedy: "convert it, for example with: gdal_translate -co COMPRESS=DEFLATE FILE out.tif",
        },
        TiffError::LimitsExceeded => {
            Fault::broken(FORMAT, "a tag or a block claims more than the file holds")
        }
        other => Fault::broken(FORMAT, other.to_string()),
    }
}

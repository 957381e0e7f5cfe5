//! GeoTIFF: strips and tiles, integers and floats of 8 to 64 bits, uncompressed, LZW, deflate, PackBits and Zstandard,
//! with predictors, classic and BigTIFF in both byte orders.
//!
//! Of several bands the first is read, of several images the first (a cloud-optimized file's full
//! resolution). Scale, offset, unit and no-data value come from GDAL's tags. An unsupported compression is
//! refused by name.

use std::io::{Cursor, Read, Seek};

use glam::DAffine2;
use tiff::decoder::{Decoder, Limits, ifd};
use tiff::tags::Tag;

use crate::dem::error::DemErrorKind;
use crate::dem::formats::{DemFormat, Recognition, any_size};
use crate::dem::georef;
use crate::dem::limits::MOST_SAMPLES;
use crate::dem::raster::{Raster, Samples};
use crate::dem::read::DemFile;
use crate::dem::tiff::blocks;
use crate::dem::tiff::gdal_metadata::{BandMetadata, GDAL_METADATA};
use crate::dem::tiff::geokeys::GeoKeys;
use crate::dem::tiff::mask;
use crate::dem::tiff::place::PlaceTags;
use crate::dem::tiff::storage::{Storage, decode_error};
use crate::dem::tiff::write::write;

pub(crate) static FORMAT: DemFormat = DemFormat {
    name: "GeoTIFF",
    extensions: &["tif", "tiff"],
    shared_extensions: &[],
    recognition: Recognition::Content { matches: recognizes, start: "the signature of a TIFF file" },
    reader: read,
    most_bytes: any_size,
    writer: Some(write),
};

/// The most bytes of one tag: the offsets of a million blocks.
const LARGEST_TAG: usize = 16 << 20;

/// The most values of one tag.
const MOST_TAG_VALUES: usize = LARGEST_TAG / 8;

/// The most bytes of a text tag; GDAL's metadata takes a few kilobytes.
const LARGEST_TEXT: u64 = 1 << 20;

/// Whether the content starts as TIFF or BigTIFF does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|start| bytes.starts_with(*start))
}

/// Reads the first band of the first image.
fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let bytes = file.bytes;
    let decoder = Decoder::new(Cursor::new(bytes)).map_err(decode_error)?;
    let mut decoder = decoder.with_limits(limits(bytes.len()));
    let storage = Storage::read(&mut decoder, bytes.len(), MOST_SAMPLES)?;
    let GeoTiffHeader { raster, scale, offset } = GeoTiffHeader::read(&mut decoder, &storage, file)?;
    let mut samples = blocks::decode(bytes, &storage, raster.nodata)?;
    let size = (storage.width, storage.height);
    if !mask::apply_within(&mut decoder, bytes, size, &mut samples)?
        && let Some(mask) = mask::file_beside(file)
    {
        mask::apply_beside(&mask, size, &mut samples)?;
    }
    Ok(Raster { samples: samples.scaled(scale, offset), ..raster })
}

/// The most that the decoder may allocate for a file of `file_bytes` bytes. It reads tags; blocks are unpacked elsewhere.
pub(crate) fn limits(file_bytes: usize) -> Limits {
    let mut limits = Limits::default();
    limits.ifd_value_size = file_bytes.clamp(1024, LARGEST_TAG);
    // The decoder keeps a value of a tag in 32 bytes, and allocates what a tag claims before it looks whether the file holds it.
    limits.decoding_buffer_size = 32 * file_bytes.clamp(1024, MOST_TAG_VALUES);
    limits
}

/// All that a file states but its samples.
pub(crate) struct GeoTiffHeader {
    /// The raster without its samples.
    pub raster: Raster,
    /// The factor of stored values.
    pub scale: f64,
    /// The offset that is added after scaling.
    pub offset: f64,
}

impl GeoTiffHeader {
    /// Reads the tags of the decoder's current image. A tag of the wrong type counts as absent, as in GDAL.
    pub fn read<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        storage: &Storage,
        file: &DemFile,
    ) -> Result<Self, DemErrorKind> {
        let keys = geo_keys(decoder);
        let mut numbers = |tag: Tag| decoder.get_tag_f64_vec(tag).unwrap_or_default();
        let place = PlaceTags {
            scale: numbers(Tag::ModelPixelScaleTag),
            ties: numbers(Tag::ModelTiepointTag),
            matrix: numbers(Tag::ModelTransformationTag),
            is_point: keys.is_point(),
        };
        let nodata = text(decoder, Tag::GdalNodata).trim().trim_start_matches('+').parse().ok();
        let band = BandMetadata::first_band(&text(decoder, Tag::Unknown(GDAL_METADATA)))?;
        let raster = Raster {
            driver: "GTiff",
            data_type: storage.sample.map_or("Byte", |sample| sample.gdal_name()),
            width: storage.width,
            height: storage.height,
            samples: Samples::F32(Vec::new()),
            meters_per_z: band.meters_per_z.or(keys.meters_per_z()?).unwrap_or(1.0),
            map_from_grid: DAffine2::IDENTITY,
            georeferenced: false,
            crs: file.crs_or(|| keys.crs())?,
            nodata,
            vertical_datum: keys.vertical_datum(),
        };
        let raster = georef::placed(file, raster, place.map_from_grid()?, &["tfw", "tifw", "wld"])?;
        Ok(Self { raster, scale: band.scale, offset: band.offset })
    }
}

fn geo_keys<R: Read + Seek>(decoder: &mut Decoder<R>) -> GeoKeys {
    let directory = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default();
    let doubles = decoder.get_tag_f64_vec(Tag::GeoDoubleParamsTag).unwrap_or_default();
    GeoKeys::new(&directory, &doubles, &text(decoder, Tag::GeoAsciiParamsTag))
}

/// A tag of text, or of bytes that are text, up to its first NUL; empty where absent.
fn text<R: Read + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> String {
    // The decoder allocates what a text tag claims before it checks whether the file holds it.
    let claimed = decoder.image_ifd().find_entry(tag).map_or(0, |entry| entry.count());
    if claimed > LARGEST_TEXT {
        return String::new();
    }
    let found = match decoder.find_tag(tag) {
        Ok(Some(ifd::Value::Ascii(text))) => text,
        Ok(Some(other)) => String::from_utf8_lossy(&other.into_u8_vec().unwrap_or_default()).into_owned(),
        _ => String::new(),
    };
    found.split('\0').next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};
    use tiff::encoder::{TiffEncoder, colortype};

    fn file(values: &[f32], nodata: &str) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file).expect("memory");
        let mut image =
            encoder.new_image::<colortype::Gray32Float>(2, values.len() as u32 / 2).expect("memory");
        let directory = image.encoder();
        directory.write_tag(Tag::ModelPixelScaleTag, &[30.0f64, 30.0, 0.0][..]).expect("memory");
        directory.write_tag(Tag::ModelTiepointTag, &[0.0f64, 0.0, 0.0, 5e5, 4e6, 0.0][..]).expect("memory");
        directory
            .write_tag(Tag::GeoKeyDirectoryTag, &[1u16, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32612][..])
            .expect("memory");
        directory.write_tag(Tag::GdalNodata, nodata).expect("memory");
        image.write_data(values).expect("memory");
        file.into_inner()
    }

    #[test]
    fn a_small_file_comes_back_with_its_place_and_holes() {
        let raster = read("a.tif", &file(&[1.0, -9999.0, 3.0, f32::INFINITY], "-9999"), &DemHints::default())
            .expect("fine");
        assert_eq!((raster.width, raster.height, raster.nodata), (2, 2, Some(-9999.0)));
        assert!(raster.at(1, 0).is_nan() && raster.at(1, 1).is_nan() && raster.at(0, 1) == 3.0);
        assert_eq!(raster.geotransform(), [5e5, 30.0, 0.0, 4e6, 0.0, -30.0]);
        assert_eq!(raster.crs.and_then(|crs| crs.epsg()), Some(32612));
    }

    #[test]
    fn a_file_cut_anywhere_is_an_error_and_never_a_panic() {
        let whole = file(&[1.0, 2.0, 3.0, 4.0], "nan");
        for end in 0..whole.len() {
            let _ = read("a.tif", &whole[..end], &DemHints::default());
        }
        assert!(read("a.tif", &whole[..whole.len() / 2], &DemHints::default()).is_err());
    }

    #[test]
    fn every_byte_changed_in_turn_is_an_error_or_a_raster() {
        let whole = file(&[1.0, 2.0, 3.0, 4.0], "-1");
        for at in 0..whole.len() {
            for value in [0, 1, 0x7f, 0x80, 0xff] {
                let mut broken = whole.clone();
                broken[at] = value;
                let _ = read("a.tif", &broken, &DemHints::default());
            }
        }
    }
}

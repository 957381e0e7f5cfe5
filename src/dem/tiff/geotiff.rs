//! GeoTIFF over the `tiff` crate: strips and tiles, integers and floats of 8 to 64 bits, uncompressed, LZW,
//! deflate and PackBits, with predictors, classic and BigTIFF in both byte orders.
//!
//! Of several bands the first is read, of several images the first (a cloud-optimized file's full
//! resolution). Scale, offset, unit and no-data value come from GDAL's tags. What the crate cannot decode is
//! refused by name before it is tried.

use std::io::{Cursor, Read, Seek};

use tiff::decoder::{Decoder, Limits, ifd};
use tiff::tags::Tag;

use crate::dem::error::{DemErrorKind, MOST_SAMPLES};
use crate::dem::georef::{self, PlaceTags, RasterPlace};
use crate::dem::raster::{Raster, Samples};
use crate::dem::read::DemFile;
use crate::dem::tiff::blocks;
use crate::dem::tiff::gdal_metadata;
use crate::dem::tiff::geokeys::GeoKeys;
use crate::dem::tiff::mask;
use crate::dem::tiff::mask::MaskLocation;
use crate::dem::tiff::neutral::neutralised;
use crate::dem::tiff::storage::{Storage, fault};

/// The most bytes of one tag: the offsets of a million blocks.
const LARGEST_TAG: usize = 16 << 20;

/// The most bytes of a text tag; GDAL's metadata takes a few kilobytes.
const LARGEST_TEXT: u64 = 1 << 20;

/// The most bytes that one block decodes to.
const LARGEST_BLOCK: usize = 2 << 30;

const GDAL_METADATA: u16 = 42112;

/// Whether the content starts as TIFF or BigTIFF does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|start| bytes.starts_with(*start))
}

/// Reads the first band of the first image.
pub(crate) fn read(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let bytes = neutralised(source.bytes);
    let limits = limits(bytes.len(), LARGEST_BLOCK);
    let mut decoder = Decoder::new(Cursor::new(&bytes[..])).map_err(fault)?.with_limits(limits.clone());
    let storage = Storage::of(&mut decoder, bytes.len(), MOST_SAMPLES)?;
    let GeoTiffHeader { bare, scale, offset } = describe(&mut decoder, &storage, source)?;
    let mut samples = blocks::decode(&bytes, &storage, bare.nodata, &limits)?;
    let size = (storage.width, storage.height);
    let found = mask::apply(&mut decoder, size, bytes.len(), &mut samples)?;
    if let (MaskLocation::Nothing, Some(mask)) = (found, mask_beside(source)) {
        let limits = |mask_bytes| self::limits(mask_bytes, LARGEST_BLOCK);
        mask::apply_beside(&mask, limits, size, &mut samples)?;
    }
    Ok(Raster { samples: samples.scaled(scale, offset), ..bare })
}

/// The bytes of the mask that GDAL keeps in a file of its own.
pub(crate) fn mask_beside(source: &DemFile) -> Option<Vec<u8>> {
    (source.hints.companions)(&format!("{}.msk", source.name))
}

/// What the decoder may allocate for a file of `file_bytes` bytes.
pub(crate) fn limits(file_bytes: usize, largest_block: usize) -> Limits {
    let mut limits = Limits::default();
    limits.ifd_value_size = file_bytes.clamp(1024, LARGEST_TAG);
    limits.intermediate_buffer_size = file_bytes.min(largest_block);
    limits.decoding_buffer_size = largest_block;
    limits
}

/// What a file says of itself.
pub(crate) struct GeoTiffHeader {
    /// The raster without its samples.
    pub bare: Raster,
    /// What a stored value is multiplied by.
    pub scale: f64,
    /// What is then added.
    pub offset: f64,
}

/// Reads everything but the samples of the decoder's current image.
pub(crate) fn describe<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    storage: &Storage,
    source: &DemFile,
) -> Result<GeoTiffHeader, DemErrorKind> {
    let tags = GeoTags::read(decoder);
    let place = tags.place(source, storage.height)?;
    let crs = match &source.hints.crs {
        Some(crs) => Some(crs.clone()),
        None => tags.keys.crs()?.map_or_else(|| source.crs_beside(), |crs| Ok(Some(crs)))?,
    };
    let band = gdal_metadata::first_band(&tags.metadata)?;
    let meters_per_z = band.meters_per_z.or(tags.keys.meters_per_z()?).unwrap_or(1.0);
    let bare = Raster {
        driver: "GTiff",
        data_type: storage.data_type(),
        width: storage.width,
        height: storage.height,
        samples: Samples::F32(Vec::new()),
        meters_per_z,
        map_from_grid: place.map_from_grid,
        georeferenced: place.stated,
        crs,
        nodata: tags.nodata,
        vertical_datum: tags.keys.vertical_datum(),
    };
    Ok(GeoTiffHeader { bare, scale: band.scale, offset: band.offset })
}

/// The tags beyond the picture; a tag of the wrong type counts as absent, as GDAL has it.
struct GeoTags {
    place: PlaceTags,
    keys: GeoKeys,
    nodata: Option<f64>,
    metadata: String,
}

impl GeoTags {
    fn read<R: Read + Seek>(decoder: &mut Decoder<R>) -> Self {
        let numbers = |decoder: &mut Decoder<R>, tag: Tag| decoder.get_tag_f64_vec(tag).unwrap_or_default();
        let directory = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default();
        let words = text(decoder, Tag::GeoAsciiParamsTag);
        let keys = GeoKeys::new(&directory, &numbers(decoder, Tag::GeoDoubleParamsTag), &words);
        let nodata = text(decoder, Tag::GdalNodata);
        Self {
            place: PlaceTags {
                scale: numbers(decoder, Tag::ModelPixelScaleTag),
                ties: numbers(decoder, Tag::ModelTiepointTag),
                matrix: numbers(decoder, Tag::ModelTransformationTag),
                is_point: keys.is_point(),
            },
            keys,
            nodata: nodata.trim().trim_start_matches('+').parse().ok(),
            metadata: text(decoder, Tag::Unknown(GDAL_METADATA)),
        }
    }

    fn place(&self, source: &DemFile, height: u32) -> Result<RasterPlace, DemErrorKind> {
        match self.place.place()? {
            Some(map_from_grid) => Ok(RasterPlace { map_from_grid, stated: true }),
            None => georef::beside(source, height, &["tfw", "tifw", "wld"]),
        }
    }
}

/// A tag of text, or of bytes that are text, up to its first NUL; empty where absent.
fn text<R: Read + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> String {
    // The decoder allocates what a text tag claims before it looks whether the file holds it.
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

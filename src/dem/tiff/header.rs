//! The metadata of a GeoTIFF: everything that it states about its elevation, without the samples.

use std::io::{Read, Seek};

use glam::DAffine2;
use tiff::decoder::{Decoder, ifd};
use tiff::tags::Tag;

use crate::dem_file::DemFile;
use crate::formats::text::{number, unknown_nodata};
use crate::tiff::fault;
use crate::tiff::gdal_metadata::{BandMetadata, GDAL_METADATA};
use crate::tiff::geokeys::GeoKeys;
use crate::tiff::place::PlaceTags;
use crate::tiff::storage::Storage;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::file_bands::FileBands;
use sandtable_raster::raster::{Raster, Samples};

/// The most bytes of a text tag; GDAL's metadata takes a few kilobytes.
const LARGEST_TEXT: u64 = 1 << 20;

/// Whether the content starts as TIFF or BigTIFF does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|start| bytes.starts_with(*start))
}

/// The error of a file that is all no data.
pub(crate) fn all_absent() -> DemErrorKind {
    fault::broken("none of its blocks was ever written, so that all of it is no data")
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
        let stated = text(decoder, Tag::GdalNodata);
        let nodata = number(stated.trim().as_bytes());
        let band = BandMetadata::first_band(&text(decoder, Tag::Unknown(GDAL_METADATA)))?;
        let meters_per_z = band.meters_per_z.or(keys.meters_per_z()?);
        let raster = Raster {
            driver: "GTiff",
            data_type: storage.sample.map_or("Byte", |sample| sample.gdal_name()),
            width: storage.width,
            height: storage.height,
            samples: Samples::F32(Vec::new()),
            meters_per_z: meters_per_z.unwrap_or(1.0),
            states_z_unit: meters_per_z.is_some() || keys.names_system_in_meters(),
            map_from_grid: DAffine2::IDENTITY,
            georeferenced: false,
            crs: file.crs_or(|| keys.crs())?,
            nodata,
            vertical_datum: keys.vertical_datum(),
            ..Raster::without_place(storage.width, storage.height)
        };
        let (count, mask) = (storage.bands.into(), storage.alpha.map(|band| u64::from(band) + 1));
        let mut raster = raster.with_bands(FileBands { count, mask });
        if nodata.is_none() && !stated.trim().is_empty() {
            raster.notes.push(unknown_nodata(&stated));
        }
        let raster = file.placed(raster, place.map_from_grid()?, &["tfw", "tifw", "wld"])?;
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

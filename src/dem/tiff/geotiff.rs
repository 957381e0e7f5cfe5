//! GeoTIFF: strips and tiles, integers and floats of 8 to 64 bits, uncompressed, LZW, deflate, PackBits, Zstandard, LZMA,
//! LERC and JPEG (one band of 8 bits), with predictors, classic and BigTIFF in both byte orders.
//!
//! Blocks that were never written (GDAL's sparse files) are no data, or 0 where the file states no value for that, as in GDAL.
//! Of several bands the first is read, of several images the first (a cloud-optimized file's full
//! resolution). Scale, offset, unit and no-data value come from GDAL's tags. An unsupported compression is
//! refused by name.

use std::io::Cursor;

use tiff::decoder::Decoder;

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, FormatWriter, Recognition, any_size};
use crate::tiff::blocks;
use crate::tiff::decoder::limits;
use crate::tiff::fault::{self, decode_error};
use crate::tiff::header::{GeoTiffHeader, all_absent, recognizes};
use crate::tiff::mask;
use crate::tiff::storage::Storage;
use crate::tiff::windows::GeoTiffWindows;
use crate::tiff::write::{write, write_windows};
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::Windows;

pub(crate) static FORMAT: DemFormat = DemFormat {
    name: fault::NAME,
    extensions: &["tif", "tiff"],
    shared_extensions: &[],
    recognition: Recognition::Content { matches: recognizes, start: "the signature of a TIFF file" },
    reader: read,
    windows: Some(windows),
    most_bytes: any_size,
    writer: Some(FormatWriter { extensions: &["tif", "tiff"], write }),
    windows_writer: Some(write_windows),
};

/// Opens the first band of the first image.
fn windows(
    file: &DemFile,
    content: Box<dyn FileContent>,
    cache_bytes: usize,
) -> Result<Box<dyn Windows + Send>, DemErrorKind> {
    Ok(Box::new(GeoTiffWindows::open_first(file.name, content, file.hints, cache_bytes)?))
}

/// Reads the first band of the first image.
fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let bytes = file.bytes;
    let decoder = Decoder::new(Cursor::new(bytes)).map_err(decode_error)?;
    let mut decoder = decoder.with_limits(limits(bytes.len()));
    let storage = Storage::read(&mut decoder, bytes.len(), &RASTER_SAMPLES)?;
    let GeoTiffHeader { raster, scale, offset } = GeoTiffHeader::read(&mut decoder, &storage, file)?;
    if raster.nodata.is_some() && storage.is_all_absent() {
        return Err(all_absent());
    }
    let mut samples = blocks::decode(bytes, &storage, raster.nodata)?;
    let size = (storage.width, storage.height);
    if !mask::apply_within(&mut decoder, bytes, size, &mut samples)?
        && let Some(mask) = mask::file_beside(file)
    {
        mask::apply_beside(&mask, size, &mut samples)?;
    }
    Ok(Raster { samples: samples.scaled(scale, offset), ..raster })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;
    use tiff::encoder::{TiffEncoder, colortype};
    use tiff::tags::Tag;

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

    /// A TIFF of `side` samples squared in tiles of 64 squared, plain 32-bit floats, of which only the second tile is
    /// written, with 7 in each sample; or none is.
    fn sparse(side: u32, nodata: Option<&str>, writes: bool) -> Vec<u8> {
        const TILE: u32 = 64;
        let tiles = side.div_ceil(TILE).pow(2);
        let mut file = b"II*\0\0\0\0\0".to_vec();
        let tile: Vec<u8> = 7f32.to_le_bytes().repeat(if writes { (TILE * TILE) as usize } else { 0 });
        file.extend(&tile);
        let starts = file.len() as u32;
        let table = |value: u32| (0..tiles).map(move |tile| if tile == 1 { value } else { 0 });
        file.extend(table(8 * u32::from(writes)).flat_map(u32::to_le_bytes));
        let sizes = file.len() as u32;
        file.extend(table(tile.len() as u32).flat_map(u32::to_le_bytes));
        let text = file.len() as u32;
        file.extend(nodata.unwrap_or_default().as_bytes());
        file.extend([0; 8]);
        let directory = file.len() as u32;
        let mut entries = vec![
            (256u16, 4u16, 1, side),
            (257, 4, 1, side),
            (258, 3, 1, 32),
            (259, 3, 1, 1),
            (262, 3, 1, 1),
            (277, 3, 1, 1),
            (322, 4, 1, TILE),
            (323, 4, 1, TILE),
            (324, 4, tiles, starts),
            (325, 4, tiles, sizes),
            (339, 3, 1, 3),
        ];
        entries.extend(nodata.map(|value| (42113, 2, value.len() as u32 + 1, text)));
        file[4..8].copy_from_slice(&directory.to_le_bytes());
        file.extend((entries.len() as u16).to_le_bytes());
        for (tag, kind, count, value) in entries {
            file.extend(tag.to_le_bytes());
            file.extend(kind.to_le_bytes());
            file.extend(u32::to_le_bytes(count));
            file.extend(u32::to_le_bytes(value));
        }
        file.extend([0; 4]);
        file
    }

    #[test]
    fn blocks_that_were_never_written_are_no_data_or_else_0() {
        for (nodata, absent) in [(Some("-9999"), f64::NAN), (None, 0.0)] {
            // Of 16,777,216 samples the file holds 4,096.
            let raster = read("a.tif", &sparse(4096, nodata, true), &DemHints::default()).expect("sparse");
            assert_eq!((raster.at(64, 0), raster.at(127, 63)), (7.0, 7.0));
            for (column, row) in [(63, 0), (128, 0), (64, 64), (4095, 4095)] {
                let found = raster.at(column, row);
                assert!(found == absent || found.is_nan() && absent.is_nan(), "{column}, {row}: {found}");
            }
        }
    }

    #[test]
    fn a_file_without_any_block_is_refused_where_that_leaves_no_data() {
        let empty = sparse(4096, Some("-9999"), false);
        let error = read("a.tif", &empty, &DemHints::default()).map(drop).expect_err("empty");
        assert!(error.to_string().contains("none of its blocks"), "{error}");
        let zeros = read("a.tif", &sparse(4096, None, false), &DemHints::default()).expect("zeros");
        assert!(zeros.at(0, 0) == 0.0 && zeros.at(4095, 4095) == 0.0);
    }

    /// A TIFF whose only strip is a JPEG stream of 8-bit gray, 40 columns by 24 rows.
    fn jpeg(bands: u32, stream: &[u8]) -> Vec<u8> {
        let mut file = b"II*\0\0\0\0\0".to_vec();
        file.extend(stream);
        let directory = file.len() as u32;
        let entries: [(u16, u16, u32); 10] = [
            (256, 4, 40),
            (257, 4, 24),
            (258, 3, 8),
            (259, 3, 7),
            (262, 3, 1),
            (273, 4, 8),
            (277, 3, bands),
            (278, 4, 24),
            (279, 4, stream.len() as u32),
            (339, 3, 1),
        ];
        file[4..8].copy_from_slice(&directory.to_le_bytes());
        file.extend((entries.len() as u16).to_le_bytes());
        for (tag, kind, value) in entries {
            file.extend(tag.to_le_bytes());
            file.extend(kind.to_le_bytes());
            file.extend(1u32.to_le_bytes());
            file.extend(value.to_le_bytes());
        }
        file.extend([0; 4]);
        file
    }

    #[test]
    fn gray_jpeg_blocks_are_heights_and_colors_are_none() {
        let gray: Vec<u8> =
            (0..40 * 24).map(|index: u32| (60 + index % 40 * 2 + index / 40 * 3) as u8).collect();
        let mut stream = Vec::new();
        image::codecs::jpeg::JpegEncoder::new_with_quality(&mut stream, 95)
            .encode(&gray, 40, 24, image::ExtendedColorType::L8)
            .expect("memory");
        let raster = read("a.tif", &jpeg(1, &stream), &DemHints::default()).expect("gray");
        assert_eq!((raster.width, raster.height, raster.data_type), (40, 24, "Byte"));
        for (index, &wanted) in gray.iter().enumerate() {
            let found = raster.samples.get(index);
            assert!((found - f64::from(wanted)).abs() <= 3.0, "{index}: {found} for {wanted}");
        }
        let refused = read("a.tif", &jpeg(3, &stream), &DemHints::default()).expect_err("colors");
        assert!(refused.to_string().contains("JPEG compression of colors"), "{refused}");
        for end in (8..stream.len()).step_by(7) {
            let _ = read("a.tif", &jpeg(1, &stream[..end]), &DemHints::default());
        }
    }

    #[test]
    fn blocks_that_are_written_must_fit_the_file() {
        let mut cut = sparse(4096, None, true);
        // The table of sizes claims that all tiles are written.
        let sizes = 8 + 4 * 64 * 64 + 4 * 4096;
        assert_eq!(cut[sizes + 4..sizes + 8], (4 * 64 * 64u32).to_le_bytes());
        cut[sizes..sizes + 4 * 4096].fill(1);
        let error = read("a.tif", &cut, &DemHints::default()).map(drop).expect_err("too short");
        assert!(error.to_string().contains("cut short"), "{error}");
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

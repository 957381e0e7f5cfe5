//! GeoTIFF: strips and tiles, integers and floats of 8 to 64 bits, uncompressed, LZW, deflate, PackBits, Zstandard, LZMA,
//! LERC and JPEG (one band of 8 bits), with predictors, classic and BigTIFF in both byte orders.
//!
//! Blocks that were never written (GDAL's sparse files) are no data, or 0 where the file states no value for that, as in GDAL.
//! Of several bands the first is read, and where another is alpha, what it makes transparent is no data; of several images
//! the first (a cloud-optimized file's full resolution). Scale, offset, unit and no-data value come from GDAL's tags. An unsupported compression is
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
    use crate::read::{open_windows, read};
    use sandtable_raster::file_bands::FileBands;
    use sandtable_raster::raster::Samples;
    use sandtable_raster::windows::{RasterWindow, window_samples};
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

    /// The bands of a small TIFF of 16-bit integers, and how they are stored.
    struct Banded<'a> {
        /// Each of 5 columns and 4 rows.
        bands: &'a [[i16; 20]],
        /// What the last bands mean: 0 is not stated, 1 and 2 are alpha.
        extra: &'a [u16],
        is_planar: bool,
        has_differences: bool,
        nodata: Option<&'a str>,
    }

    impl Banded<'_> {
        /// The file, uncompressed, in strips of two rows.
        fn bytes(&self) -> Vec<u8> {
            let (count, columns) = (self.bands.len(), 5);
            let row_of = |bands: &[[i16; 20]], row: usize| {
                let mut values: Vec<i16> = (0..columns)
                    .flat_map(|column| bands.iter().map(move |band| band[row * columns + column]))
                    .collect();
                if self.has_differences {
                    for at in (bands.len()..values.len()).rev() {
                        values[at] = values[at].wrapping_sub(values[at - bands.len()]);
                    }
                }
                values.into_iter().flat_map(i16::to_le_bytes).collect::<Vec<u8>>()
            };
            let strip =
                |bands: &[[i16; 20]], first: usize| [row_of(bands, first), row_of(bands, first + 1)].concat();
            let strips: Vec<Vec<u8>> = match self.is_planar {
                true => self.bands.chunks(1).flat_map(|band| [strip(band, 0), strip(band, 2)]).collect(),
                false => vec![strip(self.bands, 0), strip(self.bands, 2)],
            };
            let mut file = b"II*\0\0\0\0\0".to_vec();
            let mut starts = Vec::new();
            for strip in &strips {
                starts.push(file.len() as u32);
                file.extend(strip);
            }
            let mut table = |values: Vec<u32>| {
                let at = file.len() as u32;
                file.extend(values.into_iter().flat_map(u32::to_le_bytes));
                at
            };
            let starts = table(starts);
            let sizes = table(strips.iter().map(|strip| strip.len() as u32).collect());
            // Tables of short numbers that do not fit an entry of the directory.
            let shorts = |values: Vec<u16>| {
                let mut values = values;
                values.resize(values.len().next_multiple_of(2), 0);
                values
                    .chunks(2)
                    .map(|pair| u32::from(pair[0]) | u32::from(pair[1]) << 16)
                    .collect::<Vec<u32>>()
            };
            let mut short_table = |values: Vec<u16>| match values.len() {
                ..=2 => shorts(values)[0],
                _ => table(shorts(values)),
            };
            let count_of = count as u32;
            let bits = short_table(vec![16; count]);
            let formats = short_table(vec![2; count]);
            let extra = (!self.extra.is_empty()).then(|| short_table(self.extra.to_vec()));
            let nodata = self.nodata.map(|text| {
                let at = file.len() as u32;
                file.extend(text.as_bytes());
                file.extend([0; 8]);
                at
            });
            let strips = strips.len() as u32;
            let mut entries = vec![
                (256u16, 4u16, 1, 5),
                (257, 4, 1, 4),
                (258, 3, count_of, bits),
                (259, 3, 1, 1),
                (262, 3, 1, 1),
                (273, 4, strips, starts),
                (277, 3, 1, count_of),
                (278, 4, 1, 2),
                (279, 4, strips, sizes),
                (284, 3, 1, if self.is_planar { 2 } else { 1 }),
                (317, 3, 1, if self.has_differences { 2 } else { 1 }),
            ];
            entries.extend(extra.map(|extra| (338, 3, self.extra.len() as u32, extra)));
            entries.push((339, 3, count_of, formats));
            entries.extend(nodata.map(|at| (42113, 2, self.nodata.map_or(0, str::len) as u32 + 1, at)));
            let directory = file.len() as u32;
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

        /// The raster as it is read whole, after it was compared with what windows hold.
        fn read(&self) -> Raster {
            let bytes = self.bytes();
            let raster = read("a.tif", &bytes, &DemHints::default()).expect("a small file");
            let content = Box::new(Cursor::new(bytes.clone()));
            let windows = open_windows("a.tif", &bytes, content, &DemHints::default(), 1 << 20);
            let mut windows = windows.expect("a small file").expect("it has windows");
            assert_eq!((&windows.metadata().notes, windows.metadata().bands), (&raster.notes, raster.bands));
            let bits = |samples: &Samples| samples.iter().map(f64::to_bits).collect::<Vec<_>>();
            let all = windows.samples(RasterWindow::all(raster.size())).expect("readable");
            assert_eq!(bits(&all), bits(&raster.samples));
            let window = RasterWindow { column: 1, row: 1, width: 3, height: 2 };
            let part = windows.samples(window).expect("readable");
            let wanted = window_samples(&raster, RasterWindow::all(raster.size()), window);
            assert_eq!(bits(&part), bits(&wanted));
            raster
        }
    }

    #[test]
    fn what_an_alpha_band_makes_transparent_is_no_data_however_it_is_stored() {
        let heights: [i16; 20] = std::array::from_fn(|at| 100 + 7 * at as i16);
        let other = [3; 20];
        // The first column is transparent, the second nearly.
        let alpha: [i16; 20] = std::array::from_fn(|at| [0, 1, 255, -1, 255][at % 5]);
        for (is_planar, has_differences) in [(false, false), (false, true), (true, false), (true, true)] {
            let file =
                Banded { bands: &[heights, alpha], extra: &[2], is_planar, has_differences, nodata: None };
            let raster = file.read();
            for (index, &height) in heights.iter().enumerate() {
                let found = raster.samples.get(index);
                assert!(
                    if index % 5 == 0 { found.is_nan() } else { found == f64::from(height) },
                    "{index}: {found}"
                );
            }
            assert_eq!(raster.bands, FileBands { count: 2, mask: Some(2) });
            assert!(raster.notes[0].starts_with("band 2 of 2 is alpha"), "{:?}", raster.notes);

            let several = Banded { bands: &[heights, other, alpha], extra: &[0, 1], ..file };
            let raster = several.read();
            assert_eq!((raster.bands.mask, raster.samples.valid().count()), (Some(3), 16));
            let nodata = Banded { nodata: Some("121.000"), ..several };
            let raster = nodata.read();
            assert_eq!((raster.samples.valid().count(), raster.at(3, 0).is_nan()), (15, true));

            // A band whose meaning is not stated is not read, and told.
            let unknown = Banded { bands: &[heights, alpha], extra: &[0], nodata: None, ..several };
            let raster = unknown.read();
            assert_eq!(
                (raster.bands, raster.samples.valid().count()),
                (FileBands { count: 2, mask: None }, 20)
            );
            assert!(raster.notes[0].contains("the first of its 2 bands"), "{:?}", raster.notes);
        }
        let one =
            Banded { bands: &[heights], extra: &[], is_planar: false, has_differences: false, nodata: None };
        assert!(one.read().notes.is_empty() && one.read().bands == FileBands::default());
        let odd = Banded { nodata: Some("none"), ..one };
        assert!(odd.read().notes[0].contains("'none' is no number"));
    }

    #[test]
    fn files_of_several_bands_cut_or_changed_anywhere_are_errors_or_rasters() {
        let heights: [i16; 20] = std::array::from_fn(|at| at as i16);
        for is_planar in [false, true] {
            let file = Banded {
                bands: &[heights, heights],
                extra: &[2],
                is_planar,
                has_differences: true,
                nodata: None,
            };
            let whole = file.bytes();
            for end in 0..whole.len() {
                let _ = read("a.tif", &whole[..end], &DemHints::default());
            }
            for at in 0..whole.len() {
                for value in [0, 1, 0x7f, 0xff] {
                    let mut broken = whole.clone();
                    broken[at] = value;
                    let _ = read("a.tif", &broken, &DemHints::default());
                }
            }
        }
    }

    #[test]
    fn a_value_for_no_data_with_fewer_digits_than_the_samples_is_met() {
        for (stated, sample) in [
            ("-3.40282e+38", f32::MIN),
            ("-3.4e38", f32::MIN),
            ("-3,40282e+38", f32::MIN),
            ("3.40282347e+38", f32::MAX),
            ("1.70141e+38", 1.701_41e38),
            ("-9999.9", -9999.9),
            ("-1.797693134862316e+308", f32::MIN),
        ] {
            let raster = read("a.tif", &file(&[1.0, sample, 3.0, 277.0], stated), &DemHints::default());
            let raster = raster.expect("fine");
            assert!(
                raster.at(1, 0).is_nan() && raster.samples.valid().count() == 3,
                "{stated}: {:?}, {:?}",
                raster.samples,
                raster.nodata
            );
        }
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

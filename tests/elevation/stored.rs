//! Files that GDAL 3.10 wrote (`stored/`), each in a way of its own, beside a plain GeoTIFF that GDAL made of the same.

use std::io::Cursor;
use std::path::Path;

use sandtable_dem::hints::DemHints;
use sandtable_dem::read::{open_windows, read};
use sandtable_raster::error::DemError;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::RasterWindow;

/// The ways of storing, and the plain file of the same samples.
const STORED: [(&str, &str); 14] = [
    ("hills_lzma.tif", "hills.tif"),
    ("hills_lzma_strips.tif", "hills.tif"),
    ("hills_lerc.tif", "hills.tif"),
    ("hills_lerc_deflate.tif", "hills.tif"),
    ("meters_lzma.tif", "meters.tif"),
    ("meters_lerc_zstd.tif", "meters.tif"),
    ("bytes_lerc.tif", "bytes.tif"),
    ("near_lerc.tif", "near.tif"),
    ("holes_lerc.tif", "holes.tif"),
    ("hills.img", "hills.tif"),
    ("levels_packed.img", "levels.tif"),
    ("hills.gpkg", "hills.tif"),
    ("hills.tif", "hills.tif"),
    ("levels.tif", "levels.tif"),
];

fn bytes(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("SANDTABLE_ROOT")).join("tests/elevation/stored");
    std::fs::read(folder.join(name)).expect("a file of the project")
}

fn raster(name: &str, bytes: &[u8]) -> Result<Raster, DemError> {
    read(name, bytes, &DemHints::default())
}

/// The bits of all samples; every NaN is the same.
fn bits(raster: &Raster) -> Vec<u64> {
    raster.samples.iter().map(|value| if value.is_nan() { f64::NAN } else { value }.to_bits()).collect()
}

#[test]
fn whatever_way_a_raster_is_stored_it_reads_as_the_plain_file_does() {
    for (stored, plain) in STORED {
        let [found, wanted] =
            [stored, plain].map(|name| raster(name, &bytes(name)).unwrap_or_else(|error| panic!("{error}")));
        assert_eq!((found.width, found.height), (40, 24), "{stored}");
        assert!(bits(&found) == bits(&wanted), "{stored}");
        assert_eq!(found.geotransform(), wanted.geotransform(), "{stored}");
        assert_eq!(found.crs.as_ref().and_then(|crs| crs.epsg()), Some(32612), "{stored}");
        assert_eq!(found.data_type, wanted.data_type, "{stored}");
    }
}

#[test]
fn windows_of_packed_files_hold_what_the_whole_holds() {
    for (stored, _) in STORED.iter().filter(|(name, _)| !name.ends_with(".gpkg")) {
        let bytes = bytes(stored);
        let whole = raster(stored, &bytes).expect("sound");
        let content = Box::new(Cursor::new(bytes.clone()));
        let opened = open_windows(stored, &bytes, content, &DemHints::default(), 1 << 20).expect("sound");
        let window = RasterWindow { column: 3, row: 2, width: 30, height: 20 };
        let samples = opened.expect("it has windows").samples(window).expect("sound");
        for at in 0..window.samples() {
            let (column, row) = (3 + at as u32 % 30, 2 + at as u32 / 30);
            let (found, wanted) = (samples.get(at), whole.at(column, row));
            assert!(found == wanted || found.is_nan() && wanted.is_nan(), "{stored}: {column}, {row}");
        }
    }
}

#[test]
fn files_cut_anywhere_or_with_bytes_turned_are_errors_or_rasters() {
    for (stored, _) in STORED {
        let whole = bytes(stored);
        let step = (whole.len() / 700).max(1) | 1;
        for at in (0..whole.len()).step_by(step) {
            let _ = raster(stored, &whole[..at]);
            for value in [0, 1, 0x80, 0xff] {
                let mut turned = whole.clone();
                turned[at] = value;
                if let Ok(raster) = raster(stored, &turned) {
                    assert_eq!(
                        raster.samples.len(),
                        raster.width as usize * raster.height as usize,
                        "{stored}"
                    );
                }
            }
        }
    }
}

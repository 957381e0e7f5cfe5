//! Windows of GeoTIFFs hold what the whole reader holds, and hostile files cost no more than their windows.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_dem::tiff::windows::GeoTiffWindows;
use sandtable_raster::raster::Raster;
use sandtable_raster::reduced::{reduced, reduced_by_overview, reduced_part};
use sandtable_raster::windows::{RasterWindow, Windows};

use crate::common::data::{data, files_below};
use crate::common::tiles::{Image, Packing, file};

/// Numbers that look random and are the same in every run.
pub struct Seeded(pub u64);

impl Seeded {
    /// A number below `bound`.
    pub fn below(&mut self, bound: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % u64::from(bound)) as u32
    }

    fn window(&mut self, (width, height): (u32, u32)) -> RasterWindow {
        let (column, row) = (self.below(width), self.below(height));
        RasterWindow {
            column,
            row,
            width: 1 + self.below(width - column),
            height: 1 + self.below(height - row),
        }
    }
}

fn bits(values: &[f32]) -> Vec<u32> {
    // All holes alike: which NaN stands for one means nothing.
    values.iter().map(|value| if value.is_nan() { f32::NAN } else { *value }.to_bits()).collect()
}

fn assert_windows_match(windows: &mut impl Windows, whole: &mut Raster, seed: u64, what: &str) {
    assert_eq!(windows.size(), (whole.width, whole.height), "{what}");
    assert_eq!(windows.metadata().geotransform(), whole.geotransform(), "{what}");
    assert_eq!(windows.metadata().crs, whole.crs, "{what}");
    let mut seeded = Seeded(seed);
    let (mut found, mut wanted) = (Vec::new(), Vec::new());
    let all = RasterWindow { column: 0, row: 0, width: whole.width, height: whole.height };
    let size = (whole.width, whole.height);
    for window in std::iter::once(all).chain((0..20).map(|_| seeded.window(size))) {
        windows.read(window, &mut found).unwrap_or_else(|fault| panic!("{what}: {fault}"));
        whole.read(window, &mut wanted).expect("in memory");
        assert!(bits(&found) == bits(&wanted), "{what}: {window:?} differs");
    }
}

fn hilly(column: u32, row: u32) -> f32 {
    if (column / 7 + row / 5).is_multiple_of(31) { -9999.0 } else { slopes(column, row) }
}

fn slopes(column: u32, row: u32) -> f32 {
    let (x, y) = (f64::from(column), f64::from(row));
    (libm::sin(x * 0.031) * 90.0 + libm::cos(y * 0.017) * 70.0) as f32
}

#[test]
fn windows_of_tiles_and_of_their_overviews_hold_what_the_whole_file_holds() {
    for packing in [Packing::Plain, Packing::Deflate] {
        let full = Image::of(1537, 1025, hilly);
        let half = full.halved();
        let quarter = half.halved();
        let bytes = file(&[full, half, quarter], 256, packing);
        let mut whole = read("a.tif", &bytes, &DemHints::default()).expect("sound");
        let cache = 6 * 256 * 256 * 4;
        let mut windows =
            GeoTiffWindows::open("a.tif", Cursor::new(&bytes), &DemHints::default(), cache).expect("sound");
        assert_windows_match(&mut windows, &mut whole, 1, "full");
        assert!(windows.cached_bytes() <= cache && windows.cached_bytes() > 0);
        let overviews = windows.overviews().to_vec();
        let sizes: Vec<_> = overviews.iter().map(|overview| (overview.width, overview.height)).collect();
        assert_eq!(sizes, [(769, 513), (385, 257)]);
        let mut half = windows.at_overview(&overviews[0]).expect("sound");
        assert_eq!(half.metadata().geotransform()[1], 10.0 * 1537.0 / 769.0);
        let mut found = Vec::new();
        half.read(RasterWindow { column: 300, row: 200, width: 9, height: 1 }, &mut found).expect("sound");
        let wanted: Vec<f32> = (300..309)
            .map(|column| hilly(column * 2, 400))
            .map(|value| if value == -9999.0 { f32::NAN } else { value })
            .collect();
        assert_eq!(bits(&found), bits(&wanted));
    }
}

#[test]
fn a_smaller_raster_is_made_of_an_overview_and_lies_where_that_of_all_samples_does() {
    // Without holes, beside which means are those of other samples.
    let full = Image::of(1537, 1025, slopes);
    let half = full.halved();
    let quarter = half.halved();
    let mut bytes = file(&[full, half, quarter], 256, Packing::Deflate);
    let open = |bytes: &[u8]| {
        GeoTiffWindows::open("a.tif", Cursor::new(bytes.to_vec()), &DemHints::default(), 1 << 20)
            .expect("sound")
    };
    let mut sound = open(&bytes);
    // A block of the file's own samples that cannot be read: only what reads it fails.
    bytes[8..40].fill(0xff);
    let mut damaged = open(&bytes);
    for step in [4, 8, 16] {
        let wanted = reduced(&mut sound, step).expect("sound");
        assert!(reduced(&mut damaged, step).is_err());
        let found = reduced_by_overview(&mut damaged, step).expect("its overviews are sound");
        assert_eq!((found.size(), found.geotransform()), (wanted.size(), wanted.geotransform()));
        let pairs = found.samples.iter().zip(wanted.samples.iter());
        let most = pairs.map(|(found, wanted)| (found - wanted).abs()).fold(0.0, f64::max);
        // The overview has every second or fourth sample: its means lie up to three samples aside, over which the ground rises
        // by 2.8 m eastward and 1.2 m northward each.
        assert!(most < 12.0, "every {step}th: {most}");
        let part = reduced_part(&mut damaged, step, 3..9, 2..5).expect("its overviews are sound");
        assert_eq!(part[0].to_bits(), (found.at(3, found.height - 3) as f32).to_bits());
    }
    let half = sound.at_overview(&sound.overviews()[0]).expect("sound");
    assert_eq!(half.overviews(), &sound.overviews()[1..], "an overview has the coarser ones");
}

#[test]
fn a_block_that_was_damaged_leaves_the_other_windows_readable() {
    let full = Image::of(300, 300, hilly);
    let mut bytes = file(&[full], 128, Packing::Deflate);
    bytes[8..40].fill(0xff);
    let mut windows = GeoTiffWindows::open("a.tif", Cursor::new(&bytes), &DemHints::default(), 1 << 20)
        .expect("sound header");
    let mut out = Vec::new();
    for _ in 0..2 {
        assert!(windows.read(RasterWindow { column: 0, row: 0, width: 9, height: 9 }, &mut out).is_err());
        windows
            .read(RasterWindow { column: 130, row: 0, width: 9, height: 9 }, &mut out)
            .expect("another block");
        assert_eq!(out[0], hilly(130, 0));
    }
}

#[test]
fn a_picture_in_one_huge_block_is_refused_with_the_remedy() {
    let mut bytes = file(&[Image::of(1, 1, |_, _| 1.0)], 4096, Packing::Deflate);
    let directory = u32::from_le_bytes(bytes[4..8].try_into().expect("four")) as usize;
    for entry in 1..3 {
        bytes[directory + 2 + entry * 12 + 8..][..4].copy_from_slice(&4000u32.to_le_bytes());
    }
    let refused = GeoTiffWindows::open("a.tif", Cursor::new(&bytes), &DemHints::default(), 1 << 20);
    let said = refused.err().expect("refused").to_string();
    assert!(said.contains("4000 x 4000") && said.contains("TILED=YES"), "{said}");
}

fn is_tiff(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("tif"))
}

#[test]
fn windows_of_every_real_geotiff_hold_what_the_whole_reader_holds() {
    let Some(folder) = data("dem") else { return };
    let formats = folder.with_file_name("dem_formats");
    let (mut read_in_both, mut tiled_with_overviews) = (0, 0);
    for path in files_below(&folder).into_iter().chain(files_below(&formats)).filter(|path| is_tiff(path)) {
        let (name, bytes) = (path.to_string_lossy().into_owned(), fs::read(&path).expect("readable"));
        let companions = |name: &str| fs::read(name).ok();
        let hints = DemHints { companions: &companions, ..DemHints::default() };
        let opened = GeoTiffWindows::open(&name, fs::File::open(&path).expect("readable"), &hints, 1 << 18);
        match (read(&name, &bytes, &hints), opened) {
            (Ok(mut whole), Ok(mut windows)) => {
                assert_windows_match(&mut windows, &mut whole, 7, &name);
                read_in_both += 1;
                for overview in windows.overviews().to_vec() {
                    let mut reduced = windows.at_overview(&overview).expect("sound");
                    let window =
                        RasterWindow { column: 0, row: 0, width: overview.width, height: overview.height };
                    reduced.read(window, &mut Vec::new()).expect("sound");
                    tiled_with_overviews += 1;
                }
            }
            (Err(whole), Err(windows)) => assert_eq!(whole.to_string(), windows.to_string()),
            (whole, windows) => panic!("{name}: whole {:?}, windows {:?}", whole.err(), windows.err()),
        }
    }
    assert!(read_in_both >= 40 && tiled_with_overviews >= 1, "{read_in_both}, {tiled_with_overviews}");
}

#[test]
fn hostile_geotiffs_are_errors_or_windows_and_never_a_panic() {
    let Some(folder) = data("broken") else { return };
    let files = files_below(&folder).into_iter().filter(|path| {
        let below = path.strip_prefix(&folder).expect("below").to_string_lossy().into_owned();
        below.starts_with("tiff_") || below.starts_with("mutants")
    });
    let (mut opened, mut refused) = (0, 0);
    for path in files {
        let bytes = fs::read(&path).expect("readable");
        let name = path.to_string_lossy();
        match GeoTiffWindows::open(&name, Cursor::new(&bytes), &DemHints::default(), 1 << 20) {
            Err(error) => {
                assert!(!error.kind.to_string().is_empty());
                refused += 1;
            }
            Ok(mut windows) => {
                let (width, height) = windows.size();
                let mut seeded = Seeded(3);
                for _ in 0..8 {
                    let (column, row) = (seeded.below(width), seeded.below(height));
                    let window = RasterWindow {
                        column,
                        row,
                        width: 64.min(width - column),
                        height: 64.min(height - row),
                    };
                    let _ = windows.read(window, &mut Vec::new());
                    assert!(windows.cached_bytes() <= 1 << 20);
                }
                for overview in windows.overviews().to_vec() {
                    let _ = windows.at_overview(&overview);
                }
                opened += 1;
            }
        }
    }
    assert!(opened > 0 && refused > 10, "{opened} opened, {refused} refused");
}

#[test]
fn every_byte_of_a_tiled_file_changed_in_turn_is_an_error_or_a_raster() {
    let full = Image::of(20, 18, hilly);
    let whole = file(&[full.halved(), full.halved().halved()], 16, Packing::Deflate);
    for at in 0..whole.len() {
        for value in [0, 1, 0x7f, 0xff] {
            let mut broken = whole.clone();
            broken[at] = value;
            let opened = GeoTiffWindows::open("a.tif", Cursor::new(&broken), &DemHints::default(), 1 << 16);
            if let Ok(mut windows) = opened {
                let (width, height) = windows.size();
                let window = RasterWindow { column: 0, row: 0, width: width.min(20), height: height.min(20) };
                let _ = windows.read(window, &mut Vec::new());
                for overview in windows.overviews().to_vec() {
                    let _ = windows.at_overview(&overview);
                }
            }
        }
    }
}

#[test]
fn whole_rows_that_are_stored_as_they_are_take_no_room_in_the_cache() {
    // One column of tiles, which is what strips are.
    for (side, packing, is_kept) in [(704, Packing::Plain, false), (704, Packing::Deflate, true)] {
        let bytes = file(&[Image::of(700, 900, hilly)], side, packing);
        let mut whole = read("a.tif", &bytes, &DemHints::default()).expect("sound");
        let open = || GeoTiffWindows::open("a.tif", Cursor::new(&bytes), &DemHints::default(), 64 << 20);
        let mut windows = open().expect("sound");
        let (mut found, mut wanted) = (Vec::new(), Vec::new());
        for window in RasterWindow::all((700, 900)).bands(333 * 700) {
            windows.read(window, &mut found).expect("sound");
            whole.read(window, &mut wanted).expect("in memory");
            assert!(bits(&found) == bits(&wanted), "{window:?}");
        }
        assert_eq!(windows.cached_bytes() > 0, is_kept);
        assert_windows_match(&mut windows, &mut whole, 5, "in any order");
    }
}

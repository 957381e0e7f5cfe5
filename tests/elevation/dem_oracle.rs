//! The elevation readers and the coordinate systems against GDAL and PROJ, on real files.
//!
//! `DEM_ORACLE.json` states what GDAL read of every file, `oracle/<name>.samples.csv` what it says at points of
//! each.

use crate::common::data;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::DVec2;
use sandtable_dem::formats::height_encoding::HeightEncoding;
use sandtable_dem::hints::{DemHints, DemOptions};
use sandtable_dem::read::read;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_raster::answer::Answer;
use sandtable_raster::error::DemError;
use sandtable_raster::raster::Raster;
use sandtable_raster::sample::{bilinear, nearest};
use sandtable_raster::stats::Stats;
use sandtable_raster::warp::to_metric;
use serde_json::Value;

/// How many files of the oracle are read; a change here is a format gained or lost.
const READ: usize = 86;

fn data() -> Option<PathBuf> {
    data::data("DEM_ORACLE.json")?.parent().map(Path::to_path_buf)
}

fn open(path: &Path) -> Result<Raster, DemError> {
    let bytes = fs::read(path).expect("a file of the test data");
    let companions = |name: &str| fs::read(name).ok();
    let hints = DemHints {
        companions: &companions,
        ..DemOptions { height_scale: Some(1.0), ..DemOptions::default() }.into()
    };
    read(&path.to_string_lossy(), &bytes, &hints)
}

fn oracle(folder: &Path) -> Vec<(String, Value)> {
    let text = fs::read_to_string(folder.join("DEM_ORACLE.json")).expect("the oracle");
    let root: Value = serde_json::from_str(&text).expect("the oracle is JSON");
    let files = root["dems"].as_array().expect("a list").iter();
    files
        .map(|entry| {
            let file = entry["file"].as_str().expect("a name").trim_start_matches("shared/").to_owned();
            (file, entry.clone())
        })
        .collect()
}

/// One line of a samples file.
struct Sample {
    at: DVec2,
    degrees: Option<DVec2>,
    nearest: f64,
    bilinear: f64,
}

fn samples(folder: &Path, file: &str, suffix: &str) -> Vec<Sample> {
    let path = folder.join(file);
    let name = path.file_name().expect("a file").to_string_lossy().into_owned();
    let csv = path.with_file_name(format!("oracle/{name}.{suffix}.csv"));
    let text = fs::read_to_string(&csv).unwrap_or_else(|error| panic!("{}: {error}", csv.display()));
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |name: &str| header.iter().position(|known| *known == name);
    let columns = ["x", "y", "lon", "lat", "nearest", "bilinear"].map(column);
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let [x, y, lon, lat, nearest, bilinear] =
                columns.map(|at| at.and_then(|at| cells[at].parse().ok()).unwrap_or(f64::NAN));
            let degrees = DVec2::new(lon, lat);
            Sample {
                at: DVec2::new(x, y),
                degrees: degrees.is_finite().then_some(degrees),
                nearest,
                bilinear,
            }
        })
        .collect()
}

fn number(entry: &Value, key: &str) -> Option<f64> {
    entry[key].as_f64().or_else(|| entry[key].as_str().and_then(|text| text.parse().ok()))
}

fn same(a: f64, b: f64, within: f64) -> bool {
    (a.is_nan() && b.is_nan()) || (a - b).abs() <= within
}

fn value(sampled: Answer) -> f64 {
    match sampled {
        Answer::Height(value) => value,
        Answer::NoData => f64::NAN,
        Answer::Outside => f64::INFINITY,
    }
}

#[test]
fn every_file_is_read_as_gdal_reads_it() {
    let Some(folder) = data() else { return };
    let files = oracle(&folder);
    for (file, entry) in &files {
        let raster = open(&folder.join(file)).unwrap_or_else(|error| panic!("{error}"));
        check_raster(file, &raster, entry);
    }
    assert_eq!(files.len(), READ);
}

fn check_raster(file: &str, raster: &Raster, entry: &Value) {
    assert_eq!(raster.driver, entry["driver"], "{file}");
    // GDAL takes the decimals of this file's no-data value for those of its samples.
    let whole = file == "dem/gdal_nodata_float.asc";
    assert_eq!(
        raster.data_type,
        if whole { "Int32" } else { entry["type"].as_str().unwrap_or("") },
        "{file}"
    );
    let size = [u64::from(raster.width), u64::from(raster.height)];
    assert_eq!(serde_json::json!(size), entry["size"], "{file}");
    let nodata = number(entry, "nodata");
    if let Some(wanted) = nodata {
        let ours = raster.nodata.unwrap_or(0.5);
        assert!(same(ours, wanted, 1e-15 * wanted.abs()), "{file}: no data is {ours}, GDAL {wanted}");
    }
    let (scale, offset) = (number(entry, "scale").unwrap_or(1.0), number(entry, "offset").unwrap_or(0.0));
    let stats = Stats::new(raster);
    assert_eq!(Some(stats.valid as u64), entry["valid"].as_u64(), "{file}");
    for (key, ours, factor, shift) in [
        ("min", stats.min, scale, offset),
        ("max", stats.max, scale, offset),
        ("mean", stats.mean, scale, offset),
        ("std", stats.std, scale, 0.0),
    ] {
        let wanted = number(entry, key).expect("a number") * factor + shift;
        assert!(same(ours, wanted, 1e-9 * wanted.abs().max(1.0)), "{file}: {key} {ours}, GDAL {wanted}");
    }
    check_place(file, raster, entry);
    if let Some(code) = entry["crs"].as_str().and_then(|name| name.strip_prefix("EPSG:")) {
        let ours = raster.crs.as_ref().and_then(Crs::epsg);
        assert_eq!(ours.map(|epsg| epsg.to_string()).as_deref(), Some(code), "{file}");
    }
}

fn check_place(file: &str, raster: &Raster, entry: &Value) {
    let Some(wanted) = entry["geotransform"].as_array() else { return };
    let ours = raster.geotransform();
    let mut wanted: Vec<f64> = wanted.iter().filter_map(Value::as_f64).collect();
    if raster.driver == "BT" {
        // VTP's reading of the extents, which is ours: nodes, not edges.
        let vtp = |key: &str| entry["vtp_convention"][key].as_f64().expect("a number");
        let (dx, dy) = (vtp("dx"), vtp("dy"));
        wanted = vec![vtp("left") - dx * 0.5, dx, 0.0, vtp("top") + dy * 0.5, 0.0, -dy];
    }
    let cell = wanted[1].abs().max(wanted[2].abs());
    for (ours, wanted) in ours.iter().zip(&wanted) {
        assert!(same(*ours, *wanted, 1e-9 * cell.max(wanted.abs())), "{file}: {ours} for {wanted}");
    }
    assert!(raster.georeferenced, "{file}");
}

#[test]
fn points_have_gdals_heights() {
    let Some(folder) = data() else { return };
    let mut points = 0;
    for (file, entry) in oracle(&folder) {
        if entry["geotransform"].is_null() {
            continue;
        }
        let raster = open(&folder.join(&file)).expect("readable");
        let (scale, offset) =
            (number(&entry, "scale").unwrap_or(1.0), number(&entry, "offset").unwrap_or(0.0));
        let suffix = if raster.driver == "BT" { "samples_vtp" } else { "samples" };
        for sample in samples(&folder, &file, suffix) {
            let wanted = sample.bilinear * scale + offset;
            let ours = value(bilinear(&raster, sample.at));
            assert!(same(ours, wanted, 1e-4), "{file} {}: {ours}, GDAL {wanted}", sample.at);
            if raster.driver == "BT" {
                // The VTP samples state no nearest value.
                points += 1;
                continue;
            }
            let hole = number(&entry, "nodata")
                .is_some_and(|wanted| same(sample.nearest, wanted, 1e-15 * wanted.abs()));
            let wanted = if hole { f64::NAN } else { sample.nearest * scale + offset };
            let ours = value(nearest(&raster, sample.at));
            assert!(same(ours, wanted, 0.0), "{file} {}: nearest {ours}, GDAL {wanted}", sample.at);
            points += 1;
        }
    }
    assert!(points > 7000, "only {points} points");
}

#[test]
fn every_system_agrees_with_proj_in_both_directions() {
    let Some(folder) = data() else { return };
    let (wgs84, mut checked) = (Crs::wgs84(), 0);
    for (file, _) in oracle(&folder) {
        let Ok(raster) = open(&folder.join(&file)) else { continue };
        let (Some(crs), "GTiff" | "AAIGrid" | "SRTMHGT") = (&raster.crs, raster.driver) else { continue };
        let mut worst: f64 = 0.0;
        for sample in samples(&folder, &file, "samples") {
            let Some(wanted) = sample.degrees else { continue };
            let ours = match crs.transform(&wgs84, sample.at) {
                Ok(ours) => ours,
                Err(CrsError::Datum { .. }) => {
                    assert!(matches!(crs.epsg(), Some(26711)), "{file}: {} is refused", crs.name());
                    continue;
                }
                Err(error) => panic!("{file}: {error}"),
            };
            let off = (ours - wanted) * DVec2::new(111_320.0 * wanted.y.to_radians().cos(), 111_320.0);
            worst = worst.max(off.length());
            let back = wgs84.transform(crs, ours).expect("where it came from");
            let meters = if crs.is_geographic() { 111_320.0 } else { crs.meters_per_unit() };
            assert!((back - sample.at).length() * meters < 1e-3, "{file}: {back} for {}", sample.at);
            checked += 1;
        }
        // Ten decimals of a degree are 11 micrometers. The equal-area systems differ by the authalic latitude,
        // whose short series the oracle's PROJ 9.1 still used.
        let allowed = match crs.name() {
            "EPSG:27700" => 0.01,
            // PROJ shifts NAD83(HARN) by the 0.9 m that the registry's proj strings leave out.
            name if name.starts_with("EPSG:2853") => 1.0,
            name if name == "EPSG:3035" || name.contains("+proj=laea") => 1e-3,
            _ => 1e-4,
        };
        assert!(worst <= allowed, "{file}: {} is {worst} m off", crs.name());
    }
    assert!(checked > 4900, "only {checked} points");
}

#[test]
fn packed_terrain_is_the_terrain_unpacked() {
    let Some(folder) = data() else { return };
    let plain = open(&folder.join("dem_formats/bt_f32.bt")).expect("readable");
    let packed = open(&folder.join("dem_formats/bt_f32.bt.gz")).expect("readable");
    assert_eq!(Stats::new(&plain), Stats::new(&packed));
    assert_eq!(packed.crs.and_then(|crs| crs.epsg()), Some(32612));
    assert_eq!(open(&folder.join("scenes/crater_lake_bt/crater_0513.btz")).expect("readable").width, 513);
}

#[test]
fn control_points_on_a_straight_map_give_the_place_of_the_twin_with_a_scale() {
    let Some(folder) = data() else { return };
    for kind in ["pixel_is_area", "pixel_is_point"] {
        let name = |tags: &str| folder.join(format!("dem/austrian_capitals_model_tie_{tags}_{kind}.tif"));
        let by_points = open(&name("points")).expect("readable");
        let by_scale = open(&name("point_and_pixel_scale")).expect("readable");
        for (ours, wanted) in by_points.geotransform().iter().zip(by_scale.geotransform()) {
            assert!((ours - wanted).abs() < 1e-6, "{kind}: {ours} for {wanted}");
        }
        assert_eq!(by_points.crs, by_scale.crs);
    }
}

/// Hostile files: whatever comes out, it comes soon and is not a panic.
#[test]
fn hostile_files_neither_panic_nor_hang_nor_take_the_memory() {
    let Some(folder) = data() else { return };
    let mut files = Vec::new();
    for part in
        ["tiff_fuzz", "tiff_gdal", "tiff_misc", "aaigrid_gdal", "png", "mutants", "dted_gdal", "usgsdem_gdal"]
    {
        list(&folder.join("broken").join(part), &mut files);
    }
    assert!(files.len() >= 180, "only {} files", files.len());
    let mut read = 0;
    for file in files {
        let start = Instant::now();
        match open(&file) {
            Ok(raster) => {
                read += 1;
                assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
        assert!(start.elapsed() < Duration::from_secs(5), "{} took {:?}", file.display(), start.elapsed());
    }
    assert!(read >= 15, "only {read} of the odd but valid files are read");
}

/// What GDAL reads of the odd files that are read: valid samples, lowest, highest, mean.
const ODD: [(&str, usize, f64, f64, f64); 11] = [
    ("usgsdem_gdal/022gdeme_truncated", 1201, 0.0, 127.0, 7.4712739383847),
    ("usgsdem_gdal/114p01_0100_deme_truncated.dem", 0, f64::NAN, f64::NAN, f64::NAN),
    ("usgsdem_gdal/39079G6_truncated.dem", 225, 325.0, 385.0, 353.69777777778),
    ("usgsdem_gdal/4619old_truncated.dem", 2402, -32000.0, 120.0, -10591.480432972),
    ("usgsdem_gdal/usgsdem_with_extra_values_at_end_of_profile.dem", 396, -1.0, 36.0, 4.1969696969697),
    ("dted_gdal/n43_bad_crc.dt0", 14641, 75.0, 460.0, 161.86189467933),
    ("dted_gdal/n43_sparse_cols.dt0", 242, 0.0, 0.0, 0.0),
    ("aaigrid_gdal/byte.tif.grd", 400, 74.0, 255.0, 126.765),
    ("mutants/zion_tail.bt", 19200, 1653.0, 2722.0, 2234.9378125),
    ("mutants/comma.asc", 4, 1.5, 4.5, 3.0),
    // GDAL 3.6 takes the decimal commas of this one for the ends of numbers.
    ("aaigrid_gdal/pixel_per_line_comma.asc", 180, f64::NAN, f64::NAN, f64::NAN),
];

/// Broken files, and what the refusal of each must say.
const BROKEN: [(&str, &str); 12] = [
    ("mutants/zion_magic.bt", "version '9.9'"),
    ("mutants/zion_hdronly.bt", "cannot be held"),
    ("mutants/zion_hdrcut.bt", "less than its header"),
    ("mutants/zion_cut.bt", "cannot be held"),
    ("mutants/zion_w0.bt", "0 columns"),
    ("mutants/zion_wneg.bt", "-5 columns"),
    ("mutants/zion_whuge.bt", "more than the"),
    ("mutants/zion_ds3.bt", "values of 3 bytes"),
    ("mutants/zion_ext.bt", "extents"),
    ("mutants/N43E007_short.hgt", "20000 bytes"),
    ("mutants/notacoord.hgt", "states its corner"),
    ("mutants/cell0.asc", "not of a positive size"),
];

#[test]
fn odd_files_are_read_as_gdal_reads_them_and_broken_ones_refused_for_a_reason() {
    let Some(folder) = data() else { return };
    for (file, valid, min, max, mean) in ODD {
        let stats =
            Stats::new(&open(&folder.join("broken").join(file)).unwrap_or_else(|error| panic!("{error}")));
        assert_eq!(stats.valid, valid, "{file}");
        for (ours, wanted) in [(stats.min, min), (stats.max, max), (stats.mean, mean)] {
            assert!(
                wanted.is_nan() || same(ours, wanted, 1e-9 * wanted.abs()),
                "{file}: {ours} for {wanted}"
            );
        }
    }
    for (file, wanted) in BROKEN {
        let error = open(&folder.join("broken").join(file)).expect_err(file).to_string();
        assert!(error.contains(wanted), "{file} is refused, but not for '{wanted}': {error}");
    }
}

#[test]
fn map_tiles_of_heights_are_the_model_that_they_were_made_of() {
    let Some(folder) = data() else { return };
    let wanted = open(&folder.join("dem_formats/f32_strip_none_nan.tif")).expect("readable");
    for (file, encoding, step) in [
        ("terrain_rgb.png", HeightEncoding::TerrainRgb, 0.1),
        ("terrarium.png", HeightEncoding::Terrarium, 1.0 / 256.0),
    ] {
        let bytes = fs::read(folder.join("dem_formats").join(file)).expect("a file of the test data");
        let hints = |height_encoding| {
            DemHints::from(DemOptions { height_encoding, cell: Some(30.0), ..DemOptions::default() })
        };
        let tile = read(file, &bytes, &hints(Some(encoding))).expect("a tile");
        assert_eq!((tile.width, tile.height), (wanted.width, wanted.height), "{file}");
        for (ours, wanted) in tile.samples.iter().zip(wanted.samples.iter()) {
            // Holes were written as 500 m below the sea.
            let wanted = if wanted.is_nan() { -500.0 } else { wanted };
            assert!((ours - wanted).abs() <= step, "{file}: {ours} for {wanted}");
        }
        let refused = read(file, &bytes, &hints(None)).expect_err("colors").to_string();
        assert!(refused.contains("terrain-rgb") && refused.contains("terrarium"), "{refused}");
    }
    let fuji = fs::read(folder.join("dem/fuji_terrain_rgb.png")).expect("a file of the test data");
    let hints = DemHints::from(DemOptions {
        height_encoding: Some(HeightEncoding::TerrainRgb),
        ..DemOptions::default()
    });
    let summit = Stats::new(&read("fuji.png", &fuji, &hints).expect("a tile")).max;
    assert!((3700.0..3800.0).contains(&summit), "Fuji is {summit} m high");
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    for entry in entries {
        let path = entry.expect("a folder that can be read").path();
        if path.is_dir() { list(&path, files) } else { files.push(path) }
    }
    files.sort();
}

/// Prefixes and flipped bytes of real files of every format.
#[test]
fn mutants_of_real_files_are_errors_or_rasters() {
    let Some(folder) = data() else { return };
    let mut state = 1u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % below
    };
    let hints = DemHints::from(DemOptions { height_scale: Some(1.0), ..DemOptions::default() });
    for name in [
        "i16_tiled_deflate_p2.tif",
        "cog_f32_overviews.tif",
        "i16_bigtiff_tiled.tif",
        "f32_mask.tif",
        "i16_packbits.tif",
        "f32_strip_lzw_p3.tif",
        "f32_two_bands_pixel.tif",
        "bt_f32.bt",
        "png16.png",
        "xllcenter.asc",
        "bt_f32.bt.gz",
        "usgs.dem",
        "terragen.ter",
        "surfer7.grd",
        "points.xyz",
        "../dem/n43.dt0",
    ] {
        let whole = fs::read(folder.join("dem_formats").join(name)).expect("a file of the test data");
        for round in 0..150 {
            let mut bytes = whole.clone();
            // Mostly where headers and tags are.
            let near = if round % 3 == 0 { bytes.len() } else { bytes.len().min(600) };
            for _ in 0..1 + round % 4 {
                bytes[random(near)] = random(256) as u8;
            }
            if round % 5 == 0 {
                bytes.truncate(random(whole.len()));
            }
            if let Ok(raster) = read(name, &bytes, &hints) {
                assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
            }
        }
    }
}

#[test]
fn a_grid_that_old_gdal_cannot_read_is_read() {
    let Some(folder) = data() else { return };
    let raster = open(&folder.join("dem/gdal_nodata_nan.asc")).expect("readable");
    let values: Vec<f64> = raster.samples.iter().collect();
    assert!(values[0].is_nan());
    assert_eq!(values[1..], [-1.0, 0.0, 1.0, 2.0, 3.0]);
}

#[test]
fn every_raster_with_a_place_comes_to_meters_or_is_refused_for_a_reason() {
    let Some(folder) = data() else { return };
    for (file, entry) in oracle(&folder) {
        let Ok(raster) = open(&folder.join(&file)) else { continue };
        let text = match to_metric(&raster, None) {
            Ok(metric) => {
                assert!(metric.is_north_up() && metric.crs.as_ref().is_none_or(Crs::is_metric), "{file}");
                let (before, after) = (Stats::new(&raster), Stats::new(&metric));
                let range = before.max - before.min;
                assert!(after.min >= before.min - 1e-9 && after.max <= before.max + 1e-9, "{file}");
                assert!((after.mean - before.mean).abs() <= 0.02 * range, "{file}: {before:?} {after:?}");
                let kept = after.valid as f64 / before.valid as f64;
                assert!((0.9..1.15).contains(&kept) || before.valid < 500, "{file}: {kept} of the samples");
                continue;
            }
            Err(error) => error.to_string(),
        };
        let wanted = match &file[..] {
            "dem/etopo1_1deg_global.tif" => "no UTM zone",
            "dem/boulder_SRTMGL3.asc"
            | "dem_formats/xllcenter.asc"
            | "dem_formats/crlf_tabs.asc"
            | "dem_formats/points.xyz"
            | "dem_formats/i16_no_crs_tfw.tif" => "EPSG:4326",
            _ if entry["geotransform"].is_null() => "cell",
            _ => panic!("{file} is refused: {text}"),
        };
        assert!(text.contains(wanted), "{file} is refused, but not for '{wanted}': {text}");
    }
}

#[test]
fn the_flagship_keeps_its_heights_on_the_way_to_utm() {
    let Some(folder) = data() else { return };
    let file = "scenes/swellendam_za/dem_srtm_wgs84_f32.tif";
    let raster = open(&folder.join(file)).expect("readable");
    let start = Instant::now();
    let metric = to_metric(&raster, None).expect("in one zone");
    println!(
        "{} x {} samples to {} x {} in {:?}",
        raster.width,
        raster.height,
        metric.width,
        metric.height,
        start.elapsed()
    );
    let utm = metric.crs.as_ref().expect("a zone");
    assert_eq!(utm.epsg(), Some(32734));
    let mut count = 0;
    for at in (0..metric.samples.len()).step_by(7) {
        let (column, row) = (at % metric.width as usize, at / metric.width as usize);
        let center = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
        let exact = utm.transform(&Crs::wgs84(), metric.map_from_grid.transform_point2(center));
        let wanted = value(bilinear(&raster, exact.expect("inside")));
        let ours = metric.samples.get(at);
        if wanted.is_finite() {
            // A parabola may stand in for the projection, and heights are kept in 32 bits.
            assert!((ours - wanted).abs() < 0.002, "({column}, {row}): {ours} for {wanted}");
            count += 1;
        }
    }
    assert!(count > 70_000, "{count} cells");
    let samples = samples(&folder, file, "samples");
    let inside = samples.iter().filter(|sample| {
        let at = Crs::wgs84().transform(utm, sample.at).expect("inside");
        matches!(bilinear(&*metric, at), Answer::Height(_))
    });
    assert!(inside.count() > 190, "the extent is kept");
}

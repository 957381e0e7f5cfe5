//! What is written comes back: through our own readers to the last bit, and through GDAL where that is installed.

use crate::common::scratch;
use crate::common::skip;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::{DAffine2, DMat2, DVec2};
use proptest::prelude::*;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::{DemHints, DemOptions};
use sandtable_dem::read::read;
use sandtable_dem::write::write;
use sandtable_dem::written::{WriteError, WrittenDem};
use sandtable_geom::crs::Crs;
use sandtable_raster::raster::{Raster, Samples};

use scratch::Scratch;

fn format(extension: &str) -> &'static DemFormat {
    DemFormat::to_write(extension).expect("a format that is written")
}

fn raster(width: u32, samples: Samples, crs: Option<&str>) -> Raster {
    let height = samples.len() as u32 / width;
    let in_degrees = crs.is_some_and(|crs| crs == "EPSG:4326");
    let (cell, corner) =
        if in_degrees { (0.25, DVec2::new(7.0, 44.0)) } else { (12.5, DVec2::new(5e5, 4e6)) };
    Raster {
        driver: "test",
        data_type: "Float32",
        width,
        height,
        samples,
        meters_per_z: 1.0,
        states_z_unit: false,
        map_from_grid: DAffine2 {
            matrix2: DMat2::from_diagonal(DVec2::new(cell, -cell)),
            translation: corner,
        },
        georeferenced: true,
        crs: crs.map(|crs| Crs::parse(crs).expect("known")),
        ..Raster::without_place(1, 1)
    }
}

fn back(name: &str, written: &WrittenDem, hints: DemHints) -> Raster {
    let stem = name.split('.').next().unwrap_or_default();
    let beside = |asked: &str| {
        let is = |extension: &str| asked == format!("{stem}.{extension}");
        written.companions.iter().find(|file| is(file.extension)).map(|file| file.bytes.clone())
    };
    let hints = DemHints { companions: &beside, ..hints };
    read(name, &written.bytes, &hints).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The bits of all samples; every NaN is the same.
fn bits(raster: &Raster) -> Vec<u64> {
    raster.samples.iter().map(|value| if value.is_nan() { f64::NAN } else { value }.to_bits()).collect()
}

#[track_caller]
fn assert_same(ours: &Raster, wanted: &Raster) {
    assert_eq!((ours.width, ours.height), (wanted.width, wanted.height));
    assert_eq!(std::mem::discriminant(&ours.samples), std::mem::discriminant(&wanted.samples));
    assert_eq!(bits(ours), bits(wanted));
    assert_eq!(ours.crs, wanted.crs);
    assert_eq!(ours.georeferenced, wanted.georeferenced);
    for (ours, wanted) in ours.geotransform().iter().zip(wanted.geotransform()) {
        assert!((ours - wanted).abs() <= 1e-12 * wanted.abs(), "{ours} for {wanted}");
    }
}

fn f32s() -> impl Strategy<Value = Vec<f32>> {
    let kinds = prop_oneof![
        3 => (-500i32..9000).prop_map(|value| value as f32),
        2 => -500f32..9000.0,
        1 => Just(f32::NAN),
        1 => any::<f32>().prop_filter("finite", |value| value.is_finite()),
        1 => Just(-9999.0),
        1 => Just(-0.0),
    ];
    prop_oneof![
        proptest::collection::vec(kinds, 12),
        proptest::collection::vec((0u16..).prop_map(f32::from), 12),
        proptest::collection::vec((i16::MIN..).prop_map(f32::from), 12),
    ]
}

fn f64s() -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![
        proptest::collection::vec(any::<i32>().prop_map(f64::from), 12),
        proptest::collection::vec(any::<u32>().prop_map(f64::from), 12),
        proptest::collection::vec(prop_oneof![-1e9..1e9, Just(f64::NAN), Just(-9999.0)], 12),
    ]
}

proptest! {
    #[test]
    fn a_geotiff_gives_every_raster_back_to_the_last_bit(narrow in f32s(), wide in f64s(), columns in 1u32..=4) {
        let width = [1, 2, 3, 4][columns as usize - 1];
        for samples in [Samples::F32(narrow), Samples::F64(wide)] {
            let one = raster(width, samples, Some("EPSG:32612"));
            let written = write(&one, format("tif"), "a").expect("every raster can be");
            assert_same(&back("a.tif", &written, DemHints::default()), &one);
        }
    }

    #[test]
    fn a_text_grid_gives_32_bit_heights_back_to_the_last_bit(values in f32s()) {
        let one = raster(4, Samples::F32(values), Some("EPSG:4326"));
        match write(&one, format("asc"), "a") {
            Ok(written) => assert_same(&back("a.asc", &written, DemHints::default()), &one),
            Err(error) => assert!(matches!(error, WriteError::NoDataTaken { .. }), "{error}"),
        }
    }

    #[test]
    fn a_terrain_gives_32_bit_heights_back_to_the_last_bit(values in f32s()) {
        let one = raster(3, Samples::F32(values), Some("EPSG:32612"));
        match write(&one, format("bt"), "a") {
            Ok(written) => assert_same(&back("a.bt", &written, DemHints::default()), &one),
            Err(error) => {
                assert!(matches!(error, WriteError::NoDataTaken { value: -32768.0, .. }), "{error}");
            }
        }
    }

    #[test]
    fn a_float_grid_gives_32_bit_heights_back_to_the_last_bit(values in f32s()) {
        let one = raster(3, Samples::F32(values), Some("EPSG:32612"));
        match write(&one, format("flt"), "a.flt") {
            Ok(written) => {
                assert_eq!((&*written.stored, written.notes.len()), ("float32", 0));
                assert_same(&back("a.flt", &written, DemHints::default()), &one);
            }
            Err(error) => assert!(matches!(error, WriteError::NoDataTaken { .. }), "{error}"),
        }
    }

    #[test]
    fn a_binary_grid_gives_integers_and_32_bit_floats_back_to_the_last_bit(narrow in f32s(), wide in f64s()) {
        for samples in [Samples::F32(narrow), Samples::F64(wide)] {
            let one = raster(3, samples, Some("EPSG:4326"));
            let written = match write(&one, format("bil"), "a.bil") {
                Ok(written) => written,
                Err(error) => {
                    assert!(matches!(error, WriteError::NoDataTaken { .. }), "{error}");
                    continue;
                }
            };
            let again = back("a.bil", &written, DemHints::default());
            if written.notes.is_empty() && again.samples.is_wide() == one.samples.is_wide() {
                assert_same(&again, &one);
            } else {
                assert_eq!((&*written.stored, one.samples.is_wide()), ("float32", true));
                let rounded = one.samples.iter().map(|value| f64::from(value as f32));
                assert!(again.samples.iter().zip(rounded).all(|(again, one)| again == one || one.is_nan() && again.is_nan()));
            }
        }
    }

    #[test]
    fn points_give_32_bit_heights_back_to_the_last_bit(values in f32s()) {
        let one = raster(4, Samples::F32(values), Some("EPSG:32612"));
        let written = write(&one, format("xyz"), "a.xyz").expect("every grid can be");
        assert_same(&back("a.xyz", &written, DemHints::default()), &one);
    }

    #[test]
    fn a_picture_gives_heights_back_to_half_a_step(values in proptest::collection::vec(-500f32..9000.0, 12)) {
        let mut values = values;
        values[5] = f32::NAN;
        let one = raster(4, Samples::F32(values), Some("EPSG:32612"));
        let written = write(&one, format("png"), "a").expect("some heights");
        let words: Vec<&str> = written.notes[0].split(' ').collect();
        let number = |at: usize| words[at].parse::<f64>().expect("a number");
        let hints = DemHints::from(DemOptions {
            height_scale: Some(number(4)),
            height_offset: Some(number(6)),
            ..DemOptions::default()
        });
        let again = back("a.png", &written, hints);
        assert_eq!(again.crs, one.crs);
        for (ours, wanted) in again.samples.iter().zip(one.samples.iter()) {
            let near = (ours - wanted).abs() <= 0.5001 * number(4);
            prop_assert!(near || (ours.is_nan() && wanted.is_nan()), "{ours} for {wanted}");
        }
    }
}

/// A raster of more than one tile, with holes, whose heights are no integers.
fn hills(crs: &str) -> Raster {
    let value = |i: u32| {
        let (x, y) = (f64::from(i % 300), f64::from(i / 300));
        if i.is_multiple_of(97) {
            f32::NAN
        } else {
            (800.0 + 90.0 * (x / 31.0).sin() + 70.0 * (y / 23.0).cos()) as f32
        }
    };
    raster(300, Samples::F32((0..300 * 270).map(value).collect()), Some(crs))
}

#[test]
fn systems_with_and_without_a_code_come_back_as_they_were() {
    for crs in [
        "EPSG:32612",
        "EPSG:27700",
        "EPSG:2853 +to_meter=0.3048006096012192",
        "+proj=lcc +lat_1=36.5 +lat_2=34.25 +lat_0=33.75 +k_0=1 +lon_0=-79 +x_0=609601.22 +y_0=0 +datum=NAD83 +to_meter=1",
        "+proj=tmerc +lat_0=10 +lon_0=20 +k=0.9999 +x_0=1000 +y_0=0 +ellps=intl +towgs84=-87,-98,-121 +units=m",
        "+proj=sinu +lon_0=0 +datum=WGS84 +units=m",
        "+proj=longlat +ellps=intl +towgs84=-87,-98,-121",
    ] {
        let one = raster(2, Samples::F32(vec![1.0, 2.0, 3.0, 4.0]), Some(crs));
        let written = write(&one, format("tif"), "a").expect("every raster can be");
        assert_same(&back("a.tif", &written, DemHints::default()), &one);
    }
}

#[test]
fn feet_the_vertical_datum_and_a_turned_place_come_back() {
    let mut one = hills("EPSG:32612");
    one.meters_per_z = 0.3048;
    one.vertical_datum = Some("NAVD88".into());
    one.map_from_grid = DAffine2 {
        matrix2: DMat2::from_cols(DVec2::new(9.0, 3.0), DVec2::new(3.0, -9.0)),
        translation: DVec2::new(5e5, 4e6),
    };
    for datum in ["NAVD88", "EPSG:9999", "the harbour's gauge"] {
        one.vertical_datum = Some(datum.into());
        let again = back("a.tif", &write(&one, format("tif"), "a").expect("it can be"), DemHints::default());
        assert_same(&again, &one);
        assert_eq!((again.meters_per_z, again.vertical_datum.as_deref()), (0.3048, Some(datum)));
    }
}

#[test]
fn a_tile_is_written_under_its_own_name_alone() {
    let mut one = raster(1201, Samples::F32(vec![7.0; 1201 * 1201]), Some("EPSG:4326"));
    let cell = 1.0 / 1200.0;
    one.map_from_grid = DAffine2 {
        matrix2: DMat2::from_diagonal(DVec2::new(cell, -cell)),
        translation: DVec2::new(7.0 - cell / 2.0, 44.0 + cell / 2.0),
    };
    let written = write(&one, format("hgt"), "n43e007").expect("a tile");
    assert_same(&back("N43E007.hgt", &written, DemHints::default()), &one);
    let refused = write(&one, format("hgt"), "N44E007").expect_err("another tile");
    assert_eq!(refused, WriteError::Name("N43E007".into()));
    one.map_from_grid.translation.x += 0.3;
    assert!(matches!(write(&one, format("hgt"), "N43E007"), Err(WriteError::Shape { .. })));
}

#[test]
fn what_a_format_cannot_hold_is_refused_with_what_can() {
    let mut one = raster(2, Samples::F32(vec![-32768.0, 2.0, 3.0, 4.0]), Some("EPSG:32612"));
    assert!(matches!(write(&one, format("bt"), "a"), Err(WriteError::NoDataTaken { .. })));
    one.map_from_grid.matrix2.y_axis.x = 5.0;
    for format in [format("asc"), format("bt"), format("flt"), format("xyz"), format("hgt"), format("dt1")] {
        let refused = write(&one, format, "a").expect_err("askew").to_string();
        assert!(refused.contains("GeoTIFF"), "{refused}");
    }
    one.georeferenced = false;
    for format in [format("asc"), format("flt"), format("xyz"), format("dt1")] {
        assert!(matches!(write(&one, format, "a"), Err(WriteError::NoPlace(_))));
    }
    one.samples = Samples::F32(vec![f32::NAN; 4]);
    assert_eq!(write(&one, format("png"), "a"), Err(WriteError::Empty));
    let row = raster(4, Samples::F32(vec![1.0, 2.0, 3.0, 4.0]), Some("EPSG:32612"));
    assert!(matches!(write(&row, format("xyz"), "a.xyz"), Err(WriteError::Shape { .. })));
    let high = raster(2, Samples::F64(vec![1e300, 2.0]), Some("EPSG:32612"));
    for name in ["a.flt", "a.bil"] {
        assert!(matches!(write(&high, format("flt"), name), Err(WriteError::OutOfRange { .. })));
    }
}

#[test]
fn what_a_format_rounds_or_leaves_open_is_told() {
    let third = raster(2, Samples::F64(vec![1.0 / 3.0, 2.0, 3.0, f64::NAN]), Some("EPSG:32612"));
    for name in ["a.flt", "a.bil"] {
        let written = write(&third, format("bil"), name).expect("rounded");
        assert_eq!(written.notes, ["heights are rounded to 32-bit floats"]);
    }
    let written = write(&third, format("xyz"), "a.xyz").expect("a grid");
    assert_eq!(written.notes, ["1 of 4 points have no data, written as nan"]);
}

#[test]
fn cells_that_are_not_square_come_back() {
    let mut one = raster(3, Samples::F32(vec![1.0, 2.5, 3.0, 4.0, 5.0, 6.0]), Some("EPSG:32612"));
    one.map_from_grid.matrix2.y_axis.y = -6.25;
    for name in ["a.flt", "a.bil", "a.xyz"] {
        let written = write(&one, format(name.rsplit('.').next().expect("named")), name).expect("a grid");
        assert_same(&back(name, &written, DemHints::default()), &one);
    }
}

#[test]
fn rows_from_south_to_north_are_mirrored_where_a_format_has_north_up() {
    let upright = raster(2, Samples::F32(vec![1.0, 2.0, 3.0, 4.0]), Some("EPSG:32612"));
    let mut mirrored = raster(2, Samples::F32(vec![3.0, 4.0, 1.0, 2.0]), Some("EPSG:32612"));
    mirrored.map_from_grid.translation.y = upright.extent().min.y;
    mirrored.map_from_grid.matrix2.y_axis.y *= -1.0;
    for format in [format("asc"), format("bt"), format("flt"), format("xyz")] {
        let [one, other] = [&upright, &mirrored].map(|raster| write(raster, format, "a").expect("written"));
        assert!(one.bytes == other.bytes, "{}", format.name);
    }
}

/// What `gdalinfo -json -stats` says of a file.
fn gdalinfo(path: &Path) -> serde_json::Value {
    let ran = Command::new("gdalinfo").args(["-json", "-stats"]).arg(path).output().expect("it is installed");
    assert!(ran.status.success(), "{}: {}", path.display(), String::from_utf8_lossy(&ran.stderr));
    assert_eq!(String::from_utf8_lossy(&ran.stderr), "", "{}", path.display());
    serde_json::from_slice(&ran.stdout).expect("JSON")
}

fn gdal_is_there() -> bool {
    let is_there = Command::new("gdalinfo").arg("--version").output().is_ok();
    if !is_there {
        skip::skipped("gdalinfo is not installed");
    }
    is_there
}

fn put(scratch: &Scratch, name: &str, written: &WrittenDem) -> PathBuf {
    for companion in &written.companions {
        let stem = name.split('.').next().unwrap_or_default();
        scratch.write(&format!("{stem}.{}", companion.extension), &companion.bytes);
    }
    scratch.write(name, &written.bytes)
}

#[test]
fn gdal_reads_what_is_written_as_we_do() {
    if !gdal_is_there() {
        return;
    }
    for (crs, wanted) in [
        ("EPSG:32612", "ID[\"EPSG\",32612]"),
        ("EPSG:27700", "ID[\"EPSG\",27700]"),
        (
            "+proj=lcc +lat_1=36.5 +lat_2=34.25 +lat_0=33.75 +lon_0=-79 +x_0=609601.22 +datum=NAD83",
            "Lambert Conic Conformal (2SP)",
        ),
        ("+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=30 +datum=WGS84", "Polar Stereographic (variant B)"),
        (
            "+proj=tmerc +lat_0=10 +lon_0=20 +k=0.9999 +x_0=1000 +ellps=intl +towgs84=-87,-98,-121",
            "Transverse Mercator",
        ),
    ] {
        let one = hills(crs);
        for name in ["a.tif", "a.asc", "a.bt", "a.flt", "a.bil"] {
            let extension = name.rsplit('.').next().expect("named");
            // A folder for each: GDAL leaves statistics of one file beside it, for all of its stem.
            let scratch = Scratch::new();
            let file = put(&scratch, name, &write(&one, format(extension), name).expect("it can be"));
            let said = gdalinfo(&file);
            assert_eq!(said["size"], serde_json::json!([300, 270]), "{name}");
            let wkt = said["coordinateSystem"]["wkt"].as_str().expect("a system");
            assert!(wkt.contains(wanted), "{name} of {crs}: {wkt}");
            let stats = sandtable_raster::stats::Stats::new(&one);
            let band = &said["bands"][0];
            let metadata = &band["metadata"][""];
            // Some drivers keep statistics in files of their own, others in the metadata.
            let number = |key: &str, field: &str| {
                let stated = metadata[key].as_str().and_then(|text| text.parse::<f64>().ok());
                stated.or_else(|| band[field].as_f64()).expect(key)
            };
            assert!((number("STATISTICS_MEAN", "mean") - stats.mean).abs() < 1e-3, "{name}");
            assert!((number("STATISTICS_MINIMUM", "minimum") - stats.min).abs() < 1e-3, "{name}");
            let valid = 100.0 * stats.valid as f64 / one.samples.len() as f64;
            assert!((number("STATISTICS_VALID_PERCENT", "") - valid).abs() < 0.1, "{name}");
            if name != "a.bt" {
                // GDAL takes a terrain's extents for outer edges, VTP for nodes.
                for (at, wanted) in one.geotransform().iter().enumerate() {
                    assert!(
                        (said["geoTransform"][at].as_f64().expect("a number") - wanted).abs() < 1e-6,
                        "{name}"
                    );
                }
            }
        }
    }
}

/// Every way of storing that GDAL's users meet reads as the plain file does.
#[test]
fn whatever_way_gdal_stores_a_raster_it_reads_the_same() {
    if !gdal_is_there() {
        return;
    }
    let scratch = Scratch::new();
    let plain =
        put(&scratch, "plain.tif", &write(&hills("EPSG:32612"), format("tif"), "plain").expect("it can be"));
    let wanted = open(&plain);
    let mut count = 0;
    for packing in ["NONE", "DEFLATE", "LZW", "PACKBITS", "ZSTD"] {
        let predictors: &[u8] = if matches!(packing, "NONE" | "PACKBITS") { &[1] } else { &[1, 2, 3] };
        for predictor in predictors {
            for layout in
                [&["TILED=YES", "BLOCKXSIZE=64", "BLOCKYSIZE=32"][..], &["BLOCKYSIZE=7"], &["BIGTIFF=YES"]]
            {
                for order in ["LITTLE", "BIG"] {
                    // GDAL's own reading of its floating-point differences in big-endian files is at odds with itself.
                    if order == "BIG" && *predictor == 3 {
                        continue;
                    }
                    let mut options = vec![format!("COMPRESS={packing}"), format!("ENDIANNESS={order}")];
                    options.extend(layout.iter().map(|option| (*option).to_owned()));
                    if *predictor > 1 {
                        options.push(format!("PREDICTOR={predictor}"));
                    }
                    count += usize::from(translated(&scratch, &plain, &options, &[], &wanted));
                }
            }
        }
    }
    for bands in ["PIXEL", "BAND"] {
        for packing in ["NONE", "DEFLATE", "LZW"] {
            let options = [format!("INTERLEAVE={bands}"), format!("COMPRESS={packing}"), "TILED=YES".into()];
            count += usize::from(translated(
                &scratch,
                &plain,
                &options,
                &["-b", "1", "-b", "1", "-b", "1"],
                &wanted,
            ));
        }
    }
    assert!(count >= 40, "only {count} ways");
}

/// Integers of every width and both signs, and floats of three widths.
#[test]
fn every_type_of_number_reads_the_same() {
    if !gdal_is_there() {
        return;
    }
    let scratch = Scratch::new();
    let whole =
        raster(70, Samples::F32((0..70 * 50).map(|i| (i % 120) as f32).collect()), Some("EPSG:32612"));
    let plain = put(&scratch, "plain.tif", &write(&whole, format("tif"), "plain").expect("it can be"));
    let mut count = 0;
    for number in
        ["Byte", "Int8", "UInt16", "Int16", "UInt32", "Int32", "UInt64", "Int64", "Float32", "Float64"]
    {
        for (packing, predictor) in [("NONE", 1), ("DEFLATE", 1), ("DEFLATE", 2), ("LZW", 2)] {
            for order in ["LITTLE", "BIG"] {
                let mut options = vec![
                    format!("COMPRESS={packing}"),
                    format!("ENDIANNESS={order}"),
                    "TILED=YES".into(),
                    "BLOCKXSIZE=32".into(),
                    "BLOCKYSIZE=16".into(),
                ];
                options.extend((predictor == 2).then(|| "PREDICTOR=2".to_owned()));
                count += usize::from(translated(&scratch, &plain, &options, &["-ot", number], &whole));
            }
        }
    }
    // 16-bit floats hold integers up to 2048.
    let half = ["COMPRESS=DEFLATE".to_owned(), "NBITS=16".into()];
    count += usize::from(translated(&scratch, &plain, &half, &["-ot", "Float32"], &whole));
    assert!(count >= 50, "only {count} ways");
}

fn open(path: &Path) -> Raster {
    let bytes = std::fs::read(path).expect("it was written");
    let beside = |name: &str| std::fs::read(path.with_file_name(name)).ok();
    let hints = DemHints { companions: &beside, ..DemHints::default() };
    read(&path.file_name().expect("named").to_string_lossy(), &bytes, &hints)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Stores `plain` another way and compares; false where this GDAL does not know the way.
fn translated(scratch: &Scratch, plain: &Path, options: &[String], more: &[&str], wanted: &Raster) -> bool {
    let file = scratch.at("other.tif");
    let mut command = Command::new("gdal_translate");
    command.args(["-q"]).args(more);
    for option in options {
        command.args(["-co", option]);
    }
    let ran = command.arg(plain).arg(&file).output().expect("it is installed");
    if !ran.status.success() {
        return false;
    }
    let ours = open(&file);
    assert!(bits(&ours) == bits(wanted), "{options:?} {more:?}");
    assert_eq!(ours.geotransform(), wanted.geotransform());
    true
}

#[test]
fn a_mask_beside_a_file_hides_as_one_within_does() {
    if !gdal_is_there() {
        return;
    }
    let scratch = Scratch::new();
    let plain =
        put(&scratch, "plain.tif", &write(&hills("EPSG:32612"), format("tif"), "plain").expect("it can be"));
    let wanted = open(&plain);
    for (name, inside) in [("inside.tif", "YES"), ("beside.tif", "NO")] {
        let file = scratch.at(name);
        let ran = Command::new("gdal_translate")
            .args([
                "-q",
                "-mask",
                "mask,1",
                "-a_nodata",
                "none",
                "--config",
                "GDAL_TIFF_INTERNAL_MASK",
                inside,
            ])
            .arg(&plain)
            .arg(&file)
            .output()
            .expect("it is installed");
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
        assert_eq!(scratch.names().contains(&format!("{name}.msk")), inside == "NO");
        assert!(bits(&open(&file)) == bits(&wanted), "{name}");
    }
}

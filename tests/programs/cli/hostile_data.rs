//! Data that was once misread in silence: what it says is told, or it is refused.

use glam::{DAffine2, DVec2};
use sandtable::Crs;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::write::write;
use sandtable_raster::raster::{Raster, Samples};

use crate::cli::{project, run_in};
use crate::common::scratch::Scratch;

/// A GeoTIFF of 20 × 20 samples 30 m apart that begins some meters east of the others, with heights above `datum`.
fn tile(datum: Option<&str>, east_m: f64, height: f32) -> Vec<u8> {
    let corner = DVec2::new(700_000.0 + east_m, 4_000_000.0);
    let raster = Raster {
        crs: Some(Crs::from_epsg(32616).expect("a zone")),
        map_from_grid: DAffine2::from_cols(DVec2::new(30.0, 0.0), DVec2::new(0.0, -30.0), corner),
        georeferenced: true,
        vertical_datum: datum.map(str::to_owned),
        ..Raster::new(20, Samples::F32(vec![height; 400]))
    };
    write(&raster, DemFormat::to_write("tif").expect("a GeoTIFF"), "a").expect("written").bytes
}

#[test]
fn tiles_from_different_zeros_are_joined_with_a_word_or_not_at_all() {
    let scratch = Scratch::new();
    for (name, datum, east_m) in [
        ("egm.tif", Some("EGM96 geoid"), 0.0),
        ("unstated.tif", None, 600.0),
        ("navd.tif", Some("NAVD88"), 600.0),
    ] {
        scratch.write(name, tile(datum, east_m, 100.0));
    }
    let join =
        |other: &str| run_in(scratch.folder(), &["dem", "convert", "egm.tif", other, "-o", "joined.tif"]);
    let said = join("navd.tif").failed(1);
    assert!(said.contains("EGM96 geoid") && said.contains("NAVD88"), "{said}");
    assert!(!scratch.at("joined.tif").exists());
    let told = join("unstated.tif").ok();
    assert!(
        told.contains("1 of them state no vertical datum and are taken to be above EGM96 geoid"),
        "{told}"
    );
    // The datum of the one is that of the result.
    let about = run_in(scratch.folder(), &["dem", "info", "joined.tif"]).ok();
    assert!(about.contains("40 columns, 20 rows") && about.contains("EGM96 geoid"), "{about}");
}

#[test]
fn a_road_with_exchanged_axes_makes_its_scene_wrong() {
    let scratch = Scratch::new();
    scratch.write("base.tif", tile(None, 0.0, 100.0));
    let zone = Crs::from_epsg(32616).expect("a zone");
    let swapped = [100.0, 400.0].map(|off_m| {
        let place = zone.transform(&Crs::wgs84(), DVec2::new(700_000.0 + off_m, 4_000_000.0 - off_m));
        let place = place.expect("on Earth");
        [place.y, place.x]
    });
    let road = format!("{{\"type\":\"LineString\",\"coordinates\":{swapped:?}}}");
    scratch.write("swapped.geojson", road);
    scratch.write("swapped.toml", "[terrain]\ndem = \"base.tif\"\n[[road]]\nfile = \"swapped.geojson\"\n");
    let ran = run_in(scratch.folder(), &["check", "swapped.toml"]);
    assert_eq!((ran.code, ran.err.as_str()), (1, ""), "{ran:?}");
    for wanted in
        ["swapped.toml:4:8: error[axes-swapped]: ", "[latitude, longitude]", "swapped.toml is wrong"]
    {
        assert!(ran.out.contains(wanted), "{wanted}: {}", ran.out);
    }
}

#[test]
fn points_that_are_no_grid_are_refused_whatever_their_numbers() {
    let scratch = Scratch::new();
    for far in ["375121249879465922", "-9e300", "1.7976931348623157e308", "nan", "1e999"] {
        // Steps of a few thousandths, as of degrees, and one point very far away.
        let text =
            format!("-113.13 37.406 1873\n-113.1266667 37.4093333 1891\n440870 {far} 37.4\n-1e308 0 1\n");
        scratch.write("points.xyz", text);
        let said = run_in(scratch.folder(), &["dem", "info", "points.xyz"]).failed(1);
        assert!(said.contains("points.xyz: ") && said.contains("; "), "{far}: {said}");
    }
}

#[test]
fn blocks_of_a_tiff_that_were_never_written_are_0_or_no_data() {
    // Two gigabytes by its header, written by GDAL with SPARSE_OK: 64-bit floats in 16 tiles, none of which is there.
    let file = project("tests/programs/cli/sparse16k.tif");
    let scratch = Scratch::new();
    let height = |file: &str| run_in(scratch.folder(), &["height", file, "--at", "700100,3999000"]);
    assert!(height(&file).ok().ends_with("\n700100,3999000,0,Ok\n"));
    // With a value for no data, nothing is there at all.
    let mut bytes = std::fs::read(&file).expect("a file of the project");
    add_nodata(&mut bytes);
    scratch.write("void.tif", &bytes);
    let said = height("void.tif").failed(1);
    assert!(said.contains("void.tif") && said.contains("all of it is no data"), "{said}");
}

/// Adds the tag GDAL_NODATA with the value 0 to the directory of a little-endian TIFF, which moves to the file's end.
fn add_nodata(file: &mut Vec<u8>) {
    let at = u32::from_le_bytes(file[4..8].try_into().expect("four bytes")) as usize;
    let count = u16::from_le_bytes(file[at..at + 2].try_into().expect("two bytes"));
    let entries = file[at + 2..at + 2 + 12 * usize::from(count)].to_vec();
    let start = file.len() as u32;
    file.extend((count + 1).to_le_bytes());
    file.extend(entries);
    file.extend(42113u16.to_le_bytes());
    file.extend(2u16.to_le_bytes());
    file.extend(2u32.to_le_bytes());
    file.extend(*b"0\0\0\0");
    file.extend([0; 4]);
    file[4..8].copy_from_slice(&start.to_le_bytes());
}

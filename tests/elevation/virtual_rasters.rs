//! Virtual rasters, as `gdalbuildvrt` writes them, are their tiles joined: in memory, in windows, in scenes.

use glam::{DAffine2, DMat2, DVec2};
use sandtable::dem::formats::DemFormat;
use sandtable::dem::raster::{Raster, Samples};
use sandtable::dem::read::DemOptions;
use sandtable::dem::windows::{RasterWindow, Windows};
use sandtable::dem::write::write;
use sandtable::geom::crs::Crs;
use sandtable::message::chain::error_text;
use sandtable::pipeline::dem::{OpenedDem, open, open_either};
use sandtable::pipeline::scene_file::build_scene_text;

use crate::common::scratch::Scratch;

/// Sixty by forty posts from column `west` on, 20 m apart, all raised by `raised`.
fn tile(west: u32, raised: f32) -> Raster {
    let height = |index: u32| match (index % 60 + west, index / 60) {
        (70, 20) => -9999.0,
        (column, row) => raised + (column * 3 + row * 7 % 50) as f32,
    };
    let matrix2 = DMat2::from_diagonal(DVec2::new(20.0, -20.0));
    let translation = DVec2::new(500_000.0 + 20.0 * f64::from(west), 4_100_000.0);
    Raster {
        map_from_grid: DAffine2 { matrix2, translation },
        georeferenced: true,
        crs: Some(Crs::from_epsg(32616).expect("known")),
        ..Raster::new(60, Samples::F32((0..60 * 40).map(height).collect()))
    }
}

/// Two tiles that share ten columns, of which the second, a meter higher, lies over the first.
fn scratch() -> Scratch {
    let scratch = Scratch::new();
    let format = DemFormat::to_write("tif").expect("written");
    for (name, tile) in [("vrt/tiles/w.tif", tile(0, 0.0)), ("vrt/tiles/e.tif", tile(50, 1.0))] {
        scratch.write(name, write(&tile, format, "a").expect("it has a place").bytes);
    }
    let source = |file: &str, column: u32| {
        format!(
            "    <ComplexSource>\n      <SourceFilename relativeToVRT=\"1\">{file}</SourceFilename>\n      <SourceBand>1</SourceBand>\n      \
             <SourceProperties RasterXSize=\"60\" RasterYSize=\"40\" DataType=\"Float32\" BlockXSize=\"60\" BlockYSize=\"34\" />\n      \
             <SrcRect xOff=\"0\" yOff=\"0\" xSize=\"60\" ySize=\"40\" />\n      \
             <DstRect xOff=\"{column}\" yOff=\"0\" xSize=\"60\" ySize=\"40\" />\n      <NODATA>-9999</NODATA>\n    </ComplexSource>\n"
        )
    };
    let text = format!(
        "<VRTDataset rasterXSize=\"110\" rasterYSize=\"40\">\n  <SRS dataAxisToSRSAxisMapping=\"1,2\">PROJCS[\"x\"]</SRS>\n  \
         <GeoTransform>  5.0000000000000000e+05,  2.0000000000000000e+01,  0.0000000000000000e+00,  4.1000000000000000e+06,  \
         0.0000000000000000e+00, -2.0000000000000000e+01</GeoTransform>\n  <VRTRasterBand dataType=\"Float32\" band=\"1\">\n    \
         <NoDataValue>-9999</NoDataValue>\n    <ColorInterp>Gray</ColorInterp>\n{}{}  </VRTRasterBand>\n</VRTDataset>\n",
        source("tiles/w.tif", 0),
        source("tiles/e.tif", 50)
    );
    scratch.write("vrt/a.vrt", text);
    scratch
}

#[test]
fn a_virtual_raster_is_its_tiles_joined_the_last_over_the_first() {
    let scratch = scratch();
    let joined =
        open(&scratch.at("vrt/a.vrt"), &DemOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let mut whole = joined.raster;
    assert_eq!((joined.tiles, whole.size()), (2, (110, 40)));
    assert_eq!([whole.at(49, 3), whole.at(55, 3), whole.at(109, 3)], [168.0, 187.0, 349.0]);
    assert!(whole.at(70, 20).is_nan(), "no data by the virtual raster alone");
    let opened = open_either(&scratch.at("vrt/a.vrt"), &DemOptions::default(), 0);
    let Ok(OpenedDem::Windows(mut windows)) = opened else { panic!("read whole") };
    let all = RasterWindow::all((110, 40));
    let bits = |samples: Samples| samples.iter().map(f64::to_bits).collect::<Vec<_>>();
    let (windowed, whole) = (windows.samples(all).expect("there"), whole.samples(all).expect("in memory"));
    assert_eq!(bits(windowed), bits(whole));
}

#[test]
fn a_scene_names_a_virtual_raster_and_may_read_its_tiles_alone() {
    let scratch = scratch();
    let scene = |dem: &str| {
        let text = format!("[terrain]\ndem = \"{dem}\"\n");
        build_scene_text(&scratch.at("vrt/a.toml"), &text, &[], &|_| ()).map_err(|error| error_text(&error))
    };
    let built = scene("a.vrt").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((built.lattice.columns(), built.lattice.rows()), (110, 40));
    assert!(built.notes().iter().any(|note| note.contains("2 tiles joined")), "{:?}", built.notes());
    let built = scene("tiles/").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((built.lattice.columns(), built.lattice.rows()), (110, 40), "a folder is its tiles");
    scratch.write("vrt/empty/a.txt", "");
    let refused = scene("empty").err().expect("no tiles");
    assert!(refused.contains("a folder without elevation"), "{refused}");
    let vrt = std::fs::read_to_string(scratch.at("vrt/a.vrt")).expect("written");
    scratch.write("vrt/out.vrt", vrt.replace("tiles/w.tif", "../../../../../etc/passwd"));
    let refused = scene("out.vrt").err().expect("outside");
    assert!(refused.contains("leads to") && refused.contains("--allow"), "{refused}");
    scratch.write("vrt/cut.vrt", vrt.replace("rasterXSize=\"110\"", "rasterXSize=\"100\""));
    let refused = scene("cut.vrt").err().expect("cropped");
    assert!(
        refused.contains("100 x 40 samples of tiles that span 110 x 40")
            && refused.contains("gdal_translate"),
        "{refused}"
    );
}

//! Virtual rasters, as `gdalbuildvrt` writes them, are their tiles joined: in memory, in windows, in scenes.

use glam::{DAffine2, DMat2, DVec2};
use sandtable_base::message::chain::error_text;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemOptions;
use sandtable_dem::write::write;
use sandtable_geom::crs::Crs;
use sandtable_query::dem::{OpenedDem, open, open_either};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};
use sandtable_scene::scene_file::build_scene_text;

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
    let built = scene("cut.vrt").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((built.lattice.columns(), built.lattice.rows()), (100, 40), "what lies beyond is cut off");
    scratch.write("vrt/wide.vrt", vrt.replace("rasterXSize=\"110\"", "rasterXSize=\"120\""));
    let built = scene("wide.vrt").unwrap_or_else(|error| panic!("{error}"));
    let source = built.heights.snapshot().source().clone();
    assert_eq!(source.size(), (120, 40), "what no tile covers is no data");
    assert!(source.at(109, 3) == 349.0 && source.at(110, 3).is_nan());
    scratch.write("vrt/moved.vrt", vrt.replace("5.0000000000000000e+05", "5.0000700000000000e+05"));
    let refused = scene("moved.vrt").err().expect("another place");
    assert!(
        refused.contains("another place than its tiles") && refused.contains("gdal_translate"),
        "{refused}"
    );
}

/// A virtual raster of `columns` × `rows` cells of `cell` meters, of tiles by name, source rectangle and target rectangle.
fn written(
    (columns, rows): (u32, u32),
    (west, north, cell): (f64, f64, f64),
    tiles: &[(&str, [f64; 4], [f64; 4])],
) -> String {
    let rect = |[x, y, width, height]: [f64; 4]| {
        format!("xOff=\"{x}\" yOff=\"{y}\" xSize=\"{width}\" ySize=\"{height}\"")
    };
    let source = |(file, from, to): &(&str, [f64; 4], [f64; 4])| {
        format!(
            "<ComplexSource><SourceFilename relativeToVRT=\"1\">{file}</SourceFilename><SourceBand>1</SourceBand>\
             <SrcRect {}/><DstRect {}/><NODATA>-9999</NODATA></ComplexSource>",
            rect(*from),
            rect(*to)
        )
    };
    format!(
        "<VRTDataset rasterXSize=\"{columns}\" rasterYSize=\"{rows}\"><GeoTransform>{west}, {cell}, 0, {north}, 0, -{cell}\
         </GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\"><NoDataValue>-9999</NoDataValue>{}</VRTRasterBand>\
         </VRTDataset>",
        tiles.iter().map(source).collect::<String>()
    )
}

#[test]
fn tiles_are_cropped_and_brought_to_the_samples_of_the_virtual_raster() {
    let scratch = scratch();
    let whole = [0.0, 0.0, 60.0, 40.0];
    // As `gdalbuildvrt -te` writes it, the last tile over the first.
    let cropped = written(
        (80, 30),
        (500_200.0, 4_099_900.0, 20.0),
        &[
            ("tiles/w.tif", [10.0, 5.0, 50.0, 30.0], [0.0, 0.0, 50.0, 30.0]),
            ("tiles/e.tif", [0.0, 5.0, 40.0, 30.0], [40.0, 0.0, 40.0, 30.0]),
        ],
    );
    scratch.write("vrt/te.vrt", cropped);
    // As `gdalbuildvrt -resolution user -tr 10 10` and `gdal_translate -outsize 40 25` do.
    let finer = written(
        (220, 80),
        (500_000.0, 4_100_000.0, 10.0),
        &[("tiles/w.tif", whole, [0.0, 0.0, 120.0, 80.0]), ("tiles/e.tif", whole, [100.0, 0.0, 120.0, 80.0])],
    );
    scratch.write("vrt/finer.vrt", finer);
    let coarser =
        written((40, 25), (500_000.0, 4_100_000.0, 30.0), &[("tiles/w.tif", whole, [0.0, 0.0, 40.0, 25.0])])
            .replace("0, -30", "0, -32");
    scratch.write("vrt/coarser.vrt", coarser);
    let tiles = [tile(0, 0.0), tile(50, 1.0)];
    // The tile of the place and its sample there; the second tile lies over the first.
    let value = |x: f64, y: f64| -> f64 {
        let (column, row) = ((x / 20.0) as u32, (y / 20.0) as u32);
        let east = (50..110).contains(&column).then(|| tiles[1].at(column - 50, row));
        let value =
            east.filter(|value| *value != -9999.0).or((column < 60).then(|| tiles[0].at(column, row)));
        value.filter(|value| *value != -9999.0).unwrap_or(f64::NAN)
    };
    for (name, size, west, north, cell) in [
        ("vrt/te.vrt", (80, 30), 200.0, 100.0, DVec2::new(20.0, 20.0)),
        ("vrt/finer.vrt", (220, 80), 0.0, 0.0, DVec2::new(10.0, 10.0)),
        ("vrt/coarser.vrt", (40, 25), 0.0, 0.0, DVec2::new(30.0, 32.0)),
    ] {
        let joined = open(&scratch.at(name), &DemOptions::default());
        let mut whole = joined.unwrap_or_else(|error| panic!("{name}: {}", error_text(&error))).raster;
        assert_eq!((whole.size(), whole.spacing()), (size, cell), "{name}");
        let is_west_alone = name == "vrt/coarser.vrt";
        for (column, row) in (0..size.1).flat_map(|row| (0..size.0).map(move |column| (column, row))) {
            let (x, y) = (west + (f64::from(column) + 0.5) * cell.x, north + (f64::from(row) + 0.5) * cell.y);
            let wanted = match is_west_alone {
                true => tiles[0].at((x / 20.0) as u32, (y / 20.0) as u32),
                false => value(x, y),
            };
            let found = whole.at(column, row);
            assert!(
                found == wanted || (found.is_nan() && wanted.is_nan()),
                "{name} {column} {row}: {found} {wanted}"
            );
        }
        let opened = open_either(&scratch.at(name), &DemOptions::default(), 0);
        let Ok(OpenedDem::Windows(mut windows)) = opened else { panic!("{name} is read whole") };
        let part = RasterWindow { column: 7, row: 3, width: size.0 - 9, height: size.1 - 5 };
        let bits = |samples: Samples| samples.iter().map(f64::to_bits).collect::<Vec<_>>();
        let (windowed, whole) =
            (windows.samples(part).expect("there"), whole.samples(part).expect("in memory"));
        assert_eq!(bits(windowed), bits(whole), "{name}");
    }
}

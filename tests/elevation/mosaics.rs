//! Mosaics and voids on real tiles: an SRTM tile cut up is joined to itself again, and in scenes.

use crate::common::data;
use crate::common::scratch;
use std::fs;

use glam::{DAffine2, DVec2};
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_description::parse::parse_bytes;
use sandtable_raster::mosaic::{Mosaic, MosaicError, Tiles};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::void_counts::VoidCounts;
use sandtable_raster::voids;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;

/// The real tile, with a few voids over the sea cliffs.
fn monaco() -> Option<Raster> {
    let path = data::data("scenes/monaco/N43E007.hgt.zip")?;
    let bytes = fs::read(path).expect("readable");
    Some(read("N43E007.hgt.zip", &bytes, &DemHints::default()).expect("a tile"))
}

/// The part of `whole` from (column, row) on.
fn part(whole: &Raster, (column, row): (u32, u32), (width, height): (u32, u32)) -> Raster {
    let rows = row..row + height;
    let values =
        rows.flat_map(|row| (column..column + width).map(move |column| whole.at(column, row) as f32));
    let shift = DAffine2::from_translation(DVec2::new(f64::from(column), f64::from(row)));
    Raster {
        width,
        height,
        samples: Samples::F32(values.collect()),
        map_from_grid: whole.map_from_grid * shift,
        ..whole.clone()
    }
}

fn quarters(whole: &Raster) -> Vec<Raster> {
    // As SRTM tiles do, they share the row and the column between them.
    let corners = [(600, 600), (0, 600), (600, 0), (0, 0)];
    corners.map(|corner| part(whole, corner, (601, 601))).into()
}

fn join(rasters: Vec<Raster>) -> Result<Mosaic, MosaicError> {
    let mut tiles = Tiles::default();
    for (index, raster) in rasters.into_iter().enumerate() {
        tiles.push(format!("tile {index}"), raster)?;
    }
    tiles.join()
}

fn same(one: &Raster, two: &Raster) -> bool {
    let alike = |(a, b): (f64, f64)| a == b || (a.is_nan() && b.is_nan());
    one.samples.len() == two.samples.len() && one.samples.iter().zip(two.samples.iter()).all(alike)
}

#[test]
fn a_tile_cut_up_is_itself_again_when_joined() {
    let Some(whole) = monaco() else { return };
    let joined = join(quarters(&whole)).expect("of one raster");
    assert!(same(&joined.raster, &whole));
    assert_eq!((joined.tiles, joined.differing, joined.gaps), (4, 0, 0));
    // Shared: the cross of a row and a column, its middle three times more than once; voids are not values.
    assert!((2390..=2 * 1201 + 1).contains(&joined.overlaps), "{}", joined.overlaps);
    for (ours, wanted) in joined.raster.geotransform().iter().zip(whole.geotransform()) {
        assert!((ours - wanted).abs() < 1e-12, "{ours} for {wanted}");
    }
    assert_eq!(joined.raster.vertical_datum.as_deref(), Some("EGM96 geoid"));
}

#[test]
fn a_seam_that_disagrees_is_told_and_the_first_tile_wins() {
    let Some(whole) = monaco() else { return };
    let mut tiles = quarters(&whole);
    let Samples::F32(values) = &mut tiles[1].samples else { panic!("16-bit samples") };
    // The middle of the whole tile, on the border of all four; then one of its own.
    let own = 601 * 300 + 20;
    let (seam, inner) = (values[600], values[own]);
    values[600] += 7.0;
    values[own] += 7.0;
    let joined = join(tiles).expect("of one raster");
    assert_eq!((joined.differing, joined.greatest_difference), (1, 7.0));
    assert_eq!(joined.raster.at(600, 600), f64::from(seam));
    assert_eq!(joined.raster.at(20, 900), f64::from(inner + 7.0));
}

#[test]
fn a_missing_quarter_is_a_gap() {
    let Some(whole) = monaco() else { return };
    let tiles = quarters(&whole)[..3].to_vec();
    let joined = join(tiles).expect("of one raster");
    assert_eq!(joined.gaps, 600 * 600);
    assert!(joined.raster.at(0, 0).is_nan() && joined.raster.at(600, 0) == whole.at(600, 0));
}

#[test]
fn tiles_of_two_resolutions_are_joined_in_the_finer_cells() {
    let Some(whole) = monaco() else { return };
    let bytes = vec![0; 3601 * 3601 * 2];
    let fine = read("N43E008.hgt", &bytes, &DemHints::default()).expect("a tile");
    let joined = join(vec![whole.clone(), fine]).expect("they nest");
    // The cells at the border of the coarser tile reach one finer cell beyond those of the other.
    assert_eq!((joined.raster.width, joined.raster.height, joined.overlaps), (7202, 3603, 0));
    for (column, row) in
        (0..1200).step_by(7).flat_map(|column| (0..1201).step_by(11).map(move |row| (column, row)))
    {
        let (found, wanted) = (joined.raster.at(3 * column + 1, 3 * row + 1), whole.at(column, row));
        assert!(
            found == wanted || found.is_nan() && wanted.is_nan(),
            "{column}, {row}: {found} for {wanted}"
        );
    }
    assert_eq!([joined.raster.at(3601, 1), joined.raster.at(7201, 3601)], [0.0, 0.0]);
    assert!(joined.raster.notes[0].contains("cells 3 times as large"), "{:?}", joined.raster.notes);
    let odd = Raster {
        map_from_grid: whole.map_from_grid * DAffine2::from_scale(DVec2::splat(0.7)),
        ..whole.clone()
    };
    let refused = join(vec![whole, odd]).expect_err("they do not nest").to_string();
    assert!(refused.contains("tile 1 and tile 0") || refused.contains("tile 0 and tile 1"), "{refused}");
    assert!(refused.contains("do not nest") && refused.contains("--cell"), "{refused}");
}

#[test]
fn the_voids_of_a_real_tile_are_filled_within_the_heights_around() {
    let Some(mut raster) = monaco() else { return };
    let before = raster.clone();
    let VoidCounts { voids, samples: cells } = VoidCounts::of(&before);
    assert!(voids > 0, "the tile has voids");
    let filled = voids::fill(&mut raster);
    assert_eq!((filled.voids, filled.cells, filled.voids_left), (voids, cells, 0));
    assert_eq!(VoidCounts::of(&raster), VoidCounts::default());
    let (low, high) = before
        .samples
        .iter()
        .filter(|height| !height.is_nan())
        .fold((f64::MAX, f64::MIN), |range, height| (range.0.min(height), range.1.max(height)));
    let mut changed = 0;
    for (old, new) in before.samples.iter().zip(raster.samples.iter()) {
        if old.is_nan() && !new.is_nan() {
            changed += 1;
            assert!((low..=high).contains(&new));
        } else {
            assert!(old == new || old.is_nan());
        }
    }
    assert_eq!(changed, cells);
}

/// Two tiles side by side that share a column, the second with a void.
fn scene(scratch: &scratch::Scratch, terrain: &str) -> Result<(Vec<String>, f64, Option<String>), String> {
    let scene = built(scratch, terrain)?;
    let now = scene.heights.snapshot();
    let source = now.source();
    Ok((
        scene.notes().into_iter().map(str::to_owned).collect(),
        source.at(source.width - 2, 1),
        source.vertical_datum.clone(),
    ))
}

/// The scene of those tiles, and of one of larger cells around both.
fn built(scratch: &scratch::Scratch, terrain: &str) -> Result<SceneModel, String> {
    let tile = |west: u32, heights: &str| {
        format!("ncols 3\nnrows 3\nxllcorner {west}\nyllcorner 0\ncellsize 10\n{heights}\n")
    };
    scratch.write("s/a.asc", tile(500_000, "1 2 3 1 2 3 1 2 3"));
    scratch.write("s/b.asc", tile(500_020, "3 4 5 3 -9999 5 4 4 5"));
    let wide = |cell: u32| {
        let heights = "7 7 7 7 7 7 7 7 7";
        format!("ncols 3\nnrows 3\nxllcorner 500000\nyllcorner 0\ncellsize {cell}\n{heights}\n")
    };
    scratch.write("s/wide.asc", wide(20));
    scratch.write("s/odd.asc", wide(17));
    scratch.write("s/a.toml", terrain);
    let path = scratch.folder().join("s/a.toml");
    let document = parse_bytes("a.toml", terrain.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&path, &[]).map_err(|error| error.to_string())?;
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

#[test]
fn a_scene_joins_tiles_fills_voids_and_states_a_datum_where_it_asks_for_it() {
    let scratch = scratch::Scratch::new();
    let asked = "[terrain]\ndem = [\"a.asc\", \"b.asc\"]\ncrs = \"EPSG:32633\"\nfill_voids = true\n\
                 vertical_datum = \"NAVD88\"\n";
    let (notes, filled, datum) = scene(&scratch, asked).expect("sound");
    let notes = notes.join("\n");
    assert!(notes.contains("2 tiles joined; 3 samples are shared, 1 of them differs, by up to 1"), "{notes}");
    assert!(notes.contains("1 sample in 1 void filled"), "{notes}");
    assert!((filled - 4.0).abs() < 1e-6, "{filled}");
    assert_eq!(datum.as_deref(), Some("NAVD88"));

    let plain = "[terrain]\ndem = \"b.asc\"\ncrs = \"EPSG:32633\"\n";
    let (notes, left, datum) = scene(&scratch, plain).expect("sound");
    assert!(left.is_nan() && datum.is_none(), "the source stays as it is read");
    assert!(notes.join("\n").contains("1 sample in 1 void filled"), "{notes:?}");
    let (notes, left, _) = scene(&scratch, &format!("{plain}fill_voids = false\n")).expect("sound");
    assert!(left.is_nan() && !notes.join("\n").contains("filled"));
}

#[test]
fn a_scene_adds_the_offsets_of_its_tiles() {
    let scratch = scratch::Scratch::new();
    let terrain = "[terrain]\ndem = [{ file = \"a.asc\", offset = 10 }, { file = \"b.asc\", offset = 9.5 }]\n\
                   crs = \"EPSG:32633\"\n";
    let scene = built(&scratch, terrain).expect("sound");
    let now = scene.heights.snapshot();
    let source = now.source();
    assert_eq!([0, 1, 2, 4].map(|column| source.at(column, 0)), [11.0, 12.0, 13.0, 14.5]);
    assert!(source.at(3, 1).is_nan());
    let notes = scene.notes().join("\n");
    assert!(notes.contains("3 of them differ, by up to 0.5"), "{notes}");
    for (terrain, wanted) in [
        ("dem = { offset = 1 }", "needs the key `file`"),
        ("dem = [\"a.asc\", { file = \"b.asc\", ofset = 1 }]", "did you mean `offset`?"),
        ("dem = { file = \"a.asc\", offset = \"1 m\" }", "write 1"),
        ("dem = { file = 1 }", "must be text"),
    ] {
        let refused = scene_error(&scratch, terrain);
        assert!(refused.contains(wanted), "{terrain}: {refused}");
    }
    let alone =
        built(&scratch, "[terrain]\ndem = { file = \"a.asc\" }\ncrs = \"EPSG:32633\"\n").expect("sound");
    assert_eq!(alone.heights.snapshot().source().at(0, 0), 1.0);
}

fn scene_error(scratch: &scratch::Scratch, dem: &str) -> String {
    built(scratch, &format!("[terrain]\n{dem}\ncrs = \"EPSG:32633\"\n")).map(drop).expect_err(dem)
}

#[test]
fn a_scene_joins_tiles_of_several_cells_and_tells_it() {
    let scratch = scratch::Scratch::new();
    let joined = |dem: &str| built(&scratch, &format!("[terrain]\ncrs = \"EPSG:32633\"\n{dem}\n"));
    let scene = joined("dem = [\"wide.asc\", \"a.asc\"]").expect("they nest");
    let now = scene.heights.snapshot();
    let source = now.source();
    assert_eq!((source.width, source.height), (6, 6));
    assert_eq!([source.at(0, 5), source.at(2, 5), source.at(3, 5), source.at(0, 0)], [1.0, 3.0, 7.0, 7.0]);
    let notes = scene.notes().join("\n");
    assert!(notes.contains("1 of 2 tiles have cells 2 times as large as the finest, 10 by -10"), "{notes}");

    let refused = joined("dem = [\"odd.asc\", \"a.asc\"]").map(drop).expect_err("17 m and 10 m");
    assert!(refused.contains("do not nest") && refused.contains("`cell` under [terrain]"), "{refused}");
    let scene = joined("dem = [\"odd.asc\", \"a.asc\"]\ncell = 5").expect("resampled");
    assert_eq!(scene.heights.snapshot().source().spacing(), DVec2::splat(5.0));
    let notes = scene.notes().join("\n");
    assert!(notes.contains("2 tiles whose cells do not nest were resampled to cells of 5"), "{notes}");
}

#[test]
fn what_a_scene_says_wrong_of_its_elevation_is_told_with_its_place() {
    let scratch = scratch::Scratch::new();
    for (terrain, place, wanted) in [
        ("[terrain]\ndem = []\n", "a.toml:2:7", "`dem` lists 0 elevation files"),
        ("[terrain]\ndem = [\"a.asc\", 3]\n", "a.toml:2:17", "must be text"),
        ("[terrain]\ndem = \"a.asc\"\nheight_encoding = \"rgb\"\n", "a.toml:3:19", "terrarium"),
        ("[terrain]\ndem = \"a.asc\"\nraw = \"3x3\"\n", "a.toml:3:7", "1201x1201:i16be"),
        ("[terrain]\ndem = [\"a.asc\", \"c.asc\"]\n", "a.toml:2:7", "c.asc"),
    ] {
        let refused = scene(&scratch, terrain).expect_err(terrain);
        assert!(refused.contains(place) && refused.contains(wanted), "{terrain}: {refused}");
    }
}

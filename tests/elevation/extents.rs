//! Scenes on a part of elevation that is too large to be read whole: the ground is that of the whole file's part.

use std::sync::Arc;

use glam::{DAffine2, DMat2, DVec2};
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read as read_dem;
use sandtable_dem::write::write;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::parse::parse_bytes;
use sandtable_geom::crs::Crs;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_scene::assets::Assets;
use sandtable_scene::ground::{LoadedGround, load};
use sandtable_scene::planned_pictures::ElevationNeed;

use crate::common::scratch::Scratch;

/// Posts a side: two million in all.
const SIDE: u32 = 1500;

/// Hills with a void of 12 by 12 posts around (700, 800) and one of 3 by 3 around (500, 600).
fn height(column: u32, row: u32) -> f32 {
    let (x, y) = (f64::from(column), f64::from(row));
    let is_void = column.abs_diff(700) < 6 && row.abs_diff(800) < 6
        || column.abs_diff(500) < 2 && row.abs_diff(600) < 2;
    match is_void {
        true => f32::NAN,
        false => (300.0 + 80.0 * libm::sin(x * 0.02) * libm::cos(y * 0.03) + 3.0 * libm::sin(x * 1.7)) as f32,
    }
}

/// The posts of the hills from a column and a row on, `cell` apart, the north-west corner of all at `corner`.
fn tile(
    (west, north): (u32, u32),
    (width, height_): (u32, u32),
    corner: DVec2,
    cell: f64,
    crs: u32,
) -> Raster {
    let posts =
        (north..north + height_).flat_map(|row| (west..west + width).map(move |column| height(column, row)));
    let matrix2 = DMat2::from_diagonal(DVec2::new(cell, -cell));
    let translation = corner + matrix2 * DVec2::new(f64::from(west), f64::from(north));
    Raster {
        crs: Some(Crs::from_epsg(crs).expect("known")),
        map_from_grid: DAffine2 { matrix2, translation },
        georeferenced: true,
        ..Raster::new(width, Samples::F32(posts.collect()))
    }
}

fn stored(scratch: &Scratch, name: &str, raster: &Raster) {
    let (_, extension) = name.rsplit_once('.').expect("a name with an extension");
    let format = DemFormat::to_write(extension).expect("written");
    scratch.write(name, write(raster, format, "a").expect("it has a place").bytes);
}

/// The ground of a scene over files in the scratch folder; with `whole`, over that raster in place of any of them.
fn ground(scratch: &Scratch, text: &str, whole: Option<&Raster>) -> Result<LoadedGround, Diagnostic> {
    let document = parse_bytes("a.toml", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    let assets = Assets::new(&scratch.at("a.toml"), &[]).expect("the folder is there");
    match whole {
        Some(whole) => load(&document, &assets.with_elevation(Arc::new(whole.clone())), ElevationNeed::All),
        None => load(&document, &assets, ElevationNeed::All),
    }
}

fn assert_same_ground(read: &LoadedGround, whole: &LoadedGround, what: &str) {
    let frame = |ground: &LoadedGround| {
        let lattice = &ground.lattice;
        (
            lattice.origin(),
            lattice.cell(),
            lattice.columns(),
            lattice.rows(),
            ground.crs.clone(),
            ground.stated_crs.clone(),
        )
    };
    assert_eq!(frame(read), frame(whole), "{what}");
    let bits =
        |ground: &LoadedGround| ground.lattice.heights().iter().map(|it| it.to_bits()).collect::<Vec<_>>();
    assert!(bits(read) == bits(whole), "{what}: heights differ");
    assert!(!read.lattice.heights().iter().any(|height| height.is_nan()), "{what}: a void is left");
}

#[test]
fn the_ground_within_an_extent_is_that_of_the_whole_model_bit_for_bit() {
    let (meters, degrees) = (DVec2::new(500_000.0, 4_100_000.0), DVec2::new(-84.4, 37.2));
    let mercator = DVec2::new(-9_400_000.0, 4_400_000.0);
    // Over the larger void, and beside the smaller one.
    for (name, corner, cell, crs, extent) in [
        ("a.tif", meters, 30.0, 32616, "[[516000, 4074000], [523000, 4080000]]"),
        ("a.bt", meters, 30.0, 32616, "[[516000, 4074000], [523000, 4080000]]"),
        ("a.tif", degrees, 1.0 / 3600.0, 4326, "[[-84.24, 36.94], [-84.18, 37.0]]"),
        ("a.tif", mercator, 30.0, 3857, "[[-9384000, 4374000], [-9377000, 4380000]]"),
    ] {
        let scratch = Scratch::new();
        let whole = tile((0, 0), (SIDE, SIDE), corner, cell, crs);
        stored(&scratch, name, &whole);
        let bytes = std::fs::read(scratch.at(name)).expect("stored");
        let whole = read_dem(name, &bytes, &DemHints::default()).expect("sound");
        let points = if crs == 4326 { "points_crs = \"EPSG:4326\"\n" } else { "" };
        let text = format!("{points}[terrain]\ndem = \"{name}\"\nextent = {extent}\n");
        let read = ground(&scratch, &text, None).unwrap_or_else(|error| panic!("{error}"));
        let expected = ground(&scratch, &text, Some(&whole)).unwrap_or_else(|error| panic!("{error}"));
        let what = format!("{name} in EPSG:{crs}");
        assert!(
            read.source.raster().samples.len() < whole.samples.len() * 3 / 4,
            "{what}: read nearly whole"
        );
        assert_same_ground(&read, &expected, &what);
    }
}

#[test]
fn the_extent_of_tiles_is_read_from_those_that_it_meets() {
    let scratch = Scratch::new();
    let corner = DVec2::new(500_000.0, 4_100_000.0);
    let (half, rest) = (SIDE / 2, SIDE - SIDE / 2);
    let mut names = Vec::new();
    for (index, (at, size)) in [
        ((0, 0), (half, half)),
        ((half, 0), (rest, half)),
        ((0, half), (half, rest)),
        ((half, half), (rest, rest)),
    ]
    .into_iter()
    .enumerate()
    {
        let name = format!("t{index}.tif");
        stored(&scratch, &name, &tile(at, size, corner, 30.0, 32616));
        names.push(format!("\"{name}\""));
    }
    let extent = "extent = [[516000, 4074000], [523000, 4080000]]";
    let text = format!("[terrain]\ndem = [{}]\n{extent}\nvertical_datum = \"EGM96\"\n", names.join(", "));
    let read = ground(&scratch, &text, None).unwrap_or_else(|error| panic!("{error}"));
    let whole = tile((0, 0), (SIDE, SIDE), corner, 30.0, 32616);
    let text = format!("[terrain]\ndem = \"t0.tif\"\n{extent}\n");
    let expected = ground(&scratch, &text, Some(&whole)).unwrap_or_else(|error| panic!("{error}"));
    assert_same_ground(&read, &expected, "tiles");
    assert_eq!(read.source.header().vertical_datum.as_deref(), Some("EGM96"));
}

#[test]
fn an_extent_beside_a_large_model_is_refused_at_its_place() {
    let scratch = Scratch::new();
    stored(&scratch, "a.tif", &tile((0, 0), (SIDE, SIDE), DVec2::new(500_000.0, 4_100_000.0), 30.0, 32616));
    let text = "[terrain]\ndem = \"a.tif\"\nextent = [[100, 100], [900, 900]]\n";
    let refused = ground(&scratch, text, None).err().expect("nothing there").to_string();
    assert!(refused.contains("a.toml:3:10") && refused.contains("less than two samples"), "{refused}");
}

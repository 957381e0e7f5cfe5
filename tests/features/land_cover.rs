//! Rasters of land-cover classes as areas.
//!
//! `worldcover.tif` is made in the format of ESA WorldCover: bytes with its palette in tiles, cells of 1/12,000 degree around 15° E,
//! 45° N. `corine.tif` and `corine-numbers.tif` are made in those of CORINE: codes of 16 bits and numbers of a byte, cells of 100 m
//! in EPSG:3035. The shares of classes on the ground were counted at a million places, each transformed to its cell.

use std::collections::BTreeMap;

use glam::{DAffine2, DVec2};
use sandtable_analysis::land::LandCover;
use sandtable_base::message::choice::Choice;
use sandtable_catalog::kind::LandPart;
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::hints::DemHints;
use sandtable_dem::write::write;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::parse::parse_bytes;
use sandtable_description::words::Cover;
use sandtable_geom::crs::Crs;
use sandtable_geom::polygon;
use sandtable_lint::opened::open_linted;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_ribbon::partition::overlap_m2;
use sandtable_ribbon::plan::{PlanMesh, PlanVertex};
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::class_raster::legend::ClassLegend;
use sandtable_scene::class_raster::{ClassRaster, SampledLegend};
use sandtable_scene::land::land_of;
use sandtable_scene::scene_model::SceneModel;

use crate::common::scratch::Scratch;

const WORLD_COVER: &[u8] = include_bytes!("land_cover/worldcover.tif");
const CORINE: &[u8] = include_bytes!("land_cover/corine.tif");
const CORINE_NUMBERS: &[u8] = include_bytes!("land_cover/corine-numbers.tif");

/// Areas with the cover of each class.
const ALL: &str = "[[area]]\nfile = \"cover.tif\"\nwhere = \"cover\"\ncover = \"(cover)\"\n";

/// The side of the ground in meters, of 30 cells, and its corner in EPSG:32633.
struct Square {
    side_m: u32,
    corner: [f64; 2],
}

/// Within `worldcover.tif`.
const NEAR: Square = Square { side_m: 300, corner: [499_850.0, 4_982_800.0] };
/// Within the rasters of CORINE.
const WIDE: Square = Square { side_m: 3000, corner: [498_500.0, 4_981_450.0] };

/// A folder with a scene of `text` on the square, and `cover.tif` of these bytes.
fn folder(bytes: &[u8], square: &Square, text: &str) -> Scratch {
    let folder = Scratch::new();
    let cell = square.side_m / 30;
    let [x, y] = square.corner.map(|corner| corner - f64::from(cell) / 2.0);
    let heights = (0..31 * 31).map(|index| format!("{} ", 100 + index % 31)).collect::<String>();
    let grid = format!("ncols 31\nnrows 31\nxllcorner {x}\nyllcorner {y}\ncellsize {cell}\n{heights}");
    folder.write("ground.asc", grid);
    folder.write("cover.tif", bytes);
    folder.write("scene.toml", format!("[terrain]\ndem = \"ground.asc\"\ncrs = \"EPSG:32633\"\n{text}"));
    folder
}

fn built(bytes: &[u8], square: &Square, text: &str) -> Result<SceneModel, Diagnostic> {
    let folder = folder(bytes, square, text);
    let text = std::fs::read(folder.at("scene.toml")).expect("just written");
    let document = parse_bytes("scene.toml", &text).expect("a scene file");
    let assets = Assets::new(&folder.at("scene.toml"), &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).map_err(|errors| errors.into_first())
}

/// The area of what a plan covers of the ground, square meters.
fn area_on(plan: &PlanMesh, square: &Square) -> f64 {
    let side = f64::from(square.side_m);
    let ground = [DVec2::ZERO, DVec2::new(side, 0.0), DVec2::splat(side), DVec2::new(0.0, side)];
    let area = |corners: [PlanVertex; 3]| {
        let mut part: Vec<DVec2> = polygon::counter_clockwise(&corners.map(|corner| corner.at));
        polygon::clip_convex(&mut part, &mut Vec::new(), &ground);
        polygon::doubled_area(&part).abs() / 2.0
    };
    plan.corners().map(area).sum()
}

/// The share of the ground that each cover has.
fn shares(scene: &SceneModel, square: &Square) -> BTreeMap<&'static str, f64> {
    let mut shares = BTreeMap::new();
    for ribbon in &scene.ribbons {
        let RibbonSurface::Cover(cover) = ribbon.surface else { panic!("{:?}", ribbon.surface) };
        let word = cover.word();
        *shares.entry(word).or_default() += area_on(&ribbon.plan, square) / f64::from(square.side_m).powi(2);
    }
    shares
}

fn assert_shares(scene: &SceneModel, square: &Square, expected: &[(Cover, f64)]) {
    let found = shares(scene, square);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (cover, share) in expected {
        let own = found[cover.word()];
        // Half a percent of the ground: borders move by less than half a cell, as much to one side as to the other.
        assert!((own - share).abs() < 0.005, "{cover:?}: {own} of {share}");
    }
    let overlap = overlap_m2(scene.ribbons.iter().map(|ribbon| &ribbon.plan).collect::<Vec<_>>());
    assert!(overlap < 1e-6 * f64::from(square.side_m).powi(2), "{overlap}");
}

#[test]
fn covers_of_world_cover_have_their_shares_of_the_ground_and_water_has_none() {
    let scene = built(WORLD_COVER, &NEAR, ALL).expect("a raster of classes");
    // The speck of two cells of shrubs is built-up ground, which it lies in.
    let expected =
        [(Cover::Forest, 0.4123), (Cover::Meadow, 0.0656), (Cover::Field, 0.1086), (Cover::BuiltUp, 0.3154)];
    assert_shares(&scene, &NEAR, &expected);
    let names: Vec<&str> = scene.features.iter().map(|feature| feature.name.as_str()).collect();
    assert!(names.contains(&"Tree cover") && names.contains(&"Cropland"), "{names:?}");
    let land = land_of(&scene, &[LandPart::Cover]).cover.expect("covers");
    let wood = land.iter().filter(|cover| **cover == LandCover::Wood).count() as f64 / land.len() as f64;
    assert!((wood - 0.41).abs() < 0.04, "{wood}");
}

#[test]
fn corine_is_the_same_by_codes_and_by_numbers() {
    let expected = [
        (Cover::DenseBuiltUp, 0.05),
        (Cover::BuiltUp, 0.1643),
        (Cover::Field, 0.4162),
        (Cover::Forest, 0.3676),
    ];
    let scenes = [CORINE, CORINE_NUMBERS].map(|bytes| built(bytes, &WIDE, ALL).expect("classes"));
    scenes.iter().for_each(|scene| assert_shares(scene, &WIDE, &expected));
    assert_eq!(shares(&scenes[0], &WIDE), shares(&scenes[1], &WIDE));
}

#[test]
fn classes_are_selected_by_number_and_water_makes_a_lake() {
    let text = "[[area]]\nfile = \"cover.tif\"\nwhere = { class = 10 }\ncover = \"forest\"\n\
                [[lake]]\nfile = \"cover.tif\"\nwhere = { class = 80 }\n";
    let scene = built(WORLD_COVER, &NEAR, text).expect("a raster of classes");
    let area = |wanted: RibbonSurface| -> f64 {
        scene
            .ribbons
            .iter()
            .filter(|ribbon| ribbon.surface == wanted)
            .map(|ribbon| area_on(&ribbon.plan, &NEAR))
            .sum()
    };
    assert!((area(RibbonSurface::Cover(Cover::Forest)) / 9e4 - 0.4123).abs() < 0.005);
    // A round patch of 14 cells is cut by a third of a cell all around where its border is made smooth.
    assert!((area(RibbonSurface::Lake) / 9e4 - 0.0982).abs() < 0.007);
}

#[test]
fn a_raster_beside_the_ground_is_a_note_and_no_error() {
    let folder = folder(CORINE, &Square { side_m: 300, corner: [300_000.0, 4_982_800.0] }, ALL);
    let (scene, findings) =
        open_linted(&folder.at("scene.toml"), &[], &|_| ()).expect("ground without areas");
    assert!(scene.ribbons.is_empty());
    let notes: Vec<String> = findings.into_iter().map(|finding| finding.message).collect();
    assert!(notes.iter().any(|note| note.contains("covers none of the ground")), "{notes:?}");
}

#[test]
fn other_rasters_are_refused_with_what_was_found() {
    let message = |bytes: &[u8], text: &str| {
        let error = built(bytes, &NEAR, text).map(drop).expect_err("refused");
        format!("{} {}", error.message(), error.help().unwrap_or_default())
    };
    let elevation = message(&elevation(417.25), ALL);
    assert!(elevation.contains("no class of land cover") && elevation.contains("`dem`"), "{elevation}");
    assert!(elevation.contains("417.25"), "{elevation}");
    let layer = message(WORLD_COVER, &ALL.replace("where", "layer = \"a\"\nwhere"));
    assert!(layer.contains("`layer` has no effect"), "{layer}");
    let cut = message(&WORLD_COVER[..WORLD_COVER.len() / 2], ALL);
    assert!(cut.contains("cover.tif"), "{cut}");
}

/// A GeoTIFF of level ground at this height.
fn elevation(height_m: f32) -> Vec<u8> {
    let place = DAffine2::from_scale_angle_translation(
        DVec2::new(10.0, -10.0),
        0.0,
        DVec2::new(499_800.0, 4_983_200.0),
    );
    let raster = Raster {
        map_from_grid: place,
        georeferenced: true,
        crs: Crs::from_epsg(32633).ok(),
        ..Raster::new(50, Samples::F32(vec![height_m; 2500]))
    };
    write(&raster, DemFormat::to_write("tif").expect("a GeoTIFF"), "cover.tif")
        .expect("it can be written")
        .bytes
}

#[test]
fn level_ground_is_not_surely_land_cover() {
    let sampled = |bytes: &[u8]| {
        let content = Box::new(std::io::Cursor::new(bytes.to_vec()));
        let raster = ClassRaster::of_content("cover.tif", content, &DemHints::default());
        raster.and_then(|mut raster| raster.sampled_legend()).expect("classes")
    };
    let sure = |legend| SampledLegend { legend, is_sure: true };
    assert_eq!(sampled(WORLD_COVER), sure(ClassLegend::WorldCover));
    assert_eq!(sampled(CORINE), sure(ClassLegend::Corine));
    assert!(!sampled(CORINE_NUMBERS).is_sure);
    assert!(!sampled(&elevation(100.0)).is_sure);
}

#[test]
fn a_file_that_is_cut_or_changed_anywhere_is_an_error_or_a_scene_and_no_panic() {
    for at in (0..WORLD_COVER.len()).step_by(61) {
        let _ = built(&WORLD_COVER[..at], &NEAR, ALL);
        let mut changed = WORLD_COVER.to_vec();
        changed[at] ^= 0xff;
        let _ = built(&changed, &NEAR, ALL);
    }
}

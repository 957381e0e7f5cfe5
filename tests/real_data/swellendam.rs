//! Swellendam below the Langeberg: a geographic elevation model, roads in another zone's meters, rivers that
//! leave the model, and reservoirs to be leveled.

use sandtable_geom::crs::Crs;
use sandtable_scene::feature::FeatureKind;
use sandtable_terrain::lattice::Post;
use sandtable_terrain::query::Surface;

use crate::common::data::data;
use crate::common::scratch::Scratch;
use crate::common::shapefile::{self, Shape};
use crate::oracle::{compare, samples};
use crate::{clearance_of_draped, picture, scene};

const FOLDER: &str = "scenes/swellendam_za";

/// The scene, without its lakes where `lakes` is empty; its rivers then leave the ground as it is.
fn text(dem: &str, lakes: &str) -> String {
    let water = if lakes.is_empty() { "drape" } else { "falls" };
    format!(
        r#"
title = "Swellendam"
subtitle = "and the Langeberg"
points_crs = "EPSG:4326"

[terrain]
dem = '{dem}'
vertical_exaggeration = 1.5

[[river]]
file = "../layers/rivers.geojson"
width = 60
water = "{water}"

[[road]]
file = "../layers/roads.geojson"
crs = "EPSG:32733"
width = 40

{lakes}

[[label]]
text = "Swellendam"
at = [20.4417, -34.0225]

[[camera]]
name = "south"
eye = [20.46, -34.20]
eye_elevation = 5000
look_at = [20.46, -34.02]
field_of_view = 45

[[camera]]
name = "everything"
eye = [20.45, -34.55]
eye_elevation = 40000
look_at = [20.45, -34.03]
field_of_view = 55

[[camera]]
name = "reservoirs"
eye = [20.48, -34.075]
eye_elevation = 900
look_at = [20.49, -34.02]
"#
    )
}

const LAKES: &str = "[[lake]]\nname = \"dam\"\nfile = \"../layers/water.geojson\"\n";

/// The layers as GeoJSON, and how many lines of roads, lines of rivers and polygons of water there are.
fn layers(folder: &Scratch) -> Option<[usize; 3]> {
    let layer = |from: &str, to: &str| {
        let shapes = shapefile::read(&data(&format!("{FOLDER}/{from}"))?);
        folder.write(&format!("layers/{to}.geojson"), shapefile::geojson(&shapes));
        let parts = |shape: &Shape| match shape {
            Shape::Null => 0,
            Shape::Point(_) => 1,
            Shape::Lines(parts) | Shape::Rings(parts) => parts.len(),
        };
        Some(shapes.iter().map(parts).sum())
    };
    Some([
        layer("projected/roads_33S.shp", "roads")?,
        layer("rivers.shp", "rivers")?,
        layer("water.shp", "water")?,
    ])
}

#[test]
#[ignore = "slow: a whole place of real data"]
fn swellendam_is_built_with_every_layer_and_everything_lies_on_the_ground() {
    let Some(place) = data(FOLDER) else { return };
    let folder = Scratch::new();
    let Some([roads, rivers, waters]) = layers(&folder) else { return };
    assert_eq!((roads, rivers, waters), (350, 20, 37));
    let dem = place.join("dem_srtm_wgs84_f32.tif");
    let scene = scene(&folder, &text(&dem.to_string_lossy(), LAKES), &[place])
        .unwrap_or_else(|error| panic!("{error}"));
    println!("{:#?}", scene.notes());
    let count =
        |wanted| scene.census().into_iter().find(|(kind, _)| *kind == wanted).map_or(0, |(_, count)| count);
    assert_eq!(count(FeatureKind::Lake), waters);
    assert_eq!(count(FeatureKind::Road), roads);
    // Of twelve rivers some never come near the model.
    let off = scene.notes().iter().filter(|note| note.contains("left out")).count();
    assert!(count(FeatureKind::River) >= 6 && (count(FeatureKind::River) == rivers) == (off == 0));

    for (view, size) in [("south", (960, 540)), ("everything", (480, 270)), ("reservoirs", (480, 270))] {
        let pictured = picture(&scene, view, &format!("swellendam_{view}"), size);
        let (clearance, corners) = clearance_of_draped(&pictured.shot);
        println!("{view}: {clearance} m at {corners} draped corners; {:?}", pictured.pixels);
        assert!(pictured.ground_pixels > 1000);
        assert!(pictured.pixels.iter().all(|&(_, pixels)| pixels > 0), "{:?}", pictured.pixels);
    }
}

#[test]
fn heights_under_every_sampled_vertex_are_what_gdal_finds() {
    let Some(place) = data(FOLDER) else { return };
    let folder = Scratch::new();
    if layers(&folder).is_none() {
        return;
    }
    let dem = place.join("dem_srtm_wgs84_f32.tif");
    // Without lakes: they level the ground around them.
    let text = text(&dem.to_string_lossy(), "");
    let scene = scene(&folder, &text, std::slice::from_ref(&place)).unwrap_or_else(|error| panic!("{error}"));
    assert!(scene.crs.is_metric() && !scene.crs.is_geographic());
    let samples = samples(&place);
    assert!(samples.len() > 700);
    let service = (&scene.heights, &scene.crs);
    let as_vertex = |sample: &crate::oracle::Sample| {
        let code = if sample.file.starts_with("projected/") { 32733 } else { 4326 };
        (Crs::from_epsg(code).expect("known"), sample.vertex)
    };
    let as_position = |sample: &crate::oracle::Sample| (Crs::wgs84(), sample.on_dem);

    let source = compare(service, Surface::Source, &samples, as_position);
    println!(
        "source at positions: max {} m, rms {} m of {}",
        source.max(),
        source.rms(),
        source.sorted.len()
    );
    assert!(source.max() < SOURCE_M);
    let source = compare(service, Surface::Source, &samples, as_vertex);
    println!("source at vertices: max {} m, rms {} m of {}", source.max(), source.rms(), source.sorted.len());
    assert!(source.max() < SOURCE_M);

    let ground = compare(service, Surface::Ground, &samples, as_vertex);
    println!(
        "ground: max {} m, rms {} m, half within {} m, 95 % within {} m of {}",
        ground.max(),
        ground.rms(),
        ground.quantile(0.5),
        ground.quantile(0.95),
        ground.sorted.len()
    );
    assert!(ground.sorted.len() == samples.len());
    assert!(ground.quantile(0.95) < 4.0 && ground.rms() < 2.0 && ground.max() < 20.0);
}

#[test]
fn reservoirs_move_land_only_beside_their_shores() {
    let Some(place) = data(FOLDER) else { return };
    let folder = Scratch::new();
    if layers(&folder).is_none() {
        return;
    }
    let dem = place.join("dem_srtm_wgs84_f32.tif").to_string_lossy().into_owned();
    let text = |lakes: &str| format!("points_crs = \"EPSG:4326\"\n[terrain]\ndem = '{dem}'\n{lakes}");
    let build = |lakes: &str| {
        let allowed = [place.clone()];
        scene(&folder, &text(lakes), &allowed).unwrap_or_else(|error| panic!("{error}"))
    };
    let (plain, flooded) = (build(""), build(LAKES));
    let spacing_m = flooded.lattice.cell().max_element();
    // They may move ground 30 m from their shores, and a moved post moves the ground up to the next: around the mean
    // of them, 65 m in radius, less than three times its area.
    let every = 1 << (flooded.lattice.doublings() - plain.lattice.doublings());
    let water_m2: f64 = flooded.report.lakes.iter().map(|lake| lake.area).sum();
    let posts = flooded.lattice.posts().filter(|post| post.row % every == 0 && post.column % every == 0);
    let moved = posts.filter(|post| {
        let before = plain.lattice.height(Post { column: post.column / every, row: post.row / every });
        flooded.lattice.height(*post) != before && !before.is_nan()
    });
    let moved_m2 = moved.count() as f64 * plain.lattice.cell_m2();
    println!(
        "{} lakes of {water_m2} m² moved {moved_m2} m² on posts {spacing_m} m apart",
        flooded.report.lakes.len()
    );
    assert!(spacing_m < 25.0, "{spacing_m}");
    assert!(moved_m2 < 3.0 * water_m2, "{moved_m2} m² of land for {water_m2} m² of water");
}

/// Meters of height: a tenth of a millimeter. Bringing a position to UTM and back moves it by less than a
/// micrometer, which on the steepest slope of the model is less than a micrometer of height.
const SOURCE_M: f64 = 1e-4;

//! Six more places, each with something that breaks what is too simple: holes, non-square cells, bytes, a zipped
//! tile, systems without a code.

use std::path::{Path, PathBuf};

use sandtable_geom::crs::Crs;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::query::Surface;

use crate::common::data::data;
use crate::common::scratch::Scratch;
use crate::common::shapefile::{self, Shape};
use crate::oracle::{Sample, compare, samples};
use crate::{Pictured, clearance_of_draped, picture};

const SIZE: (u32, u32) = (480, 270);

/// Meters of height; see the same in `swellendam`.
const SOURCE_M: f64 = 1e-4;

/// The folder of a place, and a scratch folder for what is made of it.
fn place(name: &str) -> Option<(PathBuf, Scratch)> {
    data(&format!("scenes/{name}")).map(|place| (place, Scratch::new()))
}

/// Builds `text`, with `PLACE` replaced by the folder of the place and `PROJECT` by the project's.
fn built(scratch: &Scratch, place: &Path, text: &str) -> SceneModel {
    let project = env!("SANDTABLE_ROOT");
    let text = text.replace("PLACE", &place.to_string_lossy()).replace("PROJECT", project);
    let allowed = [place.to_path_buf(), Path::new(project).join("assets")];
    let scene = crate::scene(scratch, &text, &allowed).unwrap_or_else(|error| panic!("{error}"));
    scene.ground().exact().check(scene.ground().layout());
    for note in scene.notes().iter().take(8) {
        println!("note: {note}");
    }
    scene
}

/// The picture of a view; everything in it lies on the ground, and ground fills part of it.
fn pictured(scene: &SceneModel, view: &str, name: &str) -> Pictured {
    let pictured = picture(scene, view, name, SIZE);
    let (clearance, corners) = clearance_of_draped(&pictured.shot);
    println!("{name}: {clearance} m at {corners} draped corners; {:?}", pictured.pixels);
    let drawn = pictured.ground_pixels + pictured.pixels.iter().map(|(_, pixels)| pixels).sum::<usize>();
    assert!(drawn > 5000, "{drawn} pixels");
    pictured
}

fn count(scene: &SceneModel, wanted: FeatureKind) -> usize {
    scene.census().into_iter().find(|(kind, _)| *kind == wanted).map_or(0, |(_, count)| count)
}

/// Holds the source against every sampled vertex; positions in the elevation model's own system `dem`.
fn source_agrees(scene: &SceneModel, place: &Path, dem: &Crs, least: usize) {
    let samples = samples(place);
    assert!(samples.len() >= least, "{} samples", samples.len());
    let at = |sample: &Sample| (dem.clone(), sample.on_dem);
    let off = compare((&scene.heights, &scene.crs), Surface::Source, &samples, at);
    println!("source: max {} m, rms {} m of {}", off.max(), off.rms(), off.sorted.len());
    assert!(off.max() < SOURCE_M);
    let ground = compare((&scene.heights, &scene.crs), Surface::Ground, &samples, at);
    println!("ground: max {} m, rms {} m of {}", ground.max(), ground.rms(), ground.sorted.len());
}

#[test]
fn red_butte_has_a_masked_model_with_a_road_into_the_mask() {
    let Some((place, scratch)) = place("redbutte_us") else { return };
    let scene = built(
        &scratch,
        &place,
        r#"
title = "Red Butte Canyon"
[terrain]
dem = 'PLACE/red_butte_dem.tif'
[style.contours]
interval = 50
[[lake]]
name = "reservoir"
file = 'PLACE/red_butte_reservoir.geojson'
[[road]]
name = "canyon road"
file = 'PLACE/red_butte_road.geojson'
width = 30
[[camera]]
name = "close"
eye = [430300, 4512600]
eye_elevation = 2600
look_at = [432000, 4514700]
"#,
    );
    assert_eq!((count(&scene, FeatureKind::Road), count(&scene, FeatureKind::Lake)), (1, 1));
    assert_eq!(scene.crs, Crs::from_epsg(26912).expect("known"));
    // Far from the reservoir, which is leveled, the ground is the source.
    let boundary: Vec<Sample> =
        samples(&place).into_iter().filter(|it| it.file == "red_butte_rna.geojson").collect();
    let at = |sample: &Sample| (scene.crs.clone(), sample.on_dem);
    let ground = compare((&scene.heights, &scene.crs), Surface::Ground, &boundary, at);
    println!("ground along the mask: max {} m of {}", ground.max(), ground.sorted.len());
    assert!(ground.sorted.len() > 100 && ground.max() < 1e-3);
    let close = pictured(&scene, "close", "redbutte");
    assert!(close.pixels.iter().all(|&(_, pixels)| pixels > 50), "{:?}", close.pixels);
    source_agrees(&scene, &place, &scene.crs, 250);
}

#[test]
fn the_reserve_s_boundary_can_be_a_shore_though_it_runs_along_the_mask() {
    let Some((place, scratch)) = place("redbutte_us") else { return };
    let text = "[terrain]\ndem = 'PLACE/red_butte_dem.tif'\n[[lake]]\nfile = 'PLACE/red_butte_rna.geojson'\nlevel = 2000\n";
    let scene = built(&scratch, &place, text);
    pictured(&scene, "overview", "redbutte_flooded");
}

#[test]
fn crater_lake_has_cells_that_are_not_square() {
    let Some((place, scratch)) = place("crater_lake_bt") else { return };
    let scene = built(
        &scratch,
        &place,
        r##"
title = "Crater Lake"
[terrain]
dem = 'PLACE/crater.bt'
vertical_exaggeration = 1.5
[style]
ramp = [[1500, "#507050"], [1900, "#b0a070"], [2500, "#ffffff"]]
[style.contours]
interval = 100
"##,
    );
    let cell = scene.lattice.cell();
    assert!((cell.x - 20.18225).abs() < 1e-4 && (cell.y - 27.30469).abs() < 1e-4, "{cell}");
    pictured(&scene, "overview", "crater");
}

#[test]
fn taunton_has_trees_on_a_model_of_bytes() {
    let Some((place, scratch)) = place("taunton_uk") else { return };
    let trees = shapefile::read(&place.join("trees.shp"));
    assert_eq!(trees.len(), 52);
    let tree = |shape: &Shape| match shape {
        Shape::Point([x, y]) => {
            format!("[[model]]\nfile = 'PROJECT/assets/models/firtree.obj'\nat = [{x}, {y}]\nscale = 3\n")
        }
        other => panic!("a tree is a point, not {other:?}"),
    };
    let lines = shapefile::read(&place.join("lines.shp"));
    scratch.write("layers/lines.geojson", shapefile::geojson(&lines));
    let mut text = String::from(
        r#"
title = "Taunton"
points_crs = "EPSG:27700"
[terrain]
dem = 'PLACE/dtm.tif'
[[road]]
name = "lines"
file = "../layers/lines.geojson"
crs = "EPSG:27700"
width = 8
[[camera]]
name = "trees"
eye = [321900, 128900]
eye_elevation = 400
look_at = [321850, 129900]
"#,
    );
    text.extend(trees.iter().map(tree));
    let scene = built(&scratch, &place, &text);
    assert_eq!(count(&scene, FeatureKind::Model), 52);
    // One of the four lines lies at (0, 0), 350 km away.
    assert_eq!(count(&scene, FeatureKind::Road), 3);
    let trees = pictured(&scene, "trees", "taunton");
    assert!(trees.pixels.iter().all(|&(_, pixels)| pixels > 30), "{:?}", trees.pixels);
    let crs = Crs::from_epsg(27700).expect("known");
    source_agrees(&scene, &place, &crs, 180);
    // Nothing is resampled and nothing leveled here: the ground is the source, but for its outer half cell.
    let ground = compare((&scene.heights, &crs), Surface::Ground, &samples(&place), |sample| {
        (crs.clone(), sample.on_dem)
    });
    assert!(ground.sorted.len() > 150 && ground.max() < 1e-3, "{} of {}", ground.max(), ground.sorted.len());
}

#[test]
fn monaco_is_a_corner_of_a_zipped_tile() {
    let Some((place, scratch)) = place("monaco") else { return };
    let scene = built(
        &scratch,
        &place,
        r#"
title = "Monaco"
points_crs = "EPSG:4326"
[terrain]
dem = 'PLACE/N43E007.hgt.zip'
[[road]]
file = 'PLACE/derived/roads.geojson'
where = { highway = ["primary", "secondary", "tertiary", "residential"] }
width = 12
[[lake]]
file = 'PLACE/derived/water.geojson'
[[river]]
file = 'PLACE/derived/waterways.geojson'
[[camera]]
name = "harbour"
eye = [7.47, 43.715]
eye_elevation = 1200
look_at = [7.42, 43.738]
[[camera]]
name = "tile"
eye = [7.5, 42.9]
eye_elevation = 60000
look_at = [7.5, 43.5]
field_of_view = 60
"#,
    );
    assert_eq!(count(&scene, FeatureKind::Road), 90 + 80 + 4 + 178);
    assert!(count(&scene, FeatureKind::Lake) >= 6);
    let harbour = pictured(&scene, "harbour", "monaco");
    assert!(harbour.pixels.iter().any(|&(kind, pixels)| kind == FeatureKind::Road && pixels > 300));
    pictured(&scene, "tile", "monaco_tile");
    source_agrees(&scene, &place, &Crs::wgs84(), 380);
}

#[test]
fn porto_alegre_lies_south_and_west() {
    let Some((place, scratch)) = place("porto_alegre_br") else { return };
    let scene = built(
        &scratch,
        &place,
        r#"
title = "Porto Alegre"
points_crs = "EPSG:4326"
[terrain]
dem = 'PLACE/poa_elevation.tif'
vertical_exaggeration = 3
[[road]]
file = 'PLACE/derived/roads_centre.geojson'
where = { highway = ["primary", "secondary", "tertiary"] }
width = 25
[[road]]
name = "paths"
file = 'PLACE/derived/roads_centre.geojson'
where = { highway = ["residential", "path", "track", "footway", "service"] }
surface = "track"
[[lake]]
file = 'PLACE/derived/water.geojson'
[[camera]]
name = "center"
eye = [-51.222, -30.085]
eye_elevation = 2500
look_at = [-51.222, -30.043]
"#,
    );
    assert_eq!(count(&scene, FeatureKind::Road), 103 + 282 + 167 + 250 + 118 + 23 + 389 + 311);
    let center = pictured(&scene, "center", "porto_alegre");
    // Underpasses and tunnels show nothing where no hill rises over them.
    let shown = center.pixels.iter().filter(|(kind, _)| *kind != FeatureKind::Tunnel);
    assert!(
        shown.clone().count() >= 2 && shown.clone().all(|&(_, pixels)| pixels > 0),
        "{:?}",
        center.pixels
    );
    source_agrees(&scene, &place, &Crs::wgs84(), 150);
}

#[test]
fn wake_county_is_in_a_system_without_a_code() {
    let Some((place, scratch)) = place("wake_nc_us") else { return };
    let lakes = shapefile::read(&place.join("lakes.shp"));
    scratch.write("layers/lakes.geojson", shapefile::geojson(&lakes));
    let scene = built(
        &scratch,
        &place,
        r#"
title = "Wake County"
[terrain]
dem = 'PLACE/elev_ned_30m.tif'
vertical_exaggeration = 4
[[lake]]
file = "../layers/lakes.geojson"
"#,
    );
    assert_eq!(count(&scene, FeatureKind::Lake), 6);
    let overview = pictured(&scene, "overview", "wake");
    assert!(overview.pixels.iter().all(|&(_, pixels)| pixels > 10), "{:?}", overview.pixels);
    let dem = scene.crs.clone();
    source_agrees(&scene, &place, &dem, 300);
}

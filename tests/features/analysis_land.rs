//! The land of a scene for terrain analysis: what lets water through its roads, and how high its woods and buildings stand.

use glam::DVec2;
use sandtable_analysis::land::{Crossing, CrossingKind, Land};
use sandtable_catalog::kind::LandPart;
use sandtable_geom::segment;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::land::{land_of, land_of_drawn};
use sandtable_scene::scene_file::{open_scene, open_scene_land};

use crate::common::data::data;
use crate::common::scratch::Scratch;

/// The crossings of a road across a river of a width in meters, on a plane of 300 m by 300 m. `more` are keys of the river.
fn crossings(river_m: f64, more: &str) -> Vec<Crossing> {
    let folder = Scratch::new();
    let heights: Vec<String> = (0..31 * 31).map(|index| format!("{}", 100 + index / 31)).collect();
    let grid = "ncols 31\nnrows 31\nxllcorner -5\nyllcorner -5\ncellsize 10\n";
    folder.write("plane.asc", format!("{grid}{}", heights.join(" ")));
    let scene = format!(
        "[terrain]\ndem = \"plane.asc\"\ncrs = \"EPSG:32633\"\n\
         [[road]]\nname = \"lane\"\nwidth = 4\npoints = [[20, 150], [280, 150]]\n\
         [[river]]\nname = \"brook\"\nwidth = {river_m}\npoints = [[150, 280], [150, 20]]\n{more}\n"
    );
    let scene = open_scene(&folder.write("scene.toml", scene), &[], &|_| {});
    let land = land_of(&scene.unwrap_or_else(|failure| panic!("{failure:?}")), &[LandPart::Crossings]);
    assert!(land.knows(LandPart::Crossings) && !land.knows(LandPart::Roads));
    land.crossings
}

#[test]
fn a_road_over_a_narrow_brook_has_a_culvert_there() {
    let found = crossings(2.0, "");
    let [culvert] = &found[..] else { panic!("{found:?}") };
    assert_eq!(
        (culvert.kind, culvert.name.as_str(), culvert.width_m),
        (CrossingKind::InferredCulvert, "lane", 4.0)
    );
    let [from, to] = [culvert.line[0], culvert.line[culvert.line.len() - 1]];
    assert!(from.distance(DVec2::new(140.0, 150.0)) < 0.1 && to.distance(DVec2::new(160.0, 150.0)) < 0.1);
    assert!(crossings(5.0, "").is_empty(), "a wider river needs a bridge");
}

#[test]
fn a_river_in_a_culvert_is_one_crossing_along_its_water() {
    for width_m in [2.0, 5.0] {
        let found = crossings(width_m, "culvert = \"true\"");
        let [culvert] = &found[..] else { panic!("{found:?}") };
        assert_eq!(
            (culvert.kind, culvert.name.as_str(), culvert.width_m),
            (CrossingKind::Culvert, "brook", width_m)
        );
        let ends = [culvert.line[0], culvert.line[culvert.line.len() - 1]].map(|at| at.y.round());
        assert!(ends == [20.0, 280.0] || ends == [280.0, 20.0], "{ends:?}");
    }
    assert_eq!(crossings(2.0, "culvert = \"false\"")[0].kind, CrossingKind::InferredCulvert);
}

#[test]
fn the_stream_of_monaco_that_openstreetmap_has_in_a_tunnel_is_a_culvert() {
    let Some(place) = data("scenes/monaco") else { return };
    let folder = Scratch::new();
    let source = |table: &str, more: &str| {
        format!("[[{table}]]\nfile = '{}'\nlayer = \"{more}\"\n", place.join("monaco.osm.gz").display())
    };
    let scene = format!(
        "points_crs = \"EPSG:4326\"\n[terrain]\ndem = '{}'\n{}width = 2\nwater = \"drape\"\n{}profile = \"drape\"\n",
        place.join("N43E007.hgt.zip").display(),
        source("river", "waterways"),
        source("road", "roads"),
    );
    let scene = open_scene(&folder.write("scene.toml", scene), &[place], &|_| {});
    let scene = scene.unwrap_or_else(|failure| panic!("{failure:?}"));
    let rivers = scene.features.iter().filter(|feature| feature.kind == FeatureKind::River).count();
    assert_eq!((rivers, scene.culverts.len()), (3, 1));
    let land = land_of(&scene, &[LandPart::Crossings]);
    let culverts: Vec<&Crossing> =
        land.crossings.iter().filter(|crossing| crossing.kind == CrossingKind::Culvert).collect();
    let [culvert] = &culverts[..] else { panic!("{culverts:?}") };
    assert_eq!((culvert.line.len(), culvert.width_m), (2, 2.0));
    // No road over it has an inferred one as well.
    let ends = (culvert.line[0], culvert.line[1]);
    let inferred = land.crossings.iter().filter(|crossing| crossing.kind == CrossingKind::InferredCulvert);
    for road in inferred {
        let over = road.line.windows(2).any(|leg| segment::crossing((leg[0], leg[1]), ends).is_some());
        assert!(!over, "{road:?}");
    }
}

#[test]
fn on_an_exaggerated_scene_buildings_have_their_heights_true_to_scale() {
    let folder = Scratch::new();
    let heights: Vec<String> =
        (0..31 * 31).map(|index| format!("{:.1}", 100.3 + 0.7 * f64::from(index / 31))).collect();
    let grid = "ncols 31\nnrows 31\nxllcorner -5\nyllcorner -5\ncellsize 10\n";
    folder.write("plane.asc", format!("{grid}{}", heights.join(" ")));
    let house = |south: u32| {
        let north = south + 25;
        format!(
            "[[building]]\npoints = [[100, {south}], [131, {south}], [131, {north}], [100, {north}]]\nheight = 7.3\n"
        )
    };
    let houses: String = (0..5).map(|row| house(20 + row * 50)).collect();
    let scene = format!(
        "[terrain]\ndem = \"plane.asc\"\ncrs = \"EPSG:32633\"\nvertical_exaggeration = 1.7\n{houses}"
    );
    let path = folder.write("scene.toml", scene);
    let drawn = open_scene(&path, &[], &|_| {}).unwrap_or_else(|failure| panic!("{failure:?}"));
    let reopen = || open_scene_land(&path, &[], &|_| {});
    let true_to_scale = reopen().unwrap_or_else(|failure| panic!("{failure:?}"));
    let bits =
        |land: Land| -> Vec<u32> { land.obstacles_m.expect("known").into_iter().map(f32::to_bits).collect() };
    let layers = [LandPart::Obstacles];
    let wanted = bits(land_of(&true_to_scale, &layers));
    let found = land_of_drawn(&drawn, &layers, reopen).unwrap_or_else(|failure| panic!("{failure:?}"));
    assert!(bits(found) == wanted && wanted.iter().any(|&bits| f32::from_bits(bits) > 5.0));
    assert!(bits(land_of(&drawn, &layers)) != wanted, "the drawn scene has them in other bits");
    let same = land_of_drawn(&true_to_scale, &layers, || -> Result<_, ()> { Err(()) });
    assert!(bits(same.expect("nothing is opened again")) == wanted);
}

/// The heights of what stands at posts of a row of the land of a scene with these tables, 31 posts 10 m apart.
fn standing(tables: &str) -> Vec<f32> {
    let folder = Scratch::new();
    let grid = "ncols 31\nnrows 31\nxllcorner -5\nyllcorner -5\ncellsize 10\n";
    folder.write("plane.asc", format!("{grid}{}", vec!["100"; 31 * 31].join(" ")));
    let scene = format!("[terrain]\ndem = \"plane.asc\"\ncrs = \"EPSG:32633\"\n{tables}");
    let scene = open_scene(&folder.write("scene.toml", scene), &[], &|_| {});
    let land = land_of(&scene.unwrap_or_else(|failure| panic!("{failure:?}")), &[LandPart::Obstacles]);
    land.obstacles_m.expect("known")[15 * 31..][..31].to_vec()
}

#[test]
fn a_forest_stands_as_high_as_its_trees_and_without_any_as_usual() {
    let forest = "[[area]]\ncover = \"forest\"\npoints = [[45, 45], [255, 45], [255, 255], [45, 255]]\n";
    let plain = standing(forest);
    assert_eq!((plain[3], plain[7], plain[23], plain[27]), (0.0, 15.0, 15.0, 0.0), "{plain:?}");
    let road = "[[road]]\nwidth = 30\npoints = [[150, 20], [150, 280]]\n";
    let cut = standing(&format!("{forest}{road}"));
    assert_eq!((cut[12], cut[15], cut[18]), (15.0, 0.0, 15.0), "nothing grows on a road: {cut:?}");
    let trees = "[[scatter]]\nof = \"conifer\"\ndensity = 400\nscale = [1, 1]\n\
                 points = [[45, 45], [255, 45], [255, 255], [45, 255]]\n";
    let grown = standing(&format!("{forest}{trees}"));
    let tallest = grown[7..=23].iter().fold(0.0_f32, |tallest, &height| tallest.max(height));
    assert!(grown[7..=23].iter().all(|&height| height > 0.5 * tallest), "no gaps between crowns: {grown:?}");
    assert!(tallest > 2.0 && tallest != 15.0, "{tallest}");
    let orchard = standing(&forest.replace("forest", "orchard"));
    assert_eq!(orchard[15], 4.0);
}

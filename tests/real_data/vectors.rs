//! Scenes whose features come as people have them: a GeoPackage and shapefiles, OpenStreetMap as XML and as protocol
//! buffers, nothing converted.

use std::path::Path;

use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;

use crate::common::data::data;
use crate::common::scratch::Scratch;
use crate::{clearance_of_draped, picture, scene};

fn built(text: &str, place: &Path) -> Result<SceneModel, String> {
    let text = text.replace("PLACE", &place.to_string_lossy());
    scene(&Scratch::new(), &text, &[place.to_path_buf()])
}

fn count(scene: &SceneModel, wanted: FeatureKind) -> usize {
    scene.census().into_iter().find(|(kind, _)| *kind == wanted).map_or(0, |(_, count)| count)
}

/// Everything draped lies on the ground, and every kind of feature shows.
fn shows_everything(scene: &SceneModel, name: &str) {
    let pictured = picture(scene, "view", name, (960, 540));
    let (clearance, corners) = clearance_of_draped(&pictured.shot);
    println!("{name}: {clearance} m at {corners} draped corners; {:?}", pictured.pixels);
    // Tunnels show nothing but their portals, and those only where a hill rises over them.
    let shown = |&(kind, pixels): &(FeatureKind, usize)| kind == FeatureKind::Tunnel || pixels > 0;
    assert!(pictured.pixels.iter().all(shown), "{:?}", pictured.pixels);
}

const SWELLENDAM: &str = r#"
title = "Swellendam"
points_crs = "EPSG:4326"
[terrain]
dem = 'PLACE/dem_srtm_wgs84_f32.tif'
vertical_exaggeration = 1.5
[[river]]
file = 'PLACE/rivers.shp'
width = 60
[[lake]]
file = 'PLACE/water.shp'
[[road]]
file = 'PLACE/training_data.gpkg'
layer = "roads"
where = { highway = ["primary", "secondary", "trunk", "tertiary", "unclassified"] }
width = 40
[[camera]]
name = "view"
eye = [20.46, -34.14]
eye_elevation = 3000
look_at = [20.46, -34.02]
"#;

#[test]
fn swellendam_has_roads_of_a_geopackage_and_water_of_shapefiles() {
    let Some(place) = data("scenes/swellendam_za") else { return };
    let scene = built(SWELLENDAM, &place).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(count(&scene, FeatureKind::Lake), 37);
    assert!(count(&scene, FeatureKind::Road) > 50 && count(&scene, FeatureKind::River) >= 6);
    shows_everything(&scene, "swellendam_vectors");
}

#[test]
fn a_layer_that_is_not_there_is_pointed_at_with_those_that_are() {
    let Some(place) = data("scenes/swellendam_za") else { return };
    let wrong = |text: &str| built(text, &place).err().expect("it cannot be built");
    let error = wrong(&SWELLENDAM.replace("\"roads\"", "\"road\""));
    assert!(error.contains("has no layer 'road'; did you mean 'roads'?"), "{error}");
    assert!(error.contains("layer = \"road\"") && error.contains("buildings"), "{error}");
    let error = wrong(&SWELLENDAM.replace("layer = \"roads\"\n", ""));
    assert!(error.contains("holds 4 layers") && error.contains("add `layer"), "{error}");
}

#[test]
fn monaco_and_porto_alegre_come_straight_from_openstreetmap() {
    for (name, dem, osm, eye, look_at, elevation) in [
        ("monaco", "N43E007.hgt.zip", "monaco.osm.gz", "[7.452, 43.722]", "[7.42, 43.738]", 1500),
        ("porto_alegre_br", "poa_elevation.tif", "poa_osm.pbf", "[-51.25, -30.16]", "[-51.2, -30.06]", 6000),
    ] {
        let Some(place) = data(&format!("scenes/{name}")) else { return };
        let text = format!(
            r#"
title = "{name}"
points_crs = "EPSG:4326"
[terrain]
dem = 'PLACE/{dem}'
[[road]]
file = 'PLACE/{osm}'
layer = "roads"
where = {{ highway = ["motorway", "trunk", "primary", "secondary", "tertiary"] }}
width = 12
[[lake]]
file = 'PLACE/{osm}'
layer = "water"
[[camera]]
name = "view"
eye = {eye}
eye_elevation = {elevation}
look_at = {look_at}
"#
        );
        let scene = built(&text, &place).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(count(&scene, FeatureKind::Road) > 50 && count(&scene, FeatureKind::Lake) > 0, "{name}");
        shows_everything(&scene, &format!("{name}_vectors"));
    }
}

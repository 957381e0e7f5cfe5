//! Heights, roofs and parts of buildings as OpenStreetMap writes them: what is meant is drawn, and what is not understood is
//! reported.

use sandtable_description::finding_code::FindingCode;
use sandtable_draw::list::FeatureId;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;
use sandtable_structure::building;

use crate::level_ground::{Read, degrees, written};

/// The elevation of the ground, meters.
const GROUND_M: f64 = 100.0;

/// A house from west to east in GeoJSON, 12 m by 8 m, its south-west corner at meters from that of the ground.
fn house(x: f64, y: f64, properties: &str) -> String {
    let corners = [(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0), (0.0, 0.0)];
    let ring: Vec<String> =
        corners.iter().map(|(dx, dy)| format!("[{}]", written(degrees(x + dx, y + dy), ","))).collect();
    let ring = ring.join(",");
    format!(
        r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"Polygon","coordinates":[[{ring}]]}}}}"#
    )
}

/// A scene of houses.
fn town(houses: &[String]) -> Read {
    let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, houses.join(","));
    Read::new("[[building]]\nfile = \"town.geojson\"\n", "town.geojson", text)
}

/// A scene of a row of houses with these properties.
fn row(properties: &[String]) -> Read {
    let house = |(index, properties): (usize, &String)| {
        house(20.0 + 20.0 * (index % 18) as f64, 20.0 + 20.0 * (index / 18) as f64, properties)
    };
    town(&properties.iter().enumerate().map(house).collect::<Vec<_>>())
}

/// The lowest and the highest corner of each building, above the ground.
fn extents(scene: &SceneModel) -> Vec<[f64; 2]> {
    let mut extents = vec![[f64::INFINITY, f64::NEG_INFINITY]; scene.features.len()];
    for solid in &scene.solids {
        let index = solid.feature.index().expect("a feature");
        for vertex in &solid.mesh.vertices {
            let z = f64::from(vertex.position[2]) - GROUND_M;
            extents[index] = [extents[index][0].min(z), extents[index][1].max(z)];
        }
    }
    extents
}

/// How high each house of a row rises.
fn heights(read: &Read) -> Vec<f64> {
    extents(&read.scene()).iter().map(|[_, top]| (top * 1e3).round() / 1e3).collect()
}

#[test]
fn heights_and_levels_are_read_as_people_write_them() {
    let cases = [
        (r#""height":"12,5""#, 12.5),
        (r#""height":"12.0 ; 14""#, 14.0),
        (r#""height":"ca. 12""#, 12.0),
        (r#""height":"~12""#, 12.0),
        (r#""height":"12 metres""#, 12.0),
        (r#""height":"40'""#, 12.192),
        (r#""height":"39'4\"""#, 11.989),
        (r#""height":12.5"#, 12.5),
        (r#""building:levels":"3;4""#, 12.0),
        (r#""building:levels":"2-3""#, 9.0),
        (r#""building:levels":"3.5""#, 10.5),
        (r#""building:levels":"2","roof:levels":"1""#, 9.0),
        (r#""height":"tall","building:levels":"3""#, 9.0),
    ];
    let read = row(&cases.map(|(properties, _)| properties.to_owned()));
    assert_eq!(heights(&read), cases.map(|(_, height)| height));
    assert_eq!(
        read.messages(FindingCode::DefaultTaken),
        [
            "building:levels: 2 features have several numbers, '3;4', '2-3'; the greatest was taken",
            "height: 1 feature has several numbers, '12.0 ; 14'; the greatest was taken",
            "height: 1 feature has what is not understood, 'tall'; the default was taken",
        ]
    );
}

#[test]
fn a_height_that_is_not_understood_is_the_default_and_is_reported() {
    let texts = ["tall", "1,234", "-5", "0", "12;tall"];
    let read = row(&texts.map(|text| format!("\"height\":\"{text}\"")));
    assert_eq!(heights(&read), [6.0; 5]);
    assert_eq!(
        read.messages(FindingCode::DefaultTaken),
        [
            "height: 2 features have a number out of its range, '-5', '0'; the default was taken",
            "height: 3 features have what is not understood, 'tall', '1,234', '12;tall'; the default was taken",
        ]
    );
    let stated = r#"[[building]]
file = "town.geojson"
height = 8
"#;
    let text =
        format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, house(20.0, 20.0, r#""height":"tall""#));
    let read = Read::new(stated, "town.geojson", text);
    assert!(read.messages(FindingCode::DefaultTaken).is_empty(), "the table states the height");
}

/// How far eaves reach out over the walls, meters.
const EAVES_M: f64 = 0.45;

/// How far the highest corners of a house reach in plan: of the ridge of a roof, or of the high side of one slope.
fn ridge(scene: &SceneModel, number: usize) -> [f64; 2] {
    let id = FeatureId(FeatureId::GROUND.0 + 1 + number as u32);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let corners = scene
        .solids
        .iter()
        .filter(|solid| solid.feature == id)
        .flat_map(|solid| solid.mesh.vertices.iter().map(|vertex| vertex.position));
    let corners: Vec<[f32; 3]> = corners.collect();
    let top = corners.iter().map(|at| at[2]).fold(f32::NEG_INFINITY, f32::max);
    for at in corners.iter().filter(|at| at[2] > top - 1e-3) {
        for axis in 0..2 {
            low[axis] = low[axis].min(f64::from(at[axis]));
            high[axis] = high[axis].max(f64::from(at[axis]));
        }
    }
    // Without the eaves, which reach out at both ends.
    [high[0] - low[0], high[1] - low[1]].map(|span| (span - 2.0 * EAVES_M).max(0.0).round())
}

#[test]
fn a_roof_is_turned_as_its_properties_say() {
    let gabled = |turn: &str| format!(r#""height":12,"roof:shape":"gabled"{turn}"#);
    let read = row(&[
        gabled(""),
        gabled(r#","roof:orientation":"across""#),
        gabled(r#","roof:direction":"90""#),
        gabled(r#","roof:direction":"S""#),
        r#""height":12,"roof:shape":"skillion","roof:direction":"N""#.to_owned(),
        r#""height":12,"roof:shape":"skillion","roof:direction":270"#.to_owned(),
        gabled(r#","roof:direction":"forward""#),
        gabled(r#","roof:orientation":"diagonal""#),
    ]);
    let scene = read.scene();
    let ridges: Vec<[f64; 2]> = (0..8).map(|number| ridge(&scene, number)).collect();
    let (along, across) = ([12.0, 0.0], [0.0, 8.0]);
    assert_eq!(ridges, [along, across, across, along, along, across, along, along]);
    let messages = read.messages(FindingCode::DefaultTaken);
    let expected = [
        "roof:direction: 1 feature has what is not understood, 'forward'; the default was taken",
        "roof:orientation: 1 feature has what is not understood, 'diagonal'; the default was taken",
    ];
    assert_eq!(messages, expected);
}

#[test]
fn a_key_turns_the_roofs_of_a_table() {
    let table = "[[building]]\nfile = \"town.geojson\"\nroof = \"gabled\"\nroof_direction = 90\n";
    let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, house(20.0, 20.0, ""));
    assert_eq!(ridge(&Read::new(table, "town.geojson", text).scene(), 0), [0.0, 8.0]);
}

#[test]
fn every_shape_is_drawn_or_reported_by_name() {
    let drawn = [
        "flat",
        "gabled",
        "hipped",
        "pyramidal",
        "skillion",
        "half-hipped",
        "gambrel",
        "saltbox",
        "mansard",
        "round",
        "dome",
        "cone",
    ];
    let shapes = |names: &[&str]| {
        let properties: Vec<String> =
            names.iter().map(|name| format!(r#""height":12,"roof:shape":"{name}""#)).collect();
        row(&properties)
    };
    let read = shapes(&drawn);
    assert!(read.messages(FindingCode::RoofReplaced).is_empty(), "{:?}", read.findings());
    let scene = read.scene();
    for solid in &scene.solids {
        assert!(building::check(&solid.mesh).is_ok());
    }
    let read = shapes(&["onion", "sawtooth", "butterfly", "side_hipped", "many"]);
    assert_eq!(
        read.messages(FindingCode::RoofReplaced),
        [
            "roof:shape: 1 feature has what is not drawn, 'many'; drawn as flat",
            "roof:shape: 1 feature has what is not drawn, 'onion'; drawn as dome",
            "roof:shape: 1 feature has what is not drawn, 'side_hipped'; drawn as hipped",
            "roof:shape: 2 features have what is not drawn, 'sawtooth', 'butterfly'; drawn as gabled",
        ]
    );
}

#[test]
fn the_pitch_of_a_roof_is_an_angle_a_height_or_a_number_of_levels() {
    let read = row(&[
        r#""height":12,"roof:shape":"gabled","roof:angle":45"#.to_owned(),
        r#""height":12,"roof:shape":"gabled","roof:height":"1,5""#.to_owned(),
        r#""height":12,"roof:shape":"gabled","roof:levels":"1""#.to_owned(),
    ]);
    let scene = read.scene();
    let eaves = |number: u32| {
        let id = FeatureId(FeatureId::GROUND.0 + 1 + number);
        let solid = scene.solids.iter().find(|solid| solid.feature == id).expect("raised");
        let zs = solid.mesh.vertices.iter().map(|vertex| f64::from(vertex.position[2]) - GROUND_M);
        zs.filter(|z| *z < 11.9).fold(f64::NEG_INFINITY, f64::max)
    };
    for (number, wanted) in [(0, 8.0), (1, 10.5), (2, 9.0)] {
        assert!((eaves(number) - wanted).abs() < 1e-2, "{number}: {}", eaves(number));
    }
}

#[test]
fn parts_that_cover_a_building_are_drawn_in_its_place() {
    let covered = [
        house(100.0, 100.0, r#""building":"yes","height":30"#),
        house(100.0, 100.0, r#""building:part":"yes","height":10"#),
        house(100.0, 100.0, r#""building:part":"yes","height":60,"min_height":10"#),
    ];
    let read = town(&covered);
    let extents = extents(&read.scene());
    assert_eq!(extents.len(), 2, "two parts and no outline");
    assert!((extents[0][1] - 10.0).abs() < 1e-3 && extents[0][0] < 0.0, "{extents:?}");
    assert!((extents[1][0] - 10.0).abs() < 1e-3 && (extents[1][1] - 60.0).abs() < 1e-3, "{extents:?}");
    let expected = "1 building left out: drawn by parts (building:part) in place of the whole";
    assert_eq!(read.messages(FindingCode::LeftOut), [expected]);
}

#[test]
fn an_outline_that_its_parts_do_not_cover_is_drawn_as_well() {
    let corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (0.0, 30.0), (0.0, 0.0)];
    let ring: Vec<String> =
        corners.iter().map(|(x, y)| format!("[{}]", written(degrees(100.0 + x, 100.0 + y), ","))).collect();
    let ring = ring.join(",");
    let church = format!(
        r#"{{"type":"Feature","properties":{{"building":"church"}},"geometry":{{"type":"Polygon","coordinates":[[{ring}]]}}}}"#
    );
    let tower = house(102.0, 102.0, r#""building:part":"yes","height":40"#);
    let elsewhere = house(200.0, 200.0, r#""building:part":"yes","height":7"#);
    let read = town(&[church, tower, elsewhere]);
    assert_eq!(read.built(FeatureKind::Building), 3);
    let expected = "1 building drawn beside parts (building:part), which do not cover the outline";
    assert_eq!(read.messages(FindingCode::LeftOut), [expected]);
}

#[test]
fn heights_of_fences_and_layers_of_roads_are_read_alike() {
    let line = |y: f64, properties: &str| {
        let (from, to) = (written(degrees(50.0, y), ","), written(degrees(350.0, y), ","));
        format!(
            r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"LineString","coordinates":[[{from}],[{to}]]}}}}"#
        )
    };
    let text = format!(
        r#"{{"type":"FeatureCollection","features":[{},{},{}]}}"#,
        line(100.0, r#""height":"2,5 m","layer":"1;2""#),
        line(200.0, r#""height":"high","layer":"top""#),
        line(300.0, ""),
    );
    let tables = "[[fence]]\nfile = \"a.geojson\"\nkind = \"wall\"\n[[road]]\nfile = \"a.geojson\"\n";
    let read = Read::new(tables, "a.geojson", text);
    let expected = [
        "height: 1 feature has what is not understood, 'high'; the default was taken",
        "layer: 1 feature has several numbers, '1;2'; the greatest was taken",
        "layer: 1 feature has what is not understood, 'top'; the default was taken",
    ];
    assert_eq!(read.messages(FindingCode::DefaultTaken), expected);
}

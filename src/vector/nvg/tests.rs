//! NVG files that are read.

use super::*;
use crate::feature::{Feature, Geometry};
use crate::read;

fn layer(body: &str) -> VectorLayer {
    let text = format!(
        "<?xml version='1.0'?><nvg:nvg xmlns:nvg='https://tide.act.nato.int/schemas/2012/10/nvg' version='2.0.0'>{body}</nvg:nvg>"
    );
    read::read("a.nvg", text.as_bytes(), &VectorHints::default()).expect("an NVG file")
}

fn text<'a>(feature: &'a Feature, property: &str) -> &'a str {
    feature.properties.get(property).and_then(serde_json::Value::as_str).unwrap_or_default()
}

#[test]
fn points_have_their_symbol_fields_style_and_course() {
    let layer = layer(
        "<nvg:point x='15.5' y='60' symbol='app6b:SFGPUCI----D---' label='A' uri='u:1' course='45' modifiers='T:1-77;M:3 BDE;ZZ:x'>\
         <nvg:textInfo>said</nvg:textInfo><nvg:timeStamp>2026-05-01T06:00:00Z</nvg:timeStamp>\
         <nvg:ExtendedData><nvg:Section><nvg:SimpleData key='fuel'>low</nvg:SimpleData></nvg:Section></nvg:ExtendedData></nvg:point>",
    );
    let point = &layer.features[0];
    for (property, expected) in [
        ("sidc", "SFGPUCI----D---"),
        ("name", "A"),
        ("id", "u:1"),
        ("direction", "45"),
        ("unique_designation", "1-77"),
        ("higher_formation", "3 BDE"),
        ("description", "said"),
        ("begin", "2026-05-01T06:00:00Z"),
        ("fuel", "low"),
    ] {
        assert_eq!(text(point, property), expected, "{property}");
    }
}

#[test]
fn every_shape_is_computed_on_the_ground() {
    let layer = layer(
        "<g label='shapes' style='stroke:#ff0000'>\
         <circle cx='17' cy='60' r='5000' style='fill:lime'><exclude><linear-ring points='17,60 17.03,59.98 17.03,60.03'/></exclude></circle>\
         <ellipse cx='17' cy='60' rx='5000' ry='2000' rotation='30'/><rect cx='17' cy='60' rx='5000' ry='2000'/>\
         <arcband cx='17' cy='60' minr='20000' maxr='30000' startangle='315' endangle='5'/>\
         <arc cx='17' cy='60' rx='20000' ry='20000' startangle='0' endangle='90'/>\
         <corridor points='15,60 16,60 16,60.5' width='5000'/><arrow points='15,60 16,60' width='5000'/>\
         <corridor points='15,60 16,60 16,60.5' width='5000' symbol='app6a:G*C*MALC--*****'/>\
         <composite symbol='app6a:GFGPOLAV------X' label='axis'><polyline points='15,60 16,60'/><point x='15' y='60'/></composite></g>",
    );
    let kinds: Vec<&str> = layer.features.iter().map(|feature| feature.geometry.kind()).collect();
    let expected = [
        "polygons", "polygons", "polygons", "polygons", "lines", "polygons", "polygons", "lines", "lines",
        "points",
    ];
    assert_eq!(kinds, expected);
    assert!(matches!(&layer.features[0].geometry, Geometry::Polygons(found) if found[0].holes.len() == 1));
    assert_eq!(
        [text(&layer.features[0], "stroke"), text(&layer.features[0], "fill")],
        ["#ff0000", "#00ff00"]
    );
    assert_eq!(layer.features[7].properties["width"], 5000.0);
    let codes = [7, 8, 9].map(|index| text(&layer.features[index], "sidc"));
    assert_eq!(codes, ["GFGPALC--------", "GFGPOLAV------X", ""], "a composite has its symbol once");
    assert_eq!(text(&layer.features[9], "name"), "axis");
    assert!(layer.features.iter().all(|feature| text(feature, "layer") == "shapes"));
}

#[test]
fn what_is_odd_is_told_with_its_line_and_the_rest_is_read() {
    let layer = layer(
        "<point x='15' y='60'/>\n<circle cx='17' cy='60' r='1e30'/>\n<polyline points='a,b'/>\n<point x='1' y='95'/>\n<blob/>",
    );
    assert_eq!(layer.features.len(), 1);
    let told = layer.reading_notes().cloned().collect::<Vec<_>>().join("\n");
    for expected in
        ["line 2: 'circle' has no outline", "line 3: 'a,b' is no longitude", "element of an unknown kind"]
    {
        assert!(told.contains(expected), "{told}");
    }
}

/// The bearing in degrees and the distance in meters of a vertex from the center of the shapes.
fn from_center(at: glam::DVec2) -> [f64; 2] {
    let line = sandtable_geom::geodesic::Geodesic::between(glam::DVec2::new(17.0, 60.0), at);
    [line.bearing_deg().rem_euclid(360.0), line.length_m()]
}

#[test]
fn rotations_are_counterclockwise_and_directions_clockwise() {
    let layer = layer(
        "<ellipse cx='17' cy='60' rx='5000' ry='2000' rotation='30'/>\
         <arc cx='17' cy='60' rx='5000' ry='2000' startangle='90' endangle='180' rotation='30'/>\
         <rect cx='17' cy='60' rx='4000' ry='3000' rotation='10'/>",
    );
    let farthest = layer.features[0].geometry.vertices().map(|at| from_center(*at));
    let [bearing, length_m] = farthest.max_by(|a, b| a[1].total_cmp(&b[1])).expect("vertices");
    assert!(
        (length_m - 5000.0).abs() < 1e-3 && ((bearing % 180.0) - 60.0).abs() < 1e-6,
        "{bearing} {length_m}"
    );
    let arc = &layer.features[1].lines()[0];
    let ends = [arc[0], arc[arc.len() - 1]].map(from_center);
    assert!((ends[0][0] - 60.0).abs() < 1e-6 && (ends[0][1] - 5000.0).abs() < 1e-3, "{ends:?}");
    assert!((ends[1][0] - 150.0).abs() < 1e-6 && (ends[1][1] - 2000.0).abs() < 1e-3, "{ends:?}");
    let corner = from_center(layer.features[2].polygons()[0].exterior[0]);
    assert!((corner[1] - 5000.0).abs() < 1e-3, "{corner:?}");
    assert!((corner[0] - (4f64.atan2(3.0).to_degrees() - 10.0)).abs() < 1e-6, "{corner:?}");
}

#[test]
fn areas_exclude_rings_of_every_kind_and_orbits_are_racetracks() {
    let layer = layer(
        "<circle cx='17' cy='60' r='9000'><exclude><circular-ring cx='17' cy='60' r='100'/>\
         <elliptical-ring cx='17.02' cy='60' rx='200' ry='100'/><rectangular-ring cx='17.04' cy='60' rx='200' ry='100'/>\
         <arcband-ring cx='16.95' cy='60' minr='100' maxr='200' startangle='0' endangle='90'/></exclude></circle>\
         <orbit points='15,60 15,60.5' width='2000' alignment='LEFT'/><orbit points='15,60 15,60.5 16,60.5' width='2000'/>\
         <circle cx='17' cy='60' r='9000'><exclude><hexagon/></exclude></circle>",
    );
    assert_eq!(layer.features.len(), 2);
    assert_eq!(layer.features[0].polygons()[0].holes.len(), 4);
    assert!(layer.features[1].geometry.vertices().all(|at| at.x < 15.0001), "left of its line");
    let faults = layer.faults.join("\n");
    assert!(
        faults.contains("an orbit has two points, this one 3") && faults.contains("excludes 'hexagon'"),
        "{faults}"
    );
}

#[test]
fn version_1_4_has_its_styles_in_attributes_and_speeds_in_knots() {
    let text_of_file = "<nvg xmlns='http://tide.act.nato.int/schemas/2008/10/nvg' version='1.4.0'><g label='Blue' stroke='red' stroke-width='2'>\
        <point x='1' y='2' symbol='2525b:S*GPUCI---*****' speed='12.5' modifiers='F:RD;T:1:2' timestamp='2026-05-01T06:00:00Z'/>\
        <multipoint points='1,2 1.5,2 1.5,2.5' symbol='2525b:GFTPC-----****X' fill='#00f' style='stroke:lime'/>\
        <point x='1' y='2' symbol='icons:tank'/></g></nvg>";
    let layer = read::read("a.xml", text_of_file.as_bytes(), &VectorHints::default()).expect("an NVG file");
    let [unit, task, other] = &layer.features[..] else { panic!("three: {:?}", layer.features) };
    let of = |feature, keys: [&'static str; 4]| keys.map(|key| text(feature, key).to_owned());
    assert_eq!(
        of(unit, ["sidc", "speed", "reinforced", "unique_designation"]),
        ["SUGPUCI--------", "12.5 kt", "(±)", "1:2"]
    );
    assert_eq!(
        of(unit, ["stroke", "layer", "begin", "fill"]),
        ["#ff0000", "Blue", "2026-05-01T06:00:00Z", ""]
    );
    assert_eq!(of(task, ["stroke", "fill", "sidc", "name"]), ["#00ff00", "#0000ff", "GFTPC---------X", ""]);
    assert_eq!((task.lines()[0].len(), text(other, "sidc")), (3, ""));
    assert!(layer.faults[0].contains("1 element has a symbol that is no code"), "{:?}", layer.faults);
}

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
         <composite symbol='app6a:GFGPOLAV------X'><polyline points='15,60 16,60'/><point x='15' y='60'/></composite></g>",
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
        ["line 2: the r of 'circle'", "line 3: 'a,b' is no longitude", "element of an unknown kind"]
    {
        assert!(told.contains(expected), "{told}");
    }
}

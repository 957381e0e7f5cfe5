//! Scenarios of ORBAT Mapper that are read.

use super::*;
use crate::feature::{Feature, Geometry};
use crate::read;

const SCENARIO: &str = r##"{"id": "x", "type": "ORBAT-mapper", "version": "3.3.0", "name": "A crossing",
  "startTime": "2026-05-01T04:00:00Z",
  "sides": [
    {"name": "Blue", "standardIdentity": "3", "groups": [{"name": "g", "subUnits": [
      {"id": "b", "name": "1st Brigade", "shortName": "1 BDE", "sidc": "10011000181211020000", "location": [-84.2, 36.3],
       "textAmplifiers": {"higherFormation": "2 DIV", "W": "010400ZMAY26"}, "reinforcedStatus": "Reduced",
       "state": [{"t": "2026-05-01T06:00:00+02:00", "sidc": "10031040181211020000"},
                 {"t": 1777615200000, "location": [-84.1, 36.35]},
                 {"t": "2026-05-01T12:00:00Z", "location": null}],
       "subUnits": [{"id": "c", "name": "A Company", "sidc": "10031000151211020000"}]},
      {"id": "d", "name": "Train", "sidc": "10031000151600000000", "state": [{"t": "soon", "location": [0, 0]}]}]}]},
    {"name": "Red", "standardIdentity": "6", "subUnits": [
      {"name": "3 BN", "sidc": "SHGPUCI----F---", "location": [-84.0, 36.4]}]}],
  "layerStack": [{"name": "Plan", "kind": "overlay", "items": [
    {"kind": "tacticalGraphic", "name": "PL BLUE", "graphicKind": "phase-line", "standardIdentity": "3", "status": "planned",
     "controlPoints": [[-84.3, 36.2], [-84.0, 36.2]], "textAmplifiers": {"T": "BLUE"}},
    {"kind": "geometry", "name": "Zone", "geometry": {"type": "Point", "coordinates": [-84.2, 36.3]},
     "geometryMeta": {"geometryKind": "Circle", "radius": 2500}, "style": {"fill": null, "stroke": "#7F1D1D", "stroke-width": 4}},
    {"kind": "annotation", "anchor": {"type": "point", "position": [-84.2, 36.3]}, "content": {"text": "before"},
     "state": [{"t": "2026-05-01T06:00:00Z", "patch": {"content": {"text": "after"}}}]},
    {"kind": "measurement", "name": "Frontage"},
    {"kind": "geometry", "name": "Secret", "isHidden": true, "geometry": {"type": "Point", "coordinates": [0, 0]}},
    {"kind": "geometry", "name": "Too wide", "geometry": {"type": "Point", "coordinates": [0, 0]},
     "geometryMeta": {"geometryKind": "Circle", "radius": 1e30}}]}]}"##;

fn scenario(layer: Option<&str>) -> VectorLayer {
    let hints = VectorHints { layer, ..VectorHints::default() };
    read::read("crossing.json", SCENARIO.as_bytes(), &hints).expect("a scenario")
}

fn text<'a>(feature: &'a Feature, property: &str) -> &'a str {
    feature.properties.get(property).and_then(Value::as_str).unwrap_or_default()
}

#[test]
fn a_unit_is_a_feature_for_each_state_in_which_it_has_a_place() {
    let layer = scenario(Some("units"));
    let brigade: Vec<&Feature> = layer.features.iter().filter(|unit| text(unit, "id") == "b").collect();
    let times: Vec<[&str; 2]> = brigade.iter().map(|unit| [text(unit, "begin"), text(unit, "end")]).collect();
    assert_eq!(
        times,
        [
            ["", "2026-05-01T04:00:00Z"],
            ["2026-05-01T04:00:00Z", "2026-05-01T06:00:00Z"],
            ["2026-05-01T06:00:00Z", "2026-05-01T12:00:00Z"]
        ]
    );
    let codes: Vec<&str> = brigade.iter().map(|unit| text(unit, "sidc")).collect();
    assert_eq!(codes, ["10031000181211020000", "10031040181211020000", "10031040181211020000"]);
    let first = brigade[0];
    for (property, expected) in [
        ("unique_designation", "1 BDE"),
        ("name", "1st Brigade"),
        ("higher_formation", "2 DIV"),
        ("dtg", "010400ZMAY26"),
        ("reinforced", "(-)"),
        ("side", "Blue"),
    ] {
        assert_eq!(text(first, property), expected, "{property}");
    }
}

#[test]
fn a_unit_without_a_place_is_with_the_unit_above_it_and_what_has_none_is_told() {
    let layer = scenario(Some("units"));
    let company: Vec<&Feature> = layer.features.iter().filter(|unit| text(unit, "id") == "c").collect();
    assert_eq!(company.len(), 3);
    assert_eq!(text(company[2], "parent"), "1st Brigade");
    assert!(
        layer.notes.iter().any(|note| note.contains("1 unit is where the unit above it is")),
        "{:?}",
        layer.notes
    );
    assert!(
        layer.notes.iter().any(|note| note == "left out: 1 unit without a place (unit 'Train')"),
        "{:?}",
        layer.notes
    );
    assert_eq!(layer.faults, ["left out: 1 state without a moment (unit 'Train')"]);
}

#[test]
fn layers_hold_control_measures_circles_and_texts_with_their_style() {
    let layer = scenario(Some("Plan"));
    assert_eq!(layer.features.len(), 4, "{:?}", layer.features);
    let line = &layer.features[0];
    assert_eq!(
        [text(line, "kind"), text(line, "status"), text(line, "unique_designation")],
        ["phase_line", "planned", "BLUE"]
    );
    assert_eq!([text(line, "identity"), text(line, "layer")], ["friend", "Plan"]);
    let zone = &layer.features[1];
    assert_eq!([text(zone, "fill"), text(zone, "stroke")], ["none", "#7F1D1D"]);
    assert!(matches!(&zone.geometry, Geometry::Polygons(rings) if rings[0].exterior.len() == 128));
    assert_eq!([text(&layer.features[2], "label"), text(&layer.features[3], "label")], ["before", "after"]);
    let told = layer.reading_notes().cloned().collect::<Vec<_>>().join("\n");
    for expected in ["1 hidden item", "1 item that is no feature", "'Too wide': the circle has no outline"] {
        assert!(told.contains(expected), "{told}");
    }
}

#[test]
fn a_layer_that_is_not_there_and_broken_json_are_errors() {
    let hints = VectorHints { layer: Some("Plans"), ..VectorHints::default() };
    let error = read::read("a.json", SCENARIO.as_bytes(), &hints).expect_err("no such layer").to_string();
    assert!(error.contains("did you mean 'Plan'?"), "{error}");
    let error = read::read("a.json", &SCENARIO.as_bytes()[..200], &VectorHints::default())
        .expect_err("cut")
        .to_string();
    assert!(error.contains("line 4, column 70"), "{error}");
}

#[test]
fn all_without_a_layer_are_read_together() {
    assert_eq!(scenario(None).features.len(), 3 + 3 + 1 + 4);
}

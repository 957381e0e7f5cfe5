//! GeoJSON (RFC 7946) with the `crs` member of its predecessor (GeoJSON 2008), and many GeoJSON texts in one file: a
//! text sequence (RFC 8142), each after a record separator, or one text to a line.
//!
//! The `geojson` crate parses. A third coordinate is the elevation, further ones are ignored. Coordinates are
//! (longitude, latitude) or (easting, northing) whatever axis order the named system prescribes, as all writers have
//! it. `serde_json` limits nesting to 128 levels. Where it refuses a text, `record` reads the features one by one.

pub(crate) mod record;
pub mod write;

use geojson::{Feature, GeoJson, GeometryValue, JsonObject, Position};
use serde::Deserialize;
use serde_json::Value;

use crate::builder::{FeatureParts, LayerBuilder, Vertices, position};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::geojson::record::OddText;
use crate::hints::VectorHints;
use sandtable_base::limits::GEOJSON_BYTES;
use sandtable_geom::crs::Crs;

const FORMAT: &str = "GeoJSON";
/// Precedes each text of a sequence (RFC 7464).
const RECORD_SEPARATOR: u8 = 0x1e;
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The values of `type` that GeoJSON has.
const TYPES: [&str; 9] = [
    "Feature",
    "FeatureCollection",
    "GeometryCollection",
    "Point",
    "MultiPoint",
    "LineString",
    "MultiLineString",
    "Polygon",
    "MultiPolygon",
];

/// Returns whether `text` is a text sequence, or has a JSON text on its first line and another on the next.
pub(super) fn is_sequence(text: &[u8]) -> bool {
    let mut lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    let is_object = |line: &[u8]| line.starts_with(b"{") && line.ends_with(b"}");
    text.first() == Some(&RECORD_SEPARATOR)
        || (lines.next().is_some_and(is_object) && lines.next().is_some_and(|line| line.starts_with(b"{")))
}

/// Reads all features, in the system that the file names or else in longitude and latitude on WGS 84.
///
/// Features without a geometry, lines of one vertex and rings of two are left out and noted, features that are not
/// GeoJSON are left out and reported.
///
/// # Errors
/// [`VectorError`], also where no feature is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let bytes = checked(bytes)?;
    match parse(bytes, 1) {
        Ok(text) => {
            let (features, members) = features(text);
            let crs = members.as_ref().and_then(|members| members.get("crs"));
            let mut layer = LayerBuilder::new(crs_by(hints, crs)?);
            features.into_iter().for_each(|feature| {
                let (parts, properties) = converted(feature);
                layer.add(parts, properties);
            });
            layer.finish()
        }
        Err(error) => {
            let Some(text) = OddText::parse(bytes) else { return Err(error) };
            let mut layer = LayerBuilder::new(crs_by(hints, text.crs.as_ref())?);
            text.add_to(&mut layer, |number| format!("feature {number}"));
            // The parser's error has the line.
            let is_refused = layer.is_empty() && layer.has_broken_records();
            if is_refused { Err(error) } else { layer.finish() }
        }
    }
}

/// Returns the stated system, else that of a `crs` member, else WGS 84.
fn crs_by(hints: &VectorHints, member: Option<&Value>) -> Result<Crs, VectorError> {
    match (hints.crs, member) {
        (None, Some(member)) => crs_of(member),
        (Some(crs), Some(member)) => {
            if let Ok(own) = crs_of(member) {
                (hints.overridden)(&own);
            }
            Ok(crs.clone())
        }
        (_, None) => Ok(hints.crs_or_wgs84()),
    }
}

/// Reads all features of a sequence, in the stated system or else in longitude and latitude on WGS 84, which both
/// standards prescribe. Texts that are not GeoJSON, also a last one cut short, are left out and reported.
///
/// # Errors
/// [`VectorError`] for the first text where none is GeoJSON.
pub(super) fn read_sequence(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let bytes = checked(bytes)?;
    let is_separated = bytes.trim_ascii_start().first() == Some(&RECORD_SEPARATOR);
    let separator = if is_separated { RECORD_SEPARATOR } else { b'\n' };
    let mut layer = LayerBuilder::new(hints.crs_or_wgs84());
    let mut line = 1;
    for text in bytes.split(|&byte| byte == separator) {
        let place = || format!("line {line}");
        match (text.trim_ascii().is_empty(), parse(text, line)) {
            (true, _) => {}
            (false, Ok(text)) => features(text).0.into_iter().for_each(|feature| {
                let (parts, properties) = converted(feature);
                layer.add_at(parts, properties, place);
            }),
            (false, Err(error)) => match OddText::parse(text) {
                Some(text) => text.add_to(&mut layer, |_| place()),
                None => layer.add_broken(place(), error),
            },
        }
        line += text.iter().filter(|&&byte| byte == b'\n').count() + usize::from(!is_separated);
    }
    layer.finish()
}

fn checked(bytes: &[u8]) -> Result<&[u8], VectorError> {
    if bytes.len() > GEOJSON_BYTES.count() {
        return Err(VectorError::TooLarge { bytes: bytes.len() });
    }
    Ok(bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes))
}

/// Parses the text that starts on a line of the file, counted from 1.
fn parse(text: &[u8], first_line: usize) -> Result<GeoJson, VectorError> {
    serde_json::from_slice(text).map_err(|error| {
        other_json(text).unwrap_or_else(|| {
            let line = first_line + error.line().max(1) - 1;
            let place = format!("line {line}, column {}", error.column().max(1));
            // The message has the place already.
            VectorError::broken(FORMAT, place, text_without_position(&error))
        })
    })
}

fn text_without_position(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let end = text.rfind(" at line ").unwrap_or(text.len());
    text[..end].chars().take(200).collect()
}

/// Returns the error for JSON whose `type` is not one of GeoJSON's, `None` for other texts.
fn other_json(text: &[u8]) -> Option<VectorError> {
    #[derive(Deserialize)]
    struct Head {
        #[serde(rename = "type")]
        kind: String,
    }
    let Head { kind } =
        serde_json::from_slice(text).ok().filter(|head: &Head| !TYPES.contains(&&*head.kind))?;
    let remedy = match kind.as_str() {
        "Topology" => "convert it: ogr2ogr -f GeoJSON new.geojson old.topojson",
        _ => "GeoJSON (RFC 7946) is needed",
    };
    Some(VectorError::NotGeoJson { found: shorten(&kind), remedy })
}

/// Returns the features of a text, and the members of its top object that GeoJSON does not define.
fn features(text: GeoJson) -> (Vec<Feature>, Option<JsonObject>) {
    match text {
        GeoJson::FeatureCollection(all) => (all.features, all.foreign_members),
        GeoJson::Feature(mut feature) => {
            let members = feature.foreign_members.take();
            (vec![feature], members)
        }
        GeoJson::Geometry(mut geometry) => {
            let members = geometry.foreign_members.take();
            (vec![Feature::from(geometry)], members)
        }
    }
}

fn converted(feature: Feature) -> (FeatureParts, Properties) {
    let mut parts = FeatureParts::default();
    if let Some(geometry) = feature.geometry {
        add_shape(&mut parts, &geometry.value);
    }
    (parts, feature.properties.unwrap_or_default().into_iter().collect())
}

fn add_shape(parts: &mut FeatureParts, value: &GeometryValue) {
    match value {
        GeometryValue::Point { coordinates } => add_points(parts, std::slice::from_ref(coordinates)),
        GeometryValue::MultiPoint { coordinates } => add_points(parts, coordinates),
        GeometryValue::LineString { coordinates } => add_line(parts, coordinates),
        GeometryValue::MultiLineString { coordinates } => {
            coordinates.iter().for_each(|line| add_line(parts, line));
        }
        GeometryValue::Polygon { coordinates } => add_polygon(parts, coordinates),
        GeometryValue::MultiPolygon { coordinates } => {
            coordinates.iter().for_each(|polygon| add_polygon(parts, polygon));
        }
        GeometryValue::GeometryCollection { geometries } => {
            geometries.iter().for_each(|geometry| add_shape(parts, &geometry.value));
        }
    }
}

fn add_points(parts: &mut FeatureParts, positions: &[Position]) {
    let points = vertices(positions, parts);
    parts.add_points(points);
}

fn add_line(parts: &mut FeatureParts, line: &[Position]) {
    let vertices = vertices(line, parts);
    parts.add_line(vertices);
}

fn add_polygon(parts: &mut FeatureParts, rings: &[Vec<Position>]) {
    let rings: Vec<Vertices> = rings.iter().map(|ring| vertices(ring, parts)).collect();
    parts.add_polygon(rings);
}

/// Returns the positions that have at least two numbers.
fn vertices(positions: &[Position], parts: &mut FeatureParts) -> Vertices {
    let mut vertices = Vertices::with_capacity(positions.len());
    for numbers in positions {
        match numbers.as_slice() {
            [x, y, rest @ ..] => vertices.push(position(*x, *y, rest.first().copied())),
            _ => parts.count_short_position(),
        }
    }
    vertices
}

/// Returns the system that a `crs` member names (GeoJSON 2008, section 3.1): a URN of the OGC, or `EPSG:n`.
fn crs_of(member: &Value) -> Result<Crs, VectorError> {
    let unknown =
        |source| VectorError::CrsMember { found: member.to_string().chars().take(120).collect(), source };
    if member.is_null() {
        return Ok(Crs::wgs84());
    }
    let name = member.pointer("/properties/name").and_then(Value::as_str);
    let name = name.ok_or_else(|| unknown(None))?.trim();
    let parts: Vec<&str> = name.split(':').collect();
    let definition = match parts[..] {
        [.., authority, code] if is_crs84(authority, code) => return Ok(Crs::wgs84()),
        [.., authority, version, code] if is_crs84(authority, code) && !version.contains("crs") => {
            return Ok(Crs::wgs84());
        }
        ["urn", .., authority, _, code] if authority.eq_ignore_ascii_case("epsg") => format!("EPSG:{code}"),
        _ => name.to_owned(),
    };
    Crs::parse(&definition).map_err(|error| unknown(Some(Box::new(error))))
}

/// Returns whether this is WGS 84 with longitude first, the system of all GeoJSON today.
fn is_crs84(authority: &str, code: &str) -> bool {
    authority.eq_ignore_ascii_case("ogc") && code.eq_ignore_ascii_case("crs84")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feature::{Geometry, Polygon};
    use glam::DVec2;

    fn read_plain(bytes: &[u8]) -> Result<VectorLayer, VectorError> {
        read(bytes, &VectorHints::default())
    }

    fn read_in(crs: &Crs, bytes: &[u8]) -> Result<VectorLayer, VectorError> {
        read(bytes, &VectorHints { crs: Some(crs), ..VectorHints::default() })
    }

    fn layer_of(geometry: &str) -> VectorLayer {
        let text = format!(r#"{{"type":"Feature","properties":{{"a":1}},"geometry":{geometry}}}"#);
        read_plain(text.as_bytes()).expect("valid GeoJSON")
    }

    fn only(geometry: &str) -> Geometry {
        let layer = layer_of(geometry);
        let [feature] = &layer.features[..] else { panic!("one feature, not {layer:?}") };
        assert_eq!(feature.properties["a"], 1);
        feature.geometry.clone()
    }

    const A: DVec2 = DVec2::new(1.0, 2.0);
    const B: DVec2 = DVec2::new(3.0, 4.0);
    const C: DVec2 = DVec2::new(5.0, 0.0);

    #[test]
    fn all_simple_types_are_read() {
        assert_eq!(only(r#"{"type":"Point","coordinates":[1,2]}"#), Geometry::Points(vec![A]));
        assert_eq!(
            only(r#"{"type":"MultiPoint","coordinates":[[1,2],[3,4]]}"#),
            Geometry::Points(vec![A, B])
        );
        assert_eq!(
            only(r#"{"type":"LineString","coordinates":[[1,2],[3,4]]}"#),
            Geometry::Lines(vec![vec![A, B]])
        );
        assert_eq!(
            only(r#"{"type":"MultiLineString","coordinates":[[[1,2],[3,4]],[[3,4],[5,0]]]}"#),
            Geometry::Lines(vec![vec![A, B], vec![B, C]])
        );
    }

    #[test]
    fn rings_lose_their_closing_vertex_whether_they_have_one_or_not() {
        let triangle = Polygon { exterior: vec![A, B, C], holes: vec![vec![C, B, A]] };
        let closed = r#"[[[1,2],[3,4],[5,0],[1,2]],[[5,0],[3,4],[1,2],[5,0]]]"#;
        let open = r#"[[[1,2],[3,4],[5,0]],[[5,0],[3,4],[1,2]]]"#;
        for rings in [closed, open] {
            let polygon = only(&format!(r#"{{"type":"Polygon","coordinates":{rings}}}"#));
            assert_eq!(polygon, Geometry::Polygons(vec![triangle.clone()]));
        }
        let both = only(&format!(r#"{{"type":"MultiPolygon","coordinates":[{closed},{open}]}}"#));
        assert_eq!(both, Geometry::Polygons(vec![triangle.clone(), triangle]));
    }

    #[test]
    fn a_third_coordinate_is_the_elevation_and_a_fourth_is_ignored() {
        let layer = layer_of(r#"{"type":"LineString","coordinates":[[1,2,99],[3,4],[5,0,98,7]]}"#);
        let feature = &layer.features[0];
        assert_eq!(feature.geometry, Geometry::Lines(vec![vec![A, B, C]]));
        let elevations = feature.elevations.as_ref().expect("two are known");
        assert_eq!((elevations[0], elevations[2]), (99.0, 98.0));
        assert!(elevations[1].is_nan());
        assert_eq!(layer_of(r#"{"type":"Point","coordinates":[1,2]}"#).features[0].elevations, None);
    }

    #[test]
    fn collections_become_one_feature_for_each_kind() {
        let layer = layer_of(
            r#"{"type":"GeometryCollection","geometries":[
                {"type":"LineString","coordinates":[[1,2],[3,4]]},
                {"type":"GeometryCollection","geometries":[
                    {"type":"Point","coordinates":[1,2]},{"type":"LineString","coordinates":[[3,4],[5,0]]}]}]}"#,
        );
        let geometries: Vec<_> = layer.features.iter().map(|feature| feature.geometry.clone()).collect();
        assert_eq!(geometries, [Geometry::Points(vec![A]), Geometry::Lines(vec![vec![A, B], vec![B, C]])]);
        assert_eq!(layer.features[1].properties["a"], 1);
    }

    #[test]
    fn what_is_left_out_is_noted() {
        let text = r#"{"type":"FeatureCollection","features":[
            {"type":"Feature","properties":null,"geometry":null},
            {"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[1,2]]}},
            {"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[]}},
            {"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[1,2],[3,4],[1,2]]]}},
            {"type":"Feature","properties":{},"geometry":{"type":"MultiPoint","coordinates":[[1],[]]}}]}"#;
        let layer = read_plain(text.as_bytes()).expect("valid GeoJSON");
        assert!(layer.features.is_empty());
        let expected = [
            "left out: 5 features without a usable geometry (feature 1, feature 2, feature 3, ...)",
            "left out: 2 positions of less than two numbers (feature 5)",
            "left out: 2 lines of less than two vertices (feature 2, feature 3)",
            "left out: 1 ring of less than three vertices (feature 4)",
        ];
        assert_eq!(layer.notes, expected);
    }

    fn with_crs(crs: &str) -> Result<VectorLayer, VectorError> {
        let text = format!(r#"{{"type":"FeatureCollection","crs":{crs},"features":[]}}"#);
        read_plain(text.as_bytes())
    }

    #[test]
    fn the_crs_member_of_2008_is_understood() {
        for (name, epsg) in [
            ("urn:ogc:def:crs:EPSG::27700", 27700),
            ("urn:ogc:def:crs:EPSG:6.9:26912", 26912),
            ("EPSG:32616", 32616),
            ("urn:ogc:def:crs:OGC:1.3:CRS84", 4326),
            ("urn:ogc:def:crs:OGC::CRS84", 4326),
            ("OGC:CRS84", 4326),
        ] {
            let crs =
                with_crs(&format!(r#"{{"type":"name","properties":{{"name":"{name}"}}}}"#)).expect(name).crs;
            assert_eq!(crs.epsg(), Some(epsg), "{name}");
        }
        assert_eq!(with_crs("null").expect("no system named").crs, Crs::wgs84());
    }

    #[test]
    fn a_crs_that_is_not_understood_asks_for_the_key() {
        for crs in [
            r#"{"type":"link","properties":{"href":"http://example.org/crs"}}"#,
            r#"{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::999999"}}"#,
            r#"{"type":"name","properties":{"name":"Mars"}}"#,
            "3",
        ] {
            let error = with_crs(crs).expect_err(crs).to_string();
            assert!(error.contains("with the key 'crs'"), "{error}");
        }
        let text = r#"{"type":"FeatureCollection","crs":{"type":"link"},"features":[]}"#;
        let utm = Crs::utm_at(0.0, 50.0);
        assert_eq!(read_in(&utm, text.as_bytes()).expect("the system is stated").crs, utm);
    }

    #[test]
    fn meters_taken_for_degrees_are_refused_with_the_feature() {
        let text = r#"{"type":"Point","coordinates":[421184,4515000]}"#;
        let error = read_plain(text.as_bytes()).expect_err("no longitude").to_string();
        assert!(error.contains("feature 1 has a vertex at (421184, 4515000)"), "{error}");
        assert!(read_in(&Crs::utm_at(-111.0, 40.0), text.as_bytes()).is_ok());
    }

    #[test]
    fn what_is_not_geojson_is_refused_with_place_and_reason() {
        let error = |text: &str| read_plain(text.as_bytes()).expect_err(text).to_string();
        assert!(error("{\n \"type\": \"Feature\",\n oops}").contains("line 3, column 2: "));
        assert!(error(r#"{"type":"Topology","objects":{}}"#).contains("ogr2ogr"));
        assert!(error(r#"{"type":"Feature","geometry":{"type":"Blob"}}"#).contains("unknown variant `Blob`"));
        assert!(error("").contains("line 1, column 1"));
        assert!(error("[1]").contains("GeoJSON"));
        assert!(error(r#"{"type":"Point","coordinates":[1]}"#).contains("GeoJSON"));
        assert!(error(r#"{"type":"Point","coordinates":[1e999,0]}"#).contains("number out of range"));
    }

    #[test]
    fn deep_nesting_is_an_error_not_an_overflow() {
        let depth = 100_000;
        let opened = r#"{"type":"GeometryCollection","geometries":["#.repeat(depth);
        assert!(read_plain(opened.as_bytes()).is_err());
        assert!(read_plain("[".repeat(depth).as_bytes()).is_err());
        let properties =
            format!(r#"{{"type":"Feature","geometry":null,"properties":{{"a":{}"#, "[".repeat(depth));
        assert!(read_plain(properties.as_bytes()).is_err());
    }

    fn point_feature(x: u32) -> String {
        format!(
            r#"{{"type":"Feature","properties":{{"x":{x}}},"geometry":{{"type":"Point","coordinates":[{x},2]}}}}"#
        )
    }

    #[test]
    fn sequences_and_lines_are_read_alike() {
        let sequence =
            format!("\u{1e}{}\n\u{1e}{}\n", point_feature(1), point_feature(2).replace(',', ",\n"));
        let lines = format!("{}\r\n\n{}", point_feature(1), point_feature(2));
        for text in [sequence, lines] {
            let layer = read_sequence(text.as_bytes(), &VectorHints::default()).expect("sound");
            let values: Vec<_> = layer.features.iter().map(|feature| &feature.properties["x"]).collect();
            assert_eq!(values, [1, 2]);
        }
    }

    #[test]
    fn the_line_of_a_broken_text_is_reported() {
        let text = format!("{}\n{}\n{{\"type\":\n", point_feature(1), point_feature(2));
        let layer = read_sequence(text.as_bytes(), &VectorHints::default()).expect("two are sound");
        assert_eq!(layer.features.len(), 2);
        assert!(layer.faults[0].contains("1 record that cannot be read: line 3, "), "{:?}", layer.faults);
        let text = format!("{}\n{{\"type\":\"Feature\"\n{}", point_feature(1), point_feature(2));
        let layer = read_sequence(text.as_bytes(), &VectorHints::default()).expect("two are sound");
        assert!(layer.features.len() == 2 && layer.faults[0].contains("line 2, "), "{:?}", layer.faults);
    }

    fn collection(features: &[&str]) -> VectorLayer {
        let features: Vec<String> = features
            .iter()
            .map(|geometry| format!(r#"{{"type":"Feature","properties":{{"a":1}},"geometry":{geometry}}}"#))
            .collect();
        let text = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
        read_plain(text.as_bytes()).expect("some are sound")
    }

    const SOUND: &str = r#"{"type":"LineString","coordinates":[[1,2],[3,4]]}"#;

    #[test]
    fn empty_coordinates_are_no_shape_and_no_error() {
        for empty in [
            r#"{"type":"Point","coordinates":[]}"#,
            r#"{"type":"Point","coordinates":null}"#,
            r#"{"type":"MultiPoint","coordinates":[]}"#,
            r#"{"type":"LineString","coordinates":[]}"#,
            r#"{"type":"Polygon","coordinates":null}"#,
            r#"{"type":"GeometryCollection","geometries":null}"#,
            "{}",
            "null",
        ] {
            let layer = collection(&[empty, SOUND]);
            assert!(layer.features.len() == 1 && layer.faults.is_empty(), "{empty}: {:?}", layer.faults);
            assert_eq!(layer.features[0].properties["a"], 1);
            let expected = "left out: 1 feature without a usable geometry (feature 1)";
            assert_eq!(layer.notes[0], expected, "{empty}");
        }
        let alone = read_plain(br#"{"type":"Point","coordinates":[]}"#).expect("valid");
        assert!(alone.features.is_empty());
    }

    #[test]
    fn a_height_that_is_no_number_costs_the_height_alone() {
        for height in ["null", "\"12\"", "[]"] {
            let line = format!(r#"{{"type":"LineString","coordinates":[[1,2,{height}],[3,4,9]]}}"#);
            let layer = collection(&[&line, SOUND]);
            assert!(layer.features.len() == 2 && layer.faults.is_empty());
            let elevations = layer.features[0].elevations.as_ref().expect("one is known");
            assert!(elevations[0].is_nan() && elevations[1] == 9.0);
            assert_eq!(layer.notes, ["left out: 1 elevation that is not a number (feature 1)"]);
        }
    }

    #[test]
    fn features_that_are_not_geojson_are_left_out_and_reported() {
        for (odd, reason) in [
            (r#"{"type":"Blob","coordinates":[]}"#, "the unknown type Blob"),
            (r#"{"type":"Point","coordinates":["1",2]}"#, "a coordinate is \"1\""),
            (r#"{"type":"Point","coordinates":[1]}"#, "one number only"),
            (r#"{"type":"Point"}"#, "has no coordinates"),
            (r#"{"type":"LineString","coordinates":[[1,2],[1e999,3]]}"#, "number out of range"),
            (r#"{"type":"Polygon","coordinates":7}"#, "7 stands in place of a list"),
            ("7", "7 stands in place of a geometry"),
        ] {
            let layer = collection(&[SOUND, odd, SOUND]);
            assert_eq!(layer.features.len(), 2, "{odd}");
            let [fault] = &layer.faults[..] else { panic!("{odd}: {:?}", layer.faults) };
            assert!(fault.contains("1 record") && fault.contains("feature 2: "), "{fault}");
            assert!(fault.contains(reason), "{fault}");
        }
        let text = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32633"}},
            "features":[null,{"type":"Feature","properties":[],"geometry":{"type":"Point","coordinates":[500000,5e6]}}]}"#;
        let layer = read_plain(text.as_bytes()).expect("one is sound");
        assert_eq!((layer.crs.epsg(), layer.features.len(), layer.faults.len()), (Some(32633), 1, 1));
    }

    #[test]
    fn the_cause_of_a_broken_text_is_stated_once() {
        let error = read_plain(br#"{"type":"Point","coordinates":[1]}"#).expect_err("one number");
        let text = sandtable_base::message::chain::error_text(&error);
        assert_eq!(text.matches("two or more elements").count(), 1, "{text}");
    }
}

//! GeoJSON (RFC 7946), and the `crs` member of its predecessor (GeoJSON 2008).
//!
//! Parsing is the `geojson` crate's; here its values become [`VectorLayer`]s. A geometry collection becomes up to
//! three features with the same properties, one each for its points, lines and polygons, however deep they
//! lie. A third coordinate is the elevation, any further ones are ignored. Coordinates are taken as (longitude,
//! latitude) or (easting, northing) whatever axis order the named system prescribes, which is what all
//! writers do. Nesting is limited by `serde_json` to 128 levels.

pub(super) mod sequence;

use geojson::{GeoJson, GeometryValue, Position};
use glam::DVec3;
use serde::Deserialize;
use serde_json::Value;

use crate::geom::crs::Crs;
use crate::vector::collect::{Collector, FeatureParts, position};
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;

/// The largest file read. A file of vertices costs ten bytes of memory for each of its own, a hostile one
/// (measured: a list of a single unknown member) thirty-five, which this keeps to some two gigabytes.
pub const MAX_BYTES: usize = 64 << 20;

/// All features of a GeoJSON file in the system that it names, or else in longitude and latitude on WGS 84.
///
/// # Errors
/// [`VectorError`]; features without a geometry, lines of one vertex and rings of two are no errors but
/// left out, which [`VectorLayer::notes`] says.
pub fn read(bytes: &[u8]) -> Result<VectorLayer, VectorError> {
    read_as(bytes, None)
}

/// As [`read`], in the system `stated` whatever the file itself names.
///
/// # Errors
/// As [`read`].
pub fn read_as(bytes: &[u8], stated: Option<&Crs>) -> Result<VectorLayer, VectorError> {
    if bytes.len() > MAX_BYTES {
        return Err(VectorError::TooLarge { bytes: bytes.len(), limit: MAX_BYTES });
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let parsed: GeoJson = serde_json::from_slice(bytes).map_err(|error| malformed(bytes, &error))?;
    let named = |member: Option<&Value>| match (stated, member) {
        (Some(crs), _) => Ok(crs.clone()),
        (None, Some(member)) => crs_of(member),
        (None, None) => Ok(Crs::wgs84()),
    };
    let member =
        |members: &Option<geojson::JsonObject>| named(members.as_ref().and_then(|all| all.get("crs")));
    match parsed {
        GeoJson::FeatureCollection(all) => layer(all.features, member(&all.foreign_members)?),
        GeoJson::Feature(one) => {
            let crs = member(&one.foreign_members)?;
            layer(vec![one], crs)
        }
        GeoJson::Geometry(only) => {
            let crs = member(&only.foreign_members)?;
            layer(vec![geojson::Feature::from(only)], crs)
        }
    }
}

/// What of a feature collection its features become.
fn layer(features: Vec<geojson::Feature>, crs: Crs) -> Result<VectorLayer, VectorError> {
    let mut collector = Collector::new(crs);
    for feature in features {
        add(&mut collector, feature)?;
    }
    Ok(collector.finish())
}

/// Hands one feature over.
///
/// # Errors
/// As of [`Collector::add`].
fn add(collector: &mut Collector, feature: geojson::Feature) -> Result<(), VectorError> {
    let mut parts = FeatureParts::default();
    if let Some(geometry) = feature.geometry {
        add_shape(&mut parts, geometry.value);
    }
    collector.add(parts, feature.properties.unwrap_or_default().into_iter().collect())
}

fn add_shape(parts: &mut FeatureParts, value: GeometryValue) {
    match value {
        GeometryValue::Point { coordinates } => add_points(parts, &[coordinates]),
        GeometryValue::MultiPoint { coordinates } => add_points(parts, &coordinates),
        GeometryValue::LineString { coordinates } => add_line(parts, &coordinates),
        GeometryValue::MultiLineString { coordinates } => {
            coordinates.iter().for_each(|line| add_line(parts, line));
        }
        GeometryValue::Polygon { coordinates } => add_polygon(parts, &coordinates),
        GeometryValue::MultiPolygon { coordinates } => {
            coordinates.iter().for_each(|polygon| add_polygon(parts, polygon));
        }
        GeometryValue::GeometryCollection { geometries } => {
            geometries.into_iter().for_each(|geometry| add_shape(parts, geometry.value));
        }
    }
}

fn add_points(parts: &mut FeatureParts, positions: &[Position]) {
    vertices(positions, parts).into_iter().for_each(|at| parts.point(at));
}

fn add_line(parts: &mut FeatureParts, line: &[Position]) {
    let vertices = vertices(line, parts);
    parts.line(vertices);
}

fn add_polygon(parts: &mut FeatureParts, rings: &[Vec<Position>]) {
    let rings: Vec<_> = rings.iter().map(|ring| vertices(ring, parts)).collect();
    parts.polygon(rings);
}

/// The first three numbers of each position, the third NaN where there are two; those that have fewer are left out.
fn vertices(positions: &[Position], parts: &mut FeatureParts) -> Vec<DVec3> {
    let mut all = Vec::with_capacity(positions.len());
    for given in positions {
        match given.as_slice() {
            [x, y, rest @ ..] => all.push(position(*x, *y, rest.first().copied())),
            _ => parts.short_position(),
        }
    }
    all
}

/// The system that a `crs` member names (GeoJSON 2008, section 3.1): a URN of the OGC, or `EPSG:n`.
fn crs_of(member: &Value) -> Result<Crs, VectorError> {
    let not_understood =
        |source| VectorError::CrsMember { found: member.to_string().chars().take(120).collect(), source };
    if member.is_null() {
        return Ok(Crs::wgs84());
    }
    let name = member.pointer("/properties/name").and_then(Value::as_str);
    let name = name.ok_or_else(|| not_understood(None))?.trim();
    let parts: Vec<&str> = name.split(':').collect();
    match parts[..] {
        [.., authority, code] if is_crs84(authority, code) => Ok(Crs::wgs84()),
        [.., authority, version, code] if is_crs84(authority, code) && !version.contains("crs") => {
            Ok(Crs::wgs84())
        }
        ["urn", .., authority, _, code] if authority.eq_ignore_ascii_case("epsg") => {
            Crs::parse(&format!("EPSG:{code}")).map_err(|error| not_understood(Some(error)))
        }
        _ => Crs::parse(name).map_err(|error| not_understood(Some(error))),
    }
}

/// WGS 84 with longitude first: what all GeoJSON is in today.
fn is_crs84(authority: &str, code: &str) -> bool {
    authority.eq_ignore_ascii_case("ogc") && code.eq_ignore_ascii_case("crs84")
}

/// The error for JSON that is not GeoJSON, told by its `type` where it has one that explains it.
fn malformed(bytes: &[u8], error: &serde_json::Error) -> VectorError {
    #[derive(Deserialize)]
    struct Head {
        #[serde(rename = "type")]
        kind: String,
    }
    const KINDS: [&str; 9] = [
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
    match serde_json::from_slice::<Head>(bytes) {
        Ok(head) if !KINDS.contains(&head.kind.as_str()) => {
            let remedy = match head.kind.as_str() {
                "Topology" => "convert it: ogr2ogr -f GeoJSON new.geojson old.topojson",
                _ => "GeoJSON (RFC 7946) is needed",
            };
            VectorError::NotGeoJson { found: head.kind.chars().take(60).collect(), remedy: remedy.into() }
        }
        _ => {
            let reason = error.to_string();
            let end = reason.rfind(" at line ").unwrap_or(reason.len());
            let reason = reason[..end].chars().take(200).collect();
            VectorError::Malformed { line: error.line().max(1), column: error.column().max(1), reason }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::feature::{Geometry, Polygon};
    use glam::DVec2;

    fn layer_of(geometry: &str) -> VectorLayer {
        let text = format!(r#"{{"type":"Feature","properties":{{"a":1}},"geometry":{geometry}}}"#);
        read(text.as_bytes()).expect("valid GeoJSON")
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
    fn a_third_coordinate_is_the_elevation_and_a_fourth_nothing() {
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
        let layer = read(text.as_bytes()).expect("valid GeoJSON");
        assert!(layer.features.is_empty());
        let expected = [
            "left out: 5 features without a usable geometry",
            "left out: 2 positions of less than two numbers",
            "left out: 2 lines of less than two vertices",
            "left out: 1 rings of less than three vertices",
        ];
        assert_eq!(layer.notes, expected);
    }

    fn with_crs(crs: &str) -> Result<VectorLayer, VectorError> {
        let text = format!(r#"{{"type":"FeatureCollection","crs":{crs},"features":[]}}"#);
        read(text.as_bytes())
    }

    #[test]
    fn the_old_crs_member_is_understood() {
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
        assert_eq!(read_as(text.as_bytes(), Some(&utm)).expect("the system is stated").crs, utm);
    }

    #[test]
    fn meters_taken_for_degrees_are_refused_with_the_feature() {
        let text = r#"{"type":"Point","coordinates":[421184,4515000]}"#;
        let error = read(text.as_bytes()).expect_err("no longitude").to_string();
        assert!(error.contains("feature 1 has a vertex at (421184, 4515000)"), "{error}");
        assert!(read_as(text.as_bytes(), Some(&Crs::utm_at(-111.0, 40.0))).is_ok());
    }

    #[test]
    fn what_is_not_geojson_is_told_where_and_why() {
        let error = |text: &str| read(text.as_bytes()).expect_err(text).to_string();
        assert!(error("{\n \"type\": \"Feature\",\n oops}").starts_with("line 3, column 2: "));
        assert!(error(r#"{"type":"Topology","objects":{}}"#).contains("ogr2ogr"));
        assert!(error(r#"{"type":"Feature","geometry":{"type":"Blob"}}"#).contains("unknown variant `Blob`"));
        assert!(error("").starts_with("line 1, column 1"));
        assert!(error("[1]").contains("GeoJSON"));
        assert!(error(r#"{"type":"Point","coordinates":[1]}"#).contains("GeoJSON"));
        assert!(error(r#"{"type":"Point","coordinates":[1e999,0]}"#).contains("number out of range"));
    }

    #[test]
    fn deep_nesting_is_an_error_not_an_overflow() {
        let depth = 100_000;
        let opened = r#"{"type":"GeometryCollection","geometries":["#.repeat(depth);
        assert!(read(opened.as_bytes()).is_err());
        assert!(read("[".repeat(depth).as_bytes()).is_err());
        let properties =
            format!(r#"{{"type":"Feature","geometry":null,"properties":{{"a":{}"#, "[".repeat(depth));
        assert!(read(properties.as_bytes()).is_err());
    }
}

//! Cursor-on-Target events (MITRE, CoT schema 2.0) as ATAK and others write them: one event, several in one element or one after
//! the other, and those of a data package.
//!
//! | type | becomes |
//! |---|---|
//! | `a-f-G-U-C-I` | a symbol: the affiliation, the dimension and the function letters of MIL-STD-2525C |
//! | `u-d-…` with links | a line, an area where it is closed |
//! | a shape of ellipses or polylines | areas; lines and areas |
//! | `b-m-r` | a route |
//! | `u-rb-a` with a range and a bearing | a line |
//! | `t-…`, `b-t-f`, `y-…`: tasks, chats and replies | nothing: they are told |
//! | others | a point with the callsign as label |
//!
//! A `__milsym` or `__milicon` in the details states the code better than the type does. Heights are above the ellipsoid, not the
//! sea, so that they are no elevations; those of air and space tracks are their altitude. An event that a file breaks off
//! is told, and those before it are read.

use glam::DVec2;

use crate::builder::{FeatureParts, LayerBuilder, Vertices, position};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::moment::Moment;
use crate::overlay_schema::{
    ALTITUDE, BEGIN, DESCRIPTION, DIRECTION, END, FILL, FILL_OPACITY, ID, LABEL, MARKER_COLOR, NAME, SPEED,
    STROKE, STROKE_DASHES, STROKE_OPACITY, STROKE_WIDTH, UNIQUE_DESIGNATION, set, set_code, set_field,
    set_number,
};
use crate::svg_style::hex_color;
use crate::tally::RecordTally;
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};
use sandtable_geom::crs::Crs;
use sandtable_geom::geodesic::Geodesic;
use sandtable_geom::ground_shape::{GroundEllipse, MOST_REACH_M};

const FORMAT: &str = "Cursor-on-Target file";

/// Reads all events.
///
/// # Errors
/// [`VectorError`], also where no event is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let one = one_document(&text);
    let mut xml = XmlReader::new(&one, FORMAT);
    let mut builder = LayerBuilder::new(Crs::wgs84());
    if hints.crs.is_some_and(|crs| *crs != Crs::wgs84()) {
        builder.note("its places are on WGS 84: `crs` has no effect on them");
    }
    xml.root()?;
    let mut others = RecordTally::new();
    match read_events(&mut xml, &mut builder, &mut others).and_then(|()| xml.finish()) {
        // A recording that is broken off: what came before is sound.
        Err(error) if !builder.is_empty() => builder.report_broken("the end of the file", error),
        read => read?,
    }
    builder.note_omitted(&others, "event that is a task or a message", "events that are tasks or messages");
    fault.into_iter().for_each(|fault| builder.fault(fault));
    builder.finish()
}

/// Events one after the other as one document, with the lines they have.
fn one_document(text: &str) -> String {
    let mut body = String::with_capacity(text.len() + 20);
    let mut rest = text;
    // Each event may come with a declaration of its own.
    while let Some(start) = rest.find("<?xml") {
        let Some(length) = rest[start..].find("?>") else { break };
        body.push_str(&rest[..start]);
        body.extend(rest[start..start + length].chars().filter(|&letter| letter == '\n'));
        rest = &rest[start + length + 2..];
    }
    body.push_str(rest);
    format!("<all>{}</all>", body.trim_start_matches('\u{feff}'))
}

fn read_events(
    xml: &mut XmlReader<'_>,
    builder: &mut LayerBuilder,
    others: &mut RecordTally,
) -> Result<(), VectorError> {
    while let Some(child) = xml.next_child()? {
        if child.name() != "event" {
            // A list of events, whatever it is called.
            read_events(xml, builder, others)?;
            continue;
        }
        let event = xml.read(child)?;
        let place = || match event.attribute("uid") {
            Some(uid) => format!("event '{}'", shorten(&uid)),
            None => xml.line_of(&event),
        };
        let kind = event.attribute("type").unwrap_or_default();
        if ["t-", "y-", "b-t-f"].iter().any(|start| kind.starts_with(start)) {
            others.add(place);
            continue;
        }
        match read_event(&event) {
            Ok((parts, properties)) => builder.add_at(parts, properties, place),
            Err(reason) => builder.add_broken(place(), VectorError::broken(FORMAT, place(), reason)),
        }
    }
    Ok(())
}

fn read_event(event: &XmlElement<'_>) -> Result<(FeatureParts, Properties), String> {
    let kind = event.attribute("type").ok_or("the event has no type")?.into_owned();
    let mut properties = Properties::new();
    set(&mut properties, "cot_type", kind.as_str());
    event.attribute("uid").into_iter().for_each(|uid| set(&mut properties, ID, uid));
    for (property, name) in [(BEGIN, "start"), (END, "stale")] {
        let moment = event.attribute(name).and_then(|text| Moment::parse(&text));
        moment.into_iter().for_each(|moment| set(&mut properties, property, moment.to_string()));
    }
    let details: Vec<&XmlElement<'_>> =
        event.children_named("detail").flat_map(XmlElement::children).collect();
    let detail = |name: &str| details.iter().copied().find(|detail| detail.name() == name);
    if let Some(callsign) = detail("contact").and_then(|contact| contact.attribute("callsign")) {
        set(&mut properties, NAME, callsign.as_ref());
        set(&mut properties, UNIQUE_DESIGNATION, callsign);
    }
    detail("remarks").into_iter().for_each(|remarks| set(&mut properties, DESCRIPTION, remarks.text()));
    if let Some(track) = detail("track") {
        track.attribute("course").into_iter().for_each(|course| set(&mut properties, DIRECTION, course));
        let speed = track.number::<f64>("speed").filter(|speed| *speed > 0.0 && speed.is_finite());
        speed.into_iter().for_each(|speed| set(&mut properties, SPEED, format!("{:.0} km/h", speed * 3.6)));
    }
    let symbols = ["__milicon", "__milsym"].iter().filter_map(|name| detail(name));
    let mut is_symbol = false;
    for symbol in symbols {
        let stated = symbol.attribute("id").map_or_else(|| symbol.text(), std::borrow::Cow::into_owned);
        // An icon's code may have 20 digits where that of the symbol beside it is its equal for older programs.
        is_symbol = is_symbol || set_code(&mut properties, &stated);
        for modifier in symbol.children_named("unitmodifier") {
            if let Some(letters) = modifier.attribute("code") {
                set_field(&mut properties, &letters, &modifier.text());
            }
        }
    }
    if !is_symbol && let Some(code) = code_of(&kind) {
        is_symbol = set_code(&mut properties, &code);
    }
    let height_m = height_m(event);
    set_number(&mut properties, "hae", height_m);
    if let Some(height_m) = height_m.filter(|_| matches!(kind.split('-').nth(2), Some("A" | "P"))) {
        set(&mut properties, ALTITUDE, format!("{height_m:.0} m"));
    }
    add_colors(&details, &mut properties);
    let mut parts = FeatureParts::default();
    if !add_shape(&kind, &details, event, &mut parts)? {
        parts.add_points(vec![place_of(event)?]);
        if !is_symbol && let Some(name) = properties.get(NAME).cloned() {
            properties.insert(LABEL.to_owned(), name);
        }
    }
    Ok((parts, properties))
}

/// The code of MIL-STD-2525C that a type of atoms means: `a-h-G-U-C-I` is `SHGPUCI--------`. Parts in lower case are not of the
/// standard.
fn code_of(kind: &str) -> Option<String> {
    let mut parts = kind.split('-');
    if parts.next() != Some("a") {
        return None;
    }
    let affiliation = match parts.next()? {
        letter @ ("f" | "h" | "n" | "u" | "p" | "a" | "s" | "j" | "k") => letter.to_ascii_uppercase(),
        _ => "U".to_owned(),
    };
    let dimension = parts.next().filter(|letter| matches!(*letter, "P" | "A" | "G" | "S" | "U" | "F"))?;
    let is_function = |part: &&str| part.len() == 1 && part.bytes().all(|byte| byte.is_ascii_uppercase());
    let function: String = parts.take_while(is_function).take(6).collect();
    // The eleventh letter of an installation says so.
    let modifier = if dimension == "G" && function.starts_with('I') { 'H' } else { '-' };
    Some(format!("S{affiliation}{dimension}P{function:-<6}{modifier}----"))
}

fn place_of(event: &XmlElement<'_>) -> Result<glam::DVec3, String> {
    let point = event.children_named("point").next().ok_or("the event has no point")?;
    let number = |name: &str| point.number::<f64>(name);
    let (Some(lat), Some(lon)) = (number("lat"), number("lon")) else {
        return Err("the event's point has no latitude and longitude".into());
    };
    if !(lat.abs() <= 90.0 && lon.abs() <= 360.0) {
        return Err(format!("({lon}, {lat}) is no longitude and latitude"));
    }
    Ok(position(lon, lat, None))
}

/// The height above the ellipsoid in meters.
fn height_m(event: &XmlElement<'_>) -> Option<f64> {
    /// Stands for a height that is not known, in the schema.
    const UNKNOWN_M: f64 = 9_999_999.0;
    event.children_named("point").next()?.number("hae").filter(|height: &f64| height.abs() < UNKNOWN_M)
}

/// Adds a drawn shape; whether there is one.
fn add_shape(
    kind: &str,
    details: &[&XmlElement<'_>],
    event: &XmlElement<'_>,
    parts: &mut FeatureParts,
) -> Result<bool, String> {
    let shapes: Vec<&XmlElement<'_>> =
        details.iter().copied().filter(|detail| detail.name() == "shape").collect();
    let within = |name: &'static str| shapes.iter().flat_map(move |shape| shape.children_named(name));
    for ellipse in within("ellipse") {
        let ring = ellipse_of(ellipse, event)?.ring();
        parts.add_polygon([vertices(&ring.map_err(|error| format!("its ellipse has no outline: {error}"))?)]);
    }
    for line in within("polyline") {
        let points: Vec<DVec2> = line.children_named("vertex").map(vertex).collect::<Result<_, _>>()?;
        let is_closed = line.attribute("closed").is_some_and(|text| text.eq_ignore_ascii_case("true"));
        add_points(&points, is_closed, parts);
    }
    if !parts.is_empty() {
        return Ok(true);
    }
    if kind.starts_with("u-rb-") {
        return add_bearing(details, event, parts);
    }
    if !kind.starts_with("u-d-") && !kind.starts_with("b-m-r") {
        return Ok(false);
    }
    let links = details.iter().filter(|detail| detail.name() == "link");
    let points = links.filter_map(|link| link.attribute("point")).map(|text| {
        let mut numbers = text.split(',').map(|number| number.trim().parse::<f64>());
        match (numbers.next(), numbers.next()) {
            (Some(Ok(lat)), Some(Ok(lon))) if lat.abs() <= 90.0 && lon.abs() <= 360.0 => {
                Ok(DVec2::new(lon, lat))
            }
            _ => Err(format!("the link '{}' is no latitude and longitude", shorten(&text))),
        }
    });
    let points: Vec<DVec2> = points.collect::<Result<_, _>>()?;
    if points.len() < 2 {
        return Ok(false);
    }
    add_points(&points, kind.starts_with("u-d-r"), parts);
    Ok(!parts.is_empty())
}

/// Adds a line, or an area where it is closed.
fn add_points(points: &[DVec2], is_closed: bool, parts: &mut FeatureParts) {
    let is_ring = points.len() > 3 && points.first() == points.last();
    if is_ring || (is_closed && points.len() > 2) {
        parts.add_polygon([vertices(points)]);
    } else {
        parts.add_line(vertices(points));
    }
}

/// The ellipse around the event's point: half axes in meters, the first in the direction `angle`, clockwise from north.
fn ellipse_of(ellipse: &XmlElement<'_>, event: &XmlElement<'_>) -> Result<GroundEllipse, String> {
    let length = |name: &str| {
        let length = ellipse.number::<f64>(name).filter(|length| *length > 0.0 && *length <= MOST_REACH_M);
        length.ok_or_else(|| {
            format!("the {name} axis of the ellipse is not above 0 and up to {MOST_REACH_M} m")
        })
    };
    Ok(GroundEllipse {
        center: place_of(event)?.truncate(),
        // The second axis of a ground ellipse lies north, and rotations are counterclockwise.
        radii_m: DVec2::new(length("minor")?, length("major")?),
        rotation_deg: -ellipse.number::<f64>("angle").unwrap_or(0.0),
    })
}

fn vertex(vertex: &XmlElement<'_>) -> Result<DVec2, String> {
    let at =
        vertex.number("lon").zip(vertex.number("lat")).map(|(lon, lat): (f64, f64)| DVec2::new(lon, lat));
    at.filter(|at| at.x.abs() <= 360.0 && at.y.abs() <= 90.0)
        .ok_or_else(|| "a vertex of its polyline is no latitude and longitude".to_owned())
}

/// Adds the line of a range in meters and a true bearing in degrees; whether there is one.
fn add_bearing(
    details: &[&XmlElement<'_>],
    event: &XmlElement<'_>,
    parts: &mut FeatureParts,
) -> Result<bool, String> {
    let value = |name: &str| details.iter().find(|detail| detail.name() == name)?.number::<f64>("value");
    let (Some(range_m), Some(bearing_deg)) = (value("range"), value("bearing")) else { return Ok(false) };
    if !(range_m > 0.0 && range_m <= MOST_REACH_M && bearing_deg.abs() <= 360.0) {
        return Err(format!("its range of {range_m} m and bearing of {bearing_deg}° are no line"));
    }
    let start = place_of(event)?.truncate();
    let mut end = Geodesic::toward(start, bearing_deg, range_m).at(range_m);
    end.x += ((start.x - end.x) / 360.0).round() * 360.0;
    parts.add_line(vertices(&[start, end]));
    Ok(true)
}

fn vertices(places: &[DVec2]) -> Vertices {
    places.iter().map(|at| at.extend(f64::NAN)).collect()
}

/// Colors are signed numbers of alpha, red, green and blue.
fn add_colors(details: &[&XmlElement<'_>], properties: &mut Properties) {
    let value = |name: &str, attribute: &str| {
        details.iter().find(|detail| detail.name() == name)?.number::<f64>(attribute)
    };
    let colors = [
        ("strokeColor", "value", STROKE, STROKE_OPACITY),
        ("fillColor", "value", FILL, FILL_OPACITY),
        ("color", "argb", MARKER_COLOR, ""),
    ];
    for (name, attribute, color, opacity) in colors {
        let number = value(name, attribute).filter(|number| number.abs() < 4_294_967_296.0);
        let Some(number) = number else { continue };
        let [alpha, red, green, blue] = (number as i64 as u32).to_be_bytes();
        set(properties, color, hex_color([red, green, blue]));
        if !opacity.is_empty() {
            set_number(properties, opacity, Some(f64::from(alpha) / 255.0));
        }
    }
    let style = details
        .iter()
        .find(|detail| detail.name() == "strokeStyle")
        .and_then(|style| style.attribute("value"));
    match style.as_deref() {
        Some("dashed") => set(properties, STROKE_DASHES, "6,4"),
        Some("dotted") => set(properties, STROKE_DASHES, "2,3"),
        _ => {}
    }
    set_number(properties, STROKE_WIDTH, value("strokeWeight", "value").filter(|width| *width > 0.0));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read;
    use sandtable_base::archive::zip;

    fn event(uid: &str, kind: &str, detail: &str) -> String {
        format!(
            "<event version='2.0' uid='{uid}' type='{kind}' time='2026-05-01T06:00:00Z' start='2026-05-01T06:00:00Z' stale='2026-05-01T07:00:00Z' how='m-g'>\
             <point lat='36.3' lon='-84.2' hae='310' ce='9999999' le='9999999'/><detail>{detail}</detail></event>\n"
        )
    }

    fn layer(text: &str) -> VectorLayer {
        read::read("a.cot", text.as_bytes(), &VectorHints::default()).expect("events")
    }

    #[test]
    fn a_type_of_atoms_is_a_code() {
        for (kind, expected) in [
            ("a-f-G-U-C-I", Some("SFGPUCI--------")),
            ("a-h-G", Some("SHGP-----------")),
            ("a-n-A-M-F-Q-r", Some("SNAPMFQ--------")),
            ("a-f-G-I-B-A", Some("SFGPIBA---H----")),
            ("a-.-G-E-V-A-T", Some("SUGPEVAT-------")),
            ("b-m-p-s-m", None),
            ("a-f", None),
        ] {
            assert_eq!(code_of(kind).as_deref(), expected, "{kind}");
        }
    }

    #[test]
    fn events_have_their_callsign_track_times_and_elevation() {
        let text = event(
            "u1",
            "a-f-G-U-C",
            "<contact callsign='ALPHA 6'/><track course='90' speed='10'/><remarks>ready</remarks>",
        );
        let layer = layer(&text);
        let unit = &layer.features[0];
        for (property, expected) in [
            ("sidc", "SFGPUC---------"),
            ("unique_designation", "ALPHA 6"),
            ("direction", "90"),
            ("speed", "36 km/h"),
            ("description", "ready"),
            ("begin", "2026-05-01T06:00:00Z"),
            ("end", "2026-05-01T07:00:00Z"),
        ] {
            assert_eq!(unit.properties[property], expected, "{property}");
        }
        assert_eq!((&unit.elevations, unit.properties["hae"].as_f64()), (&None, Some(310.0)));
    }

    #[test]
    fn events_one_after_the_other_in_a_list_or_in_a_package_are_read_alike() {
        let events = [event("a", "a-f-G", ""), event("b", "a-h-G", "")];
        let declared: String =
            events.iter().map(|event| format!("<?xml version=\"1.0\"?>\n{event}")).collect();
        let listed = format!("<events>{}</events>", events.concat());
        let package = zip(&[
            ("a/a.cot", events[0].as_bytes()),
            ("b/b.cot", events[1].as_bytes()),
            ("MANIFEST/manifest.xml", b"<x/>"),
        ]);
        for bytes in [declared.into_bytes(), listed.into_bytes(), package.expect("memory")] {
            let layer = read::read("a.zip", &bytes, &VectorHints::default()).expect("events");
            let ids: Vec<&str> =
                layer.features.iter().filter_map(|unit| unit.properties["id"].as_str()).collect();
            assert_eq!(ids, ["a", "b"]);
        }
    }

    #[test]
    fn drawings_are_lines_areas_and_ellipses_with_their_colors() {
        let links =
            |points: &[&str]| points.iter().map(|at| format!("<link point='{at}'/>")).collect::<String>();
        let colors =
            "<strokeColor value='-65536'/><fillColor value='2130771712'/><strokeWeight value='3.0'/>";
        let open = ["36.1,-84.1", "36.2,-84.2,300", "36.3,-84.1"];
        let closed = [open[0], open[1], open[2], open[0]];
        let text = event("l", "u-d-f", &(links(&open) + colors))
            + &event("p", "u-d-f", &links(&closed))
            + &event("r", "u-d-r", &links(&open))
            + &event("c", "u-d-c-c", "<shape><ellipse major='500' minor='500' angle='0'/></shape>")
            + &event("m", "b-m-p-s-m", "<contact callsign='Bridge'/><color argb='-1'/>");
        let layer = layer(&text);
        let kinds: Vec<&str> = layer.features.iter().map(|feature| feature.geometry.kind()).collect();
        assert_eq!(kinds, ["lines", "polygons", "polygons", "polygons", "points"]);
        let line = &layer.features[0].properties;
        assert_eq!((line["stroke"].as_str(), line["fill"].as_str()), (Some("#ff0000"), Some("#00ff00")));
        assert_eq!(line["stroke-width"], 3.0);
        assert!((line["fill-opacity"].as_f64().expect("a number") - 127.0 / 255.0).abs() < 1e-9);
        assert_eq!(layer.features[4].properties["label"], "Bridge");
    }

    #[test]
    fn what_is_odd_is_told_by_its_uid() {
        let text = event("far", "a-f-G", "").replace("36.3", "136.3")
            + &event("wide", "u-d-c-c", "<shape><ellipse major='1e99' minor='5'/></shape>")
            + &event("link", "u-d-f", "<link point='a'/>")
            + &event("good", "a-f-G", "");
        let layer = layer(&text);
        assert_eq!(layer.features.len(), 1);
        for expected in
            ["event 'far': (-84.2, 136.3)", "event 'wide': the major axis", "event 'link': the link 'a'"]
        {
            assert!(layer.faults[0].contains(expected), "{:?}", layer.faults);
        }
    }

    #[test]
    fn symbols_in_the_details_state_code_and_fields() {
        let symbol = "<__milicon id='10031000161211000000'/><__milsym id='SFGCUCI---*****'><unitmodifier code='T'>1-77</unitmodifier></__milsym>";
        let aircraft = event("air", "a-h-A-M-F", "");
        let layer = layer(
            &(event("a", "a-f-G-U-C", symbol)
                + &aircraft
                + &event("t", "t-x-c-t", "")
                + &event("c", "b-t-f", "")),
        );
        let [unit, air] = &layer.features[..] else { panic!("two: {:?}", layer.features) };
        assert_eq!(
            (unit.properties["sidc"].as_str(), unit.properties["unique_designation"].as_str()),
            (Some("10031000161211000000"), Some("1-77"))
        );
        assert_eq!(air.properties["altitude"], "310 m");
        assert!(
            layer.notes[0].contains("2 events that are tasks or messages (event 't', event 'c')"),
            "{:?}",
            layer.notes
        );
    }

    #[test]
    fn rings_polylines_and_bearings_are_drawn() {
        let ring = |radius: u32| format!("<ellipse major='{radius}' minor='{radius}' angle='360'/>");
        let rings = format!("<shape>{}{}</shape><strokeStyle value='dashed'/>", ring(500), ring(1000));
        let corner = |lat: f64, lon: f64| format!("<vertex lat='{lat}' lon='{lon}' hae='0'/>");
        let corners = [corner(36.1, -84.1), corner(36.2, -84.2), corner(36.3, -84.1)].concat();
        let text = event("c", "u-r-b-c-c", &rings)
            + &event("p", "u-d-f", &format!("<shape><polyline closed='true'>{corners}</polyline></shape>"))
            + &event("b", "u-rb-a", "<range value='1000'/><bearing value='90'/>")
            + &event("e", "u-d-c-e", "<shape><ellipse major='2000' minor='500' angle='30'/></shape>");
        let layer = layer(&text);
        let kinds: Vec<&str> = layer.features.iter().map(|feature| feature.geometry.kind()).collect();
        assert_eq!(kinds, ["polygons", "polygons", "lines", "polygons"]);
        assert_eq!(layer.features[0].polygons().len(), 2);
        assert_eq!(layer.features[0].properties["stroke-dasharray"], "6,4");
        let center = DVec2::new(-84.2, 36.3);
        let far = layer.features[3].geometry.vertices().map(|at| Geodesic::between(center, *at));
        let far = far.max_by(|a, b| a.length_m().total_cmp(&b.length_m())).expect("vertices");
        assert!(
            (far.length_m() - 2000.0).abs() < 5.0 && (far.bearing_deg().rem_euclid(180.0) - 30.0).abs() < 2.0,
            "{far:?}"
        );
        let line = &layer.features[2].lines()[0];
        assert!((Geodesic::between(line[0], line[1]).length_m() - 1000.0).abs() < 1e-6);
    }

    #[test]
    fn a_recording_that_is_broken_off_keeps_what_came_before() {
        let text = event("a", "a-f-G", "") + &event("b", "a-f-G", "")[..80];
        let layer = layer(&text);
        assert_eq!(layer.features.len(), 1);
        assert!(layer.faults[0].contains("1 record that cannot be read: line 2"), "{:?}", layer.faults);
        let cut = &event("a", "a-f-G", "")[..80];
        assert!(read::read("a.cot", cut.as_bytes(), &VectorHints::default()).is_err());
    }
}

//! Cursor-on-Target events (MITRE, CoT schema 2.0) as ATAK and others write them: one event, several in one element or one after
//! the other, and those of a data package.
//!
//! | type | becomes |
//! |---|---|
//! | `a-f-G-U-C-I` | a symbol: the affiliation, the dimension and the function letters of MIL-STD-2525C |
//! | `u-d-…` with links | a line, an area where it is closed |
//! | `u-d-c-…` with an ellipse | an ellipse |
//! | `b-m-r` | a route |
//! | others | a point with the callsign as label |

use glam::DVec2;

use crate::builder::{FeatureParts, LayerBuilder, Vertices, position};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::ground_shape::{self, FARTHEST_M};
use crate::hints::VectorHints;
use crate::moment::Moment;
use crate::overlay_schema::{
    BEGIN, DESCRIPTION, DIRECTION, END, FILL, FILL_OPACITY, ID, LABEL, MARKER_COLOR, NAME, SIDC, SPEED,
    STROKE, STROKE_OPACITY, STROKE_WIDTH, UNIQUE_DESIGNATION, bare_code, set,
};
use crate::svg_style::set_number;
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};
use sandtable_geom::crs::Crs;

const FORMAT: &str = "Cursor-on-Target file";

/// Reads all events.
///
/// # Errors
/// [`VectorError`], also where no event is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let one = one_document(&text);
    let mut xml = XmlReader::new(&one, FORMAT);
    let mut builder = LayerBuilder::new(hints.crs.cloned().unwrap_or_else(Crs::wgs84));
    xml.root()?;
    read_events(&mut xml, &mut builder)?;
    xml.finish()?;
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

fn read_events(xml: &mut XmlReader<'_>, builder: &mut LayerBuilder) -> Result<(), VectorError> {
    while let Some(child) = xml.next_child()? {
        if child.name() != "event" {
            // A list of events, whatever it is called.
            read_events(xml, builder)?;
            continue;
        }
        let event = xml.read(child)?;
        let place = || match event.attribute("uid") {
            Some(uid) => format!("event '{}'", shorten(&uid)),
            None => xml.line_of(&event),
        };
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
    let stated = ["__milsym", "__milicon"].iter().find_map(|name| detail(name)?.attribute("id"));
    let code = stated.and_then(|code| bare_code(&code)).or_else(|| code_of(&kind));
    let is_symbol = code.is_some();
    code.into_iter().for_each(|code| set(&mut properties, SIDC, code));
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
    Some(format!("S{affiliation}{dimension}P{function:-<11}"))
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
    /// Stands for an elevation that is not known, in the schema.
    const UNKNOWN_M: f64 = 9_999_999.0;
    Ok(position(lon, lat, number("hae").filter(|height| height.abs() < UNKNOWN_M)))
}

/// Adds a drawn shape; whether there is one.
fn add_shape(
    kind: &str,
    details: &[&XmlElement<'_>],
    event: &XmlElement<'_>,
    parts: &mut FeatureParts,
) -> Result<bool, String> {
    let shapes = details.iter().filter(|detail| detail.name() == "shape");
    let ellipse = shapes.flat_map(|shape| shape.children_named("ellipse")).next();
    if let Some(ellipse) = ellipse {
        let length = |name: &str| {
            let length = ellipse.number::<f64>(name).filter(|length| *length > 0.0 && *length <= FARTHEST_M);
            length.ok_or_else(|| {
                format!("the {name} axis of the ellipse is not above 0 and up to {FARTHEST_M} m")
            })
        };
        let axes = [length("major")?, length("minor")?];
        let center = place_of(event)?.truncate();
        let ring = ground_shape::ellipse(center, axes, ellipse.number("angle").unwrap_or(0.0));
        parts.add_polygon([vertices(&ring)]);
        return Ok(true);
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
    let is_closed = points.len() > 3 && points.first() == points.last();
    match points.len() {
        0 | 1 => return Ok(false),
        _ if is_closed || (kind.starts_with("u-d-r") && points.len() > 2) => {
            parts.add_polygon([vertices(&points)]);
        }
        _ => parts.add_line(vertices(&points)),
    }
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
        set(properties, color, format!("#{red:02x}{green:02x}{blue:02x}"));
        if !opacity.is_empty() {
            set_number(properties, opacity, Some(f64::from(alpha) / 255.0));
        }
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
        assert_eq!(unit.elevations.as_deref(), Some(&[310.0][..]));
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
}

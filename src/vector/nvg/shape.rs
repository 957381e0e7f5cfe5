//! The shapes of NVG's elements, computed on the ground in meters.
//!
//! Directions run clockwise from north, from `startangle` to `endangle`; `rotation` turns a shape counterclockwise (NVG 1.5 data
//! schema, `directionAngleType` and `rotationAngleType`). `rx` is half of the axis that lies east before the rotation.

use glam::{DVec2, DVec3};

use crate::builder::{FeatureParts, Vertices};
use crate::error::shorten;
use crate::xml::XmlElement;
use sandtable_geom::ground_band::{TrackSide, arrow, corridor, racetrack};
use sandtable_geom::ground_shape::{DirectionRange, GroundEllipse, GroundShapeError, arc_band};

/// The stated width in meters.
pub(super) fn width_m(element: &XmlElement<'_>) -> Option<f64> {
    element.number::<f64>("width").filter(|width| *width > 0.0 && width.is_finite())
}

/// The shape of an element; `None` for an element that has none. With a symbol, lines with a width stay lines, and the points
/// of a multipoint are those of its draw rule.
///
/// # Errors
/// A sentence why it has no shape.
pub(super) fn parts(
    kind: &str,
    element: &XmlElement<'_>,
    has_symbol: bool,
) -> Option<Result<FeatureParts, String>> {
    let mut parts = FeatureParts::default();
    let shape = match kind {
        "point" | "text" => place(element, ["x", "y"]).map(|at| parts.add_points(vec![at.extend(f64::NAN)])),
        "multipoint" => points(element).map(|points| match has_symbol && points.len() > 1 {
            true => parts.add_line(points),
            false => parts.add_points(points),
        }),
        "polyline" => points(element).map(|points| parts.add_line(points)),
        "arc" => arc(element).map(|line| parts.add_line(vertices(&line))),
        "corridor" | "arrow" | "orbit" => strip(kind, element, has_symbol, &mut parts),
        "polygon" | "circle" | "ellipse" | "rect" | "arcband" | "arc-band" => {
            rings(kind, element).map(|rings| parts.add_polygon(rings))
        }
        _ => return None,
    };
    Some(shape.map(|()| parts))
}

/// The rings of an area, the outer one first; those of what it excludes follow.
fn rings(kind: &str, element: &XmlElement<'_>) -> Result<Vec<Vertices>, String> {
    let mut rings = ring(kind, element)?;
    let excluded = element.children().filter(|child| child.name().eq_ignore_ascii_case("exclude"));
    for hole in excluded.flat_map(XmlElement::children) {
        let name = hole.name().to_ascii_lowercase();
        let kind = match name.trim_end_matches("ring").trim_end_matches('-') {
            "linear" | "polygon" => "polygon",
            "circular" | "circle" => "circle",
            "elliptic" | "elliptical" | "ellipse" => "ellipse",
            "rect" | "rectangular" => "rect",
            "arcband" => "arcband",
            _ => return Err(format!("it excludes '{}', which is no ring", shorten(hole.name()))),
        };
        // A hole of a full band has an island, which is left out with it.
        rings.extend(ring(kind, hole)?.into_iter().take(1));
    }
    Ok(rings)
}

fn ring(kind: &str, element: &XmlElement<'_>) -> Result<Vec<Vertices>, String> {
    let said = |error: GroundShapeError| format!("'{}' has no outline: {error}", element.name());
    let rings = match kind {
        "polygon" => return Ok(vec![points(element)?]),
        "circle" => {
            vec![GroundEllipse::circle(center(element)?, number(element, "r")?).ring().map_err(said)?]
        }
        "ellipse" => vec![ellipse(element)?.ring().map_err(said)?],
        "rect" => vec![ellipse(element)?.rectangle().map_err(said)?],
        _ => {
            let radii_m = [number(element, "minr")?, number(element, "maxr")?];
            arc_band(center(element)?, radii_m, directions(element)?).map_err(said)?
        }
    };
    Ok(rings.iter().map(|ring| vertices(ring)).collect())
}

/// A part of an ellipse's outline.
fn arc(element: &XmlElement<'_>) -> Result<Vec<DVec2>, String> {
    let said = |error: GroundShapeError| format!("'{}' has no outline: {error}", element.name());
    ellipse(element)?.arc(directions(element)?).map_err(said)
}

fn ellipse(element: &XmlElement<'_>) -> Result<GroundEllipse, String> {
    // Circular arcs of some writers have one radius.
    let radius = |name: &str| number(element, name).or_else(|error| number(element, "r").map_err(|_| error));
    Ok(GroundEllipse {
        center: center(element)?,
        radii_m: DVec2::new(radius("rx")?, radius("ry")?),
        rotation_deg: element.number::<f64>("rotation").unwrap_or(0.0),
    })
}

fn directions(element: &XmlElement<'_>) -> Result<DirectionRange, String> {
    // An angle that is not stated is 0, by the schema.
    let angle = |name: &str| match element.attribute(name) {
        Some(_) => number(element, name),
        None => Ok(0.0),
    };
    let range = DirectionRange::between(angle("startangle")?, angle("endangle")?);
    range.map_err(|error| format!("'{}' has no outline: {error}", element.name()))
}

/// A corridor, an arrow or an orbit: a line with a width.
fn strip(
    kind: &str,
    element: &XmlElement<'_>,
    has_symbol: bool,
    parts: &mut FeatureParts,
) -> Result<(), String> {
    let line = points(element)?;
    let Some(width_m) = width_m(element).filter(|_| !has_symbol) else {
        parts.add_line(line);
        return Ok(());
    };
    let places: Vec<DVec2> = line.into_iter().map(DVec3::truncate).collect();
    let ring = match (kind, &places[..]) {
        ("arrow", _) => arrow(&places, width_m),
        ("orbit", &[start, end]) => racetrack([start, end], width_m, side_of(element)),
        ("orbit", _) => return Err(format!("an orbit has two points, this one {}", places.len())),
        _ => corridor(&places, width_m),
    };
    let ring = ring.map_err(|error| format!("'{}' has no outline: {error}", element.name()))?;
    parts.add_polygon([vertices(&ring)]);
    Ok(())
}

fn side_of(element: &XmlElement<'_>) -> TrackSide {
    match element.attribute("alignment").unwrap_or_default().trim().to_ascii_lowercase().as_str() {
        "left" => TrackSide::Left,
        "right" => TrackSide::Right,
        _ => TrackSide::Center,
    }
}

fn number(element: &XmlElement<'_>, name: &str) -> Result<f64, String> {
    let number = element.number::<f64>(name).filter(|number| number.is_finite());
    number.ok_or_else(|| match element.attribute(name) {
        Some(text) => format!("the {name} of '{}', '{}', is no number", element.name(), shorten(&text)),
        None => format!("'{}' has no {name}", element.name()),
    })
}

fn center(element: &XmlElement<'_>) -> Result<DVec2, String> {
    place(element, ["cx", "cy"])
}

fn place(element: &XmlElement<'_>, names: [&str; 2]) -> Result<DVec2, String> {
    let at = DVec2::new(number(element, names[0])?, number(element, names[1])?);
    on_earth(at).ok_or_else(|| format!("({}, {}) is no longitude and latitude", at.x, at.y))
}

fn on_earth(at: DVec2) -> Option<DVec2> {
    (at.x.abs() <= 360.0 && at.y.abs() <= 90.0).then_some(at)
}

/// The places of the attribute `points`: `15.8,60.1 16.4,60`. A third number of a place is its altitude.
fn points(element: &XmlElement<'_>) -> Result<Vertices, String> {
    let text = element.attribute("points").ok_or_else(|| format!("'{}' has no points", element.name()))?;
    let places = text.split_ascii_whitespace().map(|tuple| {
        let mut numbers = tuple.split(',').map(|number| number.trim().parse::<f64>());
        let at = match (numbers.next(), numbers.next()) {
            (Some(Ok(x)), Some(Ok(y))) => on_earth(DVec2::new(x, y)),
            _ => None,
        };
        let altitude = numbers.next().and_then(Result::ok).unwrap_or(f64::NAN);
        at.map(|at| at.extend(altitude))
            .ok_or_else(|| format!("'{}' is no longitude and latitude", shorten(tuple)))
    });
    let places: Vertices = places.collect::<Result<_, _>>()?;
    if places.is_empty() { Err(format!("'{}' has no points", element.name())) } else { Ok(places) }
}

fn vertices(places: &[DVec2]) -> Vertices {
    places.iter().map(|at| at.extend(f64::NAN)).collect()
}

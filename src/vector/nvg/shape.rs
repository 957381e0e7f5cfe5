//! The shapes of NVG's elements.

use glam::DVec2;

use crate::builder::{FeatureParts, Vertices};
use crate::ground_shape::{self, FARTHEST_M};
use crate::xml::XmlElement;

/// Why an element has no shape.
type OddElement = String;

/// The stated width in meters.
pub(super) fn width_m(element: &XmlElement<'_>) -> Option<f64> {
    element.number::<f64>("width").filter(|width| *width > 0.0 && *width <= FARTHEST_M)
}

/// The shape of an element; `None` for an element that has none. With a symbol, lines with a width stay lines.
pub(super) fn parts(
    kind: &str,
    element: &XmlElement<'_>,
    has_symbol: bool,
) -> Option<Result<FeatureParts, OddElement>> {
    let mut parts = FeatureParts::default();
    let shape = match kind {
        "point" | "text" => place(element, ["x", "y"]).map(|at| parts.add_points(vec![at.extend(f64::NAN)])),
        "multipoint" => points(element).map(|points| parts.add_points(vertices(&points))),
        "polyline" => points(element).map(|points| parts.add_line(vertices(&points))),
        "polygon" => points(element).map(|points| parts.add_polygon(rings(points, element))),
        "circle" => circle(element, &mut parts),
        "ellipse" => ellipse(element).map(|ring| parts.add_polygon(rings(ring, element))),
        "arc" => arc(element, &mut parts),
        "arcband" | "arc-band" => arc_band(element, &mut parts),
        "rect" => rectangle(element).map(|ring| parts.add_polygon(rings(ring, element))),
        "corridor" | "arrow" | "orbit" => strip(kind, element, has_symbol, &mut parts),
        _ => return None,
    };
    Some(shape.map(|()| parts))
}

fn number(element: &XmlElement<'_>, name: &str) -> Result<f64, OddElement> {
    let number = element.number::<f64>(name).filter(|number| number.is_finite());
    number.ok_or_else(|| format!("'{}' has no number {name}", element.name()))
}

fn length_m(element: &XmlElement<'_>, name: &str) -> Result<f64, OddElement> {
    let length = number(element, name)?;
    if (0.0..=FARTHEST_M).contains(&length) {
        return Ok(length);
    }
    Err(format!("the {name} of '{}', {length} m, is not from 0 to {FARTHEST_M} m", element.name()))
}

fn place(element: &XmlElement<'_>, names: [&str; 2]) -> Result<DVec2, OddElement> {
    let at = DVec2::new(number(element, names[0])?, number(element, names[1])?);
    on_earth(at).ok_or_else(|| format!("({}, {}) is no longitude and latitude", at.x, at.y))
}

fn on_earth(at: DVec2) -> Option<DVec2> {
    (at.x.abs() <= 360.0 && at.y.abs() <= 90.0).then_some(at)
}

/// The places of the attribute `points`: `15.8,60.1 16.4,60`.
fn points(element: &XmlElement<'_>) -> Result<Vec<DVec2>, OddElement> {
    let text = element.attribute("points").ok_or_else(|| format!("'{}' has no points", element.name()))?;
    let places = text.split_ascii_whitespace().map(|pair| {
        let mut numbers = pair.split(',').map(|number| number.trim().parse::<f64>());
        let at = match (numbers.next(), numbers.next()) {
            (Some(Ok(x)), Some(Ok(y))) => on_earth(DVec2::new(x, y)),
            _ => None,
        };
        at.ok_or_else(|| format!("'{}' is no longitude and latitude", crate::error::shorten(pair)))
    });
    let places: Vec<DVec2> = places.collect::<Result<_, _>>()?;
    if places.is_empty() { Err(format!("'{}' has no points", element.name())) } else { Ok(places) }
}

fn vertices(places: &[DVec2]) -> Vertices {
    places.iter().map(|at| at.extend(f64::NAN)).collect()
}

/// The outer ring, and those that `exclude` cuts out.
fn rings(outer: Vec<DVec2>, element: &XmlElement<'_>) -> Vec<Vertices> {
    let excluded = element.children().filter(|child| child.name().eq_ignore_ascii_case("exclude"));
    let holes = excluded.flat_map(XmlElement::children).filter_map(|hole| {
        match hole.name().to_ascii_lowercase().as_str() {
            "linear-ring" | "linearring" | "polygon" => points(hole).ok(),
            "circle" => {
                Some(ground_shape::circle(place(hole, ["cx", "cy"]).ok()?, length_m(hole, "r").ok()?))
            }
            "ellipse" => ellipse(hole).ok(),
            "rect" => rectangle(hole).ok(),
            _ => None,
        }
    });
    [outer].into_iter().chain(holes).map(|ring| vertices(&ring)).collect()
}

fn circle(element: &XmlElement<'_>, parts: &mut FeatureParts) -> Result<(), OddElement> {
    let ring = ground_shape::circle(place(element, ["cx", "cy"])?, length_m(element, "r")?);
    parts.add_polygon(rings(ring, element));
    Ok(())
}

fn ellipse(element: &XmlElement<'_>) -> Result<Vec<DVec2>, OddElement> {
    let axes = [length_m(element, "rx")?, length_m(element, "ry")?];
    // The first axis lies east; `rotation` turns it clockwise.
    let rotation = element.number::<f64>("rotation").unwrap_or(0.0);
    Ok(ground_shape::ellipse(place(element, ["cx", "cy"])?, axes, 90.0 + rotation))
}

/// A part of an ellipse's outline; of a circle where its axes are one.
fn arc(element: &XmlElement<'_>, parts: &mut FeatureParts) -> Result<(), OddElement> {
    let center = place(element, ["cx", "cy"])?;
    let radius = length_m(element, "rx").or_else(|_| length_m(element, "r"))?;
    let angles = [number(element, "startangle")?, number(element, "endangle")?];
    parts.add_line(vertices(&ground_shape::arc(center, radius, angles)));
    Ok(())
}

fn arc_band(element: &XmlElement<'_>, parts: &mut FeatureParts) -> Result<(), OddElement> {
    let center = place(element, ["cx", "cy"])?;
    let radii = [length_m(element, "minr")?, length_m(element, "maxr")?];
    if radii[0] >= radii[1] {
        return Err(format!("the least radius, {} m, is not below the greatest, {} m", radii[0], radii[1]));
    }
    let angles = [number(element, "startangle")?, number(element, "endangle")?];
    let band = ground_shape::arc_band(center, radii, angles);
    parts.add_polygon(band.iter().map(|ring| vertices(ring)));
    Ok(())
}

/// A rectangle by its middle and half sides, turned clockwise.
fn rectangle(element: &XmlElement<'_>) -> Result<Vec<DVec2>, OddElement> {
    let center = place(element, ["cx", "cy"])?;
    let (half_x, half_y) = (length_m(element, "rx")?, length_m(element, "ry")?);
    let rotation = element.number::<f64>("rotation").unwrap_or(0.0);
    let corner = |[x, y]: [f64; 2]| {
        let bearing = libm::atan2(x, y).to_degrees() + rotation;
        ground_shape::offset(center, bearing, libm::hypot(x, y))
    };
    let corners = [[-half_x, -half_y], [half_x, -half_y], [half_x, half_y], [-half_x, half_y]];
    Ok(corners.map(corner).to_vec())
}

/// A corridor, an arrow or an orbit: a line with a width.
fn strip(
    kind: &str,
    element: &XmlElement<'_>,
    has_symbol: bool,
    parts: &mut FeatureParts,
) -> Result<(), OddElement> {
    let line = points(element)?;
    let outline = match width_m(element).filter(|_| !has_symbol) {
        Some(width) if kind == "arrow" => ground_shape::arrow(&line, width),
        Some(width) => ground_shape::corridor(&line, width),
        None => None,
    };
    match outline {
        Some(ring) => parts.add_polygon([vertices(&ring)]),
        None => parts.add_line(vertices(&line)),
    }
    Ok(())
}

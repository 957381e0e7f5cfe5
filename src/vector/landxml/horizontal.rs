//! Horizontal alignments: `CoordGeom` of lines, curves, spirals and irregular lines as vertices with stations.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::xml::XmlElement;

/// How far a chord may lie off its arc, in the file's unit: less than a road is laid out to.
const SAGITTA: f64 = 0.01;

/// The most vertices of one element.
const MOST_STEPS: f64 = 2000.0;

/// The part of a spiral's length by which its end may miss the stated one.
const SPIRAL_SLACK: f64 = 0.01;

/// Points by name, easting, northing and elevation, NaN without one.
pub(super) type NamedPoints = BTreeMap<String, DVec3>;

/// A traced alignment.
#[derive(Debug, Default)]
pub(super) struct Traced {
    /// Easting, northing, and the elevation that the points themselves have, NaN without one.
    pub vertices: Vec<DVec3>,
    /// The distance from the start along the elements, arcs by their own length.
    pub distances: Vec<f64>,
    /// Sentences on what was taken for something else.
    pub notes: Vec<String>,
}

impl Traced {
    /// Adds a vertex `length` farther; a gap between two elements is bridged by a line.
    fn add(&mut self, at: DVec3, length: f64) {
        match (self.vertices.last(), self.distances.last()) {
            (Some(last), Some(&distance)) if length > 0.0 && *last != at => {
                self.vertices.push(at);
                self.distances.push(distance + length);
            }
            (None, _) => {
                self.vertices.push(at);
                self.distances.push(0.0);
            }
            _ => {}
        }
    }

    fn start(&mut self, at: DVec3) {
        let gap = self.vertices.last().map_or(0.0, |last| last.truncate().distance(at.truncate()));
        // What rounding leaves between two elements is no vertex.
        if self.vertices.is_empty() || gap > SAGITTA {
            self.add(at, gap);
        }
    }

    fn line_to(&mut self, at: DVec3) {
        let length = self.vertices.last().map_or(0.0, |last| last.truncate().distance(at.truncate()));
        self.add(at, length);
    }
}

/// Traces the elements of a `CoordGeom`.
///
/// # Errors
/// A sentence on the first element that cannot be read.
pub(super) fn trace(geometry: &XmlElement<'_>, points: &NamedPoints) -> Result<Traced, String> {
    let mut traced = Traced::default();
    for element in geometry.children() {
        match element.name() {
            "Line" => {
                traced.start(end(element, "Start", points)?);
                traced.line_to(end(element, "End", points)?);
            }
            "IrregularLine" | "Chain" => irregular(element, points, &mut traced)?,
            "Curve" => curve(element, points, &mut traced)?,
            "Spiral" => spiral(element, points, &mut traced)?,
            _ => {}
        }
    }
    Ok(traced)
}

/// Reads a point by its text, northing before easting, else by the name that it refers to; `None` where it is empty.
pub(super) fn point(element: &XmlElement<'_>, points: &NamedPoints) -> Result<DVec3, String> {
    let text = element.text();
    if let Some(at) = triple(&text) {
        return Ok(at);
    }
    let reference = element.attribute("pntRef").map(|name| name.into_owned()).unwrap_or_else(|| text.clone());
    let found = points.get(reference.trim()).copied();
    found.ok_or_else(|| {
        let text: String = reference.chars().take(40).collect();
        format!("'{text}' is neither a northing and an easting nor the name of a point")
    })
}

/// A northing, an easting and perhaps an elevation.
pub(super) fn triple(text: &str) -> Option<DVec3> {
    let mut numbers = text.split_whitespace().map(str::parse::<f64>);
    let mut next = || numbers.next()?.ok().filter(|number| number.is_finite());
    let (northing, easting) = (next()?, next()?);
    Some(DVec3::new(easting, northing, next().unwrap_or(f64::NAN)))
}

fn end(element: &XmlElement<'_>, name: &str, points: &NamedPoints) -> Result<DVec3, String> {
    optional(element, name, points)?.ok_or_else(|| format!("a {} has no {name}", element.name()))
}

fn optional(element: &XmlElement<'_>, name: &str, points: &NamedPoints) -> Result<Option<DVec3>, String> {
    element.children_named(name).next().map(|child| point(child, points)).transpose()
}

/// The numbers of a list of points, two or three to each.
pub(super) fn list(element: &XmlElement<'_>, numbers_each: usize) -> Result<Vec<DVec3>, String> {
    let text = element.text();
    let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse::<f64>).collect();
    let numbers = numbers.map_err(|error| format!("a list of points holds no number: {error}"))?;
    if !numbers.len().is_multiple_of(numbers_each) || numbers.iter().any(|number| !number.is_finite()) {
        return Err(format!("a list of {} numbers is not one of points of {numbers_each}", numbers.len()));
    }
    let at =
        |numbers: &[f64]| DVec3::new(numbers[1], numbers[0], numbers.get(2).copied().unwrap_or(f64::NAN));
    Ok(numbers.chunks_exact(numbers_each).map(at).collect())
}

fn irregular(element: &XmlElement<'_>, points: &NamedPoints, traced: &mut Traced) -> Result<(), String> {
    let mut vertices: Vec<DVec3> = Vec::new();
    vertices.extend(optional(element, "Start", points)?);
    for (name, numbers_each) in [("PntList2D", 2), ("PntList3D", 3)] {
        for child in element.children_named(name) {
            vertices.extend(list(child, numbers_each)?);
        }
    }
    vertices.extend(optional(element, "End", points)?);
    let mut vertices = vertices.into_iter();
    if let Some(first) = vertices.next() {
        traced.start(first);
    }
    vertices.for_each(|at| traced.line_to(at));
    Ok(())
}

/// 1 for a curve to the left, −1 for one to the right.
fn turn(element: &XmlElement<'_>) -> Result<f64, String> {
    match element.attribute("rot").as_deref() {
        Some("ccw") => Ok(1.0),
        Some("cw") => Ok(-1.0),
        _ => Err(format!("a {} turns neither cw nor ccw", element.name())),
    }
}

fn curve(element: &XmlElement<'_>, points: &NamedPoints, traced: &mut Traced) -> Result<(), String> {
    let (from, to) = (end(element, "Start", points)?, end(element, "End", points)?);
    let turn = turn(element)?;
    let center = match optional(element, "Center", points)? {
        Some(center) => center.truncate(),
        None => center_by_radius(element, from.truncate(), to.truncate(), turn)?,
    };
    let (out, back) = (from.truncate() - center, to.truncate() - center);
    let [first_radius, last_radius] = [out.length(), back.length()];
    if !(first_radius > 0.0 && last_radius > 0.0) {
        return Err("a Curve begins or ends at its center".to_owned());
    }
    let start_angle = libm::atan2(out.y, out.x);
    let sweep = (turn * (libm::atan2(back.y, back.x) - start_angle)).rem_euclid(TAU);
    let sweep = if sweep < 1e-12 { TAU } else { sweep };
    let step = 2.0 * libm::acos((1.0 - SAGITTA / first_radius).clamp(-1.0, 1.0)).max(1e-9);
    let steps = (sweep / step).ceil().clamp(1.0, MOST_STEPS);
    traced.start(from);
    for index in 1..=steps as usize {
        let share = index as f64 / steps;
        let angle = start_angle + turn * sweep * share;
        // Rounded radii of both ends meet.
        let radius = first_radius + (last_radius - first_radius) * share;
        let at = center + DVec2::new(libm::cos(angle), libm::sin(angle)) * radius;
        let at = if index == steps as usize { to } else { at.extend(from.z + (to.z - from.z) * share) };
        traced.add(at, sweep * first_radius / steps);
    }
    Ok(())
}

fn center_by_radius(element: &XmlElement<'_>, from: DVec2, to: DVec2, turn: f64) -> Result<DVec2, String> {
    let radius = element.number::<f64>("radius").filter(|radius| radius.is_finite() && *radius > 0.0);
    let radius = radius.ok_or("a Curve has neither a Center nor a radius")?;
    let chord = to - from;
    let aside = (radius * radius - chord.length_squared() / 4.0).max(0.0).sqrt();
    let is_large = element.number::<f64>("delta").is_some_and(|delta| delta.abs() > 180.0);
    let side = if is_large { -turn } else { turn };
    Ok((from + to) / 2.0 + chord.perp().normalize_or_zero() * side * aside)
}

/// The curvature at a share of a spiral's length, as a share of the way from its first to its last.
fn ease(kind: &str, share: f64) -> f64 {
    match kind {
        "bloss" => share * share * (3.0 - 2.0 * share),
        "sineHalfWave" | "cosine" => (1.0 - libm::cos(share * std::f64::consts::PI)) / 2.0,
        "sinusoid" => share - libm::sin(TAU * share) / TAU,
        "biquadratic" | "biquadraticParabola" if share <= 0.5 => 2.0 * share * share,
        "biquadratic" | "biquadraticParabola" => 1.0 - 2.0 * (1.0 - share) * (1.0 - share),
        // Clothoids, and what differs from them by centimeters.
        _ => share,
    }
}

fn spiral(element: &XmlElement<'_>, points: &NamedPoints, traced: &mut Traced) -> Result<(), String> {
    let (from, to) = (end(element, "Start", points)?, end(element, "End", points)?);
    let turn = turn(element)?;
    let length = element.number::<f64>("length").filter(|length| length.is_finite() && *length > 0.0);
    let length = length.ok_or("a Spiral has no length")?;
    let curvature = |name: &str| match element.attribute(name).as_deref().map(str::trim) {
        Some("INF" | "Infinity" | "inf") => Ok(0.0),
        Some(text) => match text.parse::<f64>() {
            Ok(radius) if radius > 0.0 => Ok(if radius.is_finite() { turn / radius } else { 0.0 }),
            _ => Err(format!("a Spiral's {name} is no length")),
        },
        None => Err(format!("a Spiral has no {name}")),
    };
    let [first, last] = [curvature("radiusStart")?, curvature("radiusEnd")?];
    let kind = element.attribute("spiType").unwrap_or("clothoid".into());
    if !["clothoid", "bloss", "cosine", "sineHalfWave", "sinusoid", "biquadratic", "biquadraticParabola"]
        .contains(&&*kind)
    {
        traced.notes.push(format!("a spiral of the type '{kind}' is drawn as a clothoid"));
    }
    // The tangents at both ends meet at the PI.
    let chord = to.truncate() - from.truncate();
    let toward = optional(element, "PI", points)?.map(|at| at.truncate() - from.truncate());
    let heading = toward.and_then(DVec2::try_normalize).or(chord.try_normalize());
    let heading = heading.ok_or("a Spiral ends where it begins")?;
    let sharpest = first.abs().max(last.abs()).max(1e-9);
    let steps = (length / (8.0 * SAGITTA / sharpest).sqrt()).ceil().clamp(4.0, MOST_STEPS);
    let mut path = vec![DVec2::ZERO];
    let (mut at, mut angle) = (DVec2::ZERO, libm::atan2(heading.y, heading.x));
    let step = length / steps;
    for index in 0..steps as usize {
        // Simpson's rule: for the angle over curvatures, for the place over angles at both ends and between.
        let curvature = |part: f64| first + (last - first) * ease(&kind, (index as f64 + part) / steps);
        let half = angle + step / 12.0 * (curvature(0.0) + 4.0 * curvature(0.25) + curvature(0.5));
        let next = angle + step / 6.0 * (curvature(0.0) + 4.0 * curvature(0.5) + curvature(1.0));
        let way = |angle: f64| DVec2::new(libm::cos(angle), libm::sin(angle));
        at += (way(angle) + way(half) * 4.0 + way(next)) * (step / 6.0);
        angle = next;
        path.push(at);
    }
    // Turned and scaled so that it ends where the file says.
    let fit = match chord.length_squared() {
        reached if reached > 0.0 && at.length_squared() > 0.0 => {
            chord.rotate(at.conjugate()) / at.length_squared()
        }
        _ => DVec2::X,
    };
    if (fit - DVec2::X).length() * chord.length() > SPIRAL_SLACK * length {
        traced.notes.push(format!(
            "a spiral of {length} ends {:.2} from where the file says; it is bent to end there",
            (at - chord).length()
        ));
    }
    traced.start(from);
    let count = path.len() - 1;
    for (index, place) in path.into_iter().enumerate().skip(1) {
        let share = index as f64 / count as f64;
        let z = from.z + (to.z - from.z) * share;
        let at = if index == count { to } else { (from.truncate() + place.rotate(fit)).extend(z) };
        traced.add(at, step);
    }
    Ok(())
}

/// Conjugates of vectors as complex numbers.
trait Conjugate {
    fn conjugate(self) -> Self;
}

impl Conjugate for DVec2 {
    fn conjugate(self) -> Self {
        DVec2::new(self.x, -self.y)
    }
}

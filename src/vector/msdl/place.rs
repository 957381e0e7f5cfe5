//! Places as MSDL states them: geodetic (GDC), geocentric (GCC), UTM or a grid reference (MGRS).

use glam::DVec3;

use crate::builder::position;
use crate::error::shorten;
use crate::xml::XmlElement;
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

/// All places in an element, in order: one of a unit, the anchor points of a graphic. Longitude, latitude and an elevation where
/// it is above the sea.
pub(super) fn places(element: &XmlElement<'_>) -> Result<Vec<DVec3>, String> {
    let mut places = Vec::new();
    add(element, &mut places)?;
    Ok(places)
}

fn add(element: &XmlElement<'_>, places: &mut Vec<DVec3>) -> Result<(), String> {
    for child in element.children() {
        let place = match child.name() {
            "GDC" => geodetic(child),
            "GCC" => geocentric(child),
            "UTM" => utm(child),
            "MGRS" => grid_reference(child),
            // Where a unit was told to form up is not where it is.
            "OwnFormation" | "FormationPosition" | "InPlaceSupport" => continue,
            _ => {
                add(child, places)?;
                continue;
            }
        };
        places.push(place?);
    }
    Ok(())
}

fn text(element: &XmlElement<'_>, end: &str) -> Option<String> {
    let named = |name: &str| name.to_ascii_lowercase().ends_with(end);
    element.children().find(|child| named(child.name())).map(XmlElement::text).filter(|text| !text.is_empty())
}

fn number(element: &XmlElement<'_>, end: &str) -> Result<f64, String> {
    let text = text(element, end).ok_or_else(|| format!("a place ({}) has no {end}", element.name()))?;
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("the {end} '{}' is no number", shorten(&text)))
}

fn on_earth(longitude: f64, latitude: f64) -> Result<DVec3, String> {
    if latitude.abs() <= 90.0 && longitude.abs() <= 360.0 {
        return Ok(position(longitude, latitude, None));
    }
    Err(format!("({longitude}, {latitude}) is no longitude and latitude"))
}

fn geodetic(element: &XmlElement<'_>) -> Result<DVec3, String> {
    on_earth(number(element, "longitude")?, number(element, "latitude")?)
}

/// By the method of Bowring (1976), exact to a millimeter on the ground.
fn geocentric(element: &XmlElement<'_>) -> Result<DVec3, String> {
    const A: f64 = 6_378_137.0;
    const F: f64 = 1.0 / 298.257_223_563;
    let [x, y, z] = [number(element, "x")?, number(element, "y")?, number(element, "z")?];
    let radius = DVec3::new(x, y, z).length();
    if !(6.3e6..6.5e6).contains(&radius) {
        return Err(format!(
            "({x}, {y}, {z}) is not near the ground: geocentric coordinates are meters from the middle of the Earth"
        ));
    }
    let (b, p) = (A * (1.0 - F), libm::hypot(x, y));
    let (e2, second) = (F * (2.0 - F), (A * A - b * b) / (b * b));
    let theta = libm::atan2(z * A, p * b);
    let (sin, cos) = (libm::sin(theta), libm::cos(theta));
    let latitude = libm::atan2(z + second * b * sin * sin * sin, p - e2 * A * cos * cos * cos);
    on_earth(libm::atan2(y, x).to_degrees(), latitude.to_degrees())
}

fn utm(element: &XmlElement<'_>) -> Result<DVec3, String> {
    let zone = text(element, "zone").ok_or("a place in UTM has no zone")?;
    let odd = || format!("'{}' is no zone of UTM", shorten(&zone));
    let digits: String = zone.chars().take_while(char::is_ascii_digit).collect();
    let number_of = digits.parse::<u32>().ok().filter(|number| (1..=60).contains(number)).ok_or_else(odd)?;
    // The letter is that of the band, of which those from N on lie north.
    let band = zone[digits.len()..].trim().chars().next().ok_or_else(odd)?.to_ascii_uppercase();
    if !band.is_ascii_alphabetic() {
        return Err(odd());
    }
    let code = if band >= 'N' { 32_600 } else { 32_700 } + number_of;
    let at = glam::DVec2::new(number(element, "easting")?, number(element, "northing")?);
    let crs = Crs::from_epsg(code).map_err(|error| error.to_string())?;
    let at = crs.transform(&Crs::wgs84(), at).map_err(|error| error.to_string())?;
    on_earth(at.x, at.y)
}

fn grid_reference(element: &XmlElement<'_>) -> Result<DVec3, String> {
    let zone =
        text(element, "gridzone").or_else(|| text(element, "zone")).ok_or("a grid reference has no zone")?;
    let square = text(element, "square").ok_or("a grid reference has no square")?;
    let [easting, northing] = [number(element, "easting")?, number(element, "northing")?];
    let is_within = |part: f64| (0.0..100_000.0).contains(&part);
    if !is_within(easting) || !is_within(northing) {
        return Err(format!("({easting}, {northing}) is not within a square of 100 km"));
    }
    let reference = format!("{}{}{easting:05.0}{northing:05.0}", zone.trim(), square.trim());
    let place = Position::parse(&reference).map(|place| place.in_system(&Crs::wgs84()));
    let at = place.map_err(|error| error.to_string())?.map_err(|error| error.to_string())?;
    on_earth(at.x, at.y)
}

//! Places as MSDL states them: geodetic (GDC), geocentric (GCC), UTM or a grid reference (MGRS).

use glam::DVec3;

use crate::builder::position;
use crate::error::shorten;
use crate::xml::XmlElement;
use sandtable_geom::crs::Crs;
use sandtable_geom::geocentric;
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
            "GCC" => geocentric_place(child),
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

fn geocentric_place(element: &XmlElement<'_>) -> Result<DVec3, String> {
    let at = DVec3::new(number(element, "x")?, number(element, "y")?, number(element, "z")?);
    let place = geocentric::place_of(at).ok_or_else(|| {
        format!(
            "({}, {}, {}) is not near the ground: geocentric coordinates are meters from the middle of the Earth",
            at.x, at.y, at.z
        )
    })?;
    on_earth(place.lonlat.x, place.lonlat.y)
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
    let digits = |name: &str| {
        let text = text(element, name).ok_or_else(|| format!("a grid reference has no {name}"))?;
        let is_sound = text.len() <= 5 && text.bytes().all(|digit| digit.is_ascii_digit());
        // Decimals of a meter are dropped: the reference names the square of a meter.
        let whole = text.split('.').next().unwrap_or_default();
        if is_sound {
            Ok(text)
        } else if let Ok(0..=99_999) = whole.parse::<u32>() {
            Ok(whole.to_owned())
        } else {
            Err(format!("the {name} '{}' is not within a square of 100 km", shorten(&text)))
        }
    };
    // Some writers leave out zeros in front: a coarser reference is one only where its precision says so.
    let stated = text(element, "precision").and_then(|text| text.parse::<usize>().ok());
    let width = stated.filter(|digits| (1..=5).contains(digits)).unwrap_or(5);
    let [easting, northing] = [digits("easting")?, digits("northing")?];
    let width = if easting.len().max(northing.len()) > width { 5 } else { width };
    let reference = format!("{}{}{easting:0>width$}{northing:0>width$}", zone.trim(), square.trim());
    let place = Position::parse(&reference).map(|place| place.in_system(&Crs::wgs84()));
    let at = place.map_err(|error| error.to_string())?.map_err(|error| error.to_string())?;
    on_earth(at.x, at.y)
}

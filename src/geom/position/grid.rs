//! Grid references, and eastings and northings of a zone, as text.

use glam::DVec2;

use super::fault::PositionFault;
use super::token::{DigitCommas, Token, plain, tokens};
use crate::mgrs::{GridCell, GridFault, GridZone, ZonePoint};

/// The eastings that zones of UTM and caps of UPS have on land and sea, meters: those of the military grid.
const UTM_EASTINGS: std::ops::RangeInclusive<f64> = 1e5..=9e5;
const UPS_NORTH: std::ops::RangeInclusive<f64> = 1.3e6..=2.7e6;
const UPS_SOUTH: std::ops::RangeInclusive<f64> = 8e5..=3.2e6;
/// The northings of UTM, meters: to 84° north and 80° south.
const NORTH_NORTHINGS: std::ops::RangeInclusive<f64> = 0.0..=9.4e6;
const SOUTH_NORTHINGS: std::ops::RangeInclusive<f64> = 1.1e6..=1e7;

/// The square of a text that is a grid reference, or looks like one and is wrong; `None` for other texts.
pub(super) fn reference(text: &str) -> Option<Result<GridCell, PositionFault>> {
    let text = plain(text);
    let named = ["MGRS", "USNG"].iter().find_map(|name| text.strip_prefix(name));
    let text = named.map_or(text.as_str(), |rest| rest.trim_start_matches([' ', ':']));
    let compact: String = text.chars().filter(|&character| character != ' ').collect();
    let zone_digits = compact.bytes().take_while(u8::is_ascii_digit).count();
    let after_zone = compact.get(zone_digits..)?;
    let letters = after_zone.bytes().take_while(u8::is_ascii_uppercase).count();
    let digits = after_zone.get(letters..)?;
    if !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    match (zone_digits, letters) {
        (1..=2, 3) => Some(square(text, &compact, digits)),
        (1..=2, 1) if digits.is_empty() && is_band(after_zone) => Some(Err(PositionFault::ZoneAlone)),
        (0, 3) if compact.starts_with(['A', 'B', 'Y', 'Z']) && !digits.is_empty() => {
            Some(square(text, &compact, digits))
        }
        // Three letters alone are a square of a polar cap, or a word.
        (0, 3) if digits.is_empty() => GridCell::parse(&compact).ok().map(Ok),
        (0, 2) if !digits.is_empty() => Some(Err(PositionFault::NoZone)),
        _ => None,
    }
}

fn is_band(letters: &str) -> bool {
    // A number with E or W is a longitude.
    letters.chars().all(|letter| ('C'..='X').contains(&letter) && !matches!(letter, 'I' | 'O' | 'E' | 'W'))
}

fn square(text: &str, compact: &str, digits: &str) -> Result<GridCell, PositionFault> {
    // Where digits stand in groups, they are an easting and a northing of the same number of digits.
    let after_letters = text.rfind(|character: char| character.is_ascii_uppercase()).map_or(0, |at| at + 1);
    let groups: Vec<&str> = text[after_letters..].split_whitespace().collect();
    let even = match groups[..] {
        [] => true,
        [digits] => digits.len().is_multiple_of(2),
        [easting, northing] => easting.len() == northing.len(),
        _ => false,
    };
    if !even || !digits.len().is_multiple_of(2) {
        return Err(PositionFault::Grid(GridFault::UnevenDigits));
    }
    GridCell::parse(compact).map_err(PositionFault::Grid)
}

/// The easting and northing of a text that is UTM or UPS, or looks like it and is wrong; `None` for other texts.
pub(super) fn zone_point(text: &str) -> Option<Result<ZonePoint, PositionFault>> {
    let text = plain(text);
    let mut parts = tokens(&text, DigitCommas::Separate)?;
    parts.retain(|part| *part != Token::Separator);
    let is_name =
        |part: &Token| matches!(part, Token::Word(word) if ["UTM", "UPS", "ZONE"].contains(&word.as_str()));
    let is_named = parts.iter().any(is_name);
    parts.retain(|part| !is_name(part));
    // The zone may stand behind, as in 500000 5200000 33N.
    if let [.., Token::Number(zone), Token::Word(_)] = &parts[..]
        && zone.value <= 60.0
        && matches!(parts.first(), Some(Token::Number(first)) if first.value > 60.0)
    {
        parts.rotate_right(2);
    }
    match &parts[..] {
        [Token::Number(zone), Token::Word(letter), rest @ ..] if zone.is_plain() => {
            // Smaller numbers are degrees.
            let at = easting_northing(rest).filter(|at| is_named || at.max_element() >= 1000.0)?;
            Some(utm(zone.value, letter, at))
        }
        [Token::Number(zone), rest @ ..] if zone.is_plain() && zone.value <= 60.0 => {
            let at = easting_northing(rest)?;
            (is_named || at.x >= *UTM_EASTINGS.start()).then_some(Err(PositionFault::NoHemisphere))
        }
        [Token::Word(letter), rest @ ..] => {
            let at = easting_northing(rest)?;
            ups(letter, at, is_named)
        }
        _ => None,
    }
}

/// Easting and northing, with or without their letters and units; `None` of other parts.
fn easting_northing(parts: &[Token]) -> Option<DVec2> {
    let (mut numbers, mut first_word) = (Vec::new(), None);
    for part in parts {
        match part {
            Token::Number(number) if !number.is_signed => numbers.push(number.value),
            Token::Word(word) => {
                let is_northing = match word.as_str() {
                    "E" | "ME" | "EASTING" | "EAST" => Some(false),
                    "N" | "MN" | "NORTHING" | "NORTH" => Some(true),
                    "M" => None,
                    _ => return None,
                };
                first_word = first_word.or(is_northing);
            }
            Token::Number(_) | Token::Mark(_) | Token::Separator => return None,
        }
    }
    match (&numbers[..], first_word) {
        (&[northing, easting], Some(true)) => Some(DVec2::new(easting, northing)),
        (&[easting, northing], _) => Some(DVec2::new(easting, northing)),
        _ => None,
    }
}

fn utm(zone: f64, letter: &str, at: DVec2) -> Result<ZonePoint, PositionFault> {
    let number = zone as u8;
    if !(1.0..=60.0).contains(&zone) || f64::from(number) != zone {
        return Err(PositionFault::ZoneNumber(zone));
    }
    if !UTM_EASTINGS.contains(&at.x) {
        return Err(PositionFault::Easting(at.x));
    }
    let on = |is_north: bool| -> Result<ZonePoint, PositionFault> {
        let northings = if is_north { NORTH_NORTHINGS } else { SOUTH_NORTHINGS };
        let point = GridZone::utm(number, is_north).map(|zone| ZonePoint { zone, at });
        point.filter(|_| northings.contains(&at.y)).ok_or(PositionFault::Northing(at.y))
    };
    let mut letters = letter.chars();
    match (letter, letters.next(), letters.next()) {
        // Band N lies on the northern hemisphere, so that both readings are one place.
        ("N" | "NORTH", ..) => on(true),
        ("SOUTH", ..) => on(false),
        ("S", ..) => match on(true).ok().filter(|point| point.band() == Some('S')) {
            Some(in_band) => Err(ambiguous(number, in_band, on(false)?)),
            None => on(false),
        },
        (_, Some(band @ ('C'..='H' | 'J'..='M' | 'P'..='X')), None) => {
            let point = on(band >= 'N')?;
            match point.band() {
                Some(found) if !is_near_band(point, band) => {
                    Err(PositionFault::OtherBand { stated: band, found })
                }
                _ => Ok(point),
            }
        }
        _ => Err(PositionFault::Band(letter.to_owned())),
    }
}

/// Whether a place lies in a band, or so near to it that rounding to meters takes it across.
fn is_near_band(point: ZonePoint, band: char) -> bool {
    let beside = [-1.0, 0.0, 1.0].map(|north| ZonePoint { at: point.at + DVec2::new(0.0, north), ..point });
    beside.iter().any(|point| point.band() == Some(band))
}

fn ambiguous(number: u8, in_band: ZonePoint, on_south: ZonePoint) -> PositionFault {
    let place = |point: ZonePoint| {
        let place = point.lonlat().unwrap_or_default();
        let letter = |is_positive: bool, letters: [char; 2]| letters[usize::from(!is_positive)];
        let (north, east) = (letter(place.y >= 0.0, ['N', 'S']), letter(place.x >= 0.0, ['E', 'W']));
        format!("{:.2}{north} {:.2}{east}", place.y.abs(), place.x.abs())
    };
    let DVec2 { x, y } = in_band.at;
    PositionFault::Ambiguous {
        first: format!("zone {number}, band S ({})", place(in_band)),
        second: format!("zone {number} on the southern hemisphere ({})", place(on_south)),
        remedy: format!("write {number} north {x} {y} or {number} south {x} {y}"),
    }
}

/// A point of UPS; `None` where the word is no letter of a cap.
fn ups(letter: &str, at: DVec2, is_named: bool) -> Option<Result<ZonePoint, PositionFault>> {
    let (is_north, half) = match letter {
        "A" => (false, Some(false)),
        "B" => (false, Some(true)),
        "Y" => (true, Some(false)),
        "Z" => (true, Some(true)),
        "N" | "NORTH" if is_named => (true, None),
        "S" | "SOUTH" if is_named => (false, None),
        _ => return None,
    };
    let range = if is_north { UPS_NORTH } else { UPS_SOUTH };
    let is_in_half = half.is_none_or(|is_east| (at.x >= 2e6) == is_east);
    Some(if !range.contains(&at.x) || !is_in_half {
        Err(PositionFault::Easting(at.x))
    } else if !range.contains(&at.y) {
        Err(PositionFault::Northing(at.y))
    } else {
        Ok(ZonePoint { zone: GridZone::ups(is_north), at })
    })
}

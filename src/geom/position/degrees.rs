//! Latitude and longitude as text: decimal degrees, degrees and minutes, degrees, minutes and seconds.
//!
//! ```text
//! 36.277N 84.215W      36°16'37"N, 84°12'54"W      W 84 12 54 N 36 16 37      3616N08412W      lat 36.277 lon -84.215
//! ```
//!
//! A text is cut into two angles, each with the letter, or the word, of its axis before or behind it.

use std::fmt;

use glam::DVec2;

use super::fault::PositionFault;
use super::token::{DigitCommas, NumberToken, Token, plain, tokens};

/// Latitude or longitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DegreeAxis {
    /// Degrees north of the equator.
    Latitude,
    /// Degrees east of Greenwich.
    Longitude,
}

impl DegreeAxis {
    /// The most degrees.
    pub fn limit_deg(self) -> f64 {
        match self {
            Self::Latitude => 90.0,
            Self::Longitude => 180.0,
        }
    }
}

impl fmt::Display for DegreeAxis {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Latitude => "latitude",
            Self::Longitude => "longitude",
        })
    }
}

/// What a word says of an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum AxisWord {
    /// A direction, such as W: the axis, and 1 or -1.
    Direction(DegreeAxis, f64),
    /// The name of an axis, such as lat.
    Name(DegreeAxis),
}

/// The longitude and latitude of a text.
pub(super) fn place(text: &str) -> Result<DVec2, PositionFault> {
    let text = plain(text);
    let separate = tokens(&text, DigitCommas::Separate).ok_or(PositionFault::Form);
    let separate = separate.and_then(|tokens| place_of(&tokens));
    if !text.contains(',') || text.contains('.') {
        return separate;
    }
    let decimal = tokens(&text, DigitCommas::Decimal).ok_or(PositionFault::Form);
    let decimal = decimal.and_then(|tokens| place_of(&tokens));
    match (separate, decimal) {
        (Ok(separate), Ok(decimal)) if separate != decimal => Err(PositionFault::Ambiguous {
            first: format!("{} with a comma between the two", written(separate)),
            second: format!("{} with decimal commas", written(decimal)),
            remedy: "write decimal points".to_owned(),
        }),
        (Ok(place), _) | (Err(_), Ok(place)) => Ok(place),
        (Err(fault), Err(PositionFault::Form)) | (Err(PositionFault::Form), Err(fault)) => Err(fault),
        (Err(_), Err(fault)) => Err(fault),
    }
}

/// The angle of a text about one axis.
pub(super) fn angle(text: &str, axis: DegreeAxis) -> Result<f64, PositionFault> {
    let text = plain(text);
    let commas = if text.contains('.') { DigitCommas::Separate } else { DigitCommas::Decimal };
    let tokens = tokens(&text, commas).ok_or(PositionFault::Form)?;
    let angle = Angle::read(&tokens)?;
    match angle.axis {
        Some(stated) if stated != axis => Err(PositionFault::OtherAxis(axis)),
        _ => angle.degrees(axis),
    }
}

fn place_of(tokens: &[Token]) -> Result<DVec2, PositionFault> {
    if let Some(letter) = tokens.iter().position(|token| *token == Token::Word("O".to_owned())) {
        return Err(east_or_west(tokens, letter));
    }
    let (first, second) = halves(tokens)?;
    let (first, second) = (Angle::read(first)?, Angle::read(second)?);
    match (first.axis, second.axis) {
        (Some(one), Some(other)) if one == other => Err(PositionFault::SameAxis(one)),
        (Some(DegreeAxis::Latitude), Some(_)) => in_order(&second, &first),
        (Some(DegreeAxis::Longitude), Some(_)) => in_order(&first, &second),
        (None, None) if first.has_degree_mark && second.has_degree_mark => {
            match (in_order(&second, &first), in_order(&first, &second)) {
                (Ok(lat_first), Ok(lon_first)) if lat_first != lon_first => Err(PositionFault::Ambiguous {
                    first: written(lat_first),
                    second: written(lon_first),
                    remedy: "add the letters N or S and E or W".to_owned(),
                }),
                (Ok(place), _) | (Err(_), Ok(place)) => Ok(place),
                (Err(fault), Err(_)) => Err(fault),
            }
        }
        (None, None) => Err(PositionFault::Form),
        _ => Err(PositionFault::NoLetter),
    }
}

fn in_order(longitude: &Angle<'_>, latitude: &Angle<'_>) -> Result<DVec2, PositionFault> {
    Ok(DVec2::new(longitude.degrees(DegreeAxis::Longitude)?, latitude.degrees(DegreeAxis::Latitude)?))
}

/// O is east in German and west in French, Spanish and Italian.
fn east_or_west(tokens: &[Token], letter: usize) -> PositionFault {
    let with = |word: &str| {
        let mut tokens = tokens.to_vec();
        tokens[letter] = Token::Word(word.to_owned());
        place_of(&tokens)
    };
    match (with("E"), with("W")) {
        (Ok(east), Ok(west)) => PositionFault::Ambiguous {
            first: written(east),
            second: written(west),
            remedy: "write E or W for O".to_owned(),
        },
        (Err(fault), _) | (_, Err(fault)) => fault,
    }
}

fn written(place: DVec2) -> String {
    let north = if place.y < 0.0 { 'S' } else { 'N' };
    let east = if place.x < 0.0 { 'W' } else { 'E' };
    format!("{}{north} {}{east}", rounded(place.y.abs()), rounded(place.x.abs()))
}

/// Degrees to a meter or so, without trailing zeros.
fn rounded(degrees: f64) -> f64 {
    (degrees * 1e5).round() / 1e5
}

/// The tokens of the two angles: what a separator parts, or else their letters, or their marks.
fn halves(tokens: &[Token]) -> Result<(&[Token], &[Token]), PositionFault> {
    let is_separator = |token: &Token| *token == Token::Separator;
    if let Some(at) = tokens.iter().position(is_separator) {
        let (first, second) = (&tokens[..at], &tokens[at + 1..]);
        return if second.iter().any(is_separator) { Err(PositionFault::Form) } else { Ok((first, second)) };
    }
    let words: Vec<usize> = (0..tokens.len()).filter(|&at| matches!(tokens[at], Token::Word(_))).collect();
    let names: Vec<usize> = words.iter().copied().filter(|&at| is_name(&tokens[at])).collect();
    if let [0, second] = names[..] {
        return Ok(tokens.split_at(second));
    }
    let is_number = |at: usize| matches!(tokens.get(at), Some(Token::Number(_)));
    let degree_marked =
        (1..tokens.len()).rfind(|&at| is_number(at) && tokens.get(at + 1) == Some(&Token::Mark(0)));
    let numbers: Vec<usize> = (0..tokens.len()).filter(|&at| is_number(at)).collect();
    let second = match (&words[..], &numbers[..]) {
        // Letters before the angles.
        (&[0, second], _) if second + 1 < tokens.len() => Some(second),
        // Letters behind them, or two side by side.
        (&[first, _], _) if first > 0 => Some(first + 1),
        // One before and one behind, or none: by the second number, where it alone can begin an angle.
        (_, &[_, second]) => Some(second),
        _ => degree_marked,
    };
    match (second, words.len(), numbers.len()) {
        (Some(second), ..) => Ok(tokens.split_at(second)),
        (None, 1, 2..) if matches!(&tokens[words[0]], Token::Word(word) if axis_word(word).is_some()) => {
            Err(PositionFault::NoLetter)
        }
        _ => Err(PositionFault::Form),
    }
}

fn is_name(token: &Token) -> bool {
    matches!(token, Token::Word(word) if matches!(axis_word(word), Some(AxisWord::Name(_))))
}

fn axis_word(word: &str) -> Option<AxisWord> {
    use DegreeAxis::{Latitude, Longitude};
    Some(match word {
        "N" | "NORTH" => AxisWord::Direction(Latitude, 1.0),
        "S" | "SOUTH" => AxisWord::Direction(Latitude, -1.0),
        "E" | "EAST" => AxisWord::Direction(Longitude, 1.0),
        "W" | "WEST" => AxisWord::Direction(Longitude, -1.0),
        "LAT" | "LATITUDE" => AxisWord::Name(Latitude),
        "LON" | "LONG" | "LNG" | "LONGITUDE" => AxisWord::Name(Longitude),
        _ => return None,
    })
}

/// One angle.
#[derive(Clone, Debug)]
struct Angle<'t> {
    axis: Option<DegreeAxis>,
    /// The sign of its letter.
    direction: Option<f64>,
    /// Its numbers and their units: 0 degrees, 1 minutes, 2 seconds.
    parts: Vec<(&'t NumberToken, u8)>,
    has_degree_mark: bool,
}

impl<'t> Angle<'t> {
    fn read(tokens: &'t [Token]) -> Result<Self, PositionFault> {
        let mut angle = Self { axis: None, direction: None, parts: Vec::new(), has_degree_mark: false };
        for (at, token) in tokens.iter().enumerate() {
            match token {
                Token::Word(word) => {
                    let is_outside = at == 0 || at + 1 == tokens.len() || is_name(&tokens[at - 1]);
                    angle.add_word(axis_word(word).filter(|_| is_outside).ok_or(PositionFault::Form)?)?;
                }
                Token::Number(number) => {
                    let marked = match tokens.get(at + 1) {
                        Some(&Token::Mark(unit)) => Some(unit),
                        _ => None,
                    };
                    angle.add_number(number, marked)?;
                }
                // A mark follows its number.
                Token::Mark(_)
                    if matches!(at.checked_sub(1).map(|before| &tokens[before]), Some(Token::Number(_))) => {}
                Token::Mark(_) | Token::Separator => return Err(PositionFault::Form),
            }
        }
        match angle.parts.first() {
            Some((_, 0)) => Ok(angle),
            _ => Err(PositionFault::Form),
        }
    }

    fn add_word(&mut self, word: AxisWord) -> Result<(), PositionFault> {
        let (axis, direction) = match word {
            AxisWord::Direction(axis, direction) => (axis, Some(direction)),
            AxisWord::Name(axis) => (axis, None),
        };
        if self.axis.is_some_and(|stated| stated != axis) || (self.direction.is_some() && direction.is_some())
        {
            return Err(PositionFault::Form);
        }
        self.axis = Some(axis);
        self.direction = self.direction.or(direction);
        Ok(())
    }

    fn add_number(&mut self, number: &'t NumberToken, marked: Option<u8>) -> Result<(), PositionFault> {
        let next = self.parts.last().map_or(0, |(_, unit)| unit + 1);
        let unit = marked.unwrap_or(next);
        if unit < next || unit > 2 || (unit > 0 && number.is_signed) {
            return Err(PositionFault::Form);
        }
        self.has_degree_mark |= marked == Some(0);
        self.parts.push((number, unit));
        Ok(())
    }

    /// Its degrees on an axis.
    fn degrees(&self, axis: DegreeAxis) -> Result<f64, PositionFault> {
        let (first, _) = self.parts[0];
        let sign = match (self.direction, first.is_signed) {
            (None, _) => {
                if first.is_negative {
                    -1.0
                } else {
                    1.0
                }
            }
            (Some(direction), false) => direction,
            (Some(direction), true) if !first.is_negative => direction,
            (Some(direction), true) => return Err(self.two_signs(axis, direction)),
        };
        let size = match &self.parts[..] {
            [(number, _)] if !self.has_degree_mark => single(number, axis)?,
            parts => sexagesimal(parts)?,
        };
        if size > axis.limit_deg() {
            return Err(PositionFault::Range { axis, found: size });
        }
        Ok(sign * size)
    }

    fn two_signs(&self, axis: DegreeAxis, direction: f64) -> PositionFault {
        let size = self.parts[0].0.value;
        let letter = |sign: f64| match (axis, sign > 0.0) {
            (DegreeAxis::Latitude, true) => 'N',
            (DegreeAxis::Latitude, false) => 'S',
            (DegreeAxis::Longitude, true) => 'E',
            (DegreeAxis::Longitude, false) => 'W',
        };
        PositionFault::Ambiguous {
            first: format!("{size}{}", letter(direction)),
            second: format!("{size}{}", letter(-direction)),
            remedy: "write a letter or a sign".to_owned(),
        }
    }
}

/// The degrees of a number by itself: decimal degrees, or digits that run on, as in 3616N and 0841254W.
fn single(number: &NumberToken, axis: DegreeAxis) -> Result<f64, PositionFault> {
    let degree_digits = if axis == DegreeAxis::Latitude { 2 } else { 3 };
    let whole = number.value.trunc();
    let minutes_of = |minutes: f64| (minutes < 60.0).then_some(minutes / 60.0);
    let run_on = match number.whole_digits.checked_sub(degree_digits) {
        Some(2) => minutes_of(number.value % 100.0).map(|part| (whole / 100.0).trunc() + part),
        Some(4) => {
            let minutes = minutes_of(((whole / 100.0).trunc()) % 100.0);
            let seconds = minutes_of(number.value % 100.0);
            minutes.zip(seconds).map(|(minutes, seconds)| (whole / 1e4).trunc() + minutes + seconds / 60.0)
        }
        _ => None,
    };
    let run_on = run_on.filter(|degrees| *degrees <= axis.limit_deg());
    match run_on {
        Some(run_on) if number.value <= axis.limit_deg() && run_on != number.value => {
            Err(PositionFault::Ambiguous {
                first: format!("{} degrees of {axis}", number.value),
                second: format!("{} degrees of {axis} in digits that run on", rounded(run_on)),
                remedy: "write degrees and minutes with a space between, or degrees without leading zeros"
                    .to_owned(),
            })
        }
        Some(run_on) => Ok(run_on),
        None => Ok(number.value),
    }
}

fn sexagesimal(parts: &[(&NumberToken, u8)]) -> Result<f64, PositionFault> {
    let mut degrees = 0.0;
    for (index, (number, unit)) in parts.iter().enumerate() {
        if number.has_decimals && index + 1 < parts.len() {
            return Err(PositionFault::Decimals);
        }
        if *unit > 0 && number.value >= 60.0 {
            return Err(PositionFault::Sixty(number.value));
        }
        degrees += number.value / [1.0, 60.0, 3600.0][usize::from(*unit)];
    }
    Ok(degrees)
}

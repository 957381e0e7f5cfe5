//! Parsers of argument values.

use std::ops::RangeBounds;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use glam::DVec2;

use sandtable_base::message::choice::Choice;
use sandtable_sheet::picture::PictureSize;

/// Parses one of the words of a [`Choice`].
pub fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let values = T::CHOICES.iter().map(|choice| PossibleValue::new(choice.word).help(choice.meaning));
    PossibleValuesParser::new(values).map(|word| T::from_word(&word).expect("only listed words are accepted"))
}

/// Parses a finite number in `range`; `advice` is the message for anything else.
pub fn number<T: FromStr + Into<f64> + Copy>(
    range: impl RangeBounds<f64> + Clone,
    advice: &'static str,
) -> impl Fn(&str) -> Result<T, &'static str> + Clone {
    move |text| {
        let number = text.parse::<T>().ok();
        let is_valid = |number: f64| number.is_finite() && range.contains(&number);
        number.filter(|&number| is_valid(number.into())).ok_or(advice)
    }
}

/// Parses finite numbers with commas between.
pub fn numbers(text: &str) -> Option<Vec<f64>> {
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    text.split(',').map(number).collect()
}

/// Parses the size of a picture, such as `1920x1080`.
pub fn picture_size(text: &str) -> Result<PictureSize, &'static str> {
    let sides = text.split_once(['x', 'X', '×']);
    let sides = sides.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    match sides.ok_or("write width and height as in 1920x1080")? {
        [width @ 16..=16384, height @ 16..=16384] => Ok(PictureSize { width, height }),
        _ => Err("each side must lie between 16 and 16384 pixels"),
    }
}

/// Parses a pixel's column and row, such as `960,540`.
pub fn pixel(text: &str) -> Result<[u32; 2], &'static str> {
    let pair = text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    pair.ok_or("write column and row as in 960,540")
}

/// Parses two finite numbers.
pub fn number_pair(text: &str) -> Result<[f64; 2], &'static str> {
    let pair = numbers(text).and_then(|numbers| numbers.try_into().ok());
    pair.ok_or("write two numbers with a comma between")
}

/// One or more positions.
pub type PositionList = Vec<DVec2>;

/// Parses one or more positions with spaces between.
pub fn positions(text: &str) -> Result<PositionList, &'static str> {
    let positions: Option<PositionList> =
        text.split_whitespace().map(|position| number_pair(position).ok().map(DVec2::from)).collect();
    let positions = positions.filter(|positions| !positions.is_empty());
    positions.ok_or("write positions as X,Y, for example 731500,4017200")
}

/// A position, and meters above the ground there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaisedPosition {
    pub at: DVec2,
    /// Meters above the ground, where they are stated.
    pub above_m: Option<f64>,
}

/// Parses a position with or without meters above the ground.
pub fn raised_position(text: &str) -> Result<RaisedPosition, &'static str> {
    match numbers(text).as_deref() {
        Some(&[x, y]) => Ok(RaisedPosition { at: DVec2::new(x, y), above_m: None }),
        Some(&[x, y, above_m]) => Ok(RaisedPosition { at: DVec2::new(x, y), above_m: Some(above_m) }),
        _ => Err("write a position as X,Y or, with meters above the ground, X,Y,H"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_two_finite_numbers_and_ends_may_have_a_height() {
        assert_eq!(positions("1.5,-2e3"), Ok(vec![DVec2::new(1.5, -2e3)]));
        let two = vec![DVec2::new(-84.1, 36.2), DVec2::new(-84.0, 36.0)];
        assert_eq!(positions("-84.1,36.2 -84,36"), Ok(two));
        assert_eq!(
            raised_position("1,2,30"),
            Ok(RaisedPosition { at: DVec2::new(1.0, 2.0), above_m: Some(30.0) })
        );
        assert_eq!(raised_position("1,2"), Ok(RaisedPosition { at: DVec2::new(1.0, 2.0), above_m: None }));
        for wrong in ["", "1", "1,2,3,4", "a,b", "NaN,1", "1,inf", "1;2"] {
            assert!(positions(wrong).is_err(), "{wrong}");
            assert!(raised_position(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_two_numbers_within_range() {
        assert_eq!(picture_size("640x480"), Ok(PictureSize { width: 640, height: 480 }));
        for wrong in ["640", "640x", "0x0", "99999x10", "-4x20", "axb"] {
            assert!(picture_size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_number_is_finite_and_in_range() {
        let parse = number::<f64>(0.0.., "no");
        assert_eq!(parse("2.5"), Ok(2.5));
        for wrong in ["-1", "NaN", "inf", "1e999", "five", ""] {
            assert_eq!(parse(wrong), Err("no"), "{wrong}");
        }
    }
}

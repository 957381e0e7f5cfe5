//! Parsers of argument values.

use std::ops::RangeBounds;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use sandtable_base::message::choice::Choice;
use sandtable_geom::length_unit::length_of_name;
use sandtable_query::positions::{PositionArgument, position_list};
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

/// Parses a unit of length, such as `ft`; returns its meters.
pub fn length_unit(text: &str) -> Result<f64, &'static str> {
    let known = length_of_name(text).filter(|_| !text.is_empty());
    known.ok_or("write m, ft or us-ft")
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
pub type PositionList = Vec<PositionArgument>;

/// Parses a position in any form.
pub fn position(text: &str) -> Result<PositionArgument, String> {
    PositionArgument::parse(text).map_err(|error| error.with_forms())
}

/// Parses one position, or several with semicolons or spaces between.
pub fn positions(text: &str) -> Result<PositionList, String> {
    position_list(text)
}

/// A position, and meters above the ground there.
#[derive(Clone, Debug, PartialEq)]
pub struct RaisedPosition {
    pub at: PositionArgument,
    /// Meters above the ground, where they are stated.
    pub above_m: Option<f64>,
}

/// Parses a position with or without meters above the ground.
pub fn raised_position(text: &str) -> Result<RaisedPosition, String> {
    let raised = text.rsplit_once(',').and_then(|(at, above)| {
        let above_m = above.trim().parse::<f64>().ok().filter(|above_m| above_m.is_finite())?;
        Some(PositionArgument::parse(at).map(|at| RaisedPosition { at, above_m: Some(above_m) }))
    });
    let forms = "; meters above the ground may follow, after a comma";
    match (PositionArgument::parse(text), raised) {
        (Ok(_), Some(Ok(RaisedPosition { at, above_m }))) => Err(format!(
            "'{text}' can be read as one position with decimal commas, or as {at} and {} m above the ground there; write \
             decimal points",
            above_m.unwrap_or_default()
        )),
        (Ok(at), _) => Ok(RaisedPosition { at, above_m: None }),
        (Err(_), Some(Ok(raised))) => Ok(raised),
        (Err(whole), Some(Err(error))) if whole.is_unlike_any() || error.help().is_none() => {
            Err(error.with_forms() + forms)
        }
        (Err(whole), _) => Err(whole.with_forms() + forms),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_may_be_several_and_ends_may_have_a_height() {
        let all =
            |texts: &[&str]| texts.iter().map(|text| position(text).expect("sound")).collect::<Vec<_>>();
        for (text, expected) in [
            ("1.5,-2e3", &["1.5,-2e3"][..]),
            ("-84.1,36.2 -84,36", &["-84.1,36.2", "-84,36"]),
            ("16S GF 500 180", &["16S GF 500 180"]),
            ("16SGF500180 16SGF510180", &["16SGF500180", "16SGF510180"]),
            ("16S GF 500 180; 16N 751000 4018000;", &["16S GF 500 180", "16N 751000 4018000"]),
            ("36.2N,84.1W 36N,84W", &["36.2N,84.1W", "36N,84W"]),
            ("36.2N 84.1W; 36N 84W", &["36.2N 84.1W", "36N 84W"]),
        ] {
            assert_eq!(positions(text), Ok(all(expected)), "{text}");
        }
        for (text, at, above_m) in [
            ("1,2,30", "1,2", Some(30.0)),
            ("1,2", "1,2", None),
            ("16S GF 500 180, 2.5", "16S GF 500 180", Some(2.5)),
            ("16SGF55,30", "16SGF55", Some(30.0)),
            ("16N 750000,4018000", "16N 750000,4018000", None),
            ("16N 750000,4018000,30", "16N 750000,4018000", Some(30.0)),
            ("36.2N,84.1W,30", "36.2N,84.1W", Some(30.0)),
            ("36.2N,84.1W", "36.2N,84.1W", None),
        ] {
            let raised = raised_position(text).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(raised, RaisedPosition { at: position(at).expect("sound"), above_m }, "{text}");
        }
        let ambiguous = raised_position("N48,2 E16,3").expect_err("in two ways");
        assert!(ambiguous.contains("decimal commas, or as N48,2 E16 and 3 m"), "{ambiguous}");
        for wrong in ["", "1", "1,2,3,4", "a,b", "NaN,1", "1,inf", "1;2", "16S 755447 4024162,30"] {
            assert!(positions(wrong).is_err(), "{wrong}");
            assert!(raised_position(wrong).is_err(), "{wrong}");
        }
        let both = raised_position("16S 755447 4024162,30").expect_err("in two ways");
        assert!(both.contains("band S") && both.contains("southern hemisphere"), "{both}");
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

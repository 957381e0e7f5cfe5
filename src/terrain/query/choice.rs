//! The words of choices that the command line and HTTP requests share.

use std::str::FromStr;

use crate::query::{Interpolation, Surface};
use sandtable_base::message::choice::{Choice, ChoiceWord, word};
use sandtable_base::message::suggest::{quoted, remedy};

impl Choice for Interpolation {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::Planar, "planar", "On the finest triangles"),
        word(Self::Bilinear, "bilinear", "Between four posts, as GDAL does"),
        word(Self::Nearest, "nearest", "The height of the nearest post"),
        word(Self::Cubic, "cubic", "Smooth through sixteen posts (Keys 1981, a = -0.5); may overshoot"),
        word(Self::DistanceWeighted4, "distance-weighted", "The four posts around, weighted by nearness"),
    ];
}

impl Choice for Surface {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::Source, "source", "The raster as read, in its own grid"),
        word(Self::Ground, "ground", "The ground in meters, after a scene's earthworks"),
        word(Self::Scene, "scene", "The higher of the ground and the decks over it"),
    ];
}

/// A word that names no value of a choice.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {noun} '{word}'; {remedy}")]
pub struct WordError {
    noun: &'static str,
    word: String,
    remedy: String,
}

impl FromStr for Interpolation {
    type Err = WordError;

    fn from_str(word: &str) -> Result<Self, WordError> {
        from_word("interpolation", word)
    }
}

impl FromStr for Surface {
    type Err = WordError;

    fn from_str(word: &str) -> Result<Self, WordError> {
        from_word("surface", word)
    }
}

fn from_word<T: Choice>(noun: &'static str, word: &str) -> Result<T, WordError> {
    T::from_word(word).ok_or_else(|| {
        let words: Vec<&str> = T::CHOICES.iter().map(|choice| choice.word).collect();
        WordError { noun, word: quoted(word), remedy: remedy(word, &words, "it is") }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_its_value_and_another_is_answered_with_the_nearest() {
        assert_eq!("distance-weighted".parse(), Ok(Interpolation::DistanceWeighted4));
        assert_eq!("ground".parse(), Ok(Surface::Ground));
        let wrong = "bilinaer".parse::<Interpolation>().map_err(|error| error.to_string());
        assert_eq!(wrong, Err("there is no interpolation 'bilinaer'; did you mean `bilinear`?".to_owned()));
    }
}

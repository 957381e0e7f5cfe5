//! Choices that users write as words, on the command line and in HTTP requests alike.

use crate::dem::gridding::BeyondHull;
use crate::terrain::query::{Interpolation, Surface};

/// A type whose values are written as words.
pub trait Choice: Copy + PartialEq + 'static {
    /// Every value that may be written, in the order in which they are listed.
    const CHOICES: &'static [ChoiceWord<Self>];

    /// The word for this value; empty where there is none.
    fn word(self) -> &'static str {
        Self::CHOICES.iter().find(|choice| choice.value == self).map_or("", |choice| choice.word)
    }

    /// The value that a word names.
    fn from_word(word: &str) -> Option<Self> {
        Self::CHOICES.iter().find(|choice| choice.word == word).map(|choice| choice.value)
    }
}

/// A value, its word and its meaning.
pub struct ChoiceWord<T> {
    /// The value.
    pub value: T,
    /// The word.
    pub word: &'static str,
    /// A phrase for a list of choices.
    pub meaning: &'static str,
}

/// A value with its word and meaning.
pub const fn word<T: Copy>(value: T, word: &'static str, meaning: &'static str) -> ChoiceWord<T> {
    ChoiceWord { value, word, meaning }
}

impl Choice for Interpolation {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::Planar, "planar", "On the finest triangles"),
        word(Self::Bilinear, "bilinear", "Between four posts, as GDAL does"),
        word(Self::Nearest, "nearest", "The height of the nearest post"),
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

impl Choice for BeyondHull {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::NoData, "nodata", "No data"),
        word(Self::Nearest, "nearest", "The height of the nearest point"),
    ];
}

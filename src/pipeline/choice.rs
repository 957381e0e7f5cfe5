//! Choices that users write as words, on the command line and in HTTP requests alike.

use crate::dem::gridding::BeyondHull;
use crate::terrain::query::{Interpolation, Surface};

/// A type whose values are written as words.
pub trait Choice: Copy + PartialEq + 'static {
    /// Every value that may be written, in the order in which they are listed.
    const CHOICES: &'static [Word<Self>];

    /// The word for this value; empty where there is none.
    fn word(self) -> &'static str {
        Self::CHOICES.iter().find(|choice| choice.value == self).map_or("", |choice| choice.word)
    }

    /// The value that a word names.
    fn from_word(word: &str) -> Option<Self> {
        Self::CHOICES.iter().find(|choice| choice.word == word).map(|choice| choice.value)
    }
}

/// A value, its word and what it means.
pub struct Word<T> {
    /// The value.
    pub value: T,
    /// The word.
    pub word: &'static str,
    /// A phrase for a list of choices.
    pub meaning: &'static str,
}

impl Choice for Interpolation {
    const CHOICES: &'static [Word<Self>] = &[
        Word { value: Self::Planar, word: "planar", meaning: "On the finest triangles" },
        Word { value: Self::Bilinear, word: "bilinear", meaning: "Between four posts, as GDAL does" },
        Word { value: Self::Nearest, word: "nearest", meaning: "The height of the nearest post" },
        Word {
            value: Self::DistanceWeighted4,
            word: "distance-weighted",
            meaning: "The four posts around, weighted by nearness",
        },
    ];
}

impl Choice for Surface {
    const CHOICES: &'static [Word<Self>] = &[
        Word { value: Self::Source, word: "source", meaning: "The raster as read, in its own grid" },
        Word {
            value: Self::Ground,
            word: "ground",
            meaning: "The ground in meters, after a scene's earthworks",
        },
        Word { value: Self::Scene, word: "scene", meaning: "The higher of the ground and the decks over it" },
    ];
}

impl Choice for BeyondHull {
    const CHOICES: &'static [Word<Self>] = &[
        Word { value: Self::NoData, word: "nodata", meaning: "No data" },
        Word { value: Self::Nearest, word: "nearest", meaning: "The height of the nearest point" },
    ];
}

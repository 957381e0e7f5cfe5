//! The words of choices that the command line and HTTP requests share.

use crate::dem::gridding::BeyondHull;
use crate::message::choice::{Choice, ChoiceWord, word};
use crate::terrain::query::{Interpolation, Surface};

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

impl Choice for BeyondHull {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::NoData, "nodata", "No data"),
        word(Self::Nearest, "nearest", "The height of the nearest point"),
    ];
}

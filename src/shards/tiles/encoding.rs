//! The encodings of heights in tiles.

use sandtable_base::message::choice::{Choice, ChoiceWord, word};
use sandtable_dem::formats::height_encoding::HeightEncoding;

/// The encoding of heights in tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileEncoding {
    /// As the vertices of meshes.
    QuantizedMesh,
    /// As the colors of pictures.
    Colors(HeightEncoding),
}

impl Choice for TileEncoding {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::QuantizedMesh, "quantized-mesh", "meshes on the ellipsoid, for globes"),
        word(
            Self::Colors(HeightEncoding::TerrainRgb),
            HeightEncoding::NAMES[0],
            "PNG in Web Mercator, for maps: Mapbox's colors",
        ),
        word(
            Self::Colors(HeightEncoding::Terrarium),
            HeightEncoding::NAMES[1],
            "PNG in Web Mercator, for maps: Mapzen's colors",
        ),
    ];
}

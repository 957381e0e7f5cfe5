//! The arguments of a pyramid of tiles.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::ShardError;
use crate::planned_dataset::{PlannedDataset, QueriedDataset};
use crate::tiles::colors::pyramid::ColorPyramid;
use crate::tiles::tiling::MOST_LEVEL;
use sandtable_dem::formats::height_encoding::HeightEncoding;
use sandtable_raster::answer::Answer;
use sandtable_terrain::query::Interpolation;

/// The arguments of tiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TilesArguments {
    /// The elevation or scene to read.
    pub dataset: PlannedDataset,
    /// The finest level, 0 to 22.
    pub max_zoom: u32,
    /// West, south, east and north of the elevation in degrees; its west is east of its east where it crosses the meridian of
    /// 180 degrees.
    pub bounds: [f64; 4],
    /// What the encoding needs besides.
    #[serde(flatten)]
    pub content: TileContent,
}

/// An encoding and what tiles of it need.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "encoding", rename_all = "kebab-case")]
pub enum TileContent {
    /// Meshes.
    QuantizedMesh(MeshTileArguments),
    /// Pictures in Mapbox's colors.
    TerrainRgb(ColorTileArguments),
    /// Pictures in Mapzen's colors.
    Terrarium(ColorTileArguments),
}

/// The arguments of tiles that are meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshTileArguments {
    /// The least and the greatest height that tiles can state, meters.
    pub height_range: [f32; 2],
    /// Whether heights above the geoid are brought to the ellipsoid.
    pub from_geoid: bool,
}

/// The arguments of tiles that are pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColorTileArguments {
    /// The level at whose pixels the elevation is queried, `max_zoom` or finer: as fine as its samples.
    pub sampled_zoom: u32,
}

/// The tiles of an encoding.
pub enum TilePyramid<'a> {
    /// Meshes.
    Meshes(&'a MeshTileArguments),
    /// Pictures.
    Colors(ColorPyramid),
}

impl TilesArguments {
    /// The tiles of the encoding.
    pub fn pyramid(&self) -> TilePyramid<'_> {
        let (encoding, ColorTileArguments { sampled_zoom }) = match &self.content {
            TileContent::QuantizedMesh(meshes) => return TilePyramid::Meshes(meshes),
            TileContent::TerrainRgb(colors) => (HeightEncoding::TerrainRgb, colors),
            TileContent::Terrarium(colors) => (HeightEncoding::Terrarium, colors),
        };
        let Self { max_zoom, bounds, .. } = *self;
        TilePyramid::Colors(ColorPyramid { encoding, max_zoom, sampled_zoom: *sampled_zoom, bounds })
    }

    /// The name of an argument that is out of its range, and that range.
    pub fn fault(&self) -> Option<&'static str> {
        let [west, south, east, north] = self.bounds;
        match self.max_zoom {
            _ if self.max_zoom > MOST_LEVEL => Some("`max_zoom` is not 0 to 22"),
            _ if ![west, east].iter().all(|side| (-180.0..=180.0).contains(side)) => {
                Some("`bounds` are none")
            }
            _ if west == east => Some("`bounds` are none"),
            _ if !(-90.0 <= south && south < north && north <= 90.0) => Some("`bounds` are none"),
            max_zoom => match &self.content {
                TileContent::QuantizedMesh(MeshTileArguments { height_range: [low, high], .. }) => {
                    let is_range = low.is_finite() && high.is_finite() && low < high;
                    (!is_range).then_some("`height_range` is none")
                }
                TileContent::TerrainRgb(colors) | TileContent::Terrarium(colors) => {
                    let is_within = (max_zoom..=MOST_LEVEL).contains(&colors.sampled_zoom);
                    (!is_within).then_some("`sampled_zoom` is not `max_zoom` to 22")
                }
            },
        }
    }

    /// The heights at longitudes and latitudes above what the elevation counts from.
    ///
    /// # Errors
    /// The elevation cannot be read.
    pub fn answers(&self, queried: &QueriedDataset, at: &[DVec2]) -> Result<Vec<Answer>, ShardError> {
        let QueriedDataset { dataset, crs, .. } = queried;
        Ok(dataset.heights(dataset.default_surface(), Interpolation::Bilinear, crs, at)?)
    }
}

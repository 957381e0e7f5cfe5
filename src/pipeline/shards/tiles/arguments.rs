//! The arguments of a pyramid of tiles.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::dem::answer::Answer;
use crate::dem::height_datum::HeightDatum;
use crate::geom::geoid::Geoid;
use crate::pipeline::error::FileError;
use crate::pipeline::heights_above::bring_heights;
use crate::pipeline::shards::error::ShardError;
use crate::pipeline::shards::planned_dataset::{PlannedDataset, QueriedDataset};
use crate::pipeline::shards::tiles::tiling::{MOST_LEVEL, POSTS};
use crate::terrain::query::Interpolation;

/// What tiles are made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TilesArguments {
    /// Of which elevation or scene.
    pub dataset: PlannedDataset,
    /// The finest level, 0 to 22.
    pub max_zoom: u32,
    /// West, south, east and north of the elevation in degrees.
    pub bounds: [f64; 4],
    /// The least and the greatest height that tiles can state, meters.
    pub height_range: [f32; 2],
    /// Whether heights above the geoid are brought to the ellipsoid.
    pub from_geoid: bool,
}

impl TilesArguments {
    /// The name of an argument that is out of its range, and that range.
    pub fn fault(&self) -> Option<&'static str> {
        let [west, south, east, north] = self.bounds;
        let [low, high] = self.height_range;
        match self {
            _ if self.max_zoom > MOST_LEVEL => Some("`max_zoom` is not 0 to 22"),
            _ if !(-180.0 <= west && west < east && east <= 180.0) => Some("`bounds` are none"),
            _ if !(-90.0 <= south && south < north && north <= 90.0) => Some("`bounds` are none"),
            _ if !(low.is_finite() && high.is_finite() && low < high) => Some("`height_range` is none"),
            _ => None,
        }
    }

    /// The heights at longitudes and latitudes above the ellipsoid, or above what the elevation counts from where that is not
    /// known. There are as many as rows of posts have, so that the geoid is asked about a row at a time.
    ///
    /// # Errors
    /// The elevation cannot be read.
    pub fn answers(&self, queried: &QueriedDataset, at: &[DVec2]) -> Result<Vec<Answer>, ShardError> {
        let QueriedDataset { path, dataset, crs } = queried;
        let surface = dataset.default_surface();
        let mut answers = dataset.heights(surface, Interpolation::Bilinear, crs, at)?;
        if self.from_geoid {
            let header = dataset.header();
            let datums = (header.vertical_datum.as_deref(), HeightDatum::Ellipsoid);
            let geoid = Geoid::default();
            for (answers, at) in answers.chunks_mut(POSTS).zip(at.chunks(POSTS)) {
                bring_heights(answers, datums, (crs, at), &geoid).map_err(FileError::at(path))?;
            }
        }
        Ok(answers)
    }
}

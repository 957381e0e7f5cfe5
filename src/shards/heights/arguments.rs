//! The arguments of a plan of heights.

use std::path::PathBuf;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::ShardError;
use crate::planned_dataset::{PlannedDataset, PlannedWord, QueriedDataset};
use sandtable_files::error::FileError;
use sandtable_geom::geoid::Geoid;
use sandtable_query::heights_above::bring_heights;
use sandtable_raster::answer::Answer;
use sandtable_raster::height_datum::HeightDatum;
use sandtable_terrain::query::{Interpolation, Surface};

/// The query for each point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeightsArguments {
    /// The elevation or scene to query.
    pub dataset: PlannedDataset,
    /// The table of points, from the folder of the plan.
    pub points: PathBuf,
    /// The surface.
    pub surface: PlannedWord<Surface>,
    /// The interpolation of heights between posts.
    pub interpolation: PlannedWord<Interpolation>,
    /// What heights are brought to count from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<PlannedWord<HeightDatum>>,
}

impl HeightsArguments {
    /// The heights at positions, as `height` answers.
    ///
    /// # Errors
    /// The dataset cannot be read, or has no such surface or datum.
    pub fn answers(&self, queried: &QueriedDataset, at: &[DVec2]) -> Result<Vec<Answer>, ShardError> {
        let QueriedDataset { path, dataset, crs } = queried;
        let mut answers = dataset.heights(self.surface.0, self.interpolation.0, crs, at)?;
        if let Some(PlannedWord(above)) = self.above {
            let header = dataset.header();
            let datum = header.vertical_datum.as_deref();
            let brought = bring_heights(&mut answers, (datum, above), (crs, at), &Geoid::default());
            brought.map_err(FileError::at(path))?;
        }
        Ok(answers)
    }
}

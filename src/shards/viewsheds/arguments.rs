//! The arguments of a plan of viewsheds.

use std::path::PathBuf;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::ShardError;
use crate::planned_dataset::{PlannedDataset, QueriedDataset};
use sandtable_query::dataset::transform;
use sandtable_query::ground::QueriedGround;
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{Sector, ViewshedOptions};

/// The query for each observer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewshedsArguments {
    /// On which elevation or scene.
    pub dataset: PlannedDataset,
    /// The table of observers, from the folder of the plan.
    pub points: PathBuf,
    /// Meters of the eyes above the ground, 0 to 100000.
    pub observer_height: f64,
    /// Meters of the targets above the ground, 0 to 100000.
    pub target_height: f64,
    /// How far they look, in meters, above 0; without limit where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<f64>,
    /// The refraction coefficient, -1 to below 1; a flat Earth without air where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refraction: Option<f64>,
}

impl ViewshedsArguments {
    /// The name of an argument that is out of its range, and that range.
    pub fn fault(&self) -> Option<&'static str> {
        let is_height = |height: f64| (0.0..=1e5).contains(&height);
        match self {
            _ if !is_height(self.observer_height) => Some("`observer_height` is not 0 to 100000"),
            _ if !is_height(self.target_height) => Some("`target_height` is not 0 to 100000"),
            _ if self.range.is_some_and(|range| range.is_nan() || range <= 0.0) => {
                Some("`range` is not above 0")
            }
            _ if self.refraction.is_some_and(|refraction| !(-1.0..1.0).contains(&refraction)) => {
                Some("`refraction` is not -1 to below 1")
            }
            _ => None,
        }
    }

    /// The range of an observer, meters; may be infinite.
    pub fn range_m(&self) -> f64 {
        self.range.unwrap_or(f64::INFINITY)
    }

    /// The ground within the range of an observer, or all of it.
    ///
    /// # Errors
    /// There is no ground, or it cannot be read.
    pub fn ground(&self, queried: &QueriedDataset, observer: DVec2) -> Result<QueriedGround, ShardError> {
        let reach = GroundReach { crs: &queried.crs, at: &[observer], around_m: self.range_m() };
        Ok(queried.dataset.ground(&reach)?)
    }

    /// The options of the viewshed of an observer on some ground.
    ///
    /// # Errors
    /// The observer has no place in the ground's system.
    pub fn options(
        &self,
        queried: &QueriedDataset,
        ground: &QueriedGround,
        observer: DVec2,
    ) -> Result<ViewshedOptions, ShardError> {
        let at = transform("the observer at", &queried.crs, &ground.crs, observer)?;
        let curved = |refraction| Curvature { refraction, ..Curvature::default() };
        Ok(ViewshedOptions {
            observer: SightEnd { at, above_m: self.observer_height },
            target_above_m: self.target_height,
            range_m: self.range_m(),
            sector: Sector::ALL,
            curvature: self.refraction.map_or(Curvature::FLAT, curved),
        })
    }
}

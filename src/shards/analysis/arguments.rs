//! The arguments of a plan of an analysis.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::{PlanError, PlanFault, ShardError};
use crate::planned_dataset::{PlannedDataset, QueriedDataset};
use sandtable_catalog::kind;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_query::analysis::WrittenArgument;
use sandtable_query::dataset::Dataset;
use sandtable_query::parted_analysis::PartedAnalysis;
use sandtable_scene::land::land_of;
use sandtable_scene::scene_file::{is_scene_file, open_scene_land};

/// An analysis and its arguments as they are written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalysisPlan {
    /// Of which elevation or scene.
    pub dataset: PlannedDataset,
    /// The name of the kind.
    pub kind: String,
    /// Its arguments by their names, positions in the system of the dataset's `crs`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub options: BTreeMap<String, String>,
}

/// The dataset of a plan, opened, and what makes the values of its posts.
pub struct OpenedAnalysis {
    /// The dataset.
    pub queried: QueriedDataset,
    /// What makes the values.
    pub parts: PartedAnalysis,
    /// The kind.
    pub kind: &'static AnalysisKind,
}

impl AnalysisPlan {
    /// The kind of a plan in `folder`.
    ///
    /// # Errors
    /// There is none of its name.
    pub fn kind(&self, folder: &Path) -> Result<&'static AnalysisKind, ShardError> {
        kind(&self.kind).ok_or_else(|| {
            let fault = PlanFault::Value(format!("`kind` is '{}', which is no analysis", self.kind));
            PlanError::new(&folder.join("plan.json"), fault).into()
        })
    }

    /// The arguments as users write them.
    pub fn written(&self) -> Vec<WrittenArgument> {
        let written =
            |(name, text): (&String, &String)| WrittenArgument { name: name.clone(), text: text.clone() };
        self.options.iter().map(written).collect()
    }

    /// Opens the dataset of a plan in `folder`: of a scene what lies on its ground, too, where the kind uses that.
    ///
    /// # Errors
    /// An argument is wrong, or the dataset cannot be opened.
    pub fn open(&self, folder: &Path) -> Result<OpenedAnalysis, ShardError> {
        let kind = self.kind(folder)?;
        let path = self.dataset.path(folder);
        let (queried, land) = match kind.layers.is_empty() || !is_scene_file(&path) {
            true => (self.dataset.open(folder)?, None),
            false => {
                let scene = open_scene_land(&path, &self.dataset.allowed(folder), &|_| ())?;
                let dataset = Dataset::from_scene(&path.display().to_string(), &scene);
                let crs = self.dataset.stated_crs(folder)?.unwrap_or_else(|| dataset.crs());
                (QueriedDataset { path, dataset, crs }, Some(land_of(&scene, kind.layers)))
            }
        };
        let arguments = self.written();
        let parts = PartedAnalysis::new(&queried.dataset, land, (kind, &arguments), &queried.crs)?;
        Ok(OpenedAnalysis { queried, parts, kind })
    }
}

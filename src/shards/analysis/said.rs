//! What a shard of an analysis says besides its values: whole numbers of which the figures of all are made, and notes.

use serde::{Deserialize, Serialize};

use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::ShardPlan;
use crate::record::{ShardFile, result_path};
use sandtable_analysis::tally::FigureTally;
use sandtable_files::disk;

/// The extension of its file.
const EXTENSION: &str = "tally.json";

/// A tally has some numbers for each place that looks; nothing longer is read.
const MOST_BYTES: u64 = 1 << 24;

/// The content of the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartSaid {
    tally: Vec<u64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

impl PartSaid {
    /// What a shard says.
    pub fn new(tally: &FigureTally, notes: &[String]) -> Self {
        Self { tally: tally.counts().to_vec(), notes: notes.to_vec() }
    }

    /// Its file.
    ///
    /// # Errors
    /// It cannot be written as JSON.
    pub fn file(&self, plan: &ShardPlan, id: usize) -> Result<Vec<ShardFile>, ShardError> {
        let place = result_path(plan, id, EXTENSION);
        let text =
            serde_json::to_string(self).map_err(|error| PlanError::new(&place, PlanFault::from(error)))?;
        Ok(ShardFile::only(id, EXTENSION, (text + "\n").into_bytes()))
    }

    /// What all shards of a plan say together: the sum of their tallies, and each note once.
    ///
    /// # Errors
    /// A file is not the one that a shard of the plan wrote.
    pub fn of_all(plan: &ShardPlan) -> Result<(FigureTally, Vec<String>), ShardError> {
        let (mut sum, mut notes): (Option<FigureTally>, Vec<String>) = (None, Vec::new());
        for id in 0..plan.count() {
            let said = Self::read(plan, id)?;
            let wrong = || PlanError::new(&result_path(plan, id, EXTENSION), PlanFault::Result);
            let tally = FigureTally::new(said.tally);
            sum = Some(match sum {
                Some(sum) => sum.plus(&tally).ok_or_else(wrong)?,
                None => tally,
            });
            for note in said.notes {
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        Ok((sum.unwrap_or_default(), notes))
    }

    fn read(plan: &ShardPlan, id: usize) -> Result<Self, ShardError> {
        let place = result_path(plan, id, EXTENSION);
        let text = disk::read_head(&place, MOST_BYTES)?;
        Ok(serde_json::from_slice(&text).map_err(|_| PlanError::new(&place, PlanFault::Result))?)
    }
}

//! The record of a shard that is done: of which plan, and which files it made.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use rayon::prelude::*;

use serde::{Deserialize, Serialize};

use crate::error::{PlanError, PlanFault, ShardError};
use crate::input::{has_size, hash};
use crate::plan::ShardPlan;
use crate::shard::stem;
use sandtable_files::disk;
use sandtable_files::fingerprint::content_hash;
use sandtable_files::output_files::OutputFiles;

/// The value of `format` in a record.
const FORMAT: &str = "sandtable-shard";
/// The version of records.
const VERSION: u32 = 1;
/// A record has a hundred bytes for each file; nothing longer is read.
const MOST_BYTES: u64 = 1 << 20;

/// The state of a shard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShardState {
    /// Its results are there.
    Done,
    /// It has no record.
    Missing,
    /// Its record is of another plan, or its results are not those of the record.
    Stale,
}

/// A record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShardRecord {
    format: String,
    version: u32,
    shard: usize,
    plan: String,
    files: Vec<ResultFile>,
}

/// A file that a shard made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ResultFile {
    path: String,
    bytes: u64,
    sha256: String,
}

/// The path of a result of a shard, in the folder of its plan.
fn result_name(id: usize, extension: &str) -> String {
    format!("shards/{}.{extension}", stem(id))
}

/// The path of a result of a shard.
pub fn result_path(plan: &ShardPlan, id: usize, extension: &str) -> PathBuf {
    plan.folder.join(result_name(id, extension))
}

/// A result of a shard.
pub struct ShardFile {
    /// Where it goes, in the folder of the plan.
    pub path: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl ShardFile {
    /// The one file of a shard.
    pub fn only(id: usize, extension: &str, bytes: Vec<u8>) -> Vec<Self> {
        vec![Self { path: result_name(id, extension), bytes }]
    }
}

/// Writes the results of a shard and, last, its record.
///
/// # Errors
/// A file cannot be written.
pub fn publish(plan: &ShardPlan, id: usize, results: &[ShardFile]) -> Result<(), ShardError> {
    let described = |file: &ShardFile| ResultFile {
        path: file.path.clone(),
        bytes: file.bytes.len() as u64,
        sha256: content_hash(&file.bytes),
    };
    let (format, plan_hash) = (FORMAT.to_owned(), plan.identity.clone());
    let described = results.par_iter().map(described).collect();
    let record = ShardRecord { format, version: VERSION, shard: id, plan: plan_hash, files: described };
    let place = result_path(plan, id, "json");
    let text =
        serde_json::to_string(&record).map_err(|error| PlanError::new(&place, PlanFault::from(error)))?;
    let places: Vec<PathBuf> = results.iter().map(|file| plan.folder.join(&file.path)).collect();
    let folders: BTreeSet<&Path> = places.iter().chain([&place]).filter_map(|place| place.parent()).collect();
    folders.into_iter().try_for_each(disk::make_folder)?;
    let mut files = OutputFiles::default();
    for (place, file) in places.iter().zip(results) {
        files.write(place, &file.bytes)?;
    }
    files.write(&place, (text + "\n").as_bytes())?;
    Ok(files.publish()?)
}

/// The state of a shard, by its record and by the sizes of its files.
pub fn state(plan: &ShardPlan, id: usize) -> ShardState {
    if !result_path(plan, id, "json").exists() {
        return ShardState::Missing;
    }
    let is_there = |file: &ResultFile| has_size(&plan.folder.join(&file.path), file.bytes);
    match read(plan, id) {
        Some(files) if files.iter().all(is_there) => ShardState::Done,
        _ => ShardState::Stale,
    }
}

/// [`state`], after a comparison of the files with the hashes of the record.
pub fn verified_state(plan: &ShardPlan, id: usize) -> ShardState {
    let is_own = |file: &ResultFile| {
        let content = disk::open(&plan.folder.join(&file.path)).ok();
        content
            .is_some_and(|mut content| hash(&mut content, file.bytes).is_ok_and(|hash| hash == file.sha256))
    };
    match state(plan, id) {
        ShardState::Done if !read(plan, id).is_some_and(|files| files.iter().all(is_own)) => {
            ShardState::Stale
        }
        state => state,
    }
}

/// The files of a shard's record; `None` where there is no record of this plan, or one that is wrong.
fn read(plan: &ShardPlan, id: usize) -> Option<Vec<ResultFile>> {
    let text = disk::read_head(&result_path(plan, id, "json"), MOST_BYTES).ok()?;
    let record: ShardRecord = serde_json::from_slice(&text).ok()?;
    let is_own = record.format == FORMAT
        && record.version == VERSION
        && record.shard == id
        && record.plan == plan.identity
        && !record.files.is_empty();
    // A record names files of the plan's own folders, whoever wrote it.
    let is_inside = |file: &ResultFile| {
        let mut parts = Path::new(&file.path).components();
        let is_folder = parts
            .next()
            .is_some_and(|first| ["shards", "tiles"].map(OsStr::new).contains(&first.as_os_str()));
        is_folder && parts.all(|part| matches!(part, Component::Normal(_)))
    };
    (is_own && record.files.iter().all(is_inside)).then_some(record.files)
}

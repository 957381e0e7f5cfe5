//! The record of a shard that is done: of which plan, and which files it made.

use std::fs::File;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::pipeline::files::{self, ReadFileError, SystemError};
use crate::pipeline::output_files::OutputFiles;
use crate::pipeline::shards::error::{PlanError, PlanFault, ShardError};
use crate::pipeline::shards::input::{has_size, hash, sha256};
use crate::pipeline::shards::plan::ShardPlan;
use crate::pipeline::shards::shard::stem;

/// The value of `format` in a record.
const FORMAT: &str = "sandtable-shard";
/// The version of records.
const VERSION: u32 = 1;
/// A record is a few lines; nothing longer is read.
const MOST_BYTES: u64 = 1 << 20;

/// How far a shard is.
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

/// Where a result of a shard lies.
pub fn result_path(plan: &ShardPlan, id: usize, extension: &str) -> PathBuf {
    plan.folder.join(result_name(id, extension))
}

/// Writes the result of a shard and its record.
///
/// # Errors
/// A file cannot be written.
pub fn publish(plan: &ShardPlan, id: usize, extension: &str, bytes: &[u8]) -> Result<(), ShardError> {
    let path = result_name(id, extension);
    let file = ResultFile { path, bytes: bytes.len() as u64, sha256: sha256(bytes) };
    let (format, plan_hash) = (FORMAT.to_owned(), plan.identity.clone());
    let record = ShardRecord { format, version: VERSION, shard: id, plan: plan_hash, files: vec![file] };
    let place = result_path(plan, id, "json");
    let text =
        serde_json::to_string(&record).map_err(|error| PlanError::new(&place, PlanFault::from(error)))?;
    files::make_folder(&plan.folder.join("shards"))?;
    let mut files = OutputFiles::default();
    files.write(&result_path(plan, id, extension), bytes)?;
    files.write(&place, (text + "\n").as_bytes())?;
    Ok(files.publish()?)
}

/// How far a shard is: by its record, and by the sizes of its files.
pub fn state(plan: &ShardPlan, id: usize, extension: &str) -> ShardState {
    let path = result_path(plan, id, "json");
    if !path.exists() {
        return ShardState::Missing;
    }
    match read(plan, id, extension) {
        Some(file) if has_size(&plan.folder.join(&file.path), file.bytes) => ShardState::Done,
        _ => ShardState::Stale,
    }
}

/// The result file of a shard's record; `None` where there is no record of this plan, or one that is wrong.
fn read(plan: &ShardPlan, id: usize, extension: &str) -> Option<ResultFile> {
    let text = files::read_head(&result_path(plan, id, "json"), MOST_BYTES).ok()?;
    let record: ShardRecord = serde_json::from_slice(&text).ok()?;
    let is_own = record.format == FORMAT
        && record.version == VERSION
        && record.shard == id
        && record.plan == plan.identity;
    let [file] = <[ResultFile; 1]>::try_from(record.files).ok()?;
    (is_own && file.path == result_name(id, extension)).then_some(file)
}

/// Checks that the result of a shard has the hash of its record.
///
/// # Errors
/// It has not, or cannot be read.
pub fn verify_result(plan: &ShardPlan, id: usize, extension: &str) -> Result<(), ShardError> {
    let path = result_path(plan, id, extension);
    let wrong = || ShardError::from(PlanError::new(&path, PlanFault::Result));
    let file = read(plan, id, extension).ok_or_else(wrong)?;
    let failed = |error| ReadFileError::new(&path, SystemError::from(error));
    let mut content: File = files::open(&path)?;
    match hash(&mut content, file.bytes).map_err(failed)? == file.sha256 && has_size(&path, file.bytes) {
        true => Ok(()),
        false => Err(wrong()),
    }
}

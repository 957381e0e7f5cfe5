//! The files of a plan: `plan.json`, and `shards.jsonl` with a line for each shard.

use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::analysis::arguments::AnalysisPlan;
use crate::atlas::arguments::AtlasArguments;
use crate::error::{PlanError, PlanFault, ShardError};
use crate::heights::arguments::HeightsArguments;
use crate::input::PlanInput;
use crate::shard::Shard;
use crate::tiles::arguments::TilesArguments;
use crate::viewsheds::arguments::ViewshedsArguments;
use sandtable_base::limits::PLAN_SHARDS;
use sandtable_files::disk;
use sandtable_files::fingerprint::content_hash;
use sandtable_files::output_files::OutputFiles;

/// The value of `format` in `plan.json`.
const FORMAT: &str = "sandtable-plan";
/// The version of the format that is written and read.
const VERSION: u32 = 1;
/// The version of this program.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// The product of a plan, and its arguments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "product", content = "arguments", rename_all = "lowercase")]
pub enum PlannedProduct {
    /// Heights at points.
    Heights(HeightsArguments),
    /// Counts of the observers that see each post.
    Viewsheds(ViewshedsArguments),
    /// Sheets of a scene.
    Atlas(AtlasArguments),
    /// Terrain tiles of a globe.
    Tiles(TilesArguments),
    /// A terrain analysis.
    Analysis(AnalysisPlan),
}

impl PlannedProduct {
    /// Its word on the command line and in the plan.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Heights(_) => "heights",
            Self::Viewsheds(_) => "viewsheds",
            Self::Atlas(_) => "atlas",
            Self::Tiles(_) => "tiles",
            Self::Analysis(_) => "analysis",
        }
    }
}

/// The content of `plan.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct PlanHead {
    format: String,
    version: u32,
    program: String,
    #[serde(flatten)]
    product: PlannedProduct,
    inputs: Vec<PlanInput>,
    shards: ShardList,
}

/// `shards.jsonl`, as `plan.json` states it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ShardList {
    count: usize,
    bytes: u64,
    sha256: String,
}

/// A plan in its folder.
pub struct ShardPlan {
    /// The folder.
    pub folder: PathBuf,
    /// What is made.
    pub product: PlannedProduct,
    /// The files that shards read.
    pub inputs: Vec<PlanInput>,
    /// The SHA-256 of `plan.json`, which records state.
    pub identity: String,
    shards: String,
    lines: Vec<Range<usize>>,
}

/// Writes the files of a plan to `folder`: the head last, and both or none.
///
/// # Errors
/// There are too many shards, or a file cannot be written.
pub fn write(
    folder: &Path,
    product: PlannedProduct,
    inputs: Vec<PlanInput>,
    shards: &[Shard],
) -> Result<(), ShardError> {
    let path = folder.join("plan.json");
    if shards.len() as u64 > PLAN_SHARDS.get() {
        return Err(PlanError::new(&path, PlanFault::TooManyShards(shards.len() as u64)).into());
    }
    let json = |error: serde_json::Error| PlanError::new(&path, PlanFault::from(error));
    let mut lines = String::new();
    for shard in shards {
        lines += &serde_json::to_string(shard).map_err(json)?;
        lines.push('\n');
    }
    let list =
        ShardList { count: shards.len(), bytes: lines.len() as u64, sha256: content_hash(lines.as_bytes()) };
    let (format, program) = (FORMAT.into(), PROGRAM.into());
    let head = PlanHead { format, version: VERSION, program, product, inputs, shards: list };
    let head = serde_json::to_string_pretty(&head).map_err(json)? + "\n";
    disk::make_folder(&folder.join("shards"))?;
    let mut files = OutputFiles::default();
    files.write(&folder.join("shards.jsonl"), lines.as_bytes())?;
    files.write(&path, head.as_bytes())?;
    Ok(files.publish()?)
}

impl ShardPlan {
    /// The plan in `folder`.
    ///
    /// # Errors
    /// It cannot be read, is no plan, or is one of another version of the program.
    pub fn open(folder: &Path) -> Result<Self, ShardError> {
        let path = folder.join("plan.json");
        let fault = |fault: PlanFault| PlanError::new(&path, fault);
        let head = disk::read_text(&path)?;
        /// What every version of the format has.
        #[derive(Deserialize)]
        struct PlanVersion {
            format: String,
            version: u32,
            program: String,
        }
        let version: PlanVersion = serde_json::from_str(&head).map_err(|error| fault(error.into()))?;
        if version.format != FORMAT {
            return Err(fault(PlanFault::Value(format!("its `format` is not {FORMAT}"))).into());
        }
        if version.version != VERSION {
            return Err(fault(PlanFault::Version { found: version.version, known: VERSION }).into());
        }
        if version.program != PROGRAM {
            return Err(fault(PlanFault::Program { found: version.program, own: PROGRAM }).into());
        }
        let PlanHead { product, inputs, shards: list, .. } =
            serde_json::from_str(&head).map_err(|error| fault(error.into()))?;
        match list.count as u64 {
            0 => return Err(fault(PlanFault::Value("it has no shards".into())).into()),
            count if count > PLAN_SHARDS.get() => return Err(fault(PlanFault::TooManyShards(count)).into()),
            _ => {}
        }
        let list_path = folder.join("shards.jsonl");
        let shards = disk::read_text(&list_path)?;
        let lines = line_ranges(&shards);
        if shards.len() as u64 != list.bytes
            || lines.len() != list.count
            || content_hash(shards.as_bytes()) != list.sha256
        {
            let message = "it is not the list of shards that plan.json states".to_owned();
            return Err(PlanError::new(&list_path, PlanFault::Value(message)).into());
        }
        let identity = content_hash(head.as_bytes());
        Ok(Self { folder: folder.to_owned(), product, inputs, identity, shards, lines })
    }

    /// The number of shards.
    pub fn count(&self) -> usize {
        self.lines.len()
    }

    /// Checks that the plan has all of these shards.
    ///
    /// # Errors
    /// The first that it has not is named.
    pub fn check_shards(&self, ids: &Range<usize>) -> Result<(), ShardError> {
        let found = ids.start.max(self.count());
        if ids.end <= self.count() { Ok(()) } else { Err(self.no_shard(found)) }
    }

    fn no_shard(&self, found: usize) -> ShardError {
        let fault = PlanFault::NoShard { found, last: self.count() - 1 };
        PlanError::new(&self.folder.join("shards.jsonl"), fault).into()
    }

    /// The shard with the number `id`.
    ///
    /// # Errors
    /// There is none, or its line is wrong.
    pub fn shard(&self, id: usize) -> Result<Shard, ShardError> {
        let path = self.folder.join("shards.jsonl");
        let fault = |fault: PlanFault| PlanError::new(&path, fault);
        let range = self.lines.get(id).cloned().ok_or_else(|| self.no_shard(id))?;
        let shard: Result<Shard, _> = serde_json::from_str(&self.shards[range]);
        let shard = shard.map_err(|error| fault(PlanFault::Line(id + 1, error)))?;
        if shard.id == id {
            return Ok(shard);
        }
        let message = format!("line {}: its `id` is {} instead of {id}", id + 1, shard.id);
        Err(fault(PlanFault::Value(message)).into())
    }

    /// An error about a shard's line.
    pub fn wrong_shard(&self, id: usize, message: &str) -> ShardError {
        let fault = PlanFault::Value(format!("line {}: {message}", id + 1));
        PlanError::new(&self.folder.join("shards.jsonl"), fault).into()
    }

    /// An error about an argument in the plan.
    pub fn wrong_argument(&self, fault: &str) -> ShardError {
        PlanError::new(&self.folder.join("plan.json"), PlanFault::Value(fault.to_owned())).into()
    }

    /// Checks that all inputs are what they were.
    ///
    /// # Errors
    /// The first that is not is named.
    pub fn verify_inputs(&self) -> Result<(), ShardError> {
        let verified: Vec<Result<(), ShardError>> =
            self.inputs.par_iter().map(|input| input.verify(&self.folder)).collect();
        verified.into_iter().collect()
    }
}

fn line_ranges(text: &str) -> Vec<Range<usize>> {
    let mut start = 0;
    text.split_inclusive('\n')
        .map(|line| {
            let range = start..start + line.trim_end_matches('\n').len();
            start += line.len();
            range
        })
        .collect()
}

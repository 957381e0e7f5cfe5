//! `sandtable gather`: the product of a plan.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use crate::analyze::outcome_lines;
use crate::error::CliError;
use crate::output::{print, print_lines, warn};
use crate::progress::StepTimer;
use sandtable_export::features::analysis_json::outcome_json;
use sandtable_shards::gather::{GatheredOutcome, GatheredProduct, PlanProgress, gather};
use sandtable_shards::plan::ShardPlan;
use sandtable_shards::record::ShardState;

/// Shards that a message names.
const MOST_NAMED: usize = 20;

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 the product is written, 1 shards are missing or stale, or an input has changed, 2 wrong usage."
)]
pub struct GatherArguments {
    /// The folder of the plan
    plan: PathBuf,
    /// Write the product to this file [default: one in the folder of the plan]
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Writes the product, or names the missing and stale shards; an atlas gets its page in both cases.
pub fn run(arguments: &GatherArguments) -> Result<(), CliError> {
    let plan = ShardPlan::open(&arguments.plan)?;
    let steps = StepTimer::default();
    steps.begin("checking the shards");
    let progress = PlanProgress::read(&plan, steps.step_watch().counted());
    steps.begin("joining the shards");
    let gathered = gather(&plan, &progress, arguments.output.as_deref(), steps.step_watch().counted())?;
    steps.finish();
    if let Some(GatheredOutcome { outcome, .. }) = &gathered.outcome {
        outcome.notes.iter().for_each(|note| warn(&format!("note: {note}")));
    }
    if arguments.json {
        print(&format!("{:#}\n", json(&plan, &progress, &gathered)))?;
    } else {
        let mut lines: Vec<String> = gathered.files.iter().map(|path| path.display().to_string()).collect();
        lines.extend(gathered.outcome.iter().flat_map(|of_kind| outcome_lines(&of_kind.outcome)));
        print_lines(&lines)?;
    }
    if progress.is_complete() { Ok(()) } else { Err(incomplete(&arguments.plan, &plan, &progress)) }
}

fn json(plan: &ShardPlan, progress: &PlanProgress, gathered: &GatheredProduct) -> serde_json::Value {
    let mut object = json!({
        "product": plan.product.word(),
        "shards": plan.count(),
        "done": progress.with(ShardState::Done).len(),
        "missing": progress.with(ShardState::Missing),
        "stale": progress.with(ShardState::Stale),
        "output": gathered.files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    if let Some(GatheredOutcome { kind, arguments, outcome }) = &gathered.outcome {
        object["analysis"] = outcome_json(kind, arguments, outcome);
    }
    object
}

fn incomplete(folder: &Path, plan: &ShardPlan, progress: &PlanProgress) -> CliError {
    let with = |state| progress.with(state);
    let lists = [("missing", with(ShardState::Missing)), ("stale", with(ShardState::Stale))];
    let found: Vec<String> = lists
        .iter()
        .filter(|(_, ids)| !ids.is_empty())
        .map(|(word, ids)| format!("{} {word} ({})", ids.len(), named(ids)))
        .collect();
    let (folder, count) = (folder.display(), plan.count());
    CliError::input(format!(
        "{folder}: of {count} shards {}; do them with `sandtable work {folder} --shards 0..{count}`",
        found.join(" and ")
    ))
}

fn named(ids: &[usize]) -> String {
    let named: Vec<String> = ids.iter().take(MOST_NAMED).map(usize::to_string).collect();
    named.join(", ") + if ids.len() > MOST_NAMED { ", …" } else { "" }
}

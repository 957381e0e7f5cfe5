//! `sandtable work`: shards of a plan.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use crate::error::CliError;
use crate::output::{is_quiet, print, warn};
use crate::progress::CountedBar;
use sandtable_base::message::chain::error_text;
use sandtable_render::OtherRenderer;
use sandtable_shards::plan::ShardPlan;
use sandtable_shards::work::{ShardWorker, is_done};

#[derive(Debug, Args)]
#[command(
    after_help = "A shard that is done is skipped. Exit codes: 0 all are done, 1 one failed or an input has changed, 2 wrong usage."
)]
pub struct WorkArguments {
    /// The folder of the plan
    plan: PathBuf,
    /// The number of a shard, from 0
    #[arg(long, value_name = "I", required_unless_present = "shards")]
    shard: Option<usize>,
    /// The shards from A to B, without B
    #[arg(long, value_name = "A..B", conflicts_with = "shard", value_parser = shard_range)]
    shards: Option<Range<usize>>,
}

/// Parses `A..B`.
fn shard_range(text: &str) -> Result<Range<usize>, &'static str> {
    let ends = text.split_once("..").and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    let ends = ends.filter(|ends: &Range<usize>| !ends.is_empty());
    ends.ok_or("write the first shard and the one after the last, as in 0..100")
}

/// Does the shards that are not done, and prints a line for each; goes on past one that fails. `gpu` draws the sheets of a plan that
/// states a graphics adapter.
pub fn run(arguments: &WorkArguments, gpu: Option<OtherRenderer>) -> Result<(), CliError> {
    let plan = Arc::new(ShardPlan::open(&arguments.plan)?);
    let one = arguments.shard.map(|shard| shard..shard.saturating_add(1));
    let ids = one.or_else(|| arguments.shards.clone()).unwrap_or_default();
    plan.check_shards(&ids)?;
    let mut worker = None;
    let (mut failed, count) = (0, ids.len());
    let bar = CountedBar::new("shard", count as u64);
    let say = |line: String| bar.beside(|| if is_quiet() { Ok(()) } else { print(&line) });
    for id in ids {
        if is_done(&plan, id) {
            bar.skip_one();
            say(format!("{id} skipped\n"))?;
            continue;
        }
        let worker: &mut ShardWorker = match &mut worker {
            Some(worker) => worker,
            none => none.insert(ShardWorker::open(&plan, gpu)?),
        };
        match worker.work(id) {
            Ok(()) => say(format!("{id} done\n"))?,
            Err(error) => {
                bar.beside(|| warn(&format!("error: shard {id}: {}", error_text(&error))));
                failed += 1;
            }
        }
        bar.did_one();
    }
    drop(bar);
    match failed {
        0 => Ok(()),
        _ if count == 1 => Err(CliError::Reported),
        _ => Err(CliError::input(format!("{failed} of {count} shards failed"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_of_shards_has_two_ends_and_is_not_empty() {
        assert_eq!(shard_range("0..1000"), Ok(0..1000));
        for wrong in ["", "5", "5..", "..5", "3..3", "4..3", "-1..2", "0...3", "0..1e3"] {
            assert!(shard_range(wrong).is_err(), "{wrong}");
        }
    }
}

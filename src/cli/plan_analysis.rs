//! `sandtable plan analysis`: an analysis in shards. Its kinds and their options are those of `analyze`.

use std::num::NonZeroU64;

use clap::error::ErrorKind;
use clap::{ArgMatches, Args, Command, FromArgMatches, Subcommand};

use crate::analyze::{bare_command, written};
use crate::error::CliError;
use crate::options::DatasetArguments;
use crate::output::warn;
use crate::plan::{PlanOptions, planned, report};
use sandtable_catalog::kind::AnalysisKind;
use sandtable_catalog::{kind, kinds};
use sandtable_files::disk;
use sandtable_query::analysis::WrittenArgument;
use sandtable_query::parted_analysis::check_parts;
use sandtable_shards::analysis::arguments::AnalysisPlan;
use sandtable_shards::analysis::plan::plan as plan_analysis;

/// A kind of analysis, its options and those of a plan.
#[derive(Debug)]
pub struct PlanAnalysisCommand {
    kind: &'static AnalysisKind,
    dataset: DatasetArguments,
    arguments: Vec<WrittenArgument>,
    plan: PlanOptions,
}

impl Subcommand for PlanAnalysisCommand {
    fn augment_subcommands(command: Command) -> Command {
        kinds().fold(command.subcommand_required(true).arg_required_else_help(true), |command, kind| {
            command.subcommand(PlanOptions::augment_args(bare_command(kind)))
        })
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        Self::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        kind(name).is_some()
    }
}

impl FromArgMatches for PlanAnalysisCommand {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let missing = || clap::Error::raw(ErrorKind::MissingSubcommand, "name a kind of analysis");
        let (name, matches) = matches.subcommand().ok_or_else(missing)?;
        let kind = kind(name).ok_or_else(missing)?;
        let (dataset, plan) =
            (DatasetArguments::from_arg_matches(matches)?, PlanOptions::from_arg_matches(matches)?);
        Ok(Self { kind, dataset, arguments: written(kind, matches), plan })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

pub fn run(command: &PlanAnalysisCommand) -> Result<(), CliError> {
    let PlanAnalysisCommand { kind, dataset, arguments, plan } = command;
    // What cannot be cut is refused before anything is read.
    check_parts(kind, arguments)?;
    let folder = &plan.output;
    disk::make_folder(folder)?;
    let options = arguments.iter().map(|argument| (argument.name.clone(), argument.text.clone()));
    let planned = AnalysisPlan {
        dataset: planned(dataset, folder),
        kind: kind.name.to_owned(),
        options: options.collect(),
    };
    let opened = planned.open(folder)?;
    let queried = &opened.queried.dataset;
    queried.warning().into_iter().for_each(|warning| warn(&format!("warning: {warning}")));
    queried.reading_notes().iter().for_each(|note| warn(&format!("note: {note}")));
    dataset.note_ground(queried)?;
    // For its note about the shift of datums.
    dataset.crs(queried);
    let shards = plan_analysis(planned, &opened, plan.shards.map(NonZeroU64::get), folder)?;
    report(folder, "analysis", shards, dataset.json)
}

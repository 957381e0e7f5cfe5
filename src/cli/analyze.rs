//! `sandtable analyze`: an analysis of the ground, as a raster, features, or figures and tables.
//!
//! The kinds and their options are those of the catalog, so that the command has no list of its own.

use std::path::{Path, PathBuf};
use std::slice::from_ref;

use clap::error::ErrorKind;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, Subcommand};
use serde_json::Value;

use crate::error::CliError;
use crate::options::DatasetArguments;
use crate::output::{print, print_lines, row, warn};
use crate::output_format::output_format;
use crate::progress::StepTimer;
use sandtable_analysis::outcome::{Figure, Outcome, OutcomeTable, PropertyValue};
use sandtable_catalog::kind::{AnalysisKind, AnalysisYield};
use sandtable_catalog::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};
use sandtable_catalog::{kind, kinds};
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::formats::WRITTEN_EXTENSIONS;
use sandtable_export::features::FeatureFormat;
use sandtable_export::features::analysis_json::outcome_json;
use sandtable_export::features::outcome::{OutcomeFrame, export_outcome};
use sandtable_files::raster_file;
use sandtable_query::analysis::{Analyzed, WrittenArgument, analyze, bare_land, raster};
use sandtable_scene::land::land_of;
use sandtable_scene::scene_file::open_scene_true_to_scale;
use sandtable_terrain::stop_flag::StopFlag;

/// An analysis and its options.
#[derive(Debug)]
pub struct AnalyzeCommand {
    kind: &'static AnalysisKind,
    dataset: DatasetArguments,
    arguments: Vec<WrittenArgument>,
    output: Option<PathBuf>,
}

/// A file to write.
#[derive(Clone, Copy)]
enum AnalysisFormat {
    Raster(&'static DemFormat),
    Features(FeatureFormat),
}

impl Subcommand for AnalyzeCommand {
    fn augment_subcommands(command: Command) -> Command {
        kinds().fold(command.subcommand_required(true).arg_required_else_help(true), |command, kind| {
            command.subcommand(kind_command(kind))
        })
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        Self::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        kind(name).is_some()
    }
}

impl FromArgMatches for AnalyzeCommand {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let missing = || clap::Error::raw(ErrorKind::MissingSubcommand, "name a kind of analysis");
        let (name, matches) = matches.subcommand().ok_or_else(missing)?;
        let kind = kind(name).ok_or_else(missing)?;
        Ok(Self {
            kind,
            dataset: DatasetArguments::from_arg_matches(matches)?,
            arguments: written(kind, matches),
            output: matches.get_one::<PathBuf>("output").cloned(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The arguments of a kind that are stated.
pub fn written(kind: &AnalysisKind, matches: &ArgMatches) -> Vec<WrittenArgument> {
    let written = |parameter: &AnalysisParameter| {
        let text = matches.get_one::<String>(parameter.name)?;
        Some(WrittenArgument { name: parameter.name.to_owned(), text: text.clone() })
    };
    kind.all_parameters().filter_map(written).collect()
}

/// The command of a kind.
fn kind_command(kind: &'static AnalysisKind) -> Command {
    let output = Arg::new("output")
        .short('o')
        .long("output")
        .value_name("OUT")
        .value_parser(clap::value_parser!(PathBuf))
        .help("Write the answer to this file: a raster as .tif or .asc, features as .gpkg or .geojson");
    bare_command(kind).arg(output)
}

/// The command of a kind without an output.
pub fn bare_command(kind: &'static AnalysisKind) -> Command {
    let command = DatasetArguments::augment_args(Command::new(kind.name))
        .about(kind.summary.trim_end_matches('.'))
        .after_help(format!("Source: {}.\nLimits: {}", kind.source, kind.limits.join(" ")));
    kind.all_parameters().fold(command, |command, parameter| command.arg(option(parameter)))
}

/// The option of a parameter.
fn option(parameter: &'static AnalysisParameter) -> Arg {
    let default = match parameter.default_text() {
        "" => String::new(),
        text => format!(" [default: {text}]"),
    };
    let long: &'static str = parameter.name;
    Arg::new(long)
        .long(long.replace('_', "-"))
        .value_name(value_name(parameter))
        .allow_hyphen_values(true)
        .required(parameter.default == ParameterDefault::Required)
        .display_order(0)
        .help(format!("{}{default}", parameter.doc.trim_end_matches('.')))
}

fn value_name(parameter: &AnalysisParameter) -> String {
    match parameter.form {
        ParameterForm::Number { .. } if parameter.unit.is_empty() => "NUMBER".into(),
        ParameterForm::Number { .. } => parameter.unit.to_uppercase(),
        ParameterForm::Numbers { .. } => "N,N,…".into(),
        ParameterForm::Word(words) => words.join("|"),
        ParameterForm::Points { least: 1 } => "X,Y[;X,Y…]".into(),
        ParameterForm::Points { .. } | ParameterForm::Line | ParameterForm::Area => "X,Y;X,Y…".into(),
        ParameterForm::Vehicle => "VEHICLE".into(),
        ParameterForm::Ground => "FILE|source".into(),
        ParameterForm::Extent => "X,Y,X,Y".into(),
    }
}

pub fn run(command: &AnalyzeCommand) -> Result<(), CliError> {
    let input = from_ref(&command.dataset.file);
    let output = command
        .output
        .as_deref()
        .map(|path| Ok::<_, CliError>((path, format(command.kind, path, input)?)))
        .transpose()?;
    let steps = StepTimer::default();
    let analyzed = analyzed(command, &steps)?;
    if let Some((path, format)) = output {
        steps.begin("writing");
        write(command, &analyzed, path, format)?;
    }
    steps.finish();
    analyzed.outcome.notes.iter().for_each(|note| warn(&format!("note: {note}")));
    if command.dataset.json {
        return print(&format!("{:#}\n", json(command, &analyzed.outcome)));
    }
    print_lines(&text(command, &analyzed.outcome))
}

/// The analysis; a scene is built only for a kind that uses what lies on its ground.
fn analyzed(command: &AnalyzeCommand, steps: &StepTimer) -> Result<Analyzed, CliError> {
    let AnalyzeCommand { kind, dataset: of_dataset, arguments, .. } = command;
    steps.begin("reading the ground");
    let scene = match kind.layers.is_empty() || !of_dataset.is_scene() {
        true => None,
        false => {
            let progress = |step| steps.begin(step);
            Some(open_scene_true_to_scale(&of_dataset.file, &of_dataset.access.allow, &progress)?)
        }
    };
    let dataset = match &scene {
        Some(scene) => of_dataset.of_scene(scene),
        None => of_dataset.open()?,
    };
    let crs = of_dataset.crs(&dataset);
    of_dataset.note_ground(&dataset)?;
    steps.begin("analyzing");
    let land = match &scene {
        Some(scene) => land_of(scene, kind.layers),
        None => bare_land(&dataset, (kind, arguments), &crs)?,
    };
    Ok(analyze(&dataset, land, (*kind, arguments), &crs, &StopFlag::default())?)
}

/// The format of a file; refuses a raster of a kind that gives none before anything is computed.
fn format(kind: &AnalysisKind, path: &Path, inputs: &[PathBuf]) -> Result<AnalysisFormat, CliError> {
    let features = |extension: &str| {
        let format = FeatureFormat::from_extension(extension)?;
        matches!(format, FeatureFormat::GeoPackage | FeatureFormat::GeoJson)
            .then_some(AnalysisFormat::Features(format))
    };
    let either = |extension: &str| {
        DemFormat::to_write(extension).map(AnalysisFormat::Raster).or_else(|| features(extension))
    };
    let written = format!("analyses are written as .gpkg or .geojson, and rasters as {WRITTEN_EXTENSIONS}");
    let format = output_format(path, inputs, either, &written)?;
    let gives_raster = matches!(kind.yields, AnalysisYield::Raster | AnalysisYield::Both);
    match format {
        AnalysisFormat::Raster(_) if !gives_raster => {
            Err(CliError::usage(format!("{} gives no raster; write it as .gpkg or .geojson", kind.name)))
        }
        format => Ok(format),
    }
}

fn write(
    command: &AnalyzeCommand,
    analyzed: &Analyzed,
    path: &Path,
    format: AnalysisFormat,
) -> Result<(), CliError> {
    let inputs = from_ref(&command.dataset.file);
    let Analyzed { ground, crs, outcome } = analyzed;
    match format {
        AnalysisFormat::Raster(format) => {
            let values = outcome.raster.as_ref();
            let values = values.unwrap_or_else(|| panic!("{} gives a raster", command.kind.name));
            raster_file::write(&raster(values, ground, crs), format, path, inputs)?;
        }
        AnalysisFormat::Features(format) => {
            let frame = OutcomeFrame { ground, crs };
            export_outcome(outcome, frame, path, format, command.kind.title, inputs)?;
        }
    }
    Ok(())
}

fn json(command: &AnalyzeCommand, outcome: &Outcome) -> Value {
    let mut object = outcome_json(command.kind, &command.arguments, outcome);
    object["output"] = command.output.as_ref().map(|path| path.display().to_string()).into();
    object
}

fn text(command: &AnalyzeCommand, outcome: &Outcome) -> Vec<String> {
    let mut lines: Vec<String> = command.output.iter().map(|path| path.display().to_string()).collect();
    let width = outcome.figures.iter().map(|figure| figure.name.chars().count()).max().unwrap_or(0).max(8);
    for Figure { name, value, unit } in &outcome.figures {
        lines.push(row(width, name, format!("{} {unit}", short(*value)).trim_end()));
    }
    if !outcome.features.is_empty() {
        lines.push(row(width, "features", outcome.features.len()));
    }
    outcome.tables.iter().for_each(|table| lines.extend(table_lines(table)));
    lines
}

/// A number with three decimals at most.
fn short(number: f64) -> String {
    let text = format!("{number:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A table in columns.
fn table_lines(table: &OutcomeTable) -> Vec<String> {
    let heading =
        |name: &str, unit: &str| if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") };
    let head: Vec<String> = table.columns.iter().map(|column| heading(column.name, column.unit)).collect();
    let cell = |cell: &PropertyValue, decimals: usize| match cell {
        PropertyValue::Number(number) => format!("{number:.decimals$}"),
        PropertyValue::Whole(number) => number.to_string(),
        PropertyValue::Text(text) => text.clone(),
        PropertyValue::Truth(truth) => if *truth { "yes" } else { "no" }.into(),
    };
    let cells = |row: &Vec<PropertyValue>| -> Vec<String> {
        row.iter().zip(&table.columns).map(|(value, column)| cell(value, column.decimals)).collect()
    };
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(table.rows.iter().map(cells)).collect();
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let line = |row: &Vec<String>| {
        let padded = row.iter().zip(&widths).map(|(cell, width)| format!("  {cell:>width$}"));
        padded.collect::<String>()
    };
    std::iter::once(table.title.clone()).chain(rows.iter().map(line)).collect()
}

//! `sandtable analyze`: an analysis of the ground, as a raster, features, or figures and tables.
//!
//! The kinds and their options are those of the catalog, so that the command has no list of its own.

use std::path::{Path, PathBuf};
use std::slice::from_ref;
use std::sync::Arc;

use clap::error::ErrorKind;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, Subcommand};
use serde_json::Value;

use crate::error::CliError;
use crate::options::DatasetArguments;
use crate::output::{print, print_lines, row, warn};
use crate::output_format::output_format;
use crate::progress::StepTimer;
use sandtable_analysis::outcome::{Figure, Outcome, OutcomeTable, ValueClass, with_unit};
use sandtable_base::message::numbers::trimmed;
use sandtable_catalog::kind::{AnalysisKind, AnalysisYield};
use sandtable_catalog::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};
use sandtable_catalog::{kind, kinds};
use sandtable_dem::dem_format::DemFormat;
use sandtable_dem::formats::WRITTEN_EXTENSIONS;
use sandtable_export::features::FeatureFormat;
use sandtable_export::features::analysis_json::{classes_json, outcome_json};
use sandtable_export::features::outcome::{OutcomeFrame, export_outcome};
use sandtable_files::{disk, raster_file};
use sandtable_query::analysis::{Analyzed, WrittenArgument, analyze, bare_land, ground_raster};
use sandtable_query::analysis_bands::{AnalysisBands, OutcomeWindows, analysis_bands};
use sandtable_scene::analysis_map::{MapTexts, ground_map, scene_map};
use sandtable_scene::land::land_of_drawn;
use sandtable_scene::scene_file::open_scene_land;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::analysis_map::analysis_map;
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
    /// A map, as a picture.
    Map,
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
        .help("Write the answer to this file: a map as .png, a raster as .tif or .asc, features as .gpkg or .geojson");
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
        ParameterForm::Ground => "FILE|source|phase:NAME".into(),
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
    let (outcome, classes) = match analyzed(command, output, &steps)? {
        AnalysisMade::Written { outcome, classes } => (outcome, classes),
        AnalysisMade::InMemory(analyzed, scene) => {
            match output {
                Some((path, AnalysisFormat::Map)) => write_map(command, &analyzed, scene, path, &steps)?,
                Some((path, format)) => {
                    steps.begin("writing");
                    write(command, &analyzed, path, format)?;
                }
                None => {}
            }
            // Only JSON says how a picture divides the values.
            let outcome =
                if command.dataset.json { analyzed.outcome.with_classes() } else { analyzed.outcome };
            let classes = outcome.raster.as_ref().map(|raster| raster.classes.clone());
            (outcome, classes.unwrap_or_default())
        }
    };
    steps.finish();
    outcome.notes.iter().for_each(|note| warn(&format!("note: {note}")));
    if command.dataset.json {
        return print(&format!("{:#}\n", json(command, &outcome, &classes)));
    }
    print_lines(&text(command, &outcome))
}

/// An analysis that was made.
enum AnalysisMade {
    /// Its raster was written band by band; the rest of what it gives, and how a picture divides the values.
    Written { outcome: Outcome, classes: Vec<ValueClass> },
    /// All of it, and the scene that it is of where that was built.
    InMemory(Analyzed, Option<Box<SceneModel>>),
}

/// The analysis; a scene is built only for a map, and for a kind that uses what lies on its ground.
fn analyzed(
    command: &AnalyzeCommand,
    output: Option<(&Path, AnalysisFormat)>,
    steps: &StepTimer,
) -> Result<AnalysisMade, CliError> {
    let is_map = matches!(output, Some((_, AnalysisFormat::Map)));
    let AnalyzeCommand { kind, dataset: of_dataset, arguments, .. } = command;
    steps.begin("reading the ground");
    let progress = |step| steps.begin(step);
    let (file, allowed) = (&of_dataset.file, &of_dataset.access.allow);
    let scene = match of_dataset.is_scene() {
        true if is_map => Some(scene_map(file, allowed, map_texts(command), &progress)?),
        true if !kind.layers.is_empty() => Some(open_scene_land(file, allowed, &progress)?),
        _ => None,
    };
    let dataset = match &scene {
        Some(scene) => of_dataset.of_scene(scene),
        None => of_dataset.open()?,
    };
    let crs = of_dataset.crs(&dataset);
    of_dataset.note_ground(&dataset)?;
    steps.begin("analyzing");
    let stop = Arc::new(StopFlag::default());
    steps.watch(Arc::clone(&stop));
    if let Some((path, AnalysisFormat::Raster(format))) = output
        && format.windows_writer.is_some()
        && let Some(bands) = analysis_bands(&dataset, (*kind, arguments), &crs, &stop)?
    {
        return write_bands(command, bands, path, format);
    }
    let land = match &scene {
        Some(scene) => land_of_drawn(scene, kind.layers, || open_scene_land(file, allowed, &progress))?,
        None => bare_land(&dataset, (kind, arguments), &crs)?,
    };
    steps.begin("analyzing");
    steps.watch(Arc::clone(&stop));
    let analyzed = analyze(&dataset, land, (*kind, arguments), &crs, &stop)?;
    Ok(AnalysisMade::InMemory(analyzed, scene.map(Box::new)))
}

/// The texts of a map: what it is, of what, by whom, and what it does not know.
fn map_texts(command: &AnalyzeCommand) -> MapTexts {
    let stated = command.arguments.iter().map(|argument| (&*argument.name, &*argument.text));
    MapTexts::of_analysis(command.kind, &command.dataset.file, stated)
}

/// Writes the map of an analysis: the land from above, what the analysis gives over it, a legend and tables.
fn write_map(
    command: &AnalyzeCommand,
    analyzed: &Analyzed,
    scene: Option<Box<SceneModel>>,
    path: &Path,
    steps: &StepTimer,
) -> Result<(), CliError> {
    let progress = |step| steps.begin(step);
    let Analyzed { ground, crs, outcome } = analyzed;
    let map = match scene {
        Some(scene) => *scene,
        None => {
            let raster = ground_raster(ground, crs);
            ground_map(&command.dataset.file, raster, map_texts(command), &progress)?
        }
    };
    disk::check_output(path, &map.files)?;
    let picture = analysis_map(map, command.kind, (ground, outcome), &progress)?;
    progress("writing");
    Ok(disk::write_picture(path, &picture.pixels)?)
}

/// Writes a raster while it is computed; the rest of what the analysis gives.
fn write_bands(
    command: &AnalyzeCommand,
    mut bands: AnalysisBands,
    path: &Path,
    format: &DemFormat,
) -> Result<AnalysisMade, CliError> {
    let written = raster_file::write_windows(&mut bands, format, path, &command.dataset.file);
    match bands.problem() {
        Some(problem) => Err(problem.into()),
        None => {
            written?;
            Ok(AnalysisMade::Written { outcome: bands.outcome(), classes: bands.classes().to_vec() })
        }
    }
}

/// The format of a file; refuses a raster of a kind that gives none before anything is computed.
fn format(kind: &AnalysisKind, path: &Path, inputs: &[PathBuf]) -> Result<AnalysisFormat, CliError> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        disk::check_output(path, inputs)?;
        return Ok(AnalysisFormat::Map);
    }
    let features = |extension: &str| {
        let format = FeatureFormat::from_extension(extension)?;
        matches!(format, FeatureFormat::GeoPackage | FeatureFormat::GeoJson)
            .then_some(AnalysisFormat::Features(format))
    };
    let either = |extension: &str| {
        DemFormat::to_write(extension).map(AnalysisFormat::Raster).or_else(|| features(extension))
    };
    let written =
        format!("analyses are written as .png, .gpkg or .geojson, and rasters as {WRITTEN_EXTENSIONS}");
    let format = output_format(path, inputs, either, &written)?;
    let gives_raster = matches!(kind.yields, AnalysisYield::Raster | AnalysisYield::Both);
    match format {
        AnalysisFormat::Raster(_) if !gives_raster => Err(CliError::usage(format!(
            "{} gives no raster; write it as .png, .gpkg or .geojson",
            kind.name
        ))),
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
        // A map is written with the scene under it.
        AnalysisFormat::Map => {}
        AnalysisFormat::Raster(format) => {
            let values = outcome.raster.as_ref();
            let values = values.unwrap_or_else(|| panic!("{} gives a raster", command.kind.name));
            let mut windows = OutcomeWindows::new(values, ground, crs);
            if raster_file::write_windows(&mut windows, format, path, &command.dataset.file)?.is_none() {
                raster_file::write(&windows.raster(), format, path, inputs)?;
            }
        }
        AnalysisFormat::Features(format) => {
            let frame = OutcomeFrame { ground, crs };
            export_outcome(outcome, frame, path, format, command.kind.title, inputs)?;
        }
    }
    Ok(())
}

fn json(command: &AnalyzeCommand, outcome: &Outcome, classes: &[ValueClass]) -> Value {
    let mut object = outcome_json(command.kind, &command.arguments, outcome);
    if !classes.is_empty() {
        object["classes"] = classes_json(classes);
    }
    object["output"] = command.output.as_ref().map(|path| path.display().to_string()).into();
    object
}

fn text(command: &AnalyzeCommand, outcome: &Outcome) -> Vec<String> {
    let mut lines: Vec<String> = command.output.iter().map(|path| path.display().to_string()).collect();
    lines.extend(outcome_lines(outcome));
    lines
}

/// The figures and tables of an outcome.
pub fn outcome_lines(outcome: &Outcome) -> Vec<String> {
    let mut lines = Vec::new();
    let width = outcome.figures.iter().map(|figure| figure.name.chars().count()).max().unwrap_or(0).max(8);
    for Figure { name, value, unit } in &outcome.figures {
        lines.push(row(width, name, format!("{} {unit}", trimmed(*value, 3)).trim_end()));
    }
    if !outcome.features.is_empty() {
        lines.push(row(width, "features", outcome.features.len()));
    }
    outcome.tables.iter().for_each(|table| lines.extend(table_lines(table)));
    lines
}

/// A table in columns.
fn table_lines(table: &OutcomeTable) -> Vec<String> {
    let head: Vec<String> = table.columns.iter().map(|column| with_unit(column.name, column.unit)).collect();
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(table.written_rows()).collect();
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

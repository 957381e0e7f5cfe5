//! `sandtable check`: load and validate a scene, draw nothing.

use std::collections::BTreeMap;

use clap::Args;
use serde_json::{Value, json};

use crate::error::CliError;
use crate::options::SceneArguments;
use crate::output::{print, print_lines, row};
use crate::progress::StepTimer;
use crate::values::choice;
use sandtable_base::message::choice::{Choice, ChoiceWord, word};
use sandtable_base::message::numbers::counted;
use sandtable_description::finding::{Finding, Severity};
use sandtable_description::source_place::SourcePlace;
use sandtable_lint::opened::open_linted;
use sandtable_scene::scene_label::whole_meters;
use sandtable_scene::scene_model::SceneModel;

/// The most notes that are printed: as many as fit on a screen beside the rest.
const MOST_NOTES: usize = 20;

#[derive(Debug, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Print JSON: counts by code, and every finding with code, severity, file, line, column, message and help
    #[arg(long)]
    pub json: bool,
    /// Fail where there are warnings, not only where there are errors
    #[arg(long, value_name = "FINDINGS", value_parser = choice::<DeniedFindings>())]
    pub deny: Option<DeniedFindings>,
}

/// Findings that make a check fail, besides errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeniedFindings {
    /// Warnings.
    Warnings,
}

impl Choice for DeniedFindings {
    const CHOICES: &'static [ChoiceWord<Self>] =
        &[word(Self::Warnings, "warnings", "what looks wrong, or has no effect")];
}

pub fn run(arguments: &CheckArguments) -> Result<(), CliError> {
    let steps = StepTimer::default();
    let SceneArguments { scene: path, access } = &arguments.scene;
    let opened = open_linted(path, &access.allow, &|step| steps.begin(step));
    steps.finish();
    let (scene, findings) = match opened {
        Ok((scene, findings)) => (Some(scene), findings),
        Err(error) if arguments.json => (None, error.findings()),
        Err(error) => return Err(error.into()),
    };
    let name = path.display().to_string();
    match &scene {
        _ if arguments.json => print(&format!("{:#}\n", as_json(&name, &findings)))?,
        Some(scene) => print_lines(&lines(&name, scene, &findings))?,
        None => {}
    }
    let is_denied = |finding: &Finding| match finding.severity() {
        Severity::Error => true,
        Severity::Warning => arguments.deny == Some(DeniedFindings::Warnings),
        Severity::Note => false,
    };
    if findings.iter().any(is_denied) { Err(CliError::Reported) } else { Ok(()) }
}

/// The findings that somebody should look at, each with its line, then the contents of the scene.
fn lines(name: &str, scene: &SceneModel, findings: &[Finding]) -> Vec<String> {
    let (notes, shown): (Vec<&Finding>, Vec<&Finding>) =
        findings.iter().partition(|finding| finding.severity() == Severity::Note);
    let mut lines: Vec<String> =
        shown.iter().flat_map(|finding| [finding.to_string(), String::new()]).collect();
    let is_sound = shown.iter().all(|finding| finding.severity() != Severity::Error);
    lines.push(format!("{name} {}", if is_sound { "is sound" } else { "is wrong" }));
    if !shown.is_empty() {
        let counts = format!("{}; `sandtable explain CODE` explains a code", counts(findings));
        lines.push(row(9, "findings", counts));
    }
    lines.extend(summary(scene));
    let note = |note: &Finding| format!("{} [{}]", note.message, note.code.word());
    lines.extend(note_rows(&notes.into_iter().map(note).collect::<Vec<_>>()));
    lines
}

/// `1 error, 2 warnings, 3 notes`.
fn counts(findings: &[Finding]) -> String {
    let count = |severity| findings.iter().filter(|finding| finding.severity() == severity).count();
    let each = Severity::ALL.map(|severity| (severity, count(severity)));
    let present = each.iter().filter(|(_, count)| *count > 0);
    present.map(|&(severity, count)| counted_findings(count, severity)).collect::<Vec<_>>().join(", ")
}

/// `3 warnings`.
pub fn counted_findings(count: usize, severity: Severity) -> String {
    counted(count, severity.word(), &format!("{}s", severity.word()))
}

fn as_json(name: &str, findings: &[Finding]) -> Value {
    let object = |finding: &Finding| {
        let position = finding.place.as_ref().map(SourcePlace::position);
        json!({
            "code": finding.code.word(),
            "severity": finding.severity().word(),
            "file": finding.place.as_ref().map(SourcePlace::file),
            "line": position.map(|position| position.line),
            "column": position.map(|position| position.column),
            "message": finding.message,
            "help": finding.help,
            "more": finding.more,
        })
    };
    let count = |severity| findings.iter().filter(|finding| finding.severity() == severity).count();
    let mut codes: BTreeMap<&str, usize> = BTreeMap::new();
    for finding in findings {
        *codes.entry(finding.code.word()).or_default() += 1 + finding.more;
    }
    json!({
        "scene": name,
        "errors": count(Severity::Error),
        "warnings": count(Severity::Warning),
        "notes": count(Severity::Note),
        "codes": codes,
        "findings": findings.iter().map(object).collect::<Vec<_>>(),
    })
}

/// The contents of a scene and its notes, in lines.
pub fn contents(scene: &SceneModel) -> Vec<String> {
    let mut lines = summary(scene);
    lines.extend(note_rows(&scene.notes()));
    lines
}

/// The ground, the features and the cameras of a scene, in lines.
fn summary(scene: &SceneModel) -> Vec<String> {
    let lattice = &scene.lattice;
    let (low, high) = scene.height_range_m;
    let size = lattice.extent().size() / 1000.0;
    let ground = format!(
        "{}×{} posts, {:.2}×{:.2} km, {} to {} m, {}",
        lattice.columns(),
        lattice.rows(),
        size.x,
        size.y,
        whole_meters(low),
        whole_meters(high),
        scene.crs.name()
    );
    let census = scene.census().into_iter().map(|(kind, count)| format!("{count} {}", kind.noun(count)));
    let labels = scene.labels.len();
    let labels = counted(labels, "label", "labels");
    let cameras: Vec<&str> = scene.cameras.iter().map(|view| view.name.as_str()).collect();
    vec![
        row(9, "ground", ground),
        row(9, "features", census.chain([labels]).collect::<Vec<_>>().join(", ")),
        row(9, "cameras", cameras.join(", ")),
    ]
}

fn note_rows(notes: &[impl std::fmt::Display]) -> Vec<String> {
    let mut rows: Vec<String> = notes.iter().take(MOST_NOTES).map(|note| row(9, "note", note)).collect();
    if let Some(more @ 1..) = notes.len().checked_sub(MOST_NOTES) {
        rows.push(row(9, "note", format!("… and {more} more; `sandtable report` prints all")));
    }
    rows
}

//! `sandtable report`: results of building a scene, feature by feature.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use crate::error::CliError;
use crate::options::SceneArguments;
use crate::output::{aligned, print, print_lines};
use crate::progress::StepTimer;
use sandtable_base::message::numbers::fixed;
use sandtable_files::disk::{self, WriteFileError};
use sandtable_files::output_files::OutputFiles;
use sandtable_scene::report::{ReportCell, ReportColumn, ReportTable, SceneReport};
use sandtable_scene::scene_file::open_scene_true_to_scale;
use sandtable_scene::scene_model::SceneModel;

/// The most rows of a table that are printed; a file or JSON holds all.
const SHOWN_ROWS: usize = 20;

/// The most characters of a name that are printed or become part of a file name.
const SHOWN_CHARACTERS: usize = 40;

#[derive(Debug, Args)]
#[command(after_help = "Heights are true to scale, whatever exaggeration the scene states.")]
pub struct ReportArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Print one JSON object with every row
    #[arg(long)]
    pub json: bool,
    /// Write every table, and the profile of every conforming road, as CSV files into this folder; it is made if it does not exist
    #[arg(long, value_name = "FOLDER", conflicts_with = "json")]
    pub csv: Option<PathBuf>,
}

pub fn run(arguments: &ReportArguments) -> Result<(), CliError> {
    let steps = StepTimer::default();
    let (path, allowed) = (&arguments.scene.scene, &arguments.scene.access.allow);
    let scene = open_scene_true_to_scale(path, allowed, &|step| steps.begin(step))?;
    steps.finish();
    let report = &scene.report;
    if arguments.json {
        return print(&format!("{:#}\n", as_json(report, &scene.notes())));
    }
    if let Some(folder) = &arguments.csv {
        return print_lines(&write_csv_files(&scene, folder)?);
    }
    let mut lines = vec![path.display().to_string()];
    let tables = report.tables();
    tables.iter().for_each(|table| lines.extend(printed(table)));
    if tables.is_empty() {
        lines.push("  nothing to report of single features".into());
    }
    lines.extend(scene.notes().iter().map(|note| format!("  note  {note}")));
    print_lines(&lines)
}

fn as_json(report: &SceneReport, notes: &[&str]) -> Value {
    let rows = |table: &ReportTable| (table.name.replace(' ', "_"), rows_as_json(table));
    let tables: Map<String, Value> = report.tables().iter().map(rows).collect();
    json!({"tables": tables, "notes": notes})
}

fn rows_as_json(table: &ReportTable) -> Value {
    let row = |row: &Vec<ReportCell>| -> Value {
        let cells = table.columns.iter().zip(row).map(|(column, cell)| (column.key(), value(cell)));
        Value::Object(cells.collect())
    };
    table.rows.iter().map(row).collect()
}

fn value(cell: &ReportCell) -> Value {
    match cell {
        ReportCell::Text(text) => json!(text),
        ReportCell::Number(number) => json!(number),
        ReportCell::Count(count) => json!(count),
        ReportCell::Empty => Value::Null,
    }
}

/// Writes a file for each table, `NAME.csv`, and for each road profile, `profile_NUMBER_NAME.csv` with the number of
/// the road among the scene's features. Returns their paths.
fn write_csv_files(scene: &SceneModel, folder: &Path) -> Result<Vec<String>, WriteFileError> {
    let tables = scene.report.tables();
    let tables = tables.iter().map(|table| (table.name.replace(' ', "_"), as_csv(table)));
    let profiles = scene.profiles.iter().map(|profile| {
        let name = profile.name.chars().take(SHOWN_CHARACTERS);
        let name: String = name.map(|at| if at.is_alphanumeric() { at } else { '_' }).collect();
        let separator = if name.is_empty() { "" } else { "_" };
        (format!("profile_{}{separator}{name}", profile.feature.0), profile.csv())
    });
    disk::make_folder(folder)?;
    let mut outputs = OutputFiles::default();
    let mut written = Vec::new();
    for (name, csv) in tables.chain(profiles) {
        let path = folder.join(format!("{name}.csv"));
        disk::check_output(&path, &scene.files)?;
        outputs.write(&path, csv.as_bytes())?;
        written.push(path.display().to_string());
    }
    outputs.publish()?;
    Ok(written)
}

/// A table as CSV (RFC 4180) with a header.
fn as_csv(table: &ReportTable) -> String {
    let header = table.columns.iter().map(|column| quoted(&column.key())).collect::<Vec<_>>().join(",");
    let rows = table.rows.iter().map(|row| row.iter().map(csv_cell).collect::<Vec<_>>().join(","));
    std::iter::once(header).chain(rows).map(|line| line + "\r\n").collect()
}

fn csv_cell(cell: &ReportCell) -> String {
    match cell {
        ReportCell::Text(text) => quoted(text),
        // −0 is written as 0.
        ReportCell::Number(number) => (number + 0.0).to_string(),
        ReportCell::Count(count) => count.to_string(),
        ReportCell::Empty => String::new(),
    }
}

/// A text, in quotes where it needs them.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// A table for a terminal: texts to the left, numbers to the right.
fn printed(table: &ReportTable) -> Vec<String> {
    let mut cells = vec![table.columns.iter().map(ReportColumn::heading).collect::<Vec<_>>()];
    cells.extend(table.rows.iter().take(SHOWN_ROWS).map(|row| row.iter().map(printed_cell).collect()));
    let is_text = |column: usize| table.rows.iter().any(|row| matches!(row[column], ReportCell::Text(_)));
    let mut lines = vec![format!("{} ({})", table.name, table.rows.len())];
    lines.extend(aligned(&cells, is_text).iter().map(|row| format!("  {}", row.trim_end())));
    if table.rows.len() > SHOWN_ROWS {
        lines.push(format!("  … {} more; --csv or --json give all", table.rows.len() - SHOWN_ROWS));
    }
    lines
}

fn printed_cell(cell: &ReportCell) -> String {
    match cell {
        ReportCell::Text(text) => {
            text.chars().take(SHOWN_CHARACTERS).map(|at| if at.is_control() { ' ' } else { at }).collect()
        }
        ReportCell::Number(number) if number.abs() >= 1000.0 => fixed(*number, 0),
        ReportCell::Number(number) => fixed(*number, 2),
        ReportCell::Count(count) => count.to_string(),
        ReportCell::Empty => "-".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_scene::report::TrenchRow;

    fn report(rows: usize) -> SceneReport {
        let name = |row| if row == 0 { "the \"long\", winding one".into() } else { String::new() };
        let row = |row| TrenchRow { name: name(row), length: 2.0, cut: row as f64 * 1234.5 };
        SceneReport { trenches: (0..rows).map(row).collect(), ..SceneReport::default() }
    }

    #[test]
    fn a_table_is_csv_with_a_header_and_quotes_where_they_are_needed() {
        let text = as_csv(&report(2).tables()[0]);
        assert_eq!(text, "name,length_m,cut_m3\r\n\"the \"\"long\"\", winding one\",2,0\r\n,2,1234.5\r\n");
    }

    #[test]
    fn json_holds_every_row_and_print_the_first_of_them() {
        let report = report(30);
        let json = as_json(&report, &["a note"]);
        assert_eq!(json["tables"]["trenches"].as_array().map(Vec::len), Some(30));
        assert_eq!(json["tables"]["trenches"][2]["cut_m3"], json!(2469.0));
        let lines = printed(&report.tables()[0]);
        assert_eq!(lines.len(), 2 + SHOWN_ROWS + 1);
        assert_eq!(lines[1], "  name                     length [m]  cut [m3]");
        assert_eq!(lines[2], "  the \"long\", winding one        2.00      0.00");
        assert!(lines[22].ends_with("10 more; --csv or --json give all"), "{}", lines[22]);
    }
}

//! `sandtable report`: what building a scene found out about single features.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use crate::app::arguments::Access;
use crate::app::failure::CliError;
use crate::app::progress::StepTimer;
use crate::app::{files, load, output};
use crate::scene::Scene;
use crate::scene::report::{ReportCell, ReportColumn, ReportTable, SceneReport};

/// How many rows of a table are printed; a file or JSON holds all.
const SHOWN: usize = 20;

/// `report`.
#[derive(Debug, Args)]
#[command(after_help = "Heights are true to scale, whatever exaggeration the scene asks for.")]
pub struct ReportOptions {
    /// The scene file
    pub scene: PathBuf,
    /// Print one JSON object with every row
    #[arg(long)]
    pub json: bool,
    /// Write every table, and the profile of every road that the ground follows, as CSV files into this folder, which
    /// must be there
    #[arg(long, value_name = "FOLDER", conflicts_with = "json")]
    pub csv: Option<PathBuf>,
    /// Which folders may be read.
    #[command(flatten)]
    pub access: Access,
}

/// Builds the scene and prints or writes its report.
///
/// # Errors
/// Whatever is wrong with the scene; a file cannot be written.
pub fn run(options: &ReportOptions) -> Result<(), CliError> {
    let steps = StepTimer::default();
    let scene = load::unstretched(&options.scene, &options.access, &|step| steps.begin(step))?;
    steps.finish();
    let report = &scene.report;
    if options.json {
        return output::print(&format!("{:#}\n", as_json(report, &scene.notes)));
    }
    if let Some(folder) = &options.csv {
        let mut written = write_tables(report, folder, &scene.files)?;
        written.extend(write_profiles(&scene, folder)?);
        return output::print(&output::text_of(&written));
    }
    let mut lines = vec![format!("{}", options.scene.display())];
    let tables = report.tables();
    tables.iter().for_each(|table| lines.extend(printed(table)));
    if tables.is_empty() {
        lines.push("  nothing to report of single features".into());
    }
    lines.extend(scene.notes.iter().map(|note| format!("  note  {note}")));
    output::print(&output::text_of(&lines))
}

fn as_json(report: &SceneReport, notes: &[String]) -> Value {
    let tables: Map<String, Value> =
        report.tables().iter().map(|table| (table.name.replace(' ', "_"), rows_as_json(table))).collect();
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

/// Writes a file a table, `NAME.csv` with underscores for spaces; returns their places.
fn write_tables(report: &SceneReport, folder: &Path, inputs: &[PathBuf]) -> Result<Vec<String>, CliError> {
    report
        .tables()
        .iter()
        .map(|table| {
            let path = folder.join(format!("{}.csv", table.name.replace(' ', "_")));
            files::check_no_input(&path, inputs)?;
            files::write_whole(&path, as_csv(table).as_bytes())?;
            Ok(path.display().to_string())
        })
        .collect()
}

/// Writes a file a profile, `profile_NUMBER_NAME.csv` with the road's number among the scene's features; returns their
/// places.
fn write_profiles(scene: &Scene, folder: &Path) -> Result<Vec<String>, CliError> {
    let plain = |name: &str| -> String {
        name.chars().take(40).map(|at| if at.is_alphanumeric() { at } else { '_' }).collect()
    };
    scene
        .profiles
        .iter()
        .map(|profile| {
            let name = match plain(&profile.name).as_str() {
                "" => format!("profile_{}.csv", profile.feature.0),
                name => format!("profile_{}_{name}.csv", profile.feature.0),
            };
            let path = folder.join(name);
            files::check_no_input(&path, &scene.files)?;
            files::write_whole(&path, profile.csv().as_bytes())?;
            Ok(path.display().to_string())
        })
        .collect()
}

/// RFC 4180 with a header.
fn as_csv(table: &ReportTable) -> String {
    let header = table.columns.iter().map(|column| quoted(&column.key())).collect::<Vec<_>>().join(",");
    let rows = table.rows.iter().map(|row| row.iter().map(csv_cell).collect::<Vec<_>>().join(","));
    std::iter::once(header).chain(rows).map(|line| line + "\r\n").collect()
}

fn csv_cell(cell: &ReportCell) -> String {
    match cell {
        ReportCell::Text(text) => quoted(text),
        ReportCell::Number(number) => number.to_string(),
        ReportCell::Count(count) => count.to_string(),
        ReportCell::Empty => String::new(),
    }
}

/// A text, in quotes where it needs them.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A table with its columns aligned, names to the left and numbers to the right.
fn printed(table: &ReportTable) -> Vec<String> {
    let header: Vec<String> = table.columns.iter().map(ReportColumn::heading).collect();
    let rows: Vec<Vec<String>> =
        table.rows.iter().take(SHOWN).map(|row| row.iter().map(shown).collect()).collect();
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.chain([header[column].chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let is_text = |column: usize| table.rows.iter().any(|row| matches!(row[column], ReportCell::Text(_)));
    let aligned = |cells: &[String]| -> String {
        let cells = cells.iter().enumerate().map(|(column, cell)| match is_text(column) {
            true => format!("  {cell:<width$}", width = widths[column]),
            false => format!("  {cell:>width$}", width = widths[column]),
        });
        cells.collect::<String>().trim_end().to_owned()
    };
    let mut lines = vec![format!("{} ({})", table.name, table.rows.len()), aligned(&header)];
    lines.extend(rows.iter().map(|row| aligned(row)));
    if table.rows.len() > SHOWN {
        lines.push(format!("  … {} more; --csv or --json give all", table.rows.len() - SHOWN));
    }
    lines
}

fn shown(cell: &ReportCell) -> String {
    match cell {
        ReportCell::Text(text) => {
            text.chars().take(40).map(|at| if at.is_control() { ' ' } else { at }).collect()
        }
        ReportCell::Number(number) if number.abs() >= 1000.0 => format!("{number:.0}"),
        ReportCell::Number(number) => format!("{number:.2}"),
        ReportCell::Count(count) => count.to_string(),
        ReportCell::Empty => "-".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::report::TrenchRow;

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
        let json = as_json(&report, &["a note".into()]);
        assert_eq!(json["tables"]["trenches"].as_array().map(Vec::len), Some(30));
        assert_eq!(json["tables"]["trenches"][2]["cut_m3"], json!(2469.0));
        let lines = printed(&report.tables()[0]);
        assert_eq!(lines.len(), 2 + SHOWN + 1);
        assert_eq!(lines[1], "  name                     length [m]  cut [m3]");
        assert_eq!(lines[2], "  the \"long\", winding one        2.00      0.00");
        assert!(lines[22].ends_with("10 more; --csv or --json give all"), "{}", lines[22]);
    }
}

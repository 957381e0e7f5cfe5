//! What is said of each method: a table, or JSON.

use serde_json::{Value, json};

use crate::app::lod::fly::MEASURED;
use crate::app::lod::method::{LodMethod, name};
use crate::app::lod::prepared::PreparedGround;
use crate::app::lod::way::FlightPath;
use crate::app::output;
use crate::roam::measure::HeightDifference;

/// What one method did on a flight, over all frames but the first.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightReport {
    /// The method.
    pub method: LodMethod,
    /// Frames counted.
    pub frames: usize,
    /// Triangles shown, mean over frames.
    pub triangles: f64,
    /// Triangles shown, the most in any frame.
    pub most_triangles: usize,
    /// Patches in view, the most in any frame.
    pub most_patches: usize,
    /// Vertices that the index lists name, mean over frames: three a triangle, fewer in strips.
    pub vertices_sent: f64,
    /// Triangles shown that were not shown in the frame before, mean over frames.
    pub changed_per_frame: f64,
    /// Milliseconds to bring triangles and lists up to date.
    pub update_ms_median: f64,
    /// The same, in all but one of a hundred frames.
    pub update_ms_p99: f64,
    /// Bytes of the index lists that are sent anew.
    pub upload_bytes_median: usize,
    /// How far what is shown is off the elevation model.
    pub difference: HeightDifference,
}

/// One object a method; differences are null where nothing was in view.
pub fn json(reports: &[FlightReport]) -> Value {
    reports.iter().map(object).collect()
}

fn object(report: &FlightReport) -> Value {
    let (emit, rule, refine) = report.method.parts();
    let tenths = |mean: f64| (mean * 10.0).round() / 10.0;
    json!({
        "method": report.method.to_string(),
        "emit": name(&emit),
        "criterion": rule.as_ref().map(name),
        "refine": refine.as_ref().map(name),
        "frames": report.frames,
        "triangles": report.triangles.round() as u64,
        "triangles_max": report.most_triangles,
        "vertices_sent": report.vertices_sent.round() as u64,
        "changed_per_frame": tenths(report.changed_per_frame),
        "update_ms_median": report.update_ms_median,
        "update_ms_p99": report.update_ms_p99,
        "upload_bytes_median": report.upload_bytes_median,
        "mean_m": report.difference.mean_m(),
        "rms_m": report.difference.rms_m(),
        "max_m": report.difference.max_m(),
        "max_px": report.difference.max_px(),
    })
}

/// What was flown over, a row a method, and what the columns are.
///
/// `budget` is the most triangles that were asked for, instead of a tolerance.
pub fn table(
    reports: &[FlightReport],
    terrain: &PreparedGround,
    way: &FlightPath,
    budget: Option<u32>,
) -> String {
    let lattice = &terrain.lattice;
    let frames = reports.first().map_or(0, |report| report.frames);
    let cell = lattice.cell();
    let goal = match budget {
        Some(most) => format!("triangle budget {most}"),
        None => format!("tolerance {} px", terrain.tolerance_px),
    };
    let mut lines = vec![
        format!(
            "{} × {} posts, {} × {} m apart; {way}, {frames} frames after the first, {goal}",
            lattice.columns(),
            lattice.rows(),
            meters(Some(cell.x)),
            meters(Some(cell.y)),
        ),
        String::new(),
    ];
    let mut cells = vec![HEADING.map(str::to_owned)];
    cells.extend(reports.iter().map(row));
    lines.extend(aligned(&cells));
    lines.push(String::new());
    lines.push(
        "changed: triangles not shown in the frame before; upload: bytes of index lists sent a frame".into(),
    );
    lines.push(format!(
        "mean, rms, max: meters, and pixels, off the elevation model at every post in the picture, in {} frames",
        MEASURED.min(frames + 1)
    ));
    lines.extend(budget.and_then(|most| exceeded(reports, most as usize)));
    output::text_of(&lines)
}

/// What is to be said where a budget cannot be kept.
fn exceeded(reports: &[FlightReport], most: usize) -> Option<String> {
    let roots = 2 * reports.iter().map(|report| report.most_patches).max().unwrap_or(0);
    let found = reports.iter().map(|report| report.most_triangles).max().unwrap_or(0);
    (found > most).then(|| {
        format!(
            "note: up to {found} triangles were shown; two for each patch in view, up to {roots}, are always there"
        )
    })
}

const HEADING: [&str; 11] = [
    "method",
    "triangles",
    "vertices",
    "changed",
    "median ms",
    "p99 ms",
    "upload",
    "mean m",
    "rms m",
    "max m",
    "max px",
];

fn row(report: &FlightReport) -> [String; 11] {
    let difference = &report.difference;
    [
        report.method.to_string(),
        format!("{:.0}", report.triangles),
        format!("{:.0}", report.vertices_sent),
        format!("{:.1}", report.changed_per_frame),
        format!("{:.3}", report.update_ms_median),
        format!("{:.3}", report.update_ms_p99),
        report.upload_bytes_median.to_string(),
        meters(difference.mean_m()),
        meters(difference.rms_m()),
        meters(difference.max_m()),
        difference.max_px().map_or("-".into(), |pixels| format!("{pixels:.2}")),
    ]
}

/// About four digits; a dash for nothing.
fn meters(value: Option<f64>) -> String {
    match value {
        None => "-".into(),
        Some(value) if value >= 1000.0 => format!("{value:.0}"),
        Some(value) if value >= 100.0 => format!("{value:.1}"),
        Some(value) if value >= 10.0 => format!("{value:.2}"),
        Some(value) => format!("{value:.3}"),
    }
}

/// Columns as wide as their widest cell, the first to the left, the others to the right.
fn aligned<const N: usize>(rows: &[[String; N]]) -> Vec<String> {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..N).map(width).collect();
    let line = |row: &[String; N]| {
        let cells = row.iter().enumerate().map(|(column, cell)| match column {
            0 => format!("{cell:<0$}", widths[0]),
            _ => format!("  {cell:>0$}", widths[column]),
        });
        cells.collect::<String>()
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_meters_have_about_four_digits() {
        let rows = [["a".to_owned(), "long".to_owned()], ["method".to_owned(), "7".to_owned()]];
        assert_eq!(aligned(&rows), ["a       long", "method     7"]);
        let written = [0.12345, 12.345, 123.45, 12345.6].map(|value| meters(Some(value)));
        assert_eq!(written, ["0.123", "12.35", "123.5", "12346"]);
        assert_eq!(meters(None), "-");
    }
}

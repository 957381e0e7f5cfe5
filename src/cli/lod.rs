//! `sandtable lod`: level-of-detail methods on the same flight, side by side.

use std::ops::Bound;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use serde_json::{Value, json};

use crate::error::CliError;
use crate::lod_selection::MethodFilter;
use crate::options::HeightArguments;
use crate::output::{aligned, print, print_lines, warn};
use crate::progress::StepTimer;
use crate::values::{choice, number};
use sandtable_base::message::choice::Choice;
use sandtable_files::error::FileError;
use sandtable_query::dem;
use sandtable_query::ground::MetricGround;
use sandtable_walk::lod::flight_path::FlightPath;
use sandtable_walk::lod::flight_run::{FlightPlan, FlightReport, MEASURED};
use sandtable_walk::lod::lod_ground::LodGround;
use sandtable_walk::lod::method::{CriterionKind, Emit, Refine};

#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct LodArguments {
    /// The elevation file; one in degrees is brought to UTM
    pub file: PathBuf,
    /// Only methods that emit their triangles this way
    #[arg(long, value_parser = choice::<Emit>())]
    pub emit: Option<Emit>,
    /// Only methods with this criterion of when an error shows
    #[arg(long, value_parser = choice::<CriterionKind>())]
    pub criterion: Option<CriterionKind>,
    /// Only methods that refine this way
    #[arg(long, value_parser = choice::<Refine>())]
    pub refine: Option<Refine>,
    /// The most pixels that an error may span on a picture 1024 wide
    #[arg(long, value_name = "X", default_value = "1", value_parser = number::<f32>((Bound::Excluded(0.0), Bound::Included(1000.0)), "write a number above 0 and at most 1000, such as 1.5"))]
    pub tolerance_px: f32,
    /// As fine as this number of triangles allows, instead of a tolerance; only methods that refine by queues
    #[arg(long, value_name = "N", conflicts_with = "tolerance_px", value_parser = clap::value_parser!(u32).range(1..))]
    pub budget: Option<u32>,
    /// The path of the flight: circle, line (from the south-west to the north-east), or a file of stations
    #[arg(long, value_name = "circle|line|FILE", default_value = "circle")]
    pub flight: FlightPath,
    /// How many frames the flight has
    #[arg(long, value_name = "N", default_value_t = 240, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub frames: u32,
    /// Print a JSON array with one object per method
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub heights: HeightArguments,
}

const HELP: &str = "\
Flights: the eye of a circle or a line is 30 cells above the ground's mean height along the path and looks 8° down;
a circle advances one cell a frame around the center of the south-western 513 posts. A file has a station a line,
x,y,z,tx,ty,tz: the eye and its target, meters from the south-west post, x east, y north, z the elevation; frames are
spread over it at equal distances.

Methods: without --emit, --criterion, --refine and --budget a selection is compared; with any of them, all methods that
match, with the bintree's triangles where --emit is not given. geomipmap and full have no criterion and no refiner;
deferred goes with spheres, constrained and bounding, and with bintree; a budget goes with queues, and is exceeded only
where the two root triangles of each patch in view are more.

Columns, over all frames but the first: triangles and vertices named by the index lists (means); changed: triangles
that the frame before did not show (mean); milliseconds to bring triangles and lists up to date; upload: bytes of 16-bit
index lists sent a frame (median): of the patches that changed or came into view, or of all that are shown where a
method does not know which stayed the same; full sends nothing after the first frame;
mean, RMS and maximum meters between what is shown and the elevation model, and the maximum on the picture in pixels, at
every post in the picture, hidden ones included, in eight frames.";

pub fn run(arguments: &LodArguments) -> Result<(), CliError> {
    let filter = MethodFilter {
        emit: arguments.emit,
        criterion: arguments.criterion,
        refine: arguments.refine,
        budget: arguments.budget,
    };
    let methods = filter.methods().map_err(CliError::usage)?;
    let steps = StepTimer::default();
    steps.begin("reading elevation");
    let mosaic = dem::open(&arguments.file, &arguments.heights.dem_options())?;
    let warning = dem::warning(&arguments.file, &mosaic);
    let notes = dem::reading_notes(&arguments.file, &mosaic.raster);
    let ground = MetricGround::from_raster(&mosaic.raster).map_err(FileError::at(&arguments.file))?;
    let cameras = arguments.flight.cameras(arguments.frames as usize, &ground.lattice)?;
    steps.begin("measuring terrain");
    let ground =
        LodGround::new(ground.lattice, arguments.tolerance_px).map_err(FileError::at(&arguments.file))?;
    let start = Instant::now();
    let plan = FlightPlan {
        ground: &ground,
        cameras: &cameras,
        budget: arguments.budget.map(|triangles| triangles as usize),
        seconds: &|| start.elapsed().as_secs_f64(),
    };
    let fly = |&method| {
        steps.begin("flying");
        plan.fly(method)
    };
    let reports: Vec<FlightReport> = methods.iter().map(fly).collect();
    steps.finish();
    warning.iter().for_each(|warning| warn(&format!("warning: {warning}")));
    notes.iter().for_each(|note| warn(&format!("note: {note}")));
    if arguments.json {
        let reports: Value = reports.iter().map(json).collect();
        print(&format!("{reports}\n"))
    } else {
        print_lines(&table(&reports, &ground, arguments))
    }
}

/// One object; differences are null where nothing was in view.
fn json(report: &FlightReport) -> Value {
    let tenths = |mean: f64| (mean * 10.0).round() / 10.0;
    json!({
        "method": report.method.to_string(),
        "emit": report.method.emit().word(),
        "criterion": report.method.criterion().map(Choice::word),
        "refine": report.method.refine().map(Choice::word),
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

/// The flight, a row for each method, and an explanation of the columns.
fn table(reports: &[FlightReport], ground: &LodGround, arguments: &LodArguments) -> Vec<String> {
    let lattice = ground.measured.lattice();
    let frames = reports.first().map_or(0, |report| report.frames);
    let goal = match arguments.budget {
        Some(most) => format!("triangle budget {most}"),
        None => format!("tolerance {} px", ground.tolerance_px),
    };
    let [cell_x, cell_y] = lattice.cell().to_array().map(|meters| four_digits(Some(meters)));
    let mut lines = vec![
        format!(
            "{} × {} posts, {cell_x} × {cell_y} m apart; {}, {frames} frames after the first, {goal}",
            lattice.columns(),
            lattice.rows(),
            arguments.flight,
        ),
        String::new(),
    ];
    let mut cells = vec![HEADING.map(str::to_owned).to_vec()];
    cells.extend(reports.iter().map(|report| row(report).to_vec()));
    lines.extend(aligned(&cells, |column| column == 0));
    lines.extend([
        String::new(),
        "changed: triangles not shown in the frame before; upload: bytes of index lists sent a frame".into(),
        format!(
            "mean, rms, max: meters, and pixels, off the elevation model at every post in the picture, in {} frames",
            MEASURED.min(frames + 1)
        ),
    ]);
    lines.extend(arguments.budget.and_then(|most| exceeded(reports, most as usize)));
    lines
}

/// A note where a budget is exceeded.
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
        four_digits(difference.mean_m()),
        four_digits(difference.rms_m()),
        four_digits(difference.max_m()),
        difference.max_px().map_or("-".into(), |pixels| format!("{pixels:.2}")),
    ]
}

/// A value of about four digits; a dash for `None`.
fn four_digits(value: Option<f64>) -> String {
    match value {
        None => "-".into(),
        Some(value) if value >= 1000.0 => format!("{value:.0}"),
        Some(value) if value >= 100.0 => format!("{value:.1}"),
        Some(value) if value >= 10.0 => format!("{value:.2}"),
        Some(value) => format!("{value:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meters_have_about_four_digits() {
        let written = [0.12345, 12.345, 123.45, 12345.6].map(|value| four_digits(Some(value)));
        assert_eq!(written, ["0.123", "12.35", "123.5", "12346"]);
        assert_eq!(four_digits(None), "-");
    }
}

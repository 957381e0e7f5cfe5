//! `sandtable profile`: the ground along a line, as a table or JSON, and as a chart.
//!
//! The line's vertices are brought to the ground's system, and between them the line is straight *there*: a line given in
//! degrees is not the one that would be straight on a map in degrees. Stations are given back in the system asked in.

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use clap::Args;
use glam::DVec2;
use serde_json::{Value, json};

use crate::annotate::chart::ChartText;
use crate::annotate::chart_ground::{ChartGround, ChartPoint};
use crate::annotate::chart_profile::{ProfileChart, paint};
use crate::annotate::nice;
use crate::app::arguments::{Access, InterpolationChoice, PictureSize, StatedHeights};
use crate::app::dataset::Dataset;
use crate::app::failure::CliError;
use crate::app::places::{
    InputLine, PositionList, check_picture_place, on_ground, read_way, spoken, stated_crs,
};
use crate::app::{files, output, picture};
use crate::geom::crs::Crs;
use crate::terrain::profile::{Extreme, ProfileStation, ProfileSummary, Sampling, sampled_profile};
use crate::terrain::query::Answer;

/// More steps than this are no profile that anybody reads, and would fill the memory.
const MOST_STEPS: f64 = 1e7;

/// `profile`.
#[derive(Debug, Args)]
#[command(
    after_help = "The table has station,x,y,height,status a line: meters from the start, the position in the system asked \
                  in, meters. There is a station wherever the ground bends, and on the model's border."
)]
pub struct ProfileOptions {
    /// The elevation file or scene
    pub file: PathBuf,
    /// The line: --line X,Y X,Y and so on; in quotes where one begins with a minus sign
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, required_unless_present = "points")]
    pub line: Vec<PositionList>,
    /// The line's other vertices
    #[arg(value_name = "X,Y", requires = "line", hide = true)]
    pub rest: Vec<PositionList>,
    /// A file with the line: x,y a line of CSV, or the first line of a vector file; - reads CSV from standard input
    #[arg(long, value_name = "FILE", conflicts_with = "line")]
    pub points: Option<PathBuf>,
    /// The coordinate system of the line, for example EPSG:4326 [default: the file's]
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
    /// How heights between posts are found
    #[arg(long, value_enum, default_value = "planar")]
    pub interpolation: InterpolationChoice,
    /// Also a station every so many meters
    #[arg(long, value_name = "METERS", allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Where a chart goes
    #[arg(short, long, value_name = "OUT.png")]
    pub output: Option<PathBuf>,
    /// Size of the chart in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x800")]
    pub size: PictureSize,
    /// Print one JSON object instead of a table
    #[arg(long)]
    pub json: bool,
    /// What gray values mean.
    #[command(flatten)]
    pub heights: StatedHeights,
    /// What may be read.
    #[command(flatten)]
    pub access: Access,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be had or read, has no place in meters, or the line cannot be brought there.
pub fn run(options: &ProfileOptions) -> Result<(), CliError> {
    if let Some(path) = &options.output {
        check_picture_place(path, &options.file)?;
    }
    let dataset = Dataset::open(&options.file, options.heights, &options.access)?;
    let way = way(options, &dataset)?;
    let epoch = dataset.service()?.snapshot();
    let line = way
        .vertices
        .iter()
        .map(|&at| on_ground("the position", &way.crs, epoch.crs(), at))
        .collect::<Result<Vec<_>, _>>()?;
    let sampling = Sampling { interpolation: options.interpolation.into(), step_m: step_m(options, &line)? };
    let stations = sampled_profile(epoch.lattice(), &line, sampling);
    let summary = ProfileSummary::from_stations(&stations);
    let asked = ProfileQuery { crs: &way.crs, ground: epoch.crs() };
    if let Some(path) = &options.output {
        let datum = epoch.source().vertical_datum.as_deref();
        let chart = chart(options, &way, &line, datum, (&stations, &summary));
        let pixels = paint((options.size.width, options.size.height), &chart);
        files::write_whole(path, &picture::png(&pixels)?)?;
    }
    if options.json {
        return output::print(&format!("{}\n", describe(&asked, &stations, &summary)?));
    }
    let rows = asked.positions(&stations)?;
    output::ignore_broken_pipe(write_csv(&stations, &rows))
}

fn way(options: &ProfileOptions, dataset: &Dataset) -> Result<InputLine, CliError> {
    let stated = stated_crs(options.crs.as_deref())?;
    if let Some(path) = &options.points {
        return read_way(path, stated, dataset);
    }
    let vertices: Vec<DVec2> =
        options.line.iter().chain(&options.rest).flat_map(|given| given.0.clone()).collect();
    if vertices.len() < 2 {
        return Err(CliError::Usage("--line needs at least two positions: --line X,Y X,Y".into()));
    }
    Ok(InputLine { vertices, crs: stated.unwrap_or_else(|| dataset.crs()) })
}

fn step_m(options: &ProfileOptions, line: &[DVec2]) -> Result<Option<f64>, CliError> {
    let Some(step_m) = options.step else { return Ok(None) };
    let length_m: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    if !(step_m > 0.0 && step_m.is_finite()) {
        return Err(CliError::Usage(format!("--step {step_m}: give meters above 0")));
    }
    if length_m / step_m > MOST_STEPS {
        let most = MOST_STEPS;
        return Err(CliError::Usage(format!(
            "--step {step_m}: the line is {length_m:.0} m long, and no more than {most} steps are made; take longer ones"
        )));
    }
    Ok(Some(step_m))
}

/// The system that was asked in, and the ground's.
struct ProfileQuery<'a> {
    crs: &'a Crs,
    ground: &'a Crs,
}

impl ProfileQuery<'_> {
    fn position(&self, at: DVec2) -> Result<DVec2, CliError> {
        on_ground("the station at", self.ground, self.crs, at)
    }

    fn positions(&self, stations: &[ProfileStation]) -> Result<Vec<DVec2>, CliError> {
        stations.iter().map(|station| self.position(station.at)).collect()
    }
}

fn write_csv(stations: &[ProfileStation], positions: &[DVec2]) -> io::Result<()> {
    let mut out = BufWriter::new(io::stdout().lock());
    writeln!(out, "station,x,y,height,status")?;
    for (station, at) in stations.iter().zip(positions) {
        let height = station.ground.height_m().map(|height_m| height_m.to_string()).unwrap_or_default();
        writeln!(out, "{},{},{},{height},{}", station.station_m, at.x, at.y, station.ground.status())?;
    }
    out.flush()
}

fn describe(
    asked: &ProfileQuery<'_>,
    stations: &[ProfileStation],
    summary: &ProfileSummary,
) -> Result<Value, CliError> {
    let extreme = |place: Option<Extreme>| match place {
        Some(place) => {
            let at = asked.position(place.at)?;
            Ok(json!({"station": place.station_m, "x": at.x, "y": at.y, "height": place.height_m}))
        }
        None => Ok(Value::Null),
    };
    let positions = asked.positions(stations)?;
    let rows = stations.iter().zip(positions).map(|(station, at)| {
        json!({
            "station": station.station_m,
            "x": at.x,
            "y": at.y,
            "height": station.ground.height_m(),
            "status": station.ground.status(),
        })
    });
    Ok(json!({
        "crs": asked.crs.name(),
        "straight_in": asked.ground.name(),
        "length_m": summary.length_m,
        "covered_m": summary.covered_m,
        "ground_length_m": summary.ground_length_m,
        "ascent_m": summary.ascent_m,
        "descent_m": summary.descent_m,
        "lowest": extreme(summary.lowest)?,
        "highest": extreme(summary.highest)?,
        "stations": rows.collect::<Vec<_>>(),
    }))
}

/// Stations as a chart's points.
pub fn points(stations: &[ProfileStation], height_m: impl Fn(f64, f64) -> f64) -> Vec<ChartPoint> {
    let point = |station: &ProfileStation| ChartPoint {
        along_m: station.station_m,
        ground: match station.ground {
            Answer::Height(height) => ChartGround::Height(height_m(station.station_m, height)),
            Answer::NoData => ChartGround::NoData,
            Answer::Outside => ChartGround::Outside,
        },
    };
    stations.iter().map(point).collect()
}

/// What a chart calls the file.
pub fn file_title(what: &str, file: &std::path::Path) -> String {
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    format!("{what} · {name}")
}

fn chart(
    options: &ProfileOptions,
    way: &InputLine,
    line: &[DVec2],
    datum: Option<&str>,
    (stations, summary): (&[ProfileStation], &ProfileSummary),
) -> ProfileChart {
    let [first, last] = [way.vertices.first(), way.vertices.last()].map(|at| at.copied().unwrap_or_default());
    let climbs = format!(
        "{} long, climbs {} m and falls {} m",
        nice::format_distance(summary.length_m),
        nice::format_number(summary.ascent_m, 0),
        nice::format_number(summary.descent_m, 0)
    );
    let missing_m = summary.length_m - summary.covered_m;
    let bare = if missing_m > 0.5 {
        format!("; {} without ground", nice::format_distance(missing_m))
    } else {
        String::new()
    };
    ProfileChart {
        text: ChartText {
            title: file_title("Profile", &options.file),
            subtitle: climbs + &bare,
            height_axis: datum.map_or("Height (m)".into(), |datum| format!("Height (m, {datum})")),
            along_axis: "Distance along the line".into(),
            start: format!("A  {}", spoken(&way.crs, first)),
            end: format!("{}  B", spoken(&way.crs, last)),
        },
        points: points(stations, |_, height_m| height_m),
        bends_m: bends_m(line),
    }
}

/// Where the line has vertices between its ends, meters along it.
fn bends_m(line: &[DVec2]) -> Vec<f64> {
    let lengths = line.windows(2).map(|pair| pair[0].distance(pair[1]));
    let mut reached: Vec<f64> = lengths
        .scan(0.0, |walked_m, length_m| {
            *walked_m += length_m;
            Some(*walked_m)
        })
        .collect();
    reached.pop();
    reached
}

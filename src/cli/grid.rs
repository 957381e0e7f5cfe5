//! `sandtable dem grid`: a grid of scattered points.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glam::DVec2;

use crate::error::CliError;
use crate::output::print_summary;
use crate::output_format::raster_format;
use crate::progress::StepTimer;
use crate::values::{choice, numbers};
use sandtable_dem::gridding::error::GridError;
use sandtable_dem::gridding::method::GriddingMethod;
use sandtable_dem::gridding::{self, BeyondHull, Gridded};
use sandtable_dem::points::cloud::PointCloud;
use sandtable_dem::written::WrittenDem;
use sandtable_files::error::FileError;
use sandtable_files::raster_file;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_query::gridding::PointSources;
use sandtable_raster::cell_grid::CellGrid;
use sandtable_raster::unstated_unit;

#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct GridArguments {
    /// Files of points, one or more, then the grid to write: .tif, .asc, .flt, .bil, .bt, .xyz, .hgt, .dt0, .dt1, .dt2 or .png
    #[arg(value_names = ["POINTS", "OUT"], num_args = 2.., required = true)]
    pub files: Vec<PathBuf>,
    /// The side of a cell, in the unit of the points' x and y
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub cell: f64,
    /// The gridding method
    #[arg(long, value_enum, default_value_t)]
    pub method: MethodWord,
    /// A file of lines with elevations that the ground breaks along; may be given several times
    #[arg(long, value_name = "FILE")]
    pub breaklines: Vec<PathBuf>,
    /// Take LAS points of this class only; may be a list, such as 2,9 [default: 2, ground, where the file has it]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    pub class: Vec<u8>,
    /// The coordinate system of the points, in place of the ones that their files state, for example EPSG:32633
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
    /// What to cover [default: the points, out to multiples of the cell]
    #[arg(long, value_name = "W,S,E,N", allow_hyphen_values = true, value_parser = extent)]
    pub extent: Option<Rect>,
    /// The value of cells outside the convex hull of the points
    #[arg(long, default_value = "nodata", value_parser = choice::<BeyondHull>())]
    pub beyond_hull: BeyondHull,
    /// The power of the distance by which weights fall; for idw and quadrant [default: 2 for idw, 1 for quadrant]
    #[arg(long, value_name = "P", allow_negative_numbers = true)]
    pub power: Option<f64>,
    /// How many of the nearest points; for idw [default: 12]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub k: Option<u32>,
}

const HELP: &str = "\
Points: text (.xyz, .csv, .txt; x, y, z with or without a header), LAS and LAZ, and vector files whose points have
elevations (lines and polygons in them give their vertices). Files in different coordinate systems are brought to the
first one's. Points that share their x and y become one of their mean height.

Methods: tin takes the plane through the corners of the Delaunay triangle around a cell's center, and breaklines are
edges of triangles; natural weighs natural neighbors by the area that they would lose (Sibson); idw weighs the k nearest
points by distance; quadrant weighs the nearest point of each of four quadrants; nearest takes the nearest. All but tin
take points along breaklines instead of edges.

Heights are written in meters.";

/// The format that files of points may have as well.
const POINTS_FORMAT: &str = "XYZ grid";

/// A method of gridding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MethodWord {
    /// Planes of a triangulation that keeps breaklines
    #[default]
    Tin,
    /// Natural neighbors
    Natural,
    /// Inverse distance, k nearest points
    Idw,
    /// Inverse distance, the nearest point of each quadrant
    Quadrant,
    /// The nearest point
    Nearest,
}

impl MethodWord {
    fn word(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}

/// Parses west, south, east and north.
fn extent(text: &str) -> Result<Rect, &'static str> {
    match numbers(text).as_deref() {
        Some(&[west, south, east, north]) if west < east && south < north => {
            Ok(Rect { min: DVec2::new(west, south), max: DVec2::new(east, north) })
        }
        Some(&[_, _, _, _]) => Err("west must lie below east and south below north"),
        _ => Err("write west,south,east,north as in 0,0,1000,500"),
    }
}

/// Writes the grid and prints a summary.
pub fn run(arguments: &GridArguments) -> Result<(), CliError> {
    let (out, points) =
        arguments.files.split_last().ok_or_else(|| CliError::input("name points and a grid"))?;
    let method = method(arguments)?;
    let inputs: Vec<PathBuf> = points.iter().chain(&arguments.breaklines).cloned().collect();
    let format = raster_format(out, &inputs)?;
    if format.name == POINTS_FORMAT && out.exists() {
        return Err(CliError::input(format!(
            "{}: it may be points to read, and would be written over; name the grid after the points, or remove the file",
            out.display()
        )));
    }
    let crs = arguments.crs.as_deref().map(Crs::parse).transpose();
    let crs = crs.map_err(|error| CliError::input(format!("--crs: {error}")))?;
    let steps = StepTimer::default();
    steps.begin("reading points");
    let sources = PointSources { points, breaklines: &arguments.breaklines, crs, classes: &arguments.class };
    let cloud = sources.open()?;
    steps.begin("making the grid");
    let gridded = grid(arguments, &cloud, method).map_err(FileError::at(&points[0]))?;
    steps.begin("writing");
    let written = raster_file::write(&gridded.raster, format, out, &inputs)?;
    steps.finish();
    let summary = summary(out, arguments.method, &cloud, &gridded, &written);
    print_summary(&[summary.trim_end().to_owned()])
}

fn method(arguments: &GridArguments) -> Result<GriddingMethod, CliError> {
    let wrong = |option: &str, goes_with: &str| {
        let word = arguments.method.word();
        Err(CliError::input(format!("--{option} goes with --method {goes_with}, not with {word}")))
    };
    let has_power = matches!(arguments.method, MethodWord::Idw | MethodWord::Quadrant);
    if arguments.k.is_some() && arguments.method != MethodWord::Idw {
        return wrong("k", "idw");
    }
    if arguments.power.is_some() && !has_power {
        return wrong("power", "idw or quadrant");
    }
    let power = |default: f64| arguments.power.unwrap_or(default);
    Ok(match arguments.method {
        MethodWord::Tin => GriddingMethod::Tin,
        MethodWord::Natural => GriddingMethod::Natural,
        MethodWord::Idw => {
            GriddingMethod::InverseDistance { k: arguments.k.unwrap_or(12), power: power(2.0) }
        }
        MethodWord::Quadrant => GriddingMethod::Quadrant { power: power(1.0) },
        MethodWord::Nearest => GriddingMethod::Nearest,
    })
}

fn grid(arguments: &GridArguments, cloud: &PointCloud, method: GriddingMethod) -> Result<Gridded, GridError> {
    let vertices = cloud.points.iter().chain(cloud.breaklines.iter().flatten());
    let extent = Rect::around(vertices.map(|point| point.truncate()));
    let cells = match arguments.extent {
        Some(extent) => CellGrid::within(extent, arguments.cell)?,
        None => CellGrid::around(extent, arguments.cell)?,
    };
    gridding::grid(cloud, &cells, method, arguments.beyond_hull)
}

fn summary(
    out: &Path,
    method: MethodWord,
    cloud: &PointCloud,
    gridded: &Gridded,
    written: &WrittenDem,
) -> String {
    let (report, raster) = (&gridded.report, &gridded.raster);
    let crs = raster.crs.as_ref().map_or("not stated", Crs::name);
    let cells = u64::from(raster.width) * u64::from(raster.height);
    let mut rows = vec![
        ("file", out.display().to_string()),
        ("method", method.word()),
        ("points", report.points.to_string()),
        ("duplicates", report.duplicates.to_string()),
        ("breaklines", report.breaklines.to_string()),
        ("size", format!("{} x {} cells", raster.width, raster.height)),
        ("cells with data", format!("{} of {cells}", report.filled)),
        ("coordinates", crs.to_owned()),
    ];
    if report.filled == 0 {
        rows.push(("note", "no cell's center lies between the points: choose a smaller --cell".into()));
    }
    let crossings = report.crossings;
    if crossings.count > 0 {
        let gap_m = crossings.largest_gap * raster.meters_per_z;
        let apart = format!("{} times, up to {gap_m:.3} m apart", crossings.count);
        rows.push(("note", format!("breaklines cross {apart}: the mean was taken")));
    }
    let unit = unstated_unit::note(raster);
    rows.extend(cloud.notes.iter().chain(&unit).chain(&written.notes).map(|note| ("note", note.clone())));
    rows.iter().map(|(name, value)| format!("{name:<16} {value}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_are_west_south_east_north() {
        let rect = Rect { min: DVec2::new(-1.5, 2.0), max: DVec2::new(3.0, 1e3) };
        assert_eq!(extent("-1.5, 2,3,1e3"), Ok(rect));
        for wrong in ["1,2,3", "3,2,1,4", "1,2,3,north", "0,0,inf,1", "0,nan,1,1", ""] {
            assert!(extent(wrong).is_err(), "{wrong}");
        }
    }
}

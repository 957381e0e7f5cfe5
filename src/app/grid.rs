//! `sandtable dem grid`: a grid of scattered points.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, ValueEnum};
use glam::{DVec2, DVec3};

use crate::app::failure::CliError;
use crate::app::progress::StepTimer;
use crate::app::{files, output, rasters};
use crate::dem::cell_grid::CellGrid;
use crate::dem::gridding::{self, BeyondHull, Gridded, GriddingMethod};
use crate::dem::points::{self, PointCloud};
use crate::dem::write::WrittenDem;
use crate::geom::crs::Crs;
use crate::geom::rect::Rect;
use crate::vector::feature::{Feature, Geometry, VectorLayer};
use crate::vector::hints::VectorHints;
use crate::vector::read as vector;

/// `dem grid`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct GridOptions {
    /// Files of points, one or more, then the grid to write: .tif, .asc, .bt, .hgt or .png
    #[arg(value_names = ["POINTS", "OUT"], num_args = 2.., required = true)]
    pub files: Vec<PathBuf>,
    /// The side of a cell, in the unit of the points' x and y
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub cell: f64,
    /// How heights between the points are found
    #[arg(long, value_enum, default_value_t)]
    pub method: MethodChoice,
    /// A file of lines with elevations that the ground breaks along; may be given several times
    #[arg(long, value_name = "FILE")]
    pub breaklines: Vec<PathBuf>,
    /// Take LAS points of this class only; may be a list, such as 2,9 [default: 2, ground, where the file has it]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    pub class: Vec<u8>,
    /// The coordinate system of the points, in place of what their files say, for example EPSG:32633
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
    /// What to cover [default: the points, out to multiples of the cell]
    #[arg(long, value_name = "W,S,E,N", allow_hyphen_values = true)]
    pub extent: Option<GridExtent>,
    /// What cells outside the convex hull of the points hold
    #[arg(long, value_enum, default_value_t)]
    pub beyond_hull: BeyondChoice,
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

/// A method by its name on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MethodChoice {
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

impl MethodChoice {
    fn name(self) -> &'static str {
        match self {
            Self::Tin => "tin",
            Self::Natural => "natural",
            Self::Idw => "idw",
            Self::Quadrant => "quadrant",
            Self::Nearest => "nearest",
        }
    }
}

/// What lies beyond the hull, by its name on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum BeyondChoice {
    /// No data
    #[default]
    Nodata,
    /// The nearest point's height
    Nearest,
}

/// West, south, east and north.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridExtent(Rect);

impl FromStr for GridExtent {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides: Result<Vec<f64>, _> = text.split(',').map(|side| side.trim().parse::<f64>()).collect();
        match sides.as_deref() {
            Ok(&[west, south, east, north])
                if west < east && south < north && (east - west + north - south).is_finite() =>
            {
                Ok(Self(Rect { min: DVec2::new(west, south), max: DVec2::new(east, north) }))
            }
            Ok(&[_, _, _, _]) => Err("west must lie below east and south below north".into()),
            _ => Err("write west,south,east,north as in 0,0,1000,500".into()),
        }
    }
}

/// Runs the command: prints what the grid was made of.
///
/// # Errors
/// A file cannot be had or read, the points make no grid, or it cannot be written.
pub fn run(options: &GridOptions) -> Result<(), CliError> {
    let (out, inputs) =
        options.files.split_last().ok_or_else(|| CliError::input("name points and a grid"))?;
    let method = method(options)?;
    let read: Vec<PathBuf> = inputs.iter().chain(&options.breaklines).cloned().collect();
    let format = rasters::format_of(out, &read)?;
    let steps = StepTimer::default();
    steps.begin("reading points");
    let cloud = read_all(inputs, options)?;
    steps.begin("making the grid");
    let extent = cloud.points.iter().chain(cloud.breaklines.iter().flatten()).map(|point| point.truncate());
    let frame = match options.extent {
        Some(GridExtent(extent)) => CellGrid::within(extent, options.cell),
        None => CellGrid::around(Rect::around(extent), options.cell),
    };
    let beyond = match options.beyond_hull {
        BeyondChoice::Nodata => BeyondHull::NoData,
        BeyondChoice::Nearest => BeyondHull::Nearest,
    };
    let gridded = frame
        .map_err(gridding::GridError::from)
        .and_then(|frame| gridding::grid(&cloud, &frame, method, beyond))
        .map_err(|error| CliError::input(format!("{}: {error}", inputs[0].display())))?;
    steps.begin("writing");
    let written = rasters::write(&gridded.raster, format, out, &read)?;
    steps.finish();
    output::print(&summary(&cloud, &gridded, options.method, (out, &written)))
}

fn method(options: &GridOptions) -> Result<GriddingMethod, CliError> {
    let wrong = |what: &str, goes_with: &str| {
        let name = options.method.name();
        Err(CliError::input(format!("--{what} goes with --method {goes_with}, not with {name}")))
    };
    let power = |default: f64| options.power.unwrap_or(default);
    match options.method {
        MethodChoice::Idw => {}
        _ if options.k.is_some() => return wrong("k", "idw"),
        MethodChoice::Quadrant => {}
        _ if options.power.is_some() => return wrong("power", "idw or quadrant"),
        MethodChoice::Tin | MethodChoice::Natural | MethodChoice::Nearest => {}
    }
    Ok(match options.method {
        MethodChoice::Tin => GriddingMethod::Tin,
        MethodChoice::Natural => GriddingMethod::Natural,
        MethodChoice::Idw => {
            GriddingMethod::InverseDistance { k: options.k.unwrap_or(12), power: power(2.0) }
        }
        MethodChoice::Quadrant => GriddingMethod::Quadrant { power: power(1.0) },
        MethodChoice::Nearest => GriddingMethod::Nearest,
    })
}

/// All points and breaklines, in the system of the first file.
fn read_all(inputs: &[PathBuf], options: &GridOptions) -> Result<PointCloud, CliError> {
    let stated = match &options.crs {
        Some(text) => Some(Crs::parse(text).map_err(|error| CliError::input(format!("--crs: {error}")))?),
        None => None,
    };
    let mut all: Option<PointCloud> = None;
    for path in inputs {
        let cloud = read_points(path, stated.as_ref(), &options.class)?;
        all = Some(match all {
            Some(all) => joined(all, cloud)
                .map_err(|reason| CliError::input(format!("{}: {reason}", path.display())))?,
            None => cloud,
        });
    }
    let mut all = all.ok_or_else(|| CliError::input("name points and a grid"))?;
    for path in &options.breaklines {
        let lines = read_breaklines(path, stated.as_ref())?;
        all =
            joined(all, lines).map_err(|reason| CliError::input(format!("{}: {reason}", path.display())))?;
    }
    Ok(all)
}

fn read_points(path: &Path, crs: Option<&Crs>, classes: &[u8]) -> Result<PointCloud, CliError> {
    let bytes = files::read(path)?;
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    if points::recognizes(&name, &bytes) {
        let wrong = |error| CliError::input(format!("{}: {error}", path.display()));
        return points::read(&bytes, &points::PointHints { crs, classes }).map_err(wrong);
    }
    let layer = read_layer(path, &name, &bytes, crs)?;
    let points: Vec<DVec3> =
        layer.features.iter().flat_map(|feature| vertices(feature).collect::<Vec<_>>()).collect();
    if points.is_empty() {
        let reason = "no point in it has an elevation; points with a z are needed";
        return Err(CliError::input(format!("{}: {reason}", path.display())));
    }
    Ok(of_layer(layer, points, Vec::new()))
}

fn read_breaklines(path: &Path, crs: Option<&Crs>) -> Result<PointCloud, CliError> {
    let bytes = files::read(path)?;
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let layer = read_layer(path, &name, &bytes, crs)?;
    let lines: Vec<Vec<DVec3>> = layer.features.iter().flat_map(breaklines).collect();
    if lines.is_empty() {
        let reason = "no line in it has an elevation at every vertex; breaklines with a z are needed";
        return Err(CliError::input(format!("{}: {reason}", path.display())));
    }
    Ok(of_layer(layer, Vec::new(), lines))
}

fn read_layer(path: &Path, name: &str, bytes: &[u8], crs: Option<&Crs>) -> Result<VectorLayer, CliError> {
    let beside = files::beside(path);
    let hints = VectorHints { crs, companions: &beside, ..VectorHints::default() };
    vector::read(name, bytes, &hints).map_err(|error| CliError::input(format!("{}: {error}", path.display())))
}

fn of_layer(layer: VectorLayer, points: Vec<DVec3>, breaklines: Vec<Vec<DVec3>>) -> PointCloud {
    PointCloud { breaklines, crs: Some(layer.crs), notes: layer.notes, ..PointCloud::new(points) }
}

/// The vertices of a feature that have an elevation.
fn vertices(feature: &Feature) -> impl Iterator<Item = DVec3> + '_ {
    let elevations = feature.elevations.as_deref().unwrap_or_default();
    let vertices = feature.geometry.vertices().zip(elevations);
    vertices.map(|(at, &z)| at.extend(z)).filter(|vertex| vertex.is_finite())
}

/// The lines of a feature, and the borders of its polygons, where every vertex has an elevation.
fn breaklines(feature: &Feature) -> Vec<Vec<DVec3>> {
    let elevations = feature.elevations.as_deref().unwrap_or_default();
    let mut heights = elevations.iter().copied().chain(std::iter::repeat(f64::NAN));
    let mut line = |part: &[DVec2]| -> Vec<DVec3> {
        part.iter().map(|at| at.extend(heights.next().unwrap_or(f64::NAN))).collect()
    };
    let lines: Vec<Vec<DVec3>> = match &feature.geometry {
        Geometry::Points(_) => Vec::new(),
        Geometry::Lines(lines) => lines.iter().map(|part| line(part)).collect(),
        Geometry::Polygons(polygons) => {
            let rings =
                polygons.iter().flat_map(|polygon| std::iter::once(&polygon.exterior).chain(&polygon.holes));
            let closed = |mut ring: Vec<DVec3>| {
                ring.extend(ring.first().copied());
                ring
            };
            rings.map(|ring| closed(line(ring))).collect()
        }
    };
    lines.into_iter().filter(|line| line.len() > 1 && line.iter().all(|vertex| vertex.is_finite())).collect()
}

/// Two clouds in the system and the unit of the first.
fn joined(mut first: PointCloud, mut second: PointCloud) -> Result<PointCloud, String> {
    if let (Some(to), Some(from)) = (&first.crs, &second.crs)
        && to != from
    {
        for point in second.points.iter_mut().chain(second.breaklines.iter_mut().flatten()) {
            let at = from.transform(to, point.truncate()).map_err(|error| error.to_string())?;
            *point = at.extend(point.z);
        }
    }
    let factor = second.meters_per_z / first.meters_per_z;
    for point in
        second.points.iter_mut().chain(second.breaklines.iter_mut().flatten()).filter(|_| factor != 1.0)
    {
        point.z *= factor;
    }
    first.points.append(&mut second.points);
    first.breaklines.append(&mut second.breaklines);
    first.crs = first.crs.or(second.crs);
    first.vertical_datum = first.vertical_datum.or(second.vertical_datum);
    first.notes.append(&mut second.notes);
    Ok(first)
}

fn summary(
    cloud: &PointCloud,
    gridded: &Gridded,
    method: MethodChoice,
    (out, written): (&Path, &WrittenDem),
) -> String {
    let (report, raster) = (&gridded.report, &gridded.raster);
    let crs = raster.crs.as_ref().map_or("not stated", Crs::name);
    let cells = u64::from(raster.width) * u64::from(raster.height);
    let mut rows = vec![
        ("file", out.display().to_string()),
        ("method", method.name().into()),
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
        let gap = crossings.largest_gap * raster.meters_per_z;
        let told =
            format!("breaklines cross {} times, up to {gap:.3} m apart: the mean was taken", crossings.count);
        rows.push(("note", told));
    }
    rows.extend(cloud.notes.iter().chain(&written.notes).map(|note| ("note", note.clone())));
    rows.iter().map(|(name, value)| format!("{name:<16} {value}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_are_west_south_east_north() {
        let rect = Rect { min: DVec2::new(-1.5, 2.0), max: DVec2::new(3.0, 1e3) };
        assert_eq!("-1.5, 2,3,1e3".parse(), Ok(GridExtent(rect)));
        for wrong in ["1,2,3", "3,2,1,4", "1,2,3,north", "0,0,inf,1", "0,nan,1,1", ""] {
            assert!(wrong.parse::<GridExtent>().is_err(), "{wrong}");
        }
    }
}

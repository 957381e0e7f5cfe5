//! 100,000 random points to 1025 × 1025 cells: ours, `spade` as it comes, GDAL and SciPy.
//!
//! Points lie at random on a fractal of posts one apart, heights between the posts bilinear; the same bilinear heights
//! at the cells' centers, which are the posts, are the truth that errors are told against. Our times are all in: from a
//! cloud to a raster. GDAL's are those of its whole process, which reads the points as text; SciPy's and startin's
//! are of the calls alone.

use glam::{DVec2, DVec3};
use sandtable_dem::gridding::method::GriddingMethod;
use sandtable_dem::gridding::{self, BeyondHull};
use sandtable_dem::points::cloud::PointCloud;
use sandtable_geom::rect::Rect;
use sandtable_raster::cell_grid::CellGrid;
use spade::{
    DelaunayTriangulation, FloatTriangulation, HasPosition, LastUsedVertexHintGenerator, Point2,
    Triangulation,
};

use crate::rounds::{ROUNDS, interleaved, median, ratio, time_ms};
use crate::{fields, peers};

const POINTS: usize = 100_000;
const SIDE: usize = 1025;

/// Rounds with peers that take a quarter of a minute each.
const SLOW_ROUNDS: usize = 3;

/// Prints all rows.
pub fn print() {
    let field = fields::fractal(SIDE);
    let points = points(&field);
    let cloud = PointCloud {
        points: points.clone(),
        breaklines: Vec::new(),
        crs: None,
        meters_per_z: 1.0,
        vertical_datum: None,
        notes: Vec::new(),
    };
    let extent = Rect { min: DVec2::splat(-0.5), max: DVec2::splat(SIDE as f64 - 0.5) };
    let frame = CellGrid::within(extent, 1.0).expect("a lattice");
    let ours =
        |method: GriddingMethod| gridding::grid(&cloud, &frame, method, BeyondHull::NoData).expect("a grid");
    let by_distance = GriddingMethod::InverseDistance { k: 12, power: 2.0 };
    println!(
        "{POINTS} points to {SIDE} x {SIDE} cells; medians of {ROUNDS} rounds, ratio = peer / ours in a round\n"
    );

    let values = interleaved(
        ROUNDS,
        &mut [
            &mut || time_ms(|| ours(GriddingMethod::Tin)),
            &mut || time_ms(|| spade_linear(&points)),
            &mut || time_ms(|| ours(GriddingMethod::Natural)),
            &mut || time_ms(|| spade_natural(&points)),
            &mut || time_ms(|| ours(by_distance)),
            &mut || time_ms(|| ours(GriddingMethod::Quadrant { power: 1.0 })),
            &mut || time_ms(|| ours(GriddingMethod::Nearest)),
            &mut || time_ms(|| triangulation(&points)),
        ],
    );
    let heights = |method: GriddingMethod| ours(method).raster.samples.iter().collect::<Vec<f64>>();
    let rows = [
        ("TIN-linear", heights(GriddingMethod::Tin)),
        ("  spade barycentric", north_up(&spade_linear(&points))),
        ("natural neighbor", heights(GriddingMethod::Natural)),
        ("  spade natural neighbor", north_up(&spade_natural(&points))),
        ("12 nearest, inverse square", heights(by_distance)),
        ("nearest by quadrant", heights(GriddingMethod::Quadrant { power: 1.0 })),
        ("nearest", heights(GriddingMethod::Nearest)),
    ];
    for (index, (name, heights)) in rows.iter().enumerate() {
        let peer = name.starts_with("  ");
        let ratio =
            if peer { format!("  {:.2}x", ratio(&values[index], &values[index - 1])) } else { String::new() };
        println!(
            "{name:<28} {:>9.1} ms   RMS error {:.4}{ratio}",
            median(&values[index]),
            rms(heights, &field)
        );
    }
    println!(
        "{:<28} {:>9.1} ms   of spade's two, and of ours by triangles",
        "Delaunay by spade",
        median(&values[7])
    );
    for (one, other) in [(0, 1), (2, 3)] {
        let (ours, spades) = (&rows[one].1, &rows[other].1);
        println!("{} differs from spade's by at most {:.2e}", rows[one].0, largest_difference(ours, spades));
    }
    println!();
    beside_python(&points, &ours);
    beside_gdal(&points, &ours, by_distance);
}

fn beside_python(points: &[DVec3], ours: &dyn Fn(GriddingMethod) -> gridding::Gridded) {
    let Some(python) = peers::python() else { return };
    let table = table(points);
    let mut scipy = Vec::new();
    let mut startin = Vec::new();
    let values = interleaved(
        SLOW_ROUNDS,
        &mut [
            &mut || {
                let times = peers::script(&python, "gridding.py", &[&table, &SIDE.to_string()]);
                startin.push(times.get(1).copied().unwrap_or(f64::NAN));
                scipy.push(times.first().copied().unwrap_or(f64::NAN));
                0.0
            },
            &mut || time_ms(|| ours(GriddingMethod::Tin)),
            &mut || time_ms(|| ours(GriddingMethod::Natural)),
        ],
    );
    row("scipy griddata linear", &scipy, &values[1]);
    row("startin natural neighbor", &startin, &values[2]);
}

fn beside_gdal(
    points: &[DVec3],
    ours: &dyn Fn(GriddingMethod) -> gridding::Gridded,
    by_distance: GriddingMethod,
) {
    if !peers::is_there("gdal_grid") {
        return;
    }
    let layer = layer(&table(points));
    let out = peers::folder().join("gridding.tif").display().to_string();
    let gdal = |algorithm: &str| {
        let last = format!("{}", SIDE as f64 - 0.5);
        let size = SIDE.to_string();
        let mut arguments =
            vec!["-q", "-ot", "Float32", "-zfield", "z", "-l", "gridding", "-outsize", &size, &size];
        arguments.extend(["-txe", "-0.5", &last, "-tye", "-0.5", &last, "-a", algorithm, &layer, &out]);
        time_ms(|| peers::run("gdal_grid", &arguments))
    };
    let values = interleaved(
        SLOW_ROUNDS,
        &mut [
            &mut || gdal("linear:radius=-1"),
            &mut || time_ms(|| ours(GriddingMethod::Tin)),
            &mut || gdal("invdistnn:radius=20:max_points=12"),
            &mut || time_ms(|| ours(by_distance)),
        ],
    );
    row("gdal_grid linear", &values[0], &values[1]);
    row("gdal_grid invdistnn, 12", &values[2], &values[3]);
}

fn row(name: &str, theirs: &[f64], ours: &[f64]) {
    println!(
        "  {name:<26} {:>9.1} ms  {:.1}x of ours, {:.1} ms beside it",
        median(theirs),
        ratio(theirs, ours),
        median(ours)
    );
}

/// The points as text, written once a run.
fn table(points: &[DVec3]) -> String {
    let mut text = String::from("x,y,z\n");
    for point in points {
        text.push_str(&format!("{:.4},{:.4},{:.4}\n", point.x, point.y, point.z));
    }
    let path = peers::folder().join("gridding.csv");
    std::fs::write(&path, text).expect("the folder can be written");
    path.display().to_string()
}

/// What tells GDAL which columns of the table are coordinates.
fn layer(table: &str) -> String {
    let text = format!(
        "<OGRVRTDataSource><OGRVRTLayer name=\"gridding\"><SrcDataSource>{table}</SrcDataSource>\
         <GeometryType>wkbPoint</GeometryType><GeometryField encoding=\"PointFromColumns\" x=\"x\" y=\"y\"/>\
         <Field name=\"z\" type=\"Real\"/></OGRVRTLayer></OGRVRTDataSource>"
    );
    let path = peers::folder().join("gridding.vrt");
    std::fs::write(&path, text).expect("the folder can be written");
    path.display().to_string()
}

/// Points at random places of the field, with its bilinear heights.
fn points(field: &[f32]) -> Vec<DVec3> {
    let mut state = 777u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * (SIDE - 1) as f64
    };
    (0..POINTS)
        .map(|_| {
            let (x, y) = (next(), next());
            DVec3::new(x, y, bilinear(field, x, y))
        })
        .collect()
}

fn bilinear(field: &[f32], x: f64, y: f64) -> f64 {
    let (column, row) = ((x as usize).min(SIDE - 2), (y as usize).min(SIDE - 2));
    let (u, v) = (x - column as f64, y - row as f64);
    let at = |column: usize, row: usize| f64::from(field[row * SIDE + column]);
    let south = at(column, row) + u * (at(column + 1, row) - at(column, row));
    let north = at(column, row + 1) + u * (at(column + 1, row + 1) - at(column, row + 1));
    south + v * (north - south)
}

struct Vertex(Point2<f64>, f64);

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.0
    }
}

type Web = DelaunayTriangulation<Vertex, (), (), (), LastUsedVertexHintGenerator>;

fn triangulation(points: &[DVec3]) -> Web {
    let vertices = points.iter().map(|point| Vertex(Point2::new(point.x, point.y), point.z));
    Web::bulk_load(vertices.collect()).expect("the points are sound")
}

/// Heights row by row from the south, NaN outside the hull.
fn spade_linear(points: &[DVec3]) -> Vec<f64> {
    let web = triangulation(points);
    let linear = web.barycentric();
    posts().map(|at| linear.interpolate(|vertex| vertex.data().1, at).unwrap_or(f64::NAN)).collect()
}

/// As [`spade_linear`].
fn spade_natural(points: &[DVec3]) -> Vec<f64> {
    let web = triangulation(points);
    let natural = web.natural_neighbor();
    posts().map(|at| natural.interpolate(|vertex| vertex.data().1, at).unwrap_or(f64::NAN)).collect()
}

fn posts() -> impl Iterator<Item = Point2<f64>> {
    (0..SIDE * SIDE).map(|index| Point2::new((index % SIDE) as f64, (index / SIDE) as f64))
}

fn north_up(heights: &[f64]) -> Vec<f64> {
    heights.chunks(SIDE).rev().flatten().copied().collect()
}

/// Against the field, over the cells that hold a height; rows from the north.
fn rms(heights: &[f64], field: &[f32]) -> f64 {
    let truth = field.chunks(SIDE).rev().flatten();
    let errors = heights.iter().zip(truth).map(|(height, truth)| height - f64::from(*truth));
    let errors: Vec<f64> = errors.filter(|error| !error.is_nan()).collect();
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}

fn largest_difference(one: &[f64], other: &[f64]) -> f64 {
    one.iter()
        .zip(other)
        .map(|(one, other)| (one - other).abs())
        .filter(|gap| !gap.is_nan())
        .fold(0.0, f64::max)
}

//! Library, command line and service say the same, bit for bit, on real elevation models.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use glam::DVec2;
use sandtable_geom::crs::Crs;
use sandtable_query::dataset::{Dataset, DatasetOptions};
use sandtable_query::ground::QueriedGround;
use sandtable_query::windowed_elevation::GroundReach;
use sandtable_terrain::query::{Interpolation, Surface};

use crate::common::data::data;
use crate::serve::client::{Server, numbers, strings};

/// Elevation models in degrees and in meters, with and without a system, with no-data.
const FILES: [&str; 6] = [
    "dem/zion_srtm_u16_deflate.tif",
    "dem/bigtujunga_utm11_i16_tiled.tif",
    "dem/boulder_SRTMGL3.asc",
    "dem/eudem_laea_f32_deflate.tif",
    "dem_formats/f32_strip_none_nan.tif",
    "dem/etopo1_1deg_global.tif",
];

const INTERPOLATIONS: [(&str, Interpolation); 5] = [
    ("nearest", Interpolation::Nearest),
    ("cubic", Interpolation::Cubic),
    ("bilinear", Interpolation::Bilinear),
    ("planar", Interpolation::Planar),
    ("distance-weighted", Interpolation::DistanceWeighted4),
];

/// A height to its last bit, and its status.
type Bits = (Option<u64>, String);

/// The points of the file's samples, as text, and some that lie beyond it.
fn points(file: &Path) -> Vec<[String; 2]> {
    let name = file.file_name().expect("a file").to_string_lossy().into_owned();
    let csv = file.with_file_name(format!("oracle/{name}.samples.csv"));
    let text = std::fs::read_to_string(&csv).unwrap_or_else(|error| panic!("{}: {error}", csv.display()));
    let mut points: Vec<[String; 2]> = text
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            [cells[4].to_owned(), cells[5].to_owned()]
        })
        .collect();
    assert!(points.len() >= 60 && points.iter().flatten().all(|cell| cell.parse::<f64>().is_ok()), "{name}");
    points.push(["1e7".into(), "-1.25e7".into()]);
    points
}

fn of_library(
    data: &Dataset,
    (surface, interpolation): (Surface, Interpolation),
    from: &Crs,
    at: &[DVec2],
) -> Vec<Bits> {
    let answers = data.heights(surface, interpolation, from, at).expect("answered");
    answers.iter().map(|answer| (answer.height_m().map(f64::to_bits), answer.status().to_owned())).collect()
}

fn of_command(file: &Path, interpolation: &str, points: &[[String; 2]]) -> Vec<Bits> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_sandtable"))
        .args(["height", &file.to_string_lossy(), "--points", "-", "--interpolation", interpolation])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let input: String = points.iter().map(|[x, y]| format!("{x},{y}\n")).collect();
    child.stdin.take().expect("a pipe").write_all(input.as_bytes()).expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let column = |name: &str| header.iter().position(|known| *known == name).expect("a column");
    let (height, status) = (column("height"), column("status"));
    text.lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            (cells[height].parse::<f64>().ok().map(f64::to_bits), cells[status].to_owned())
        })
        .collect()
}

fn of_service(server: &Server, query: &str, locations: &str) -> Vec<Bits> {
    let body = format!("{query}&locations={locations}");
    let answer = server.post("/v1/dem", "application/x-www-form-urlencoded", &body);
    assert_eq!(answer.status, 200, "{answer:?}");
    let heights = numbers(&answer.body, "elevation").into_iter().map(|height| height.map(f64::to_bits));
    heights.zip(strings(&answer.body, "status")).map(|(height, status)| (height, status.to_owned())).collect()
}

fn joined(points: &[[String; 2]]) -> String {
    points.iter().map(|[first, second]| format!("{first},{second}")).collect::<Vec<_>>().join("|")
}

#[test]
fn the_samples_of_real_models_are_answered_alike_by_library_command_and_service() {
    let mut compared = 0;
    for file in FILES {
        let Some(file) = data(file) else { return };
        let points = points(&file);
        let at: Vec<DVec2> = points
            .iter()
            .map(|[x, y]| DVec2::new(x.parse().expect("a number"), y.parse().expect("a number")))
            .collect();
        let dataset = open(&file);
        let server = Server::start(Path::new("."), &[&format!("dem={}", file.display())]);
        for (name, interpolation) in INTERPOLATIONS {
            let expected = of_library(&dataset, (Surface::Source, interpolation), &dataset.crs(), &at);
            assert_eq!(of_command(&file, name, &points), expected, "{}: {name}", file.display());
            let query = format!("crs=native&interpolation={name}");
            let served = of_service(&server, &query, &joined(&points));
            assert_eq!(served, expected, "{}: {name}", file.display());
            compared += expected.len();
            assert_eq!(expected.last().map(|last| last.1.as_str()), Some("Outside"));
        }
    }
    assert!(compared > 3000, "{compared}");
}

#[test]
fn the_ground_is_answered_alike_by_library_and_service_at_latitudes_and_longitudes() {
    for file in ["dem/zion_srtm_u16_deflate.tif", "dem/bigtujunga_utm11_i16_tiled.tif"] {
        let Some(file) = data(file) else { return };
        let dataset = open(&file);
        let extent = dataset.header().extent();
        let wgs84 = Crs::wgs84();
        let at: Vec<DVec2> = (0..300)
            .map(|index| {
                let part = DVec2::new(f64::from(index % 17) / 16.0, f64::from(index % 19) / 18.0);
                let inside = extent.min + (extent.max - extent.min) * (part * 1.02 - 0.01);
                dataset.crs().transform(&wgs84, inside).expect("on Earth")
            })
            .collect();
        let locations: Vec<[String; 2]> = at.iter().map(|at| [at.y.to_string(), at.x.to_string()]).collect();
        let server = Server::start(Path::new("."), &[&format!("dem={}", file.display())]);
        for (word, surface) in
            [("source", Surface::Source), ("ground", Surface::Ground), ("scene", Surface::Scene)]
        {
            let expected = of_library(&dataset, (surface, Interpolation::Bilinear), &wgs84, &at);
            let served = of_service(&server, &format!("surface={word}"), &joined(&locations));
            assert_eq!(served, expected, "{}: {word}", file.display());
            assert!(expected.iter().any(|(height, _)| height.is_some()), "{word}");
            assert!(expected.iter().any(|(_, status)| status == "Outside"), "{word}");
        }
    }
}

#[test]
fn a_scene_is_asked_for_its_ground_and_its_source_in_its_own_coordinates() {
    let scene = Path::new(env!("SANDTABLE_ROOT")).join("scenes/heightmap.toml");
    let dataset = open(&scene);
    let lattice = all_ground(&dataset).lattice;
    let extent = lattice.extent();
    let at: Vec<DVec2> = (0..50)
        .map(|index| {
            let part = DVec2::new(f64::from(index % 7) / 6.3, f64::from(index % 11) / 9.5);
            lattice.origin() + extent.min + (extent.max - extent.min) * part
        })
        .collect();
    let locations: Vec<[String; 2]> = at.iter().map(|at| [at.x.to_string(), at.y.to_string()]).collect();
    let server = Server::start(Path::new("."), &[&format!("dem={}", scene.display())]);
    for (query, surface) in [
        ("crs=native", Surface::Ground),
        ("crs=native&surface=ground", Surface::Ground),
        ("crs=native&surface=source", Surface::Source),
    ] {
        let expected = of_library(&dataset, (surface, Interpolation::Bilinear), &dataset.crs(), &at);
        assert_eq!(of_service(&server, query, &joined(&locations)), expected, "{query}");
        assert!(expected.iter().filter(|(height, _)| height.is_some()).count() > 20, "{query}");
    }
}

/// The ground everywhere.
pub fn all_ground(dataset: &Dataset) -> QueriedGround {
    let (crs, at) = (dataset.crs(), [dataset.header().center()]);
    dataset.ground(&GroundReach { crs: &crs, at: &at, around_m: f64::INFINITY }).expect("in meters")
}

fn open(file: &Path) -> Dataset {
    Dataset::open(file, &DatasetOptions::default()).expect("sound")
}

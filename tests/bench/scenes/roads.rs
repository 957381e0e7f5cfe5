//! How the time to build a town grows with its roads: 1×, 4×, 16×, and a real city of 15 852.
//!
//! The towns are blocks of 80 m by 110 m whose streets bend a little and end at every crossing, as those of
//! OpenStreetMap do; each eighth street runs on as one line across the others.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use sandtable_description::parse::parse_bytes;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;

use crate::rounds::{interleaved, median, ratio, time_ms};

/// Blocks along one side of the town.
const BLOCKS: [usize; 3] = [24, 48, 96];

/// Rounds; a town of 16× takes a second.
const ROUNDS: usize = 5;

pub fn print() {
    let folder = std::env::temp_dir().join(format!("sandtable-bench-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a writable temporary folder");
    let towns: Vec<PathBuf> = BLOCKS.iter().map(|&blocks| town(&folder, blocks)).collect();
    let mut timed: Vec<_> = towns.iter().map(|path| || time_ms(|| built(path, &[]))).collect();
    let mut contenders: Vec<&mut dyn FnMut() -> f64> =
        timed.iter_mut().map(|timed| timed as &mut dyn FnMut() -> f64).collect();
    let times_ms = interleaved(ROUNDS, &mut contenders);
    println!("{:>8} {:>10} {:>12} {:>10} {:>8}", "roads", "km", "ms (median)", "µs a road", "× first");
    for (path, ms) in towns.iter().zip(&times_ms) {
        let (roads, km) = size(path, &[]);
        let each_us = median(ms) * 1e3 / roads as f64;
        println!(
            "{roads:>8} {km:>10.1} {:>12.1} {each_us:>10.1} {:>8.2}",
            median(ms),
            ratio(ms, &times_ms[0])
        );
    }
    print_city(&folder);
    // What is left in the temporary folder harms nobody.
    let _ = fs::remove_dir_all(&folder);
}

/// Porto Alegre, where the test data is there.
fn print_city(folder: &Path) {
    let data = Path::new(env!("SANDTABLE_ROOT")).join("../shared/data/scenes/porto_alegre_br");
    let Ok(data) = data.canonicalize() else { return println!("SKIPPED: no test data of Porto Alegre") };
    let text = format!(
        "[terrain]\ndem = '{0}/poa_elevation.tif'\n[[road]]\nfile = '{0}/poa_osm.pbf'\nlayer = 'roads'\nwidth = 7\n",
        data.display()
    );
    let path = folder.join("city.toml");
    fs::write(&path, text).expect("a writable temporary folder");
    let allowed = [data];
    let ms: Vec<f64> = (0..ROUNDS).map(|_| time_ms(|| built(&path, &allowed))).collect();
    let (roads, km) = size(&path, &allowed);
    println!(
        "\nPorto Alegre: {roads} roads, {km:.0} km drawn, in {:.0} ms (median), {:.0} ms per 1000 km",
        median(&ms),
        median(&ms) / km * 1e3
    );
}

/// Features, and the kilometers of 7 m wide carriageway that were laid for them.
fn size(path: &Path, allowed: &[PathBuf]) -> (usize, f64) {
    let scene = built(path, allowed);
    let area_m2: f64 = scene.ribbons.iter().map(|ribbon| ribbon.plan.area_m2()).sum();
    (scene.features.len(), area_m2 / 7.0 / 1e3)
}

fn built(path: &Path, allowed: &[PathBuf]) -> SceneModel {
    let text = fs::read(path).expect("readable");
    let document = parse_bytes(&path.to_string_lossy(), &text).unwrap_or_else(|report| panic!("{report}"));
    let assets = Assets::new(path, allowed).unwrap_or_else(|error| panic!("{error}"));
    build(&document, &assets, &|_| ()).unwrap_or_else(|diagnostic| panic!("{diagnostic}"))
}

/// Writes a scene of a town and returns where it is.
fn town(folder: &Path, blocks: usize) -> PathBuf {
    let corner = |column: usize, row: usize| {
        let (x, y) = (column as f64 * 80.0, row as f64 * 110.0);
        (x + 9.0 * libm::sin(y / 140.0), y + 9.0 * libm::sin(x / 170.0))
    };
    let mut lines: Vec<Vec<(f64, f64)>> = Vec::new();
    for row in 0..=blocks {
        for along in [Axis::East, Axis::North] {
            let at = |step: usize| match along {
                Axis::East => corner(step, row),
                Axis::North => corner(row, step),
            };
            if row % 8 == 4 {
                lines.push((0..=blocks).map(at).collect());
            } else {
                lines.extend((0..blocks).map(|step| vec![at(step), at(step + 1)]));
            }
        }
    }
    let name = format!("town-{blocks}");
    fs::write(folder.join(format!("{name}.geojson")), geojson(&lines)).expect("a writable temporary folder");
    let cell = blocks as f64 * 120.0 / 100.0;
    let row = "5 ".repeat(101);
    let ground = format!(
        "ncols 101\nnrows 101\nxllcenter -50\nyllcenter -50\ncellsize {cell}\n{}",
        [row.as_str(); 101].join("\n")
    );
    fs::write(folder.join(format!("{name}.asc")), ground).expect("a writable temporary folder");
    let text = format!(
        "[terrain]\ndem = '{name}.asc'\ncrs = 'EPSG:32616'\n[[road]]\nfile = '{name}.geojson'\ncrs = 'EPSG:32616'\nwidth = 7\n"
    );
    let path = folder.join(format!("{name}.toml"));
    fs::write(&path, text).expect("a writable temporary folder");
    path
}

enum Axis {
    East,
    North,
}

fn geojson(lines: &[Vec<(f64, f64)>]) -> String {
    let mut text = String::from("{\"type\":\"FeatureCollection\",\"features\":[");
    for (index, line) in lines.iter().enumerate() {
        let separator = if index == 0 { "" } else { "," };
        let points: Vec<String> = line.iter().map(|(x, y)| format!("[{x},{y}]")).collect();
        let points = points.join(",");
        let _ = write!(
            text,
            "{separator}{{\"type\":\"Feature\",\"properties\":{{}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[{points}]}}}}"
        );
    }
    text.push_str("]}");
    text
}

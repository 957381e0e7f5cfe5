//! Towns of streets in a grid, with houses along them, on rolling ground: 1, 4 and 16 times as many.

use std::fmt::Write;

use sandtable_scene::feature::FeatureKind;

use crate::tests_common::scratch::Scratch;
use crate::{built, peak_mib, seconds};

/// Meters between streets.
const BLOCK_M: usize = 80;

/// An elevation model of 2 km a side for every time the town doubles its side; 513 posts a side always, so that what
/// grows is the town.
fn ground(side_m: usize) -> String {
    let cell = side_m as f64 / 512.0;
    let mut text = format!("ncols 513\nnrows 513\nxllcenter 500000\nyllcenter 4000000\ncellsize {cell}\n");
    for row in 0..513 {
        for column in 0..513 {
            let (x, y) = (column as f64 * 0.02, row as f64 * 0.017);
            let _ = write!(text, "{:.2} ", 200.0 + 40.0 * libm::sin(x) * libm::cos(y));
        }
        text.push('\n');
    }
    text
}

fn feature(kind: &str, coordinates: &str) -> String {
    format!(
        r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#
    )
}

fn collection(features: &[String]) -> String {
    let crs = r#""crs":{"type":"name","properties":{"name":"EPSG:32616"}}"#;
    format!(r#"{{"type":"FeatureCollection",{crs},"features":[{}]}}"#, features.join(","))
}

/// Streets from crossing to crossing, and houses in the blocks.
fn town(blocks: usize) -> (String, String, f64) {
    let at = |x: usize, y: usize| format!("[{},{}]", 500_020 + x * BLOCK_M, 4_000_020 + y * BLOCK_M);
    let (mut streets, mut houses) = (Vec::new(), Vec::new());
    for (x, y) in (0..blocks).flat_map(|y| (0..blocks).map(move |x| (x, y))) {
        streets.push(feature("LineString", &format!("[{},{}]", at(x, y), at(x + 1, y))));
        streets.push(feature("LineString", &format!("[{},{}]", at(x, y), at(x, y + 1))));
        for house in 0..4 {
            let (east, north) = (500_032 + x * BLOCK_M + house * 16, 4_000_035 + y * BLOCK_M);
            let corner = |dx: usize, dy: usize| format!("[{},{}]", east + dx, north + dy);
            let ring = [corner(0, 0), corner(10, 0), corner(10, 8), corner(0, 8), corner(0, 0)].join(",");
            houses.push(feature("Polygon", &format!("[[{ring}]]")));
        }
    }
    let road_km = (streets.len() * BLOCK_M) as f64 / 1000.0;
    (collection(&streets), collection(&houses), road_km)
}

/// Prints the table.
pub fn print() {
    println!(
        "{:<8}{:>8}{:>10}{:>12}{:>11}{:>16}{:>14}{:>13}",
        "town", "roads", "road km", "buildings", "laying", "per 1000 km", "everything", "peak memory"
    );
    for side in [20, 40, 80] {
        let folder = Scratch::new();
        let (streets, houses, road_km) = town(side);
        folder.write("streets.geojson", streets);
        folder.write("houses.geojson", houses);
        folder.write("ground.asc", ground((side + 1) * BLOCK_M));
        let text = "[terrain]\ndem = \"ground.asc\"\ncrs = \"EPSG:32616\"\n\
                    [[road]]\nfile = \"streets.geojson\"\nwidth = 7\n\
                    [[building]]\nfile = \"houses.geojson\"\nheight = 7\n";
        let (scene, steps) = built(&folder, text, &[]);
        let count = |wanted| scene.features.iter().filter(|feature| feature.kind == wanted).count();
        let laying = seconds(&steps, "laying features");
        let all: f64 = steps.iter().map(|step| step.seconds).sum();
        println!(
            "{:<8}{:>8}{road_km:>10.1}{:>12}{laying:>9.3} s{:>14.2} s{all:>12.3} s{:>9.0} MiB",
            format!("{}×", side * side / 400),
            count(FeatureKind::Road),
            count(FeatureKind::Building),
            laying / road_km * 1000.0,
            peak_mib(&steps),
        );
    }
}

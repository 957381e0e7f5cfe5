//! What hostile or careless vector files cost: roads that all cross one another, stars, rings of a hundred thousand
//! vertices. What is refused says by what limit.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::time::Instant;

use sandtable_scene::scene_file::open_scene;

use crate::tests_common::scratch::Scratch;

/// The middle and the half side of the ground, in meters.
const MIDDLE_M: f64 = 5000.0;

/// Prints a row a scene.
pub fn print() {
    println!("{:<14}{:<34}{:>10}  what comes of it", "shape", "table", "time");
    for count in [500, 1000, 2000] {
        for table in ["[[road]]\nwidth = 7", "[[road]]\nwidth = 7\nprofile = \"conform\""] {
            row(&format!("{count} roads"), table, &crossing_roads(count));
        }
    }
    let tables = [
        "[[area]]\ncover = \"forest\"",
        "[[area]]\ncover = \"forest\"\nborder = \"solid\"",
        "[[area]]\ncover = \"forest\"\nborder = \"dashed\"",
        "[[lake]]\nlevel = 3",
        "[[building]]\nheight = 10",
        "[[building]]\nheight = 10\nroof = \"hipped\"",
    ];
    let mut rings: Vec<(String, String)> =
        [31, 101, 301, 1001].into_iter().map(|count| (format!("star of {count}"), star(count))).collect();
    rings.push(("noisy ring".to_owned(), noisy_ring(100_000)));
    rings.push(("round ring".to_owned(), round_ring(100_000)));
    for (shape, text) in &rings {
        tables.iter().for_each(|table| row(shape, table, text));
    }
}

fn row(shape: &str, table: &str, features: &str) {
    let folder = Scratch::new();
    folder.write("features.geojson", features);
    folder.write("ground.asc", ground());
    let keys = "file = \"features.geojson\"\ncrs = \"EPSG:32616\"";
    let text = format!("[terrain]\ndem = \"ground.asc\"\ncrs = \"EPSG:32616\"\n{table}\n{keys}\n");
    let path = folder.write("scene.toml", text);
    let start = Instant::now();
    let found = match open_scene(&path, &[], &|_| {}) {
        Ok(scene) => {
            let triangles: usize = scene.ribbons.iter().map(|ribbon| ribbon.plan.triangles.len()).sum();
            format!("{triangles} triangles lie on the ground")
        }
        Err(error) => error.to_string().lines().next().unwrap_or_default().to_owned(),
    };
    let table = table.replace('\n', " ");
    println!("{shape:<14}{table:<34}{:>8.2} s  {found}", start.elapsed().as_secs_f64());
}

/// Gentle hills of 129 posts a side.
fn ground() -> String {
    let cell = 2.0 * MIDDLE_M / 128.0;
    let mut text = format!("ncols 129\nnrows 129\nxllcenter 0\nyllcenter 0\ncellsize {cell}\n");
    for row in 0..129 {
        for column in 0..129 {
            let (x, y) = (f64::from(column) * 0.1, f64::from(row) * 0.08);
            let _ = write!(text, "{:.2} ", 200.0 + 30.0 * libm::sin(x) * libm::cos(y));
        }
        text.push('\n');
    }
    text
}

/// Straight roads between places on a circle: most cross most others.
fn crossing_roads(count: u32) -> String {
    let lines: Vec<String> = (0..count)
        .map(|index| {
            // The golden ratio spreads directions and offsets evenly, without any that repeat.
            let turn = f64::from(index) * 0.618_033_988_749_895 % 1.0;
            let aside = (f64::from(index) * 0.754_877_666_246_693 % 1.0 - 0.5) * MIDDLE_M;
            let (sin, cos) = (libm::sin(turn * TAU / 2.0), libm::cos(turn * TAU / 2.0));
            let end = |along: f64| {
                let x = MIDDLE_M + cos * along - sin * aside;
                let y = MIDDLE_M + sin * along + cos * aside;
                format!("[{x:.3},{y:.3}]")
            };
            feature("LineString", &format!("[{},{}]", end(-0.8 * MIDDLE_M), end(0.8 * MIDDLE_M)))
        })
        .collect();
    collection(&lines)
}

/// A star polygon of so many points, which crosses itself almost as often as it can.
fn star(count: u32) -> String {
    ring((0..count).map(|index| {
        let angle = f64::from(index * (count / 2) % count) / f64::from(count) * TAU;
        [angle, 0.6 * MIDDLE_M]
    }))
}

/// A ring whose radius jumps from vertex to vertex.
fn noisy_ring(count: u32) -> String {
    ring((0..count).map(|index| {
        let noise = f64::from(index) * 0.618_033_988_749_895 % 1.0;
        [f64::from(index) / f64::from(count) * TAU, (0.3 + 0.3 * noise) * MIDDLE_M]
    }))
}

/// A ring that is almost a circle.
fn round_ring(count: u32) -> String {
    ring((0..count).map(|index| [f64::from(index) / f64::from(count) * TAU, 0.6 * MIDDLE_M]))
}

/// The polygon of angles and radii.
fn ring(vertices: impl Iterator<Item = [f64; 2]>) -> String {
    let mut corners: Vec<String> = vertices
        .map(|[angle, radius]| {
            let (x, y) = (MIDDLE_M + radius * libm::cos(angle), MIDDLE_M + radius * libm::sin(angle));
            format!("[{x:.4},{y:.4}]")
        })
        .collect();
    corners.extend(corners.first().cloned());
    collection(&[feature("Polygon", &format!("[[{}]]", corners.join(",")))])
}

fn feature(kind: &str, coordinates: &str) -> String {
    format!(
        r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#
    )
}

fn collection(features: &[String]) -> String {
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
}

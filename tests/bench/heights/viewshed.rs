//! What can be seen from a point of 2,049² posts, beside other people's viewsheds.
//!
//! Ours is timed in memory; `gdal_viewshed` and `r.viewshed` as their users have them: the first from
//! start to end with a raw file in and out, the second inside a session with the raster imported, which leaves out what
//! starting GRASS costs. The observer stands in the middle, and on the highest post of the middle quarter, where more
//! is seen and more is to be done.

use std::path::Path;

use glam::DVec2;
use rayon::{ThreadPool, ThreadPoolBuilder};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_terrain::sight::viewshed::{PostVisibility, Sector, Viewshed, ViewshedOptions, viewshed};

use crate::rounds::{interleaved, median, ratio, time_ms};
use crate::{fields, peers};

const SIZE: usize = 2049;
const CELL_M: f64 = 10.0;
const ORIGIN: DVec2 = DVec2::new(500_000.0, 5_000_000.0);
const EYE_M: f64 = 2.0;

/// Few, because the slowest of them takes seconds.
const ROUNDS: usize = 5;

/// Every so-manieth post is looked at along its own line: all of them would take minutes from a summit.
const STRIDE: usize = 97;

/// Prints the tables.
pub fn print() {
    let heights = fields::fractal(SIZE);
    let raster = peers::folder().join("viewshed.bin");
    peers::write_envi(&raster, &heights, SIZE, ORIGIN, CELL_M);
    let lattice =
        Lattice::new(ORIGIN, DVec2::splat(CELL_M), SIZE as u32, heights).expect("a fractal is ground");
    let middle = Post { column: SIZE as u32 / 2, row: SIZE as u32 / 2 };
    println!(
        "{SIZE}² fractal posts, eye {EYE_M} m, target 0 m, curvature and refraction; median ms of {ROUNDS} rounds."
    );
    for (name, post) in [("from the middle", middle), ("from a summit", summit(&lattice))] {
        println!("\n{name}, post {}, {}", post.column, post.row);
        print_from(&lattice, &raster, post);
    }
}

/// The highest post of the middle quarter.
fn summit(lattice: &Lattice) -> Post {
    let range = SIZE as u32 / 4..SIZE as u32 * 3 / 4;
    let middle = |post: &Post| range.contains(&post.column) && range.contains(&post.row);
    let posts = lattice.posts().filter(middle);
    posts.max_by(|a, b| lattice.height(*a).total_cmp(&lattice.height(*b))).expect("there are posts")
}

fn threads(count: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(count).build().expect("threads")
}

fn print_from(lattice: &Lattice, raster: &Path, post: Post) {
    let options = ViewshedOptions {
        observer: SightEnd { at: lattice.map_position(post), above_m: EYE_M },
        target_above_m: 0.0,
        range_m: f64::INFINITY,
        sector: Sector::ALL,
        curvature: Curvature::default(),
    };
    let (one, two) = (threads(1), threads(2));
    let swept = |pool: &ThreadPool| time_ms(|| pool.install(|| viewshed(lattice, &options)));
    let mut ours_1 = || swept(&one);
    let mut ours_2 = || swept(&two);
    let seen_by_gdal = peers::folder().join("viewshed-gdal.bin");
    let mut gdal = || time_ms(|| run_gdal(raster, &seen_by_gdal, &options));
    let place = [post.column.to_string(), (SIZE as u32 - 1 - post.row).to_string()];
    let python = peers::python();
    let mut numba = || script(python.as_deref(), "viewshed_lines.py", raster, &place);
    let at = [options.observer.at.x.to_string(), options.observer.at.y.to_string()];
    let mut grass = || script(python.as_deref(), "viewshed_grass.py", raster, &at);
    let mut contenders: Vec<(&str, &mut dyn FnMut() -> f64)> =
        vec![("ours, 1 thread", &mut ours_1), ("ours, 2 threads", &mut ours_2)];
    let has_gdal = peers::is_there("gdal_viewshed");
    if has_gdal {
        contenders.push(("gdal_viewshed, process", &mut gdal));
    }
    if python.is_some() {
        contenders.push(("a line a cell, numba", &mut numba));
    }
    if python.is_some() && peers::is_there("grass") {
        contenders.push(("r.viewshed in GRASS", &mut grass));
    }
    let names: Vec<&str> = contenders.iter().map(|(name, _)| *name).collect();
    let mut runs: Vec<&mut dyn FnMut() -> f64> = contenders.into_iter().map(|(_, run)| run).collect();
    let times = interleaved(ROUNDS, &mut runs);
    println!("{:<24}{:>10}{:>12}{:>12}", "", "ms", "× ours 1", "× ours 2");
    for (name, values) in names.iter().zip(&times) {
        let (to_one, to_two) = (ratio(values, &times[0]), ratio(values, &times[1]));
        println!("{name:<24}{:>10.1}{to_one:>12.2}{to_two:>12.2}", median(values));
    }
    let swept = viewshed(lattice, &options).expect("there is ground");
    report(lattice, &options, &swept);
    if has_gdal {
        recall(&swept, &peers::read_bytes_from_south(&seen_by_gdal, SIZE));
    }
}

fn report(lattice: &Lattice, options: &ViewshedOptions, swept: &Viewshed) {
    let line = |post: Post| {
        let target = SightEnd { at: lattice.map_position(post), above_m: options.target_above_m };
        line_of_sight(lattice, options.observer, target, options.curvature)
    };
    let sampled = lattice.posts().zip(&swept.posts).step_by(STRIDE);
    let (mut count, mut wrong) = (0, 0);
    let ms = time_ms(|| {
        for (post, &seen) in sampled {
            count += 1;
            wrong += usize::from((line(post) == Sight::Clear) != (seen == PostVisibility::Visible));
        }
    });
    let all = swept.posts.len() as f64;
    println!(
        "{:.3} % in sight; {wrong} of {count} posts differ from their lines, which took {ms:.0} ms on one thread; \
         {} posts of all were looked at by line",
        swept.counts().visible as f64 / all * 100.0,
        swept.lines
    );
}

/// How much of what can be seen GDAL finds, and how much of what it finds can be seen.
fn recall(exact: &Viewshed, gdal: &[u8]) {
    let seen = |index: usize| exact.posts[index] == PostVisibility::Visible;
    let found = (0..gdal.len()).filter(|&index| gdal[index] > 0).count() as f64;
    let both = (0..gdal.len()).filter(|&index| gdal[index] > 0 && seen(index)).count() as f64;
    let visible = exact.counts().visible as f64;
    println!("gdal_viewshed: recall {:.3}, precision {:.3}", both / visible, both / found);
}

fn run_gdal(raster: &Path, out: &Path, options: &ViewshedOptions) {
    let at = options.observer.at;
    let (x, y) = (at.x.to_string(), at.y.to_string());
    let (eye, raster, out) = (EYE_M.to_string(), raster.to_string_lossy(), out.to_string_lossy());
    let arguments = [
        "-q",
        "-f",
        "ENVI",
        "-ox",
        &x,
        "-oy",
        &y,
        "-oz",
        &eye,
        "-md",
        "0",
        "-cc",
        "0.857142857",
        &raster,
        &out,
    ];
    peers::run("gdal_viewshed", &arguments);
}

/// A script that prints milliseconds.
fn script(python: Option<&str>, name: &str, raster: &Path, place: &[String; 2]) -> f64 {
    let Some(python) = python else { return f64::NAN };
    let (raster, size, eye) = (raster.to_string_lossy(), SIZE.to_string(), EYE_M.to_string());
    let printed = peers::script(python, name, &[&raster, &size, &place[0], &place[1], &eye]);
    printed.first().copied().unwrap_or(f64::NAN)
}

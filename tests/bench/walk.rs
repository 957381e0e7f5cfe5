//! `cargo bench --bench walk`: what a frame of a walk costs before anything is drawn, and an edit of the ground.
//!
//! One section a question. `cargo bench --bench walk -- NAME…` runs some of them. What is compared is flown in turn
//! within one process (see `rounds`).

#[path = "common/fields.rs"]
#[allow(dead_code, reason = "shared by several benchmarks")]
mod fields;
#[path = "lod/flight.rs"]
#[allow(dead_code, reason = "shared by several benchmarks")]
mod flight;
#[path = "common/rounds.rs"]
#[allow(dead_code, reason = "shared by several benchmarks")]
mod rounds;

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine2, DMat2, DVec2, Vec3};
use sandtable_dem::dem_format::DemFormat;
use sandtable_earthworks::brush::Crater;
use sandtable_files::raster_file;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;
use sandtable_walk::Walk;
use sandtable_walk::frame::{WalkOptions, WalkStatistics};

use crate::rounds::{median, quantile, time_ms};

/// Frames of a flight.
const FRAMES: usize = 600;

/// Frames left out at the start: the first has everything to make.
const WARM: usize = 5;

fn main() {
    rounds::sections(&[("sizes", sizes), ("speed", speed), ("crater", crater), ("demo", demo)]);
}

/// A scene of bare ground, posts 10 m apart.
fn scene(heights: &[f32]) -> Arc<SceneModel> {
    let folder = std::env::temp_dir().join(format!("sandtable-walk-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the scene");
    let side = flight::side(heights);
    let north = heights.chunks_exact(side).rev().flatten().copied().collect();
    let cell = DVec2::splat(f64::from(flight::CELL_M));
    let corner = DVec2::new(0.0, cell.y * (side - 1) as f64);
    // Posts are in the middle of their samples.
    let map_from_grid = DAffine2 {
        matrix2: DMat2::from_diagonal(DVec2::new(cell.x, -cell.y)),
        translation: corner + DVec2::new(-0.5, 0.5) * cell,
    };
    let raster =
        Raster { map_from_grid, georeferenced: true, ..Raster::new(side as u32, Samples::F32(north)) };
    let format = DemFormat::to_write("tif").expect("GeoTIFF is written");
    raster_file::write(&raster, format, &folder.join("ground.tif"), &[]).expect("writable");
    let path = folder.join("ground.toml");
    std::fs::write(&path, "[terrain]\ndem = \"ground.tif\"\n").expect("writable");
    let scene = open_scene(&path, &[], &|_| ()).expect("a sound scene");
    std::fs::remove_dir_all(&folder).expect("removable");
    Arc::new(scene)
}

/// The cameras of the flight at 1024 × 768.
fn cameras(heights: &[f32], speed: f32) -> Vec<Camera> {
    let widened = |camera: Camera| {
        let (eye, forward) = (camera.eye(), camera.forward());
        let fov = 2.0 * libm::atanf(camera.tan_half_fov().y);
        Camera::new(eye, eye + forward * 1e4, fov, (1024, 768), camera.planes()).expect("sound")
    };
    flight::cameras(heights, speed, FRAMES).into_iter().map(widened).collect()
}

/// The times of the frames of a flight, milliseconds, and what they did, all but the first few.
fn fly(walk: &mut Walk, cameras: &[Camera]) -> (Vec<f64>, Vec<WalkStatistics>) {
    let mut done = (Vec::new(), Vec::new());
    for (frame, camera) in cameras.iter().enumerate() {
        let mut statistics = WalkStatistics::default();
        let time = time_ms(|| statistics = walk.update(camera).expect("in memory").statistics);
        if frame >= WARM {
            done.0.push(time);
            done.1.push(statistics);
        }
    }
    done
}

fn mean(values: impl ExactSizeIterator<Item = usize>) -> f64 {
    let count = values.len() as f64;
    values.sum::<usize>() as f64 / count
}

fn row(name: &str, (times, done): &(Vec<f64>, Vec<WalkStatistics>), against: f64) {
    println!(
        "{name:<16}{:>10.0}{:>10.1}{:>10.1}{:>12.0}{:>11.4} ms{:>11.4} ms{:>8.2}×",
        mean(done.iter().map(|of| of.triangles)),
        mean(done.iter().map(|of| of.splits + of.merges)),
        mean(done.iter().map(|of| of.changed_patches)),
        mean(done.iter().map(|of| of.bytes())),
        median(times),
        quantile(times, 0.99),
        median(times) / against,
    );
}

fn heading(what: &str) {
    println!(
        "{what:<16}{:>10}{:>10}{:>10}{:>12}{:>14}{:>14}",
        "triangles", "changed", "patches", "bytes", "median", "99 %"
    );
}

/// The papers' sizes on one flight: 5 m a frame, a tolerance that shows 8.8 thousand triangles of 1025².
fn sizes() {
    let options = WalkOptions { tolerance_px: Some(7.1), ..WalkOptions::default() };
    let all = fields::fractal(4097);
    let corner = |side: usize| -> Vec<f32> {
        all.chunks_exact(4097).take(side).flat_map(|row| row[..side].iter().copied()).collect()
    };
    let mut walks: Vec<(usize, Walk, Vec<Camera>)> = [129, 257, 513, 1025, 2049, 4097]
        .into_iter()
        .map(|side| {
            let heights = corner(side);
            let mut walk = None;
            let scene = scene(&heights);
            let made = time_ms(|| walk = Some(Walk::new(scene, options)));
            println!("{side}²: a walk is made in {made:.0} ms");
            (side, walk.expect("just made"), cameras(&heights, 0.5))
        })
        .collect();
    let flown: Vec<_> = walks.iter_mut().map(|(side, walk, cameras)| (*side, fly(walk, cameras))).collect();
    heading("5 m a frame");
    let smallest = median(&flown[0].1.0);
    flown.iter().for_each(|(side, done)| row(&format!("{side}²"), done, smallest));
}

/// 4097² at 100 m a second and 60 frames a second, by tolerance.
fn speed() {
    let heights = fields::fractal(4097);
    let scene = scene(&heights);
    let cameras = cameras(&heights, 100.0 / 60.0 / flight::CELL_M);
    heading("4097², 100 m/s");
    let mut first = None;
    for tolerance in [1.0, 2.0, 4.0] {
        let options = WalkOptions { tolerance_px: Some(tolerance), ..WalkOptions::default() };
        let done = fly(&mut Walk::new(Arc::clone(&scene), options), &cameras);
        row(&format!("{tolerance} px"), &done, *first.get_or_insert(median(&done.0)));
    }
}

/// A crater of radius 30 m before the camera, and the frame that shows it, while flying.
fn crater() {
    println!("{:<10}{:>14}{:>14}{:>14}{:>14}", "", "edit", "99 %", "next frame", "99 %");
    for side in [513, 1025, 4097] {
        let heights = fields::fractal(side);
        let mut walk = Walk::new(scene(&heights), WalkOptions::default());
        let (mut edits, mut frames) = (Vec::new(), Vec::new());
        for (frame, camera) in cameras(&heights, 0.5).iter().enumerate().take(200) {
            let before = camera.eye() + camera.forward().with_z(0.0).normalize_or(Vec3::Y) * 150.0;
            let center = before.truncate().as_dvec2();
            let crater = Crater { center, radius_m: 30.0, depth_m: 8.0, rim_m: 1.0 };
            let edit = time_ms(|| walk.edit(|lattice| crater.apply(lattice)).expect("in memory"));
            let next = time_ms(|| walk.update(camera).expect("in memory"));
            if frame >= WARM {
                edits.push(edit);
                frames.push(next);
            }
        }
        println!(
            "{side:>4}²{:>13.3} ms{:>11.3} ms{:>11.3} ms{:>11.3} ms",
            median(&edits),
            quantile(&edits, 0.99),
            median(&frames),
            quantile(&frames, 0.99)
        );
    }
}

/// The demonstration: ground and all that lies on it, along the way from its first view to its last.
fn demo() {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/jacksboro.toml");
    let scene = Arc::new(open_scene(&path, &[], &|_| {}).expect("the demonstration is sound"));
    let placed = |at: usize| {
        sandtable_picture::camera(&scene, &scene.cameras[at], (1280, 720)).expect("a sound camera")
    };
    let (first, last) = (placed(0), placed(scene.cameras.len() - 1));
    let cameras: Vec<Camera> = (0..FRAMES)
        .map(|frame| {
            let part = frame as f32 / FRAMES as f32;
            let eye = first.eye().lerp(last.eye(), part);
            let forward = first.forward().lerp(last.forward(), part).normalize_or(Vec3::Y);
            Camera::new(eye, eye + forward * 1e4, 0.7, (1280, 720), first.planes()).expect("sound")
        })
        .collect();
    let mut walk = Walk::new(Arc::clone(&scene), WalkOptions::default());
    let start = time_ms(|| walk.update(&cameras[0]).expect("in memory"));
    let list = time_ms(|| walk.static_list(&cameras[0], &|_| ()));
    println!("first frame {start:.1} ms, the list of what stands {list:.1} ms");
    heading("demonstration");
    let done = fly(&mut walk, &cameras);
    row("with ribbons", &done, median(&done.0));
    let late = done.0.iter().filter(|time| **time > 33.0).count();
    println!(
        "{late} of {} updates took more than 33 ms, the longest {:.1} ms",
        done.0.len(),
        quantile(&done.0, 1.0)
    );
}

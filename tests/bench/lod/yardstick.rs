//! The pass that remembers nothing, and the product's own rebuild beside it: the same flight, as many triangles.

use sandtable::app::lod::follow::Follow;
use sandtable::app::lod::method::{Lists, Refiner, Rule};
use sandtable::app::lod::prepared::Prepared;
use sandtable::app::lod::refining::Refining;
use sandtable::view::camera::Camera;

use crate::stateless::Stateless;
use crate::{fields, flight, rounds};

const FRAMES: usize = 120;

/// Prints both at 9 k and 20 k triangles on 1025².
pub fn print() {
    let heights = fields::fractal(1025);
    let cameras = flight::cameras(&heights, 1.0, FRAMES);
    let mut yardstick = Stateless::new(&heights);
    let mut terrain = Prepared::new(flight::lattice(&heights), 1.0).expect("patches can be laid");
    println!("1025² fractal, one cell a frame, {FRAMES} frames, medians of {} rounds", rounds::ROUNDS);
    println!("{:<26}{:>10}{:>14}{:>12}{:>10}", "", "triangles", "ms a frame", "ns a tri.", "p99/med");
    for target in [9_000, 20_000] {
        yardstick.tune(target, &cameras);
        yardstick.check(&cameras[0]);
        tune(&mut terrain, target, &cameras);
        compare(&mut yardstick, &terrain, &cameras);
    }
}

fn compare(yardstick: &mut Stateless, terrain: &Prepared, cameras: &[Camera]) {
    let mut rebuilding = Refining::new(Lists::Bintree, Rule::Spheres, Refiner::Rebuild, terrain, None);
    let triangles = [
        mean(cameras, |camera| yardstick.update(camera) as f64),
        mean(cameras, |camera| {
            rebuilding.update(camera);
            shown(&mut rebuilding)
        }),
    ];
    let (mut stateless_times, mut rebuild_times) = (Vec::new(), Vec::new());
    let mut stateless = || {
        let times = timed(cameras, |camera| _ = yardstick.update(camera));
        stateless_times.extend_from_slice(&times);
        rounds::median(&times)
    };
    let mut rebuild = || {
        let times = timed(cameras, |camera| rebuilding.update(camera));
        rebuild_times.extend_from_slice(&times);
        rounds::median(&times)
    };
    let medians = rounds::interleaved(rounds::ROUNDS, &mut [&mut stateless, &mut rebuild]);
    row("stateless", triangles[0], &medians[0], &stateless_times);
    row("own rebuild, spheres", triangles[1], &medians[1], &rebuild_times);
    println!("own rebuild against stateless: {:.2}×", rounds::ratio(&medians[0], &medians[1]));
}

fn mean(cameras: &[Camera], count: impl FnMut(&Camera) -> f64) -> f64 {
    cameras.iter().map(count).sum::<f64>() / cameras.len() as f64
}

fn row(name: &str, triangles: f64, medians: &[f64], frames: &[f64]) {
    let (ms, p99) = (rounds::median(medians), rounds::quantile(frames, 0.99));
    println!("{name:<26}{triangles:>10.0}{ms:>14.3}{:>12.1}{:>10.2}", ms * 1e6 / triangles, p99 / ms);
}

/// The time of every frame, milliseconds.
fn timed(cameras: &[Camera], mut update: impl FnMut(&Camera)) -> Vec<f64> {
    cameras.iter().map(|camera| rounds::time_ms(|| update(camera))).collect()
}

fn shown(follow: &mut dyn Follow) -> f64 {
    follow.shown().iter().map(|list| list.triangles.len() as f64).sum()
}

/// Sets the tolerance at which the spheres show `target` triangles, the mean over eight frames.
fn tune(terrain: &mut Prepared, target: usize, cameras: &[Camera]) {
    let some: Vec<Camera> = cameras.iter().step_by(cameras.len().div_ceil(8)).copied().collect();
    let found = rounds::bisected(target as f64, (0.05, 500.0), |tolerance_px| {
        terrain.set_tolerance_px(tolerance_px);
        let mut rebuilding = Refining::new(Lists::Bintree, Rule::Spheres, Refiner::Rebuild, terrain, None);
        mean(&some, |camera| {
            rebuilding.update(camera);
            shown(&mut rebuilding)
        })
    });
    terrain.set_tolerance_px(found);
}

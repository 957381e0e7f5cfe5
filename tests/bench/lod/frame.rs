//! What a frame costs: the deferred refiner beside the pass that remembers nothing, the queues and our own splits
//! alone, all on the same flight with as many triangles each.
//!
//! A frame is culling, the mesh, and the index lists of the patches that changed; nothing is drawn. The first frame
//! of each flight is not counted.

use sandtable_roam::spheres::SphereMap;
use sandtable_view::camera::Camera;

use crate::stateless::Stateless;
use crate::walks::{Following, Queueing, Rebuilding, Walk, World};
use crate::{fields, flight, rounds};

/// Frames of a flight, as the peers were timed.
const FRAMES: usize = 600;

/// Rounds of the flights over 4097² posts, each of which takes seconds.
const FEW_ROUNDS: usize = 5;

/// Prints all tables.
pub fn print() {
    frames_on(1025, &[(9_000, 1.0), (20_000, 1.0), (9_000, 0.2)], FRAMES, rounds::ROUNDS);
    frames_on(4097, &[(100_000, 1.0), (100_000, 0.2)], FRAMES / 2, FEW_ROUNDS);
    splits_alone();
    cost_of_change();
    sizes();
}

/// A contender's frames over all rounds.
struct Flown {
    /// Each round's median, milliseconds.
    medians: Vec<f64>,
    /// All frames of all rounds.
    all: Vec<f64>,
    triangles: f64,
    changed: f64,
    upload: f64,
}

impl Flown {
    fn new() -> Self {
        Self { medians: Vec::new(), all: Vec::new(), triangles: 0.0, changed: 0.0, upload: f64::NAN }
    }

    /// The frame that takes longest, taken at its least of all rounds: what the walk asks for, not what interrupts it.
    fn worst(&self) -> f64 {
        let frames = self.all.len() / self.medians.len();
        let least = |at: usize| self.all[at..].iter().step_by(frames).copied().fold(f64::INFINITY, f64::min);
        (0..frames).map(least).fold(0.0, f64::max)
    }

    fn row(&self, name: &str, yardstick: &Self) {
        let (median, p99) = (rounds::median(&self.medians), rounds::quantile(&self.all, 0.99));
        let ratio = rounds::ratio(&yardstick.medians, &self.medians);
        println!(
            "{name:<22}{:>10.0}{median:>10.4}{p99:>10.3}{:>10.3}{:>10.0}{:>12.0}{ratio:>9.2}×",
            self.triangles,
            self.worst(),
            self.changed,
            self.upload,
        );
    }
}

fn heading(text: &str) {
    println!("\n{text}");
    println!(
        "{:<22}{:>10}{:>10}{:>10}{:>10}{:>10}{:>12}{:>10}",
        "", "triangles", "median ms", "p99", "worst", "changed", "bytes sent", "ratio"
    );
}

fn frames_on(posts: usize, cases: &[(usize, f32)], frames: usize, turns: usize) {
    let heights = fields::fractal(posts);
    let world = World::new(&heights);
    let mut yardstick = Stateless::new(&heights);
    for &(target, speed) in cases {
        let cameras = flight::cameras(&heights, speed, frames);
        heading(&format!("{posts}², {target} triangles, {speed} cells a frame, {frames} frames × {turns}"));
        yardstick.tune(target, &cameras);
        yardstick.check(&cameras[0]);
        let spheres = tuned(&world, target, &cameras);
        let [mut stateless, mut deferred, mut queues] = [Flown::new(), Flown::new(), Flown::new()];
        rounds::interleaved(
            turns,
            &mut [
                &mut || fly_stateless(&mut yardstick, &cameras, &mut stateless),
                &mut || fly(&mut Following::new(&world, &spheres), &cameras, &mut deferred),
                &mut || fly(&mut Queueing::new(&world, &spheres, target), &cameras, &mut queues),
            ],
        );
        stateless.row("stateless", &stateless);
        queues.row("queues, budget", &stateless);
        deferred.row("deferred", &stateless);
        println!("deferred against queues: {:.2}×", rounds::ratio(&queues.medians, &deferred.medians));
        at_rest(&world, &spheres, &cameras);
    }
}

fn fly_stateless(yardstick: &mut Stateless, cameras: &[Camera], flown: &mut Flown) -> f64 {
    let mut triangles = 0;
    let times: Vec<f64> =
        cameras.iter().map(|camera| rounds::time_ms(|| triangles += yardstick.update(camera))).collect();
    flown.triangles = triangles as f64 / cameras.len() as f64;
    flown.changed = flown.triangles;
    flown.upload = 12.0 * flown.triangles;
    note(&times, flown)
}

fn fly(walk: &mut impl Walk, cameras: &[Camera], flown: &mut Flown) -> f64 {
    let (mut triangles, mut changed) = (0, 0);
    let mut uploads = Vec::new();
    let mut times = Vec::new();
    for camera in cameras {
        times.push(rounds::time_ms(|| walk.update(camera)));
        triangles += walk.triangles();
        changed += walk.work()[0];
        uploads.push(walk.upload() as f64);
    }
    flown.triangles = triangles as f64 / cameras.len() as f64;
    flown.changed = changed as f64 / cameras.len() as f64;
    flown.upload = rounds::median(&uploads);
    note(&times, flown)
}

fn note(times: &[f64], flown: &mut Flown) -> f64 {
    let median = rounds::median(&times[1..]);
    flown.medians.push(median);
    flown.all.extend_from_slice(&times[1..]);
    median
}

/// The spheres with which the deferred refiner shows `target` triangles, the mean over 24 frames.
fn tuned(world: &World, target: usize, cameras: &[Camera]) -> SphereMap {
    let some: Vec<&Camera> = cameras.iter().step_by(cameras.len().div_ceil(24)).collect();
    let found = rounds::bisected(target as f64, (1e-5, 1e-1), |tolerance| {
        let spheres = world.spheres(1.0 / tolerance);
        let mut walk = Following::new(world, &spheres);
        let triangles = some.iter().map(|camera| {
            walk.update(camera);
            walk.triangles() as f64
        });
        triangles.sum::<f64>() / some.len() as f64
    });
    world.spheres(1.0 / found)
}

fn at_rest(world: &World, spheres: &SphereMap, cameras: &[Camera]) {
    const TIMES: usize = 1000;
    let mut walk = Following::new(world, spheres);
    walk.update(&cameras[0]);
    let ms = rounds::time_ms(|| (0..TIMES).for_each(|_| walk.update(&cameras[0])));
    println!("at rest: {:.3} µs a frame, {} bytes", ms * 1e3 / TIMES as f64, walk.upload());
}

/// The comparison of Lin, Wan, Zhou and Tan: as many triangles by splits alone, every frame anew.
fn splits_alone() {
    let heights = fields::fractal(1025);
    let (world, cameras) = (World::new(&heights), flight::cameras(&heights, 1.0, FRAMES));
    for target in [8_766, 7_656, 6_360] {
        let spheres = tuned(&world, target, &cameras);
        let [mut alone, mut deferred] = [Flown::new(), Flown::new()];
        rounds::interleaved(
            rounds::ROUNDS,
            &mut [&mut || fly(&mut Rebuilding::new(&world, &spheres), &cameras, &mut alone), &mut || {
                fly(&mut Following::new(&world, &spheres), &cameras, &mut deferred)
            }],
        );
        heading(&format!("1025², {target} triangles: against our own splits alone"));
        alone.row("splits alone", &alone);
        deferred.row("deferred", &alone);
    }
}

/// t(frame) = a + b · (splits and merges) + c · (vertices looked at), fitted over all frames of flights at several
/// speeds by least squares. A frame's time is its least of all rounds, so that interruptions do not count; frames in
/// which a patch comes into view that has no mesh yet are left out.
fn cost_of_change() {
    let heights = fields::fractal(1025);
    let world = World::new(&heights);
    let mut frames: Vec<[f64; 3]> = Vec::new();
    for speed in [0.1, 0.2, 0.5, 1.0, 2.0] {
        let cameras = flight::cameras(&heights, speed, FRAMES / 2);
        let spheres = tuned(&world, 9_000, &cameras);
        let mut best: Vec<[f64; 3]> = Vec::new();
        for _ in 0..rounds::ROUNDS {
            let mut walk = Following::new(&world, &spheres);
            for (at, camera) in cameras.iter().enumerate() {
                let meshes = walk.meshes();
                let ns = rounds::time_ms(|| walk.update(camera)) * 1e6;
                let [changed, examined] = walk.work().map(|count| count as f64);
                let ns = if walk.meshes() == meshes { ns } else { f64::INFINITY };
                match best.get_mut(at) {
                    Some(frame) => frame[2] = frame[2].min(ns),
                    None => best.push([changed, examined - changed, ns]),
                }
            }
        }
        frames.extend(best.iter().filter(|frame| frame[2].is_finite()));
    }
    let [a, b, c] = fitted(&frames);
    println!(
        "\ncost of a frame, {} frames at five speeds: {:.1} µs + {b:.0} ns a split or merge + {c:.0} ns a vertex looked at",
        frames.len(),
        a / 1e3
    );
}

/// The a, b, c for which a + b·x + c·y is nearest to z: the normal equations, solved by elimination.
fn fitted(samples: &[[f64; 3]]) -> [f64; 3] {
    let mut system = [[0.0f64; 4]; 3];
    for &[x, y, z] in samples {
        let row = [1.0, x, y];
        for i in 0..3 {
            for j in 0..3 {
                system[i][j] += row[i] * row[j];
            }
            system[i][3] += row[i] * z;
        }
    }
    for i in 0..3 {
        for k in 0..3 {
            if k != i {
                let share = system[k][i] / system[i][i];
                let pivot = system[i];
                system[k].iter_mut().zip(pivot).for_each(|(value, pivot)| *value -= share * pivot);
            }
        }
    }
    [0, 1, 2].map(|i| system[i][3] / system[i][i])
}

/// How a frame grows with the elevation model: the same number of triangles over grounds of all sizes.
fn sizes() {
    println!("\n9,000 triangles, one cell a frame, over grounds of several sizes");
    println!(
        "{:<8}{:>10}{:>12}{:>12}{:>12}{:>10}",
        "posts", "triangles", "median ms", "stateless", "changed", "looked at"
    );
    let sides = [257, 513, 1025, 2049, 4097];
    let fields: Vec<Vec<f32>> = sides.iter().map(|&posts| fields::fractal(posts)).collect();
    let worlds: Vec<World> = fields.iter().map(|heights| World::new(heights)).collect();
    let flights: Vec<Vec<Camera>> =
        fields.iter().map(|heights| flight::cameras(heights, 1.0, FRAMES)).collect();
    let spheres: Vec<SphereMap> =
        worlds.iter().zip(&flights).map(|(world, cameras)| tuned(world, 9_000, cameras)).collect();
    let mut yardsticks: Vec<Stateless> = fields.iter().map(|heights| Stateless::new(heights)).collect();
    let mut flown: Vec<[Flown; 2]> = sides.iter().map(|_| [Flown::new(), Flown::new()]).collect();
    for (yardstick, cameras) in yardsticks.iter_mut().zip(&flights) {
        yardstick.tune(9_000, cameras);
    }
    for _ in 0..rounds::ROUNDS {
        for at in 0..sides.len() {
            let [deferred, stateless] = &mut flown[at];
            fly(&mut Following::new(&worlds[at], &spheres[at]), &flights[at], deferred);
            fly_stateless(&mut yardsticks[at], &flights[at], stateless);
        }
    }
    for (at, posts) in sides.iter().enumerate() {
        let [deferred, stateless] = &flown[at];
        let [ours, theirs] = [deferred, stateless].map(|flown| rounds::median(&flown.medians));
        let looked_at = looked_at(&worlds[at], &spheres[at], &flights[at]);
        println!(
            "{:<8}{:>10.0}{ours:>12.4}{theirs:>12.4}{:>12.0}{looked_at:>10.0}",
            format!("{posts}²"),
            deferred.triangles,
            deferred.changed
        );
    }
    let last = flown.len() - 1;
    for (at, name) in ["deferred", "stateless"].into_iter().enumerate() {
        println!(
            "{name}, 4097² to 257²: {:.2}×",
            rounds::ratio(&flown[last][at].medians, &flown[0][at].medians)
        );
    }
}

fn looked_at(world: &World, spheres: &SphereMap, cameras: &[Camera]) -> f64 {
    let mut walk = Following::new(world, spheres);
    let counts = cameras.iter().map(|camera| {
        walk.update(camera);
        walk.work()[1] as f64
    });
    counts.skip(1).sum::<f64>() / (cameras.len() - 1) as f64
}

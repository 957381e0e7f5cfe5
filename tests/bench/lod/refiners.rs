//! The comparison of Lin et al. on its own terms: classic queues, forced split + forced merge, and splits alone.
//!
//! 1025² posts in patches of 64 cells, the circling flight of one post a frame, about 8,766, 7,656 and 6,360
//! triangles in the patches in view. A frame is culling and the update of the mesh, nothing is emitted. All
//! methods follow the same flight in turns, round by round, so that another program's load falls on all alike; a
//! method's figure is the median of its rounds' medians. Each frame is updated twice, the second time at rest:
//! what the first takes longer, over the splits and merges it made, is the price of one.
//!
//! Two criteria. Lin et al.'s own, variance over distance, is not monotone, so that splits are forced; nested spheres,
//! where they never are, is what the other sections of this benchmark refine by.

use std::time::{Duration, Instant};

use glam::{DVec2, Vec2, Vec3};
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::midpoint::Midpoint;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::culling::{Culling, cull};
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::DEFAULT_PATCH;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::changes::RefinementChanges;
use sandtable_roam::refine::coherent::Coherent;
use sandtable_roam::refine::queues::{Goal, Queues};
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::spheres::SphereMap;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_view::camera::Camera;

use crate::fields::fractal;

/// The triangles of Lin et al.'s three comparisons.
const TRIANGLES: [usize; 3] = [8_766, 7_656, 6_360];
const POSTS: u32 = 1025;
const SPACING_M: f32 = 10.0;
const FRAMES: u32 = 240;
const ROUNDS: usize = 5;

/// Prints the comparison.
pub fn print() {
    let world = World::new();
    println!(
        "\nRefiners: {POSTS}² posts, patches of {DEFAULT_PATCH}, {FRAMES} frames of one post, {ROUNDS} rounds"
    );
    for rule in [Rule::Variance, Rule::Spheres] {
        println!("\n{}", rule.title());
        println!("method                 triangles   ms/frame   at rest   ops/frame   ns/op   ns/triangle");
        for triangles in TRIANGLES {
            compare(&world, rule, triangles);
        }
    }
    println!();
    culling(&world);
}

#[derive(Clone, Copy)]
enum Rule {
    Variance,
    Spheres,
}

impl Rule {
    fn title(self) -> &'static str {
        match self {
            Self::Variance => "k · variance · width / distance (Lin et al.)",
            Self::Spheres => "nested spheres (Yu and Zhang)",
        }
    }
}

/// The terrain and what is measured of it once.
struct World(MeasuredGround);

impl World {
    fn new() -> Self {
        let spacing = DVec2::splat(f64::from(SPACING_M));
        let lattice = Lattice::new(DVec2::ZERO, spacing, POSTS, fractal(POSTS as usize)).expect("sound");
        let measured = MeasuredGround::new(lattice, DEFAULT_PATCH).expect("sound");
        measured.measure_patches();
        Self(measured)
    }

    fn ground(&self) -> PatchedGround<'_> {
        self.0.patched()
    }

    fn spheres(&self, meters_per_meter: f32) -> SphereMap {
        let own = self.0.midpoint().values().iter().map(|error| error * meters_per_meter).collect();
        SphereMap::nested(self.ground(), own)
    }

    /// The height in posts at a place in posts.
    fn height(&self, at: Vec2) -> f32 {
        let post = Post { column: at.x as u32, row: at.y as u32 };
        self.0.lattice().height(post) / SPACING_M
    }

    /// Along a circle of 0.3 × 512 posts, 30 posts above the ground about it, 8° down, 60° × 47°.
    fn camera(&self, frame: u32) -> Camera {
        let (middle, radius) = (256.0f32, 153.6f32);
        let place = |turn: f32| Vec2::splat(middle) + Vec2::new(turn.cos(), turn.sin()) * radius;
        let turn = frame as f32 / radius;
        let about = |step: i32| self.height(place(turn + step as f32 * 2.0 / radius));
        let ground = (-8..=8).map(about).sum::<f32>() / 17.0;
        let eye = place(turn).extend(ground + 30.0) * SPACING_M;
        let forward = Vec3::new(-turn.sin(), turn.cos(), -0.14);
        let fov_y = 2.0 * (30f32.to_radians().tan() * 0.75).atan();
        Camera::new(eye, eye + forward * 100.0, fov_y, (1024, 768), (1.0, 60_000.0)).expect("sound")
    }
}

/// One method with its mesh.
enum Method<'a> {
    Rebuild(ActiveSet),
    Coherent(Box<Coherent>),
    Queues(Box<Queues<'a>>),
}

impl Method<'_> {
    fn name(&self) -> &'static str {
        match self {
            Self::Rebuild(_) => "splits alone",
            Self::Coherent(_) => "split + merge",
            Self::Queues(_) => "queues, budget",
        }
    }

    fn update(&mut self, criterion: &impl Criterion, patches: &[Vertex]) -> RefinementChanges {
        match self {
            Self::Rebuild(active) => {
                *active = rebuild(active.layout(), criterion, patches.iter().copied());
                RefinementChanges::default()
            }
            Self::Coherent(refiner) => refiner.update(criterion, patches),
            Self::Queues(refiner) => refiner.update(criterion, patches),
        }
    }

    fn active(&self) -> &ActiveSet {
        match self {
            Self::Rebuild(active) => active,
            Self::Coherent(refiner) => refiner.active(),
            Self::Queues(refiner) => refiner.active(),
        }
    }
}

/// What a flight cost.
#[derive(Default)]
struct Flown {
    moving: Vec<Duration>,
    resting: Vec<Duration>,
    triangles: usize,
    operations: usize,
}

fn compare(world: &World, rule: Rule, triangles: usize) {
    let scale = scale_for(world, rule, triangles);
    let spheres = world.spheres(scale);
    let mut rounds: [Vec<Flown>; 3] = Default::default();
    for _ in 0..ROUNDS {
        for (which, flown) in rounds.iter_mut().enumerate() {
            let mut method = match which {
                0 => Method::Rebuild(ActiveSet::new(*world.0.layout())),
                1 => Method::Coherent(Box::new(Coherent::new(*world.0.layout()))),
                _ => Method::Queues(Box::new(Queues::new(world.ground(), Goal::Budget(triangles)))),
            };
            flown.push(fly(world, rule, scale, &spheres, &mut method));
            if flown.len() == ROUNDS {
                report(&method, flown);
            }
        }
    }
    let moving = rounds.each_ref().map(|flown| medians(flown, |flown| &flown.moving));
    println!(
        "  split + merge against splits alone {:.2}×, against queues {:.2}×",
        moving[0] / moving[1],
        moving[2] / moving[1]
    );
}

fn fly(world: &World, rule: Rule, scale: f32, spheres: &SphereMap, method: &mut Method<'_>) -> Flown {
    let (mut flown, mut patches) = (Flown::default(), Vec::new());
    for frame in 0..FRAMES {
        let camera = world.camera(frame);
        let variance = Midpoint::with_k(world.ground(), world.0.midpoint(), camera.eye(), k_of(scale));
        let nested = Spheres::new(world.ground(), spheres, camera.eye());
        let mut frame_takes = || {
            let start = Instant::now();
            cull(world.ground(), world.0.heights(), &Culling::frustum(&camera), &mut patches);
            let changes = match rule {
                Rule::Variance => method.update(&variance, &patches),
                Rule::Spheres => method.update(&nested, &patches),
            };
            (start.elapsed(), changes)
        };
        let (moving, changes) = frame_takes();
        let (resting, _) = frame_takes();
        // The first frames build the mesh.
        if frame >= 8 {
            flown.moving.push(moving);
            flown.resting.push(resting);
            flown.operations += changes.splits + changes.merges;
            flown.triangles += leaves(method.active(), &patches);
        }
    }
    flown.operations /= flown.moving.len();
    flown.triangles /= flown.moving.len();
    flown
}

fn report(method: &Method<'_>, rounds: &[Flown]) {
    let moving_ms = medians(rounds, |flown| &flown.moving);
    let resting_ms = medians(rounds, |flown| &flown.resting);
    let last = &rounds[rounds.len() - 1];
    let per_operation = match last.operations {
        0 => "-".to_owned(),
        operations => format!("{:.0}", (moving_ms - resting_ms) * 1e6 / operations as f64),
    };
    println!(
        "{:22} {:9} {moving_ms:10.4} {resting_ms:9.4} {:11} {per_operation:>7} {:13.1}",
        method.name(),
        last.triangles,
        last.operations,
        moving_ms * 1e6 / last.triangles as f64,
    );
}

/// The median of the rounds' medians, milliseconds.
fn medians(rounds: &[Flown], times: fn(&Flown) -> &Vec<Duration>) -> f64 {
    median(rounds.iter().map(|flown| median(times(flown).iter().map(Duration::as_secs_f64)) * 1e3))
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// Lin et al.'s k that reaches as far as spheres of `scale` meters a meter of error.
fn k_of(scale: f32) -> f32 {
    scale / ((POSTS - 1) as f32 * SPACING_M)
}

/// Frames whose triangles are counted to find a scale.
const COUNTED: u32 = 24;

/// The scale at which splits alone make so many triangles on average.
fn scale_for(world: &World, rule: Rule, triangles: usize) -> f32 {
    let (mut low, mut high) = (1f32, 1e4f32);
    for _ in 0..14 {
        let scale = (low * high).sqrt();
        let spheres = world.spheres(scale);
        let mut found = 0;
        for frame in (0..FRAMES).step_by((FRAMES / COUNTED) as usize) {
            let camera = world.camera(frame);
            let mut patches = Vec::new();
            cull(world.ground(), world.0.heights(), &Culling::frustum(&camera), &mut patches);
            let variance = Midpoint::with_k(world.ground(), world.0.midpoint(), camera.eye(), k_of(scale));
            let nested = Spheres::new(world.ground(), &spheres, camera.eye());
            let active = match rule {
                Rule::Variance => rebuild(world.0.layout(), &variance, patches.iter().copied()),
                Rule::Spheres => rebuild(world.0.layout(), &nested, patches.iter().copied()),
            };
            found += leaves(&active, &patches);
        }
        if found / COUNTED as usize > triangles { high = scale } else { low = scale }
    }
    (low * high).sqrt()
}

fn leaves(active: &ActiveSet, patches: &[Vertex]) -> usize {
    let mut stack: Vec<Triangle> =
        patches.iter().flat_map(|&corner| Triangle::roots(corner, active.layout().patch())).collect();
    let mut leaves = 0;
    while let Some(triangle) = stack.pop() {
        if triangle.is_finest() || !active.is_active(triangle.split_vertex()) {
            leaves += 1;
        } else {
            stack.extend(triangle.split());
        }
    }
    leaves
}

/// What culling costs, by wedge, by frustum, and by asking every patch.
fn culling(world: &World) {
    const TIMES: u32 = 200;
    let ground = world.ground();
    let mut found = Vec::new();
    println!("culling of {} patches     µs   patches in view", world.0.layout().patch_count());
    for (name, culling_of) in
        [("wedge (Lin et al.)", Culling::wedge as fn(&Camera) -> Culling), ("frustum", Culling::frustum)]
    {
        let mut seen = 0;
        let times = (0..FRAMES).map(|frame| {
            let culling = culling_of(&world.camera(frame));
            let start = Instant::now();
            for _ in 0..TIMES {
                cull(ground, world.0.heights(), &culling, &mut found);
            }
            seen += found.len();
            start.elapsed().as_secs_f64() * 1e6 / f64::from(TIMES)
        });
        let times: Vec<f64> = times.collect();
        println!("{name:24} {:6.2} {:17}", median(times.into_iter()), seen / FRAMES as usize);
    }
}

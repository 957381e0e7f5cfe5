//! Looking over the ground: the pyramid, lines of sight between random posts, and the rays of a picture, beside Embree.
//!
//! Embree 3 (Intel's ray tracing library) is asked in a process of its own, round by round between ours, where `g++` and
//! its headers are installed: as the grid that it has for fields of heights, and as the very triangles of the ground. One
//! thread each. It answers whether *anything* stands between; ours says what stands there *first*.

use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::pyramid::Pyramid;
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::line::{Sight, SightEnd};
use sandtable_terrain::sight::ray::Ray;

use crate::fields::fractal;
use crate::peers;
use crate::rounds::{ROUNDS, interleaved, median, quantile, ratio, time_ms};

/// Meters between posts.
const CELL_M: f64 = 10.0;
/// How high above the ground both ends of a line stand: eyes.
const ABOVE_M: f64 = 1.8;
/// Lines of sight a round.
const PAIRS: usize = 300_000;
/// The picture whose rays are cast.
const PICTURE: (usize, usize) = (1024, 768);

/// Prints the section.
pub fn print() {
    for n in [1025, 4097] {
        compare(n);
    }
}

fn compare(n: usize) {
    let heights = fractal(n);
    let pairs = random_pairs(n);
    let rays = picture_rays(n, &heights);
    // As grids only where triangles would take gigabytes.
    let kinds: &[&str] = if n <= 1025 { &["grid", "triangles"] } else { &["grid"] };
    let mut peers: Vec<Embree> =
        kinds.iter().filter_map(|kind| Embree::start(kind, n, &heights, &pairs, &rays)).collect();
    let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(CELL_M), n as u32, heights).expect("sound");
    let ground = SightGround::new(Arc::new(lattice));
    builds(n, &ground, &mut peers);
    lines(&ground, &pairs, &mut peers);
    picture(&ground, &rays, &mut peers);
}

fn builds(n: usize, ground: &SightGround, peers: &mut [Embree]) {
    let rounds = if n > 2000 { 3 } else { ROUNDS };
    let mut ours = || one_thread(|| time_ms(|| Pyramid::new(ground.lattice())));
    let all = run(rounds, &mut ours, peers, "build");
    let share = ground.pyramid().bytes() as f64 / (4 * ground.lattice().heights().len()) as f64;
    println!("{n}²: building, one thread");
    println!("  {:<18} {:>9.2} ms   {share:>5.2} × the heights", "pyramid", median(&all[0].0));
    for (peer, (times, bytes)) in peers.iter().zip(&all[1..]) {
        let share = bytes / (4 * n * n) as f64;
        let times_as_long = ratio(times, &all[0].0);
        println!(
            "  {:<18} {:>9.2} ms   {share:>5.2} × the heights   {times_as_long:>6.1} × as long",
            peer.name(),
            median(times)
        );
    }
}

fn lines(ground: &SightGround, pairs: &[[u32; 4]], peers: &mut [Embree]) {
    let end =
        |x: u32, y: u32| SightEnd { at: DVec2::new(f64::from(x), f64::from(y)) * CELL_M, above_m: ABOVE_M };
    let asked: Vec<(SightEnd, SightEnd)> =
        pairs.iter().map(|&[x, y, to_x, to_y]| (end(x, y), end(to_x, to_y))).collect();
    let mut blocked = 0;
    let mut ours = || {
        one_thread(|| {
            time_ms(|| {
                let looks = asked.iter().map(|&(observer, target)| {
                    matches!(ground.line_of_sight(observer, target, Curvature::FLAT), Sight::Blocked(_))
                });
                blocked = looks.filter(|&blocked| blocked).count();
            })
        })
    };
    let all = run(ROUNDS, &mut ours, peers, "los");
    println!("lines of sight between {PAIRS} pairs of random posts, {ABOVE_M} m above both");
    table(PAIRS, blocked, "blocked", &all, peers);
}

fn picture(ground: &SightGround, rays: &[[f32; 6]], peers: &mut [Embree]) {
    let asked: Vec<Ray> = rays
        .iter()
        .map(|&[x, y, z, east, north, up]| Ray {
            origin: DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * CELL_M,
            direction: DVec3::new(f64::from(east), f64::from(north), f64::from(up)),
        })
        .collect();
    let mut met = 0;
    let mut ours = || {
        one_thread(|| {
            time_ms(|| met = asked.iter().filter(|&&ray| ground.pick(ray, f64::INFINITY).is_some()).count())
        })
    };
    let all = run(ROUNDS, &mut ours, peers, "primary");
    println!("the rays of a picture of {}×{}", PICTURE.0, PICTURE.1);
    table(asked.len(), met, "met", &all, peers);
}

fn table(count: usize, found: usize, what: &str, all: &[(Vec<f64>, f64)], peers: &[Embree]) {
    let rate = |times: &[f64]| count as f64 / median(times) / 1e3;
    let best = |times: &[f64]| count as f64 / quantile(times, 0.0) / 1e3;
    let row = |name: &str, times: &[f64], found: f64, more: String| {
        println!(
            "  {name:<18} {:>7.3} M/s ({:>7.3} at best)   {found:>7} {what}   {more}",
            rate(times),
            best(times)
        );
    };
    row("sandtable", &all[0].0, found as f64, String::new());
    for (peer, (times, found)) in peers.iter().zip(&all[1..]) {
        row(&peer.name(), times, *found, format!("{:.2} × as long", ratio(times, &all[0].0)));
    }
}

/// Ours and the peers in turn: times in milliseconds, and what was found in the last round (not of ours).
fn run(
    rounds: usize,
    ours: &mut dyn FnMut() -> f64,
    peers: &mut [Embree],
    what: &str,
) -> Vec<(Vec<f64>, f64)> {
    let mut found = vec![0.0; peers.len()];
    let mut asks: Vec<Box<dyn FnMut() -> f64 + '_>> = vec![Box::new(ours)];
    for (peer, found) in peers.iter_mut().zip(&mut found) {
        asks.push(Box::new(move || {
            let (time_ms, count) = peer.ask(what);
            *found = count;
            time_ms
        }));
    }
    let mut contenders: Vec<&mut dyn FnMut() -> f64> = asks.iter_mut().map(|ask| &mut **ask as _).collect();
    let times = interleaved(rounds, &mut contenders);
    drop(asks);
    times.into_iter().zip(std::iter::once(0.0).chain(found)).collect()
}

fn one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    pool.install(work)
}

/// Marsaglia's xorshift (2003) with a fixed start, from 0 up to 1.
fn random() -> impl FnMut() -> f64 {
    let mut state = 88_172_645_463_325_252u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn random_pairs(n: usize) -> Vec<[u32; 4]> {
    let mut random = random();
    (0..PAIRS).map(|_| std::array::from_fn(|_| (random() * (n - 1) as f64) as u32)).collect()
}

/// A camera 30 cells above the ground, three tenths into the field, that looks north-east and 8° down: 60° × 47°.
fn picture_rays(n: usize, heights: &[f32]) -> Vec<[f32; 6]> {
    let (width, height) = PICTURE;
    let at = (n as f32 - 1.0) * 0.3;
    let eye = heights[at as usize * n + at as usize] / CELL_M as f32 + 30.0;
    let ray = |index: usize| {
        let (column, row) = ((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
        let right = (2.0 * column / width as f32 - 1.0) * 0.577;
        let up = (1.0 - 2.0 * row / height as f32) * 0.433 - 0.14;
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let along = glam::Vec3::new(half - right * half, half + right * half, up).normalize();
        [at, at, eye, along.x, along.y, along.z]
    };
    (0..width * height).map(ray).collect()
}

/// A process that holds the field and answers round by round.
struct Embree {
    kind: &'static str,
    process: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Embree {
    fn start(
        kind: &'static str,
        n: usize,
        heights: &[f32],
        pairs: &[[u32; 4]],
        rays: &[[f32; 6]],
    ) -> Option<Self> {
        let program = compiled()?;
        let folder = peers::folder();
        let in_cells: Vec<f32> = heights.iter().map(|height| height / CELL_M as f32).collect();
        let pairs: Vec<f32> = pairs.iter().flatten().map(|&post| post as f32).collect();
        let files = [("heights", &in_cells[..]), ("pairs", &pairs), ("rays", rays.as_flattened())];
        let [heights, pairs, rays] = files.map(|(name, values)| {
            let path = folder.join(format!("embree-{n}.{name}"));
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            std::fs::write(&path, bytes).expect("the target directory can be written");
            path
        });
        let mut process = Command::new(program)
            .arg(heights)
            .args([&n.to_string(), kind])
            .args([pairs, rays])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the peer starts");
        let input = process.stdin.take().expect("a pipe");
        let output = BufReader::new(process.stdout.take().expect("a pipe"));
        Some(Self { kind, process, input, output })
    }

    fn name(&self) -> String {
        format!("Embree {}", self.kind)
    }

    /// Milliseconds, and what was counted.
    fn ask(&mut self, what: &str) -> (f64, f64) {
        writeln!(self.input, "{what}").expect("the peer listens");
        let mut line = String::new();
        self.output.read_line(&mut line).expect("the peer answers");
        let mut numbers = line.split_whitespace().map(|number| number.parse().expect("a number"));
        (numbers.next().expect("a time"), numbers.next().expect("a count"))
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The peer's program, compiled below the target directory.
fn compiled() -> Option<PathBuf> {
    let source = concat!(env!("SANDTABLE_ROOT"), "tests/bench/peers/embree.cpp");
    let program = peers::folder().join("embree");
    let made = Command::new("g++")
        .args(["-O3", "-march=native", source, "-o"])
        .arg(&program)
        .arg("-lembree3")
        .stderr(Stdio::null())
        .status();
    if made.is_ok_and(|status| status.success()) {
        return Some(program);
    }
    println!("(Embree 3 or g++ is not installed: its rows are left out)");
    None
}

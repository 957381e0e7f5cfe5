//! Batches of bilinear heights on one thread: points a second, beside a plain loop, beside what memory allows, and beside
//! other people's.

use std::fs;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;
use sandtable_geom::crs::Crs;
use sandtable_raster::answer::{Answer, Status};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::query::batch::HeightSlices;
use sandtable_terrain::query::service::{HeightService, Snapshot};
use sandtable_terrain::query::tiles::HeightTiles;
use sandtable_terrain::query::{Interpolation, Surface};

use crate::rounds::{ROUNDS, interleaved, median, ratio, time_ms};
use crate::{fields, peers};

/// Points of a batch: 32 MB of positions, more than any cache but the last.
const POINTS: usize = 2_000_000;

const CELL_M: f64 = 10.0;
const ORIGIN: DVec2 = DVec2::new(500_000.0, 4_000_000.0);

/// A ground, the same as a raster, and batches of positions on it.
struct Field {
    n: u32,
    service: HeightService,
    random: Vec<DVec2>,
    line: Vec<DVec2>,
}

pub fn print() {
    println!("million points a second, one thread, {POINTS} points a batch, medians of {ROUNDS} rounds\n");
    let mut peer = peers::python().map(|python| Peer::start(&python));
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for n in [4097, 513] {
        let field = Field::new(n);
        field.save();
        single.install(|| {
            tiles(&field);
            compare(&field, "random", &field.random, peer.as_mut());
            compare(&field, "line", &field.line, peer.as_mut());
        });
    }
}

fn tiles(field: &Field) {
    let epoch = field.service.snapshot();
    let lattice = epoch.lattice();
    let made = interleaved(3, &mut [&mut || time_ms(|| HeightTiles::new(lattice))]);
    let share = 16.0 / 9.0;
    println!("{}²: tiles are made in {:.0} ms and hold {share:.2} × the field", field.n, median(&made[0]));
}

fn compare(field: &Field, what: &'static str, at: &[DVec2], peer: Option<&mut Peer>) {
    let cold = field.service.snapshot();
    // A service of its own, whose tiles are made by the questions before the first round.
    let warm = HeightService::new(
        Arc::new(sandtable_terrain::query::source_raster::SourceRaster::from(Arc::clone(cold.source()))),
        Crs::local(),
        Arc::clone(cold.lattice()),
    )
    .snapshot();
    let mut out = Out::new();
    for _ in 0..=cold.lattice().heights().len() / POINTS + 1 {
        out.apart(&warm, Surface::Ground, &field.random);
    }
    assert_eq!(out.plain(cold.lattice(), at), out.heights_after(&warm, at), "the plain loop's heights");
    let indices: Vec<u32> = at.iter().map(|&at| index_of(cold.lattice(), at)).collect();
    let peer = std::cell::RefCell::new(peer);
    let ask = |who: &str| peer.borrow_mut().as_mut().map_or(f64::NAN, |peer| peer.ask(who, what, field.n));
    let out = std::cell::RefCell::new(out);
    let values = interleaved(
        ROUNDS,
        &mut [
            &mut || rate(|| out.borrow_mut().apart(&warm, Surface::Ground, at)),
            &mut || rate(|| out.borrow_mut().apart(&fresh(&cold), Surface::Ground, at)),
            &mut || rate(|| out.borrow_mut().answers(&warm, at)),
            &mut || rate(|| out.borrow_mut().apart(&cold, Surface::Source, at)),
            &mut || rate(|| _ = black_box(out.borrow_mut().plain(cold.lattice(), at))),
            &mut || rate(|| out.borrow_mut().reads(cold.lattice(), &indices)),
            &mut || ask("numba"),
            &mut || ask("answering"),
            &mut || ask("scipy"),
            &mut || ask("rasterio"),
        ],
    );
    println!("\n{}², {what}", field.n);
    let names = [
        "ground, heights and statuses apart",
        "— the same, before there are tiles",
        "ground, answers",
        "source, heights and statuses apart",
        "a plain loop, heights and statuses",
        "one read a point at its post (limit)",
        "numba loop, heights alone",
        "numba loop, heights and statuses",
        "scipy map_coordinates",
        "rasterio.sample, nearest",
    ];
    for (name, rates) in names.iter().zip(&values) {
        if median(rates).is_finite() {
            let times = ratio(&values[0], rates);
            println!("  {name:<38} {:8.2}   ours {times:7.2} ×", median(rates));
        }
    }
}

/// Million points a second.
fn rate(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    POINTS as f64 / start.elapsed().as_secs_f64() / 1e6
}

/// An epoch like this one that has not been asked anything.
fn fresh(epoch: &Snapshot) -> Arc<Snapshot> {
    HeightService::new(
        Arc::new(sandtable_terrain::query::source_raster::SourceRaster::from(Arc::clone(epoch.source()))),
        Crs::local(),
        Arc::clone(epoch.lattice()),
    )
    .snapshot()
}

/// Where answers go.
struct Out {
    heights_m: Vec<f64>,
    statuses: Vec<Status>,
    answers: Vec<Answer>,
}

impl Out {
    fn new() -> Self {
        Self {
            heights_m: vec![0.0; POINTS],
            statuses: vec![Status::Ok; POINTS],
            answers: vec![Answer::NoData; POINTS],
        }
    }

    fn apart(&mut self, epoch: &Snapshot, surface: Surface, at: &[DVec2]) {
        let out = HeightSlices { heights_m: &mut self.heights_m, statuses: &mut self.statuses };
        epoch.heights_apart(surface, Interpolation::Bilinear, at, out);
    }

    fn heights_after(&mut self, epoch: &Snapshot, at: &[DVec2]) -> f64 {
        self.apart(epoch, Surface::Ground, at);
        self.heights_m.iter().sum()
    }

    fn answers(&mut self, epoch: &Snapshot, at: &[DVec2]) {
        epoch.heights(Surface::Ground, Interpolation::Bilinear, at, &mut self.answers);
    }

    /// What one would write first; returns the sum of the heights.
    fn plain(&mut self, lattice: &Lattice, at: &[DVec2]) -> f64 {
        let (columns, heights) = (lattice.columns() as usize, lattice.heights());
        let last = DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
        for ((&at, height_m), status) in at.iter().zip(&mut self.heights_m).zip(&mut self.statuses) {
            let grid = (at - ORIGIN) / CELL_M;
            if !(grid.x >= 0.0 && grid.y >= 0.0 && grid.x <= last.x && grid.y <= last.y) {
                (*height_m, *status) = (f64::NAN, Status::Outside);
                continue;
            }
            let column = (grid.x as u32).min(lattice.columns() - 2);
            let row = (grid.y as u32).min(lattice.rows() - 2);
            let first = row as usize * columns + column as usize;
            let (x, y) = (grid.x - f64::from(column), grid.y - f64::from(row));
            let [sw, se] = [first, first + 1].map(|index| f64::from(heights[index]));
            let [nw, ne] = [first + columns, first + columns + 1].map(|index| f64::from(heights[index]));
            let (south, north) = (sw + (se - sw) * x, nw + (ne - nw) * x);
            *height_m = south + (north - south) * y;
            *status = if height_m.is_nan() { Status::NoData } else { Status::Ok };
        }
        self.heights_m.iter().sum()
    }

    fn reads(&mut self, lattice: &Lattice, indices: &[u32]) {
        let heights = lattice.heights();
        for (&index, height_m) in indices.iter().zip(&mut self.heights_m) {
            *height_m = f64::from(heights[index as usize]);
        }
    }
}

fn index_of(lattice: &Lattice, at: DVec2) -> u32 {
    let (cell, _) = lattice.cell_at(at - lattice.origin()).expect("on the ground");
    lattice.index(Post { ..cell }) as u32
}

impl Field {
    fn new(n: u32) -> Self {
        let heights = fields::fractal(n as usize);
        let southward: Vec<f32> = heights.chunks(n as usize).rev().flatten().copied().collect();
        let lattice = Lattice::new(ORIGIN, DVec2::splat(CELL_M), n, heights).expect("sound");
        let corner = ORIGIN + DVec2::new(-0.5, f64::from(n) - 0.5) * CELL_M;
        let raster = Raster {
            driver: "bench",
            data_type: "Float32",
            width: n,
            height: n,
            samples: Samples::F32(southward),
            meters_per_z: 1.0,
            states_z_unit: false,
            map_from_grid: glam::DAffine2::from_scale_angle_translation(
                DVec2::new(CELL_M, -CELL_M),
                0.0,
                corner,
            ),
            georeferenced: true,
            crs: None,
            ..Raster::without_place(1, 1)
        };
        let service = HeightService::new(
            Arc::new(sandtable_terrain::query::source_raster::SourceRaster::from(Arc::new(raster))),
            Crs::local(),
            Arc::new(lattice),
        );
        let extent = f64::from(n - 1) * CELL_M;
        let mut state = 88_172_645_463_325_252_u64;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let scattered = (0..POINTS).map(|_| ORIGIN + DVec2::new(random(), random()) * extent).collect();
        // A way across and across again, a third of a cell a step.
        let along = |index: usize| {
            let part = index as f64 / f64::from(n) * 0.3;
            ORIGIN + DVec2::new((part * 1.7) % 1.0, part % 1.0) * extent
        };
        Self { n, service, random: scattered, line: (0..POINTS).map(along).collect() }
    }

    /// Writes what the peers read.
    fn save(&self) {
        let write = |name: String, bytes: &[u8]| {
            fs::write(peers::folder().join(name), bytes).expect("the folder can be written");
        };
        let epoch = self.service.snapshot();
        let bytes = |values: &[f32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
        write(format!("field_{}.f32", self.n), &bytes(epoch.lattice().heights()));
        for (name, at) in [("random", &self.random), ("line", &self.line)] {
            let posts = at.iter().map(|&at| (at - ORIGIN) / CELL_M);
            let bytes: Vec<u8> =
                posts.flat_map(|at| [at.x.to_le_bytes(), at.y.to_le_bytes()]).flatten().collect();
            write(format!("{name}_{}.f64", self.n), &bytes);
        }
    }
}

/// The Python script that answers one command a line.
struct Peer {
    child: Child,
    commands: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    fn start(python: &str) -> Self {
        let script = concat!(env!("SANDTABLE_ROOT"), "tests/bench/peers/bilinear.py");
        let mut child = Command::new(python)
            .arg(script)
            .arg(peers::folder())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the Python starts");
        let (commands, answers) = (child.stdin.take(), child.stdout.take().expect("a pipe"));
        Self { child, commands, answers: BufReader::new(answers) }
    }

    fn ask(&mut self, who: &str, what: &str, n: u32) -> f64 {
        let commands = self.commands.as_mut().expect("a pipe");
        writeln!(commands, "{who} {what} {n}").expect("the script reads");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("the script answers");
        line.trim().parse().expect("a number")
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.commands = None;
        let _ = self.child.wait();
    }
}

//! Midpoint errors and extraction, beside other people's programs.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec2;

use sandtable_roam::errors::ErrorMap;
use sandtable_roam::extract::{Extract, extract};
use sandtable_roam::layout::PatchLayout;
use sandtable_terrain::lattice::Lattice;

use crate::fields;

/// Sizes with the rounds that are measured of each; odd, so that a median is a time that was measured.
const SIZES: [(usize, usize); 4] = [(513, 31), (1025, 15), (2049, 7), (4097, 5)];

const TOLERANCES_M: [f32; 2] = [1.0, 5.0];

/// Prints the tables.
pub fn print() {
    println!(
        "\nMidpoint error map, median ms; every round takes all in turn. Heights to fresh memory, but for"
    );
    println!(
        "\"again\", which reuses the last round's. Ratios are medians of the rounds' own, to the faster crate."
    );
    println!(
        "{:>5}{:>10}{:>10}{:>10}{:>10}{:>14}{:>10}{:>9}{:>10}{:>10}{:>10}",
        "n",
        "1 thread",
        "2",
        "again 1",
        "again 2",
        "martini_rtin",
        "martini",
        "memcpy",
        "× (1)",
        "× (2)",
        "2 : 1"
    );
    let grounds: Vec<Ground> = SIZES.map(|(size, rounds)| Ground::new(size, rounds)).into();
    for ground in &grounds {
        print_maps(ground);
    }
    println!("\nExtraction, one thread, median ns a triangle");
    println!(
        "{:>5}{:>8}{:>12}{:>8}{:>14}{:>10}{:>8}",
        "n", "meters", "triangles", "ours", "martini_rtin", "martini", "×"
    );
    for ground in &grounds {
        print_meshes(ground);
    }
}

struct Ground {
    size: usize,
    rounds: usize,
    lattice: Lattice,
    layout: PatchLayout,
}

impl Ground {
    fn new(size: usize, rounds: usize) -> Self {
        let posts = size as u32;
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), posts, fields::fractal(size));
        let layout = PatchLayout::new(posts, posts, posts - 1).expect("a power of two");
        Self { size, rounds, lattice: lattice.expect("sound ground"), layout }
    }

    fn map(&self) -> ErrorMap {
        ErrorMap::midpoint(&self.lattice, &self.layout)
    }

    fn columns(&self) -> Vec<Vec<f32>> {
        let size = self.size;
        (0..size).map(|x| (0..size).map(|y| self.lattice.heights()[y * size + x]).collect()).collect()
    }
}

/// Milliseconds that `work` takes; what it made is dropped after the clock is read.
fn ms<T>(work: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    let made = black_box(work());
    let spent = start.elapsed().as_secs_f64() * 1e3;
    drop(made);
    spent
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had")
}

/// The median over the rounds of a number made of a round's times.
fn median<const N: usize>(rounds: &[[f64; N]], number: impl Fn(&[f64; N]) -> f64) -> f64 {
    let mut numbers: Vec<f64> = rounds.iter().map(number).collect();
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

fn print_maps(ground: &Ground) {
    let (one, two) = (pool(1), pool(2));
    let rtin = martini_rtin::Martini::with_capacity(ground.size);
    let martini = martini::Martini::new(ground.size as u32);
    let heights = ground.lattice.heights();
    let (mut again, mut copy) = (ground.map(), heights.to_vec());
    let rounds: Vec<[f64; 7]> = (0..ground.rounds)
        .map(|_| {
            let columns = ground.columns();
            [
                ms(|| one.install(|| ground.map())),
                ms(|| two.install(|| ground.map())),
                ms(|| one.install(|| again.measure_midpoint(&ground.lattice, &ground.layout))),
                ms(|| two.install(|| again.measure_midpoint(&ground.lattice, &ground.layout))),
                ms(|| rtin.create_tile(columns)),
                ms(|| martini.create_terrain(|x, y| f64::from(heights[y * ground.size + x]))),
                ms(|| black_box(&mut copy).copy_from_slice(black_box(heights))),
            ]
        })
        .collect();
    let m = |at: usize| median(&rounds, |times| times[at]);
    let ratio = |at: usize| median(&rounds, |times| times[4].min(times[5]) / times[at]);
    let threads = median(&rounds, |times| times[2] / times[3]);
    println!(
        "{:>5}{:>10.3}{:>10.3}{:>10.3}{:>10.3}{:>14.2}{:>10.2}{:>9.3}{:>10.1}{:>10.1}{:>10.2}",
        ground.size,
        m(0),
        m(1),
        m(2),
        m(3),
        m(4),
        m(5),
        m(6),
        ratio(2),
        ratio(3),
        threads
    );
}

fn print_meshes(ground: &Ground) {
    let one = pool(1);
    let map = ground.map();
    let rtin = martini_rtin::Martini::with_capacity(ground.size);
    let tile = rtin.create_tile(ground.columns());
    let mut martini = martini::Martini::new(ground.size as u32);
    let heights = ground.lattice.heights();
    let terrain = martini.create_terrain(|x, y| f64::from(heights[y * ground.size + x]));
    let mut mesh = Extract::default();
    for tolerance_m in TOLERANCES_M {
        let rounds: Vec<[f64; 3]> = (0..ground.rounds)
            .map(|_| {
                [
                    ms(|| one.install(|| extract(&ground.layout, &map, tolerance_m, &mut mesh))),
                    ms(|| tile.get_mesh(tolerance_m)),
                    ms(|| {
                        let same = &mut |(u, v)| (u, v, 0.0);
                        terrain.construct_mesh(&mut martini, f64::from(tolerance_m), same)
                    }),
                ]
            })
            .collect();
        let count = mesh.triangles().len();
        let ns = |at: usize| median(&rounds, |times| times[at]) * 1e6 / count as f64;
        let ratio = median(&rounds, |times| times[1].min(times[2]) / times[0]);
        println!(
            "{:>5}{:>8}{:>12}{:>8.2}{:>14.2}{:>10.2}{:>8.1}",
            ground.size,
            tolerance_m,
            count,
            ns(0),
            ns(1),
            ns(2),
            ratio
        );
    }
}

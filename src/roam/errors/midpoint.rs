//! The midpoint error of every vertex: fast, and no bound.
//!
//! The vertical distance of the ground at a vertex from the middle of the hypotenuse that it splits, raised to the vertices
//! below it: the measure of right-triangulated irregular networks (Evans, Kirkpatrick, Townsend 2001, and the programs named
//! Martini), value for value. It reads one post a triangle, where the exact error reads all: of a tolerance of 5 m it leaves
//! errors of 7 to 10 m. It serves meshes of millions of posts that must be made at once, and comparisons with other programs.
//!
//! Costs about one pass over the memory of heights and errors, see `sweep`.

use std::borrow::Cow;

use crate::errors::ErrorMap;
use crate::errors::sweep::{OwnError, SweepSource};
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use sandtable_terrain::lattice::Lattice;

impl ErrorMap {
    /// The midpoint errors of `lattice`; in parallel, the same for any number of threads.
    ///
    /// A vertex without data, at the ends of its hypotenuse too, has no error of its own; where only some of the three have
    /// data it is infinite. Patch corners have none. Pinned posts are not special.
    pub fn midpoint(lattice: &Lattice, layout: &PatchLayout) -> Self {
        let mut map = Self { errors: Vec::new() };
        map.measure_midpoint(lattice, layout);
        map
    }

    /// [`ErrorMap::midpoint`] in the memory of this map where it has the size: allocating millions of errors takes as long
    /// as measuring them.
    pub fn measure_midpoint(&mut self, lattice: &Lattice, layout: &PatchLayout) {
        if self.errors.len() != layout.vertex_count() {
            self.errors = vec![0f32; layout.vertex_count()];
        }
        let heights = heights(lattice, layout);
        let source = SweepSource::new(&heights, layout);
        if !source.sweep::<Midpoints>(&mut self.errors) {
            let sound = source.sweep::<TornMidpoints>(&mut self.errors);
            debug_assert!(sound, "a measure with holes took none");
        }
    }
}

/// The height at every vertex: beyond a border, that of the nearest post on it.
fn heights<'a>(lattice: &'a Lattice, layout: &PatchLayout) -> Cow<'a, [f32]> {
    if lattice.columns() as usize == layout.columns() && lattice.rows() as usize == layout.rows() {
        return Cow::Borrowed(lattice.heights());
    }
    let mut padded = Vec::with_capacity(layout.vertex_count());
    for row in 0..layout.rows() {
        let first = lattice.index(layout.post(Vertex::new(0, row as i32)));
        let posts = &lattice.heights()[first..first + lattice.columns() as usize];
        padded.extend_from_slice(posts);
        padded.resize((row + 1) * layout.columns(), posts[posts.len() - 1]);
    }
    Cow::Owned(padded)
}

/// The midpoint error of a vertex of the layout alone, meters: the bits that a map is raised from. See
/// [`ErrorMap::midpoint`] for holes; 0 at patch corners.
pub fn midpoint_error_at(lattice: &Lattice, layout: &PatchLayout, vertex: Vertex) -> f32 {
    if layout.is_corner(vertex) {
        return 0.0;
    }
    let height = |vertex| lattice.height(layout.post(vertex));
    let [from, to] = vertex.hypotenuse().map(height);
    torn_off(from, to, height(vertex))
}

/// The distance of a height from the middle of two others, meters; in f64, where that middle is not rounded.
#[inline]
fn off(from: f32, to: f32, at: f32) -> f32 {
    ((f64::from(from) + f64::from(to)) * 0.5 - f64::from(at)).abs() as f32
}

/// [`off`]; infinite where some of the three are NaN, 0 where all are.
#[inline]
pub(crate) fn torn_off(from: f32, to: f32, at: f32) -> f32 {
    let off = off(from, to, at);
    if !off.is_nan() {
        off
    } else if from.is_nan() && to.is_nan() && at.is_nan() {
        0.0
    } else {
        f32::INFINITY
    }
}

/// Heights without NaN.
struct Midpoints;

/// Heights with NaN.
struct TornMidpoints;

impl OwnError for Midpoints {
    const HOLES: bool = false;

    fn own(from: f32, to: f32, at: f32) -> f32 {
        off(from, to, at)
    }
}

impl OwnError for TornMidpoints {
    const HOLES: bool = true;

    fn own(from: f32, to: f32, at: f32) -> f32 {
        torn_off(from, to, at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use proptest::prelude::*;

    /// The same by its words: every vertex's own error, then every vertex after its children.
    fn plain(lattice: &Lattice, layout: &PatchLayout) -> Vec<f32> {
        let mut errors = vec![0f32; layout.vertex_count()];
        let mut step = 1;
        while step < layout.patch() {
            for first in [(step, 0), (0, step), (step, step)] {
                for y in (first.1..layout.rows() as i32).step_by(2 * step as usize) {
                    for x in (first.0..layout.columns() as i32).step_by(2 * step as usize) {
                        let vertex = Vertex::new(x, y);
                        let below = vertex.children().filter(|&child| layout.contains(child));
                        let below = below.map(|child| errors[layout.index(child)]);
                        errors[layout.index(vertex)] =
                            below.fold(midpoint_error_at(lattice, layout, vertex), f32::max);
                    }
                }
            }
            step *= 2;
        }
        errors
    }

    fn lattice(columns: u32, heights: Vec<f32>) -> Lattice {
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), columns, heights).expect("sound")
    }

    fn rough(columns: u32, rows: u32, holes: &[usize]) -> Lattice {
        let mut state = 7u32;
        let mut heights: Vec<f32> = (0..columns * rows)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 8) as f32 / 4096.0 - 1000.0
            })
            .collect();
        for hole in holes {
            heights[hole % (columns * rows) as usize] = f32::NAN;
        }
        lattice(columns, heights)
    }

    fn pool(threads: usize) -> rayon::ThreadPool {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had")
    }

    proptest! {
        #[test]
        fn the_sweep_equals_the_plain_way_at_any_size_patch_and_number_of_threads(
            columns in 2u32..150, rows in 2u32..300, power in 1u32..8, snug: bool,
            holes in proptest::collection::vec(0usize..50_000, 0..6),
        ) {
            let patch = 1 << power;
            let fit = |posts: u32| if snug { (posts - 1).next_multiple_of(patch) + 1 } else { posts };
            let (columns, rows) = (fit(columns), fit(rows));
            let lattice = rough(columns, rows, &holes);
            let layout = PatchLayout::new(columns, rows, patch).expect("sound");
            let expected = plain(&lattice, &layout);
            for threads in [1, 2] {
                let map = pool(threads).install(|| ErrorMap::midpoint(&lattice, &layout));
                map.check(&layout);
                prop_assert!(map.values() == expected, "with {} threads", threads);
            }
        }

        #[test]
        fn given_errors_are_raised_to_their_children_and_no_further(
            columns in 2u32..100, rows in 2u32..200, power in 1u32..7,
        ) {
            let layout = PatchLayout::new(columns, rows, 1 << power).expect("sound");
            let own: Vec<f32> = (0..layout.vertex_count()).map(|at| (at * 7919 % 1009) as f32).collect();
            let mut expected = own.clone();
            let mut step = 1;
            while step < layout.patch() {
                for (x0, y0) in [(step, 0), (0, step), (step, step)] {
                    for y in (y0..layout.rows() as i32).step_by(2 * step as usize) {
                        for x in (x0..layout.columns() as i32).step_by(2 * step as usize) {
                            let vertex = Vertex::new(x, y);
                            for child in vertex.children().filter(|&child| layout.contains(child)) {
                                let below = expected[layout.index(child)];
                                let slot = &mut expected[layout.index(vertex)];
                                *slot = slot.max(below);
                            }
                        }
                    }
                }
                step *= 2;
            }
            let map = pool(2).install(|| ErrorMap::raised(own, &layout));
            for (at, (found, expected)) in map.values().iter().zip(&expected).enumerate() {
                let vertex = Vertex::new((at % layout.columns()) as i32, (at / layout.columns()) as i32);
                let expected = if layout.is_corner(vertex) { 0.0 } else { *expected };
                prop_assert_eq!(*found, expected, "{:?}", vertex);
            }
        }
    }

    #[test]
    fn a_single_bump_is_seen_by_all_its_ancestors_and_by_nobody_else() {
        let mut heights = vec![0f32; 17 * 17];
        heights[5 * 17 + 4] = 8.0;
        let layout = PatchLayout::new(17, 17, 16).expect("sound");
        let map = ErrorMap::midpoint(&lattice(17, heights), &layout);
        assert_eq!(map.at(&layout, Vertex::new(4, 5)), 8.0);
        assert_eq!(map.at(&layout, Vertex::new(8, 8)), 8.0);
        assert_eq!(map.at(&layout, Vertex::new(13, 13)), 0.0);
    }

    #[test]
    fn no_data_beside_data_is_refined_and_no_data_alone_is_not() {
        let mut heights = vec![3f32; 17 * 17];
        for row in heights.chunks_exact_mut(17) {
            row[..9].fill(f32::NAN);
        }
        let layout = PatchLayout::new(17, 17, 16).expect("sound");
        let map = ErrorMap::midpoint(&lattice(17, heights), &layout);
        assert_eq!(map.at(&layout, Vertex::new(8, 8)), f32::INFINITY);
        assert_eq!(map.at(&layout, Vertex::new(3, 3)), 0.0);
    }

    #[test]
    fn measuring_again_forgets_what_was_measured_before() {
        let layout = PatchLayout::new(33, 33, 8).expect("sound");
        let mut map = ErrorMap::midpoint(&rough(33, 33, &[]), &layout);
        let flat = lattice(33, vec![5.0; 33 * 33]);
        map.measure_midpoint(&flat, &layout);
        assert_eq!(map, ErrorMap::midpoint(&flat, &layout));
    }
}

//! The yardstick: the best pass that remembers nothing (Lindstrom and Pascucci 2001).
//!
//! Midpoint errors raised up the graph and nested radii, one recursion a frame that culls against the frustum and
//! writes 32-bit indices. Lengths are in cells, heights too. It knows one square of 2ⁿ + 1 posts, no patches, no
//! holes, no drawing lists, and is as fast as plain code gets at that.

use sandtable_view::camera::Camera;

use crate::flight::{CELL_M, planes, side};
use crate::rounds::bisected;

/// All six planes are known to be passed.
const INSIDE: u32 = 63;

/// The ground as this pass holds it, and the last frame's triangles.
pub struct Stateless {
    n: usize,
    levels: i32,
    heights: Vec<f32>,
    errors: Vec<f32>,
    radii: Vec<f32>,
    tolerance: f32,
    eye: [f32; 3],
    planes: [[f32; 4]; 6],
    /// Three indices a triangle.
    pub indices: Vec<u32>,
}

/// A triangle's corners and the middle of its hypotenuse with half the hypotenuse.
#[derive(Clone, Copy)]
struct Node {
    a: usize,
    b: usize,
    c: usize,
    middle: (i32, i32),
    half: (i32, i32),
    /// Levels left below it.
    below: i32,
}

impl Stateless {
    /// Prepares a square ground of heights in meters.
    pub fn new(heights_m: &[f32]) -> Self {
        let n = side(heights_m);
        let heights: Vec<f32> = heights_m.iter().map(|height| height / CELL_M).collect();
        let errors = midpoint_errors(&heights, n);
        let radii = nested_radii(&heights, n);
        Self {
            n,
            levels: 2 * (n - 1).ilog2() as i32,
            heights,
            errors,
            radii,
            tolerance: 1.0,
            eye: [0.0; 3],
            planes: [[0.0; 4]; 6],
            indices: Vec::new(),
        }
    }

    /// Sets the tolerance that shows `target` triangles, the mean over eight frames of the flight.
    pub fn tune(&mut self, target: usize, flight: &[Camera]) {
        let some: Vec<&Camera> = flight.iter().step_by(flight.len().div_ceil(8)).collect();
        let found = bisected(target as f64, (1e-7, 10.0), |tolerance| {
            self.tolerance = tolerance;
            let count = |camera: &&Camera| self.update(camera);
            some.iter().map(count).sum::<usize>() as f64 / some.len() as f64
        });
        self.tolerance = found;
    }

    /// The frame for one camera; how many triangles it has.
    pub fn update(&mut self, camera: &Camera) -> usize {
        self.eye = (camera.eye() / CELL_M).to_array();
        self.planes = planes(camera);
        self.indices.clear();
        let (n, m) = (self.n, self.n - 1);
        let h = (m / 2) as i32;
        let roots = [(0, m * n + m, m, (h, h)), (m * n + m, 0, m * n, (-h, -h))];
        for (a, b, c, half) in roots {
            self.refine(Node { a, b, c, middle: (h, h), half, below: self.levels }, 0);
        }
        self.indices.len() / 3
    }

    /// `inside` has a bit for every plane that the triangle is known to lie within.
    fn refine(&mut self, node: Node, mut inside: u32) {
        let Node { a, b, c, middle: (mx, my), half: (hx, hy), below } = node;
        let m = (a + b) >> 1;
        let (px, py, pz, radius) = (mx as f32, my as f32, self.heights[m], self.radii[m]);
        if inside != INSIDE {
            for (at, plane) in self.planes.iter().enumerate() {
                if inside & (1 << at) == 0 {
                    let distance = plane[0] * px + plane[1] * py + plane[2] * pz + plane[3];
                    if distance < -radius {
                        return;
                    }
                    if distance > radius {
                        inside |= 1 << at;
                    }
                }
            }
        }
        let (dx, dy, dz) = (px - self.eye[0], py - self.eye[1], pz - self.eye[2]);
        let reach = self.errors[m] / self.tolerance + radius;
        if below > 0 && dx * dx + dy * dy + dz * dz < reach * reach && self.errors[m] > 0.0 {
            let apex = if ((my - hx) * self.n as i32 + mx + hy) as usize == c {
                (mx + hy, my - hx)
            } else {
                (mx - hy, my + hx)
            };
            let (left, right) = ((mx - hx, my - hy), (mx + hx, my + hy));
            let l = ((apex.0 + left.0) / 2, (apex.1 + left.1) / 2);
            let r = ((apex.0 + right.0) / 2, (apex.1 + right.1) / 2);
            let below = below - 1;
            let to = |from: (i32, i32), end: (i32, i32)| (end.0 - from.0, end.1 - from.1);
            self.refine(Node { a: c, b: a, c: m, middle: l, half: to(l, left), below }, inside);
            self.refine(Node { a: b, b: c, c: m, middle: r, half: to(r, apex), below }, inside);
        } else {
            self.indices.extend_from_slice(&[a as u32, b as u32, c as u32]);
        }
    }

    /// Whether the triangles of a frame in which everything is in view cover the square once, each inner edge
    /// shared by two of them.
    pub fn check(&mut self, camera: &Camera) {
        self.update(camera);
        self.indices.clear();
        let (n, m) = (self.n, self.n - 1);
        let h = (m / 2) as i32;
        for (a, b, c, half) in [(0, m * n + m, m, (h, h)), (m * n + m, 0, m * n, (-h, -h))] {
            self.refine(Node { a, b, c, middle: (h, h), half, below: self.levels }, INSIDE);
        }
        let place = |index: u32| ((index as usize % n) as i64, (index as usize / n) as i64);
        let area = |corners: &[u32]| {
            let [a, b, c] = [place(corners[0]), place(corners[1]), place(corners[2])];
            ((b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)).abs()
        };
        let whole: i64 = self.indices.chunks_exact(3).map(area).sum();
        assert_eq!(whole, 2 * (m * m) as i64, "the yardstick's triangles cover the square");
        let mut edges = std::collections::BTreeMap::new();
        for corners in self.indices.chunks_exact(3) {
            for side in 0..3 {
                let (from, to) = (corners[side], corners[(side + 1) % 3]);
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += 1;
            }
        }
        let on_border = |&(from, to): &(u32, u32)| {
            let (from, to, m) = (place(from), place(to), m as i64);
            from.0 == to.0 && (from.0 == 0 || from.0 == m) || from.1 == to.1 && (from.1 == 0 || from.1 == m)
        };
        let open = edges.iter().filter(|&(edge, &count)| count != 2 && !on_border(edge)).count();
        assert_eq!(open, 0, "the yardstick's mesh is conforming");
    }
}

/// Errors at the middles of hypotenuses, each raised to those below it, level by level.
fn midpoint_errors(heights: &[f32], n: usize) -> Vec<f32> {
    let mut errors = vec![0f32; n * n];
    let mut step = 1;
    while 2 * step < n {
        for (i, ends) in edge_middles(n, step) {
            let below = diagonal_neighbors(n, i, step / 2).map(|j| errors[j]).fold(0f32, f32::max);
            errors[i] = off_middle(heights, i, ends).max(below);
        }
        for (i, ends) in centers(n, step) {
            let below = [i - step, i + step, i - step * n, i + step * n].map(|j| errors[j]);
            errors[i] = below.into_iter().fold(off_middle(heights, i, ends), f32::max);
        }
        step *= 2;
    }
    errors
}

fn off_middle(heights: &[f32], i: usize, [a, b]: [usize; 2]) -> f32 {
    ((f64::from(heights[a]) + f64::from(heights[b])) / 2.0 - f64::from(heights[i])).abs() as f32
}

/// Radii about vertices that hold everything below them.
fn nested_radii(heights: &[f32], n: usize) -> Vec<f32> {
    let mut radii = vec![0f32; n * n];
    let mut step = 1;
    while 2 * step < n {
        let half = step / 2;
        for (i, _) in edge_middles(n, step) {
            let below = diagonal_neighbors(n, i, half).map(|j| {
                let rise = heights[i] - heights[j];
                radii[j] + ((2 * half * half) as f32 + rise * rise).sqrt()
            });
            radii[i] = below.fold(step as f32, f32::max);
        }
        for (i, _) in centers(n, step) {
            let below = [i - step, i + step, i - step * n, i + step * n].map(|j| {
                let rise = heights[i] - heights[j];
                radii[j] + ((step * step) as f32 + rise * rise).sqrt()
            });
            radii[i] = below.into_iter().fold(step as f32 * 1.42, f32::max);
        }
        step *= 2;
    }
    radii
}

/// The middles of edges of length 2 · `step` with the edges' ends.
fn edge_middles(n: usize, step: usize) -> impl Iterator<Item = (usize, [usize; 2])> {
    (0..n).step_by(step).flat_map(move |y| {
        let eastward = (y / step).is_multiple_of(2);
        let (first, apart) = if eastward { (step, step) } else { (0, step * n) };
        (first..n).step_by(2 * step).map(move |x| (y * n + x, [y * n + x - apart, y * n + x + apart]))
    })
}

/// The centers of squares of side 2 · `step` with the ends of their diagonals.
fn centers(n: usize, step: usize) -> impl Iterator<Item = (usize, [usize; 2])> {
    let side = 2 * step;
    (step..n).step_by(side).flat_map(move |y| {
        (step..n).step_by(side).map(move |x| {
            let i = y * n + x;
            let rises = (x / side + y / side).is_multiple_of(2);
            let apart = if rises { step * n + step } else { step * n - step };
            (i, [i - apart, i + apart])
        })
    })
}

/// The vertices `half` away along both axes; none for a half of 0.
fn diagonal_neighbors(n: usize, i: usize, half: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % n, i / n);
    let corners = [(-1, -1), (1, -1), (-1, 1), (1, 1)];
    corners.into_iter().take(if half > 0 { 4 } else { 0 }).filter_map(move |(dx, dy): (isize, isize)| {
        let x = x.checked_add_signed(dx * half as isize).filter(|&x| x < n)?;
        let y = y.checked_add_signed(dy * half as isize).filter(|&y| y < n)?;
        Some(y * n + x)
    })
}

//! Voids: samples without data that are enclosed by samples with data, and their filling.
//!
//! A void is a set of samples without data that are neighbors along rows and columns, none of them on the raster's
//! border: at the border the data ends, and nothing is filled.
//!
//! Filling stretches a **membrane** over each void from its rim: heights inside solve Laplace's equation, so that each
//! is the mean of its four neighbors, weighted by nearness where cells are not square. It passes through the rim
//! without a step, has no hill or hollow inside, and reproduces a plane exactly. Ridges and valleys across a wide void
//! are lost: voids above a size are left. Solved by successive over-relaxation (Young 1954) in the order of the
//! samples: the same bits everywhere.

use glam::DVec2;

use crate::raster::Raster;
use sandtable_base::message::numbers::counted;
use sandtable_geom::crs::Crs;

/// Voids of more samples than this are not filled: across three hundred posts a membrane is unrelated to the ground.
/// Also bounds the time, which grows with the power of one and a half.
pub const MOST_CELLS: u64 = 100_000;

/// At rest no height moves more than this in a sweep, in the vertical unit: far below the resolution of any survey.
const AT_REST: f64 = 1e-6;

/// The most sweeps per sample of a void's longer side. Over-relaxation needs about two.
const SWEEPS_PER_SIDE: usize = 12;

/// The voids that were filled and left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Filled {
    /// Voids filled.
    pub voids: u64,
    /// Samples filled.
    pub cells: u64,
    /// Voids left because they are too large.
    pub voids_left: u64,
    /// Samples in those.
    pub cells_left: u64,
}

impl Filled {
    /// The counts in one line.
    pub fn note(&self) -> String {
        let samples = |count: u64| counted(count, "sample", "samples");
        let voids = |count: u64| counted(count, "void", "voids");
        let mut note =
            format!("{} in {} filled by a membrane from their rims", samples(self.cells), voids(self.voids));
        if self.voids_left > 0 {
            note.push_str(&format!(
                "; {} in {} of more than {MOST_CELLS} left",
                samples(self.cells_left),
                voids(self.voids_left)
            ));
        }
        note
    }
}

/// Fills the voids of `raster` of up to [`MOST_CELLS`] samples; all other samples keep their values.
pub fn fill(raster: &mut Raster) -> Filled {
    let mut filled = Filled::default();
    let mut heights: Vec<(usize, f64)> = Vec::new();
    each(raster, |void| {
        if void.count > MOST_CELLS {
            filled.voids_left += 1;
            filled.cells_left += void.count;
            return;
        }
        filled.voids += 1;
        filled.cells += void.count;
        let solved = Membrane::new(raster, &void.cells).solve();
        heights.extend(void.cells.iter().copied().zip(solved));
    });
    for (index, height) in heights {
        raster.samples.set(index, height);
    }
    filled
}

struct Void {
    /// Its samples in order; cut off at [`MOST_CELLS`].
    cells: Vec<usize>,
    count: u64,
}

/// Calls `visit` with every void, in the order of their first samples.
fn each(raster: &Raster, mut visit: impl FnMut(Void)) {
    let mut seen = vec![false; raster.samples.len()];
    let mut open = Vec::new();
    for start in 0..seen.len() {
        if seen[start] || !raster.samples.get(start).is_nan() {
            continue;
        }
        let mut void = Void { cells: Vec::new(), count: 0 };
        let mut on_border = false;
        seen[start] = true;
        open.push(start);
        while let Some(at) = open.pop() {
            void.count += 1;
            if void.count <= MOST_CELLS {
                void.cells.push(at);
            }
            let around = raster.beside(at);
            on_border |= around.contains(&None);
            for next in around.into_iter().flatten() {
                if !seen[next] && raster.samples.get(next).is_nan() {
                    seen[next] = true;
                    open.push(next);
                }
            }
        }
        if !on_border {
            void.cells.sort_unstable();
            visit(void);
        }
    }
}

/// The weights of a neighbor along a row and along a column: inverse squares of distances, of which four add up to 1.
/// In degrees they are those at the sample `at`, to a hundredth of a degree: a part of a raster is filled as in the whole.
fn weights(raster: &Raster, at: usize) -> DVec2 {
    let mut spacing = raster.spacing();
    if raster.crs.as_ref().is_some_and(Crs::is_geographic) {
        let width = raster.width as usize;
        let center = DVec2::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5);
        let latitude_deg = (raster.map_from_grid.transform_point2(center).y * 100.0).round() / 100.0;
        spacing.x *= libm::cos(latitude_deg.to_radians()).abs();
    }
    let weights = (spacing * spacing).recip();
    let weights = weights / (2.0 * (weights.x + weights.y));
    if weights.is_finite() { weights } else { DVec2::splat(0.25) }
}

/// The heights over one void and of its rim.
struct Membrane {
    /// First the void's samples, then the rim's, which are fixed.
    heights: Vec<f64>,
    /// Per sample of the void: the indices of its west, east, north and south neighbors in `heights`.
    around: Vec<[u32; 4]>,
    weights: DVec2,
    /// The lowest and the highest of the rim: no height of a membrane lies outside.
    range: (f64, f64),
    /// Samples along the longer side of the void's rectangle.
    side: usize,
}

impl Membrane {
    /// A flat membrane at the rim's mean height. `cells` are in order, and none is on the raster's border.
    fn new(raster: &Raster, cells: &[usize]) -> Self {
        let weights = weights(raster, cells.first().copied().unwrap_or_default());
        let width = raster.width as usize;
        let mut rim: Vec<f64> = Vec::new();
        let mut index_of = |index: usize| match cells.binary_search(&index) {
            Ok(at) => at as u32,
            Err(_) => {
                rim.push(raster.samples.get(index));
                (cells.len() + rim.len() - 1) as u32
            }
        };
        let around: Vec<[u32; 4]> =
            cells.iter().map(|&at| [at - 1, at + 1, at - width, at + width].map(&mut index_of)).collect();
        let mean = rim.iter().sum::<f64>() / rim.len() as f64;
        let lowest = rim.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = rim.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let columns = || cells.iter().map(|at| at % width);
        let side = match (columns().min(), columns().max(), cells) {
            (Some(west), Some(east), [first, .., last]) => {
                (east - west + 1).max(last / width - first / width + 1)
            }
            _ => 1,
        };
        let heights = vec![mean; cells.len()].into_iter().chain(rim).collect();
        Self { heights, around, weights, range: (lowest, highest), side }
    }

    /// Returns the heights of the void's samples, at rest.
    fn solve(mut self) -> Vec<f64> {
        // The factor that is best for a square void of this side.
        let factor = 2.0 / (1.0 + libm::sin(std::f64::consts::PI / (self.side + 1) as f64));
        for _ in 0..SWEEPS_PER_SIDE * (self.side + 2) {
            if self.sweep(factor) <= AT_REST {
                break;
            }
        }
        self.heights.truncate(self.around.len());
        self.heights
    }

    /// Moves every height once; returns the farthest that any moved.
    fn sweep(&mut self, factor: f64) -> f64 {
        let mut farthest: f64 = 0.0;
        for (at, around) in self.around.iter().enumerate() {
            let [west, east, north, south] = around.map(|index| self.heights[index as usize]);
            let mean = self.weights.x * (west + east) + self.weights.y * (north + south);
            let old = self.heights[at];
            let new = (old + factor * (mean - old)).clamp(self.range.0, self.range.1);
            self.heights[at] = new;
            farthest = farthest.max((new - old).abs());
        }
        farthest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;
    use crate::void_counts::VoidCounts;

    /// A plane with the samples cleared that `hole` names by column and row.
    fn plane(side: u32, hole: impl Fn(u32, u32) -> bool) -> Raster {
        let at = |index: u32| (index % side, index / side);
        let height = |(column, row): (u32, u32)| 100.0 + 3.0 * column as f32 - 2.0 * row as f32;
        let values = (0..side * side).map(at);
        small(side, side, values.map(|at| if hole(at.0, at.1) { f32::NAN } else { height(at) }).collect())
    }

    #[test]
    fn a_void_in_a_plane_becomes_the_plane() {
        let disc = |column: u32, row: u32| column.abs_diff(32).pow(2) + row.abs_diff(30).pow(2) < 500;
        let mut raster = plane(64, disc);
        let before = raster.clone();
        let filled = fill(&mut raster);
        assert_eq!((filled.voids, filled.voids_left), (1, 0));
        assert_eq!(filled.cells, before.samples.iter().filter(|height| height.is_nan()).count() as u64);
        let whole = plane(64, |_, _| false);
        for (index, (ours, wanted)) in raster.samples.iter().zip(whole.samples.iter()).enumerate() {
            assert!((ours - wanted).abs() < 1e-4, "sample {index}: {ours} for {wanted}");
        }
    }

    #[test]
    fn holes_at_the_border_are_left() {
        let mut raster = plane(8, |column, row| (column == 3 && row < 4) || (column == 6 && row == 6));
        assert_eq!(VoidCounts::of(&raster), VoidCounts { voids: 1, samples: 1 });
        assert_eq!(fill(&mut raster), Filled { voids: 1, cells: 1, ..Filled::default() });
        assert_eq!(raster.at(6, 6), 106.0);
        assert!(raster.at(3, 0).is_nan() && raster.at(3, 3).is_nan());
    }

    #[test]
    fn voids_that_touch_at_a_corner_are_two() {
        let raster = plane(8, |column, row| column == row && (2..4).contains(&column));
        assert_eq!(VoidCounts::of(&raster), VoidCounts { voids: 2, samples: 2 });
    }

    #[test]
    fn a_membrane_is_the_mean_of_its_neighbors_and_stays_within_its_rim() {
        let mut raster = plane(40, |_, _| false);
        let rough = |index: usize| ((index * 7919) % 1009) as f64;
        for index in 0..raster.samples.len() {
            let (column, row) = (index % 40, index / 40);
            let hole = (5..33).contains(&column) && (8..30).contains(&row) && (column + row) % 11 != 0;
            raster.samples.set(index, if hole { f64::NAN } else { rough(index) });
        }
        let holes: Vec<bool> = raster.samples.iter().map(f64::is_nan).collect();
        let filled = fill(&mut raster);
        assert_eq!(filled.cells, holes.iter().filter(|hole| **hole).count() as u64);
        for index in (0..1600).filter(|&index| holes[index]) {
            let around = [index - 1, index + 1, index - 40, index + 40].map(|at| raster.samples.get(at));
            let mean = around.iter().sum::<f64>() / 4.0;
            let height = raster.samples.get(index);
            assert!((height - mean).abs() < 2e-4, "sample {index}: {height} for {mean}");
            assert!((0.0..=1008.0).contains(&height));
        }
    }

    #[test]
    fn a_void_that_is_too_large_is_left_and_counted() {
        let side = 400;
        let mut raster = plane(side, |column, row| (1..399).contains(&column) && (1..399).contains(&row));
        let filled = fill(&mut raster);
        assert_eq!(filled, Filled { voids_left: 1, cells_left: 398 * 398, ..Filled::default() });
        assert!(filled.note().contains("158404 samples in 1 void"), "{}", filled.note());
        assert!(raster.at(200, 200).is_nan());
    }
}

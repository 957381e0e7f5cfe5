//! Implausible samples: spikes, pits, and holes that were filled with one value.
//!
//! A spike or a pit is a single sample far from its eight neighbors, which agree with one another: a bird under a laser, a
//! slip of the pen, a sample without data that the file does not declare. A hole is a region of one value inside the raster
//! that ends in a step all around, as radar data have them where a slope was in the shade.

use crate::raster::Raster;
use crate::undeclared::{median, usual_steps};

/// A spike stands this many times as far from its neighbors' median as they lie apart: a summit has slopes, which spread its
/// neighbors. Smaller values take sharp summits for spikes.
const AGAINST_NEIGHBORS: f64 = 6.0;

/// The least height of a spike above its neighbors, in meters: lower ones are grass, walls and noise.
const LEAST_SPIKE_M: f64 = 15.0;

/// The least rise of a spike over one cell: what is less steep is a hill of a coarse model.
const LEAST_RISE: f64 = 0.5;

/// Of eight neighbors, those that must have data.
const LEAST_NEIGHBORS: usize = 5;

/// Fewer samples of one value are no hole but a terrace.
const LEAST_HOLE: u64 = 9;

/// The step around a hole in meters, and how many times that between usual samples it is. Lakes end in banks, which are lower.
const LEAST_STEP_M: f64 = 5.0;
const STEP_RATIO: f64 = 8.0;

/// The kind of outliers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OutlierKind {
    /// Single samples far above their neighbors.
    Spike,
    /// Single samples far below their neighbors.
    Pit,
    /// A region of one value that ends in a step all around.
    Hole,
}

/// The outliers of one kind; of holes each by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Outliers {
    /// What is odd.
    pub kind: OutlierKind,
    /// How many samples are.
    pub samples: u64,
    /// Column and row of the one that is most so.
    pub at: (u32, u32),
    /// Its value in the vertical unit.
    pub value: f64,
    /// Its distance from the samples around, meters.
    pub step_m: f64,
}

/// The spikes, the pits and the holes of a raster whose cells are `cell_m` wide.
pub fn outliers(raster: &Raster, cell_m: f64) -> Vec<Outliers> {
    let mut all: Vec<Outliers> = Vec::new();
    for at in 0..raster.samples.len() {
        let Some(found) = spike(raster, at, cell_m) else { continue };
        match all.iter_mut().find(|known| known.kind == found.kind) {
            Some(known) => {
                let samples = known.samples + 1;
                if found.step_m > known.step_m {
                    *known = found;
                }
                known.samples = samples;
            }
            None => all.push(found),
        }
    }
    all.sort_by_key(|found| found.kind);
    all.extend(holes(raster));
    all
}

/// The sample as a spike or a pit; `None` where it is neither.
fn spike(raster: &Raster, at: usize, cell_m: f64) -> Option<Outliers> {
    let value = raster.samples.get(at);
    let (width, height) = (raster.width as usize, raster.height as usize);
    let (column, row) = (at % width, at / width);
    let mut around = [f64::NAN; 8];
    let mut count = 0;
    for (across, down) in [(0, 0), (1, 0), (2, 0), (0, 1), (2, 1), (0, 2), (1, 2), (2, 2)] {
        let (x, y) = ((column + across).wrapping_sub(1), (row + down).wrapping_sub(1));
        if x < width && y < height {
            let neighbor = raster.samples.get(y * width + x);
            if !neighbor.is_nan() {
                around[count] = neighbor;
                count += 1;
            }
        }
    }
    let around = &mut around[..count];
    if value.is_nan() || count < LEAST_NEIGHBORS {
        return None;
    }
    around.sort_unstable_by(f64::total_cmp);
    let to_m = raster.meters_per_z;
    let (middle, apart) = (around[count / 2], (around[count - 1] - around[0]) * to_m);
    let step_m = ((value - middle) * to_m).abs();
    let is_odd =
        step_m >= LEAST_SPIKE_M && step_m >= AGAINST_NEIGHBORS * apart && step_m >= LEAST_RISE * cell_m;
    let kind = if value > middle { OutlierKind::Spike } else { OutlierKind::Pit };
    is_odd.then_some(Outliers { kind, samples: 1, at: (column as u32, row as u32), value, step_m })
}

/// The regions of one value inside the raster that end in a step all around.
fn holes(raster: &Raster) -> Vec<Outliers> {
    let samples = &raster.samples;
    let (mut seen, mut found) = (vec![false; samples.len()], Vec::new());
    let mut usual_m = None;
    for first in 0..samples.len() {
        let value = samples.get(first);
        if seen[first]
            || value.is_nan()
            || !raster.beside(first).into_iter().flatten().any(|at| samples.get(at) == value)
        {
            continue;
        }
        let (mut open, mut steps, mut count, mut is_inside) = (vec![first], Vec::new(), 0u64, true);
        seen[first] = true;
        while let Some(at) = open.pop() {
            count += 1;
            for beside in raster.beside(at) {
                let Some(next) = beside else {
                    is_inside = false;
                    continue;
                };
                let height = samples.get(next);
                if height == value && !seen[next] {
                    seen[next] = true;
                    open.push(next);
                } else if height != value {
                    steps.push((height - value) * raster.meters_per_z);
                }
            }
        }
        if !is_inside || count < LEAST_HOLE {
            continue;
        }
        // All around it is lower than the ground beside, or higher: a terrace is both.
        let least = steps.iter().map(|step| step.abs()).fold(f64::INFINITY, f64::min);
        let same_side = steps.iter().all(|step| *step > 0.0) || steps.iter().all(|step| *step < 0.0);
        if same_side && least >= LEAST_STEP_M / 2.0 {
            let step_m = median(steps.into_iter().map(f64::abs).collect());
            let usual = *usual_m.get_or_insert_with(|| usual_step_m(raster));
            if step_m >= LEAST_STEP_M && step_m >= STEP_RATIO * usual {
                let width = raster.width as usize;
                let at = ((first % width) as u32, (first / width) as u32);
                found.push(Outliers { kind: OutlierKind::Hole, samples: count, at, value, step_m });
            }
        }
    }
    found
}

/// The middle of the differences between neighbors in a row, meters.
fn usual_step_m(raster: &Raster) -> f64 {
    median(usual_steps(raster, f64::NAN)) * raster.meters_per_z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    /// Hills on 60 by 60 samples.
    fn hills() -> Raster {
        let height = |at: u32| {
            let (column, row) = ((at % 60) as f32, (at / 60) as f32);
            300.0 + 30.0 * libm::sinf(column * 0.2) * libm::cosf(row * 0.15)
        };
        small(60, 60, (0..3600).map(height).collect())
    }

    fn kinds(raster: &Raster) -> Vec<(OutlierKind, u64)> {
        outliers(raster, 10.0).iter().map(|found| (found.kind, found.samples)).collect()
    }

    #[test]
    fn hills_have_no_outliers() {
        assert!(kinds(&hills()).is_empty());
        // A summit as steep as a roof, and a wall.
        let roof =
            |at: u32| 400.0 - 9.0 * ((at % 60) as f32 - 30.0).abs().max(((at / 60) as f32 - 30.0).abs());
        assert!(kinds(&small(60, 60, (0..3600).map(roof).collect())).is_empty());
        let cliff = |at: u32| if at % 60 < 20 { 0.0 } else { 80.0 + (at % 60) as f32 };
        assert!(kinds(&small(60, 60, (0..3600).map(cliff).collect())).is_empty());
    }

    #[test]
    fn spikes_and_pits_are_counted_and_the_worst_is_shown() {
        let mut raster = hills();
        raster.samples.set(20 * 60 + 30, 900.0);
        raster.samples.set(40 * 60 + 10, 700.0);
        raster.samples.set(50 * 60 + 50, -9999.0);
        let found = outliers(&raster, 10.0);
        assert_eq!(kinds(&raster), [(OutlierKind::Spike, 2), (OutlierKind::Pit, 1)]);
        assert_eq!((found[0].at, found[0].value), ((30, 20), 900.0));
        assert!(found[1].step_m > 10_000.0);
    }

    #[test]
    fn a_hole_of_one_value_is_found_and_a_lake_is_not() {
        let mut raster = hills();
        let block = |raster: &mut Raster, value: f64| {
            (0..16).for_each(|at| raster.samples.set((20 + at / 4) * 60 + 20 + at % 4, value));
        };
        block(&mut raster, 0.0);
        assert_eq!(kinds(&raster), [(OutlierKind::Hole, 16)]);
        let mut raster = small(60, 60, vec![300.0; 3600]);
        block(&mut raster, 298.0);
        assert!(kinds(&raster).is_empty(), "a lake below its banks");
    }
}

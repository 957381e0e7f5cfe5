//! Depressions breached: a way out of each pit is cut where that takes away the least ground.
//!
//! From each pit, the lowest first, a least-cost search (Lindsay and Dhun 2015; Lindsay 2016) looks for lower ground or an
//! outlet: a post costs the depth of a cut to the level of the pit, times the way to it. The ground is cut along the way, so
//! that it falls evenly. A pit without a way that is short and shallow enough stays, and is filled.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::directions::runs_m;
use super::fill::sortable;
use super::prepared::BREACHED;
use crate::error::AnalysisError;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::neighbors;
use sandtable_terrain::stop_flag::StopFlag;

/// The most posts that a way may lead away from its pit by column or row: what one search remembers is a square of them.
const MOST_POSTS: f64 = 1000.0;

/// How deep and how far a breach may be cut, meters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BreachLimits {
    /// The greatest depth of the cut below the ground.
    pub depth_m: f64,
    /// The greatest distance from the pit, by column or row.
    pub length_m: f64,
}

/// What was done about pits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BreachTally {
    /// Pits with a way out that was cut.
    pub breached: usize,
    /// Pits without one within the limits.
    pub left: usize,
}

/// What a search knows of the posts around a pit.
pub(super) struct BreachSearch {
    reach: i64,
    side: i64,
    /// The search that a post was last seen by, the cost to it, and the step by which it was reached.
    seen: Vec<(u32, f64, u8)>,
    round: u32,
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

/// Breaches the pits of `heights` on the posts of `ground`.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn breach(
    ground: &Lattice,
    heights: &mut [f32],
    limits: BreachLimits,
    stop: &StopFlag,
) -> Result<BreachTally, AnalysisError> {
    let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
    let mut search = BreachSearch::new(ground, limits.length_m)?;
    let mut pits: Vec<(u32, u32)> = (0..heights.len())
        .filter(|&index| is_pit(heights, index, columns, rows))
        .map(|index| (sortable(heights[index]), index as u32))
        .collect();
    pits.sort_unstable();
    let mut tally = BreachTally::default();
    stop.stretch(0.0..BREACHED, pits.len());
    for (_, pit) in pits {
        if stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        stop.did(1);
        // An earlier way may have drained it.
        if !is_pit(heights, pit as usize, columns, rows) {
            continue;
        }
        match search.way_out(ground, heights, pit as usize, limits.depth_m) {
            // A flat drains of itself where a way costs nothing.
            Some((0.0, _)) => {}
            Some((_, way)) => {
                cut(heights, &way);
                tally.breached += 1;
            }
            None => tally.left += 1,
        }
    }
    Ok(tally)
}

/// Whether water stays on a post: it is no outlet, none of its neighbors is lower, and none that is alike comes before it.
pub(super) fn is_pit(heights: &[f32], index: usize, columns: usize, rows: usize) -> bool {
    let height = heights[index];
    !is_outlet(heights, index, columns, rows)
        && neighbors(index, columns, rows).all(|(_, other)| (heights[other], other) > (height, index))
}

/// Whether a post lies at the border or beside a hole, or is one.
fn is_outlet(heights: &[f32], index: usize, columns: usize, rows: usize) -> bool {
    let (mut count, mut is_beside_hole) = (0, heights[index].is_nan());
    for (_, other) in neighbors(index, columns, rows) {
        count += 1;
        is_beside_hole |= heights[other].is_nan();
    }
    count < 8 || is_beside_hole
}

/// Cuts a way, from its end back to its pit, so that it falls evenly from the pit to the end.
fn cut(heights: &mut [f32], way: &[usize]) {
    let (Some(&end), Some(&pit)) = (way.first(), way.last()) else { return };
    let levels = [heights[end].min(heights[pit]), heights[pit]].map(f64::from);
    let last = (way.len() - 1).max(1) as f64;
    for (at, &index) in way.iter().enumerate() {
        let level = (levels[0] + (levels[1] - levels[0]) * at as f64 / last) as f32;
        heights[index] = heights[index].min(level);
    }
}

impl BreachSearch {
    /// A search for ways that lead at most so far from their pit.
    ///
    /// # Errors
    /// [`AnalysisError::Memory`].
    pub fn new(ground: &Lattice, length_m: f64) -> Result<Self, AnalysisError> {
        let longest = f64::from(ground.columns().max(ground.rows()));
        let reach = (length_m / ground.cell().min_element()).clamp(1.0, MOST_POSTS.min(longest)) as i64;
        let side = 2 * reach + 1;
        check_memory(
            (side * side) as u64 * 24,
            "the search for ways out of pits",
            "state a shorter `breach_length_m`",
        )?;
        let seen = vec![(0, 0.0, 0); (side * side) as usize];
        Ok(Self { reach, side, seen, round: 0, queue: BinaryHeap::new() })
    }

    /// The cheapest way from lower ground or an outlet back to a pit, with its cost; `None` where it would be too long or too deep.
    pub fn way_out(
        &mut self,
        ground: &Lattice,
        heights: &[f32],
        pit: usize,
        depth_m: f64,
    ) -> Option<(f64, Vec<usize>)> {
        let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
        let runs_m = runs_m(ground.cell());
        let (column, row) = ((pit % columns) as i64, (pit / columns) as i64);
        let (reach, side) = (self.reach, self.side);
        let slot = |index: usize| {
            let east = (index % columns) as i64 - column + reach;
            let north = (index / columns) as i64 - row + reach;
            let is_near = (0..side).contains(&east) && (0..side).contains(&north);
            is_near.then(|| (north * side + east) as usize)
        };
        self.round += 1;
        self.queue.clear();
        let level = f64::from(heights[pit]);
        self.seen[slot(pit)?] = (self.round, 0.0, u8::MAX);
        self.queue.push(Reverse((0, pit as u32)));
        while let Some(Reverse((bits, index))) = self.queue.pop() {
            let (index, cost) = (index as usize, f64::from_bits(bits));
            let (_, known, _) = self.seen[slot(index)?];
            if cost > known {
                continue;
            }
            if index != pit && (heights[index] < heights[pit] || is_outlet(heights, index, columns, rows)) {
                return Some((cost, self.back(index, pit, columns, slot)));
            }
            for (step, other) in neighbors(index, columns, rows) {
                let depth = (f64::from(heights[other]) - level).max(0.0);
                let Some(slot) = slot(other).filter(|_| depth <= depth_m) else { continue };
                let cost = cost + depth * runs_m[step];
                let seen = &mut self.seen[slot];
                if seen.0 != self.round || cost < seen.1 {
                    *seen = (self.round, cost, step as u8);
                    self.queue.push(Reverse((cost.to_bits(), other as u32)));
                }
            }
        }
        None
    }

    /// The posts from the end of a way back to its pit.
    fn back(
        &self,
        end: usize,
        pit: usize,
        columns: usize,
        slot: impl Fn(usize) -> Option<usize>,
    ) -> Vec<usize> {
        let mut way = vec![end];
        let mut at = end;
        while at != pit {
            let Some((_, _, step)) = slot(at).map(|slot| self.seen[slot]) else { break };
            let (east, north) = sandtable_terrain::neighbors::STEPS[usize::from(step)];
            at = at.wrapping_add_signed(-(north as isize * columns as isize + east as isize));
            way.push(at);
        }
        way
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::{bare, noise};
    use crate::water::fill::filled;
    use glam::DVec2;

    const WIDE: BreachLimits = BreachLimits { depth_m: 100.0, length_m: 1e4 };

    fn breached(columns: u32, heights: &[f32], limits: BreachLimits) -> (Vec<f32>, BreachTally) {
        let land = bare((DVec2::ZERO, DVec2::splat(10.0)), columns, heights.to_vec());
        let mut cut = heights.to_vec();
        let tally = breach(&land.ground, &mut cut, limits, &StopFlag::default()).expect("breached");
        (cut, tally)
    }

    #[rustfmt::skip]
    const PIT: [f32; 21] = [
        99., 99., 99., 99., 99., 99., 99.,
        99., 2., 5., 8., 1., 1., 0.,
        99., 99., 99., 99., 99., 99., 99.,
    ];

    #[test]
    fn a_way_out_falls_evenly_through_the_rim() {
        let (cut, tally) = breached(7, &PIT, WIDE);
        // From 2 m in the pit to 1 m, three posts on.
        let wanted = [99.0, 2.0, 2.0 - 1.0 / 3.0, 2.0 - 2.0 / 3.0, 1.0, 1.0, 0.0];
        assert!(cut[7..14].iter().zip(wanted).all(|(cut, wanted)| (cut - wanted).abs() < 1e-6), "{cut:?}");
        assert_eq!(tally, BreachTally { breached: 1, left: 0 });
    }

    #[test]
    fn a_pit_with_too_deep_or_too_long_a_way_out_stays() {
        let shallow = BreachLimits { depth_m: 5.9, ..WIDE };
        assert_eq!(breached(7, &PIT, shallow), (PIT.to_vec(), BreachTally { breached: 0, left: 1 }));
        // The way through the rim is 6 m deep and three posts long.
        let near = BreachLimits { depth_m: 6.5, length_m: 20.0 };
        assert_eq!(breached(7, &PIT, near), (PIT.to_vec(), BreachTally { breached: 0, left: 1 }));
        let enough = BreachLimits { depth_m: 6.0, length_m: 30.0 };
        assert_eq!(breached(7, &PIT, enough).1, BreachTally { breached: 1, left: 0 });
    }

    #[test]
    fn breached_ground_needs_no_filling_and_loses_less_than_a_fill_adds() {
        let heights = noise(60 * 50, 11, 50, true);
        let (cut, tally) = breached(60, &heights, WIDE);
        assert_eq!(tally.left, 0);
        let fill = filled(&cut, 60, &StopFlag::default()).expect("filled");
        // What is left are ties of level ground, which fill to themselves.
        let deepest = fill.iter().zip(&cut).map(|(fill, cut)| fill - cut).fold(0.0, f32::max);
        assert!(deepest == 0.0, "{deepest} m");
        assert!(cut.iter().zip(&heights).all(|(cut, height)| cut <= height || height.is_nan()));
    }
}

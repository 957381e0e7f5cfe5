//! The drained ground: filled, with the direction in which each post drains.
//!
//! Every post drains to the border of the land or to a hole, each by others at or below its level, and none twice.

use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use rayon::prelude::*;

use super::directions::{NO_DIRECTION, OFF, directions};
use super::fill::filled;
use crate::error::AnalysisError;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::STEPS;
use sandtable_terrain::stop_flag::StopFlag;

/// The drained ground.
pub(crate) struct Drainage {
    /// The heights with depressions filled, meters; NaN without data.
    pub filled_m: Vec<f32>,
    /// The direction in which each post drains: 1 to 8 as [`STEPS`] has them, [`OFF`] or [`NO_DIRECTION`].
    pub codes: Vec<u8>,
    columns: usize,
    /// What is added to a post's number by direction.
    strides: [isize; 9],
}

/// Fills the ground with these heights and finds where it drains to.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn drain(ground: &Lattice, heights: &[f32], stop: &StopFlag) -> Result<Drainage, AnalysisError> {
    let columns = ground.columns() as usize;
    let filled_m = filled(heights, columns, stop)?;
    let codes = directions(ground, &filled_m, stop)?;
    Ok(Drainage { filled_m, codes, columns, strides: strides(columns) })
}

/// What is added to a post's number by direction.
fn strides(columns: usize) -> [isize; 9] {
    let mut strides = [0; 9];
    for (stride, (east, north)) in strides[1..].iter_mut().zip(STEPS) {
        *stride = north as isize * columns as isize + east as isize;
    }
    strides
}

/// The post that a post with a direction drains to; `None` where it drains off the land or has no data.
#[inline]
fn drained_to(index: usize, code: u8, strides: &[isize; 9]) -> Option<usize> {
    match code {
        OFF | NO_DIRECTION => None,
        code => Some(index.wrapping_add_signed(strides[usize::from(code)])),
    }
}

/// The number of neighbors that drain to each post, by the directions of all.
fn entering(all_codes: &[u8], columns: usize) -> Vec<u8> {
    let count = |(row, counts): (usize, &mut [u8])| {
        // A neighbor at step n drains here where its direction is the opposite of n.
        for (step, (east, north)) in STEPS.into_iter().enumerate() {
            let wanted = ((step + 4) % 8 + 1) as u8;
            let Some(row) = row.checked_add_signed(north as isize) else { continue };
            let Some(codes) = all_codes.get(row * columns..(row + 1) * columns) else { continue };
            let (here, there) = match east {
                1 => (&mut counts[..columns - 1], &codes[1..]),
                0 => (&mut counts[..], codes),
                _ => (&mut counts[1..], &codes[..columns - 1]),
            };
            for (count, &code) in here.iter_mut().zip(there) {
                *count += u8::from(code == wanted);
            }
        }
    };
    let mut counts = vec![0; all_codes.len()];
    counts.par_chunks_mut(columns).enumerate().for_each(count);
    counts
}

/// The number of posts that drain through each, itself among them, and of those that come to it and others above it from
/// elsewhere, `inflow`; 0 without data. No direction leads out of the rows.
pub(super) fn accumulated(codes: &[u8], columns: usize, inflow: Vec<u32>) -> Vec<u32> {
    let strides = strides(columns);
    // One more than the neighbors that have not told yet; 0 where nothing enters.
    let awaited: Vec<AtomicU8> = {
        let entering = entering(codes, columns);
        entering.into_iter().map(|count| AtomicU8::new(if count == 0 { 0 } else { count + 1 })).collect()
    };
    let counts: Vec<AtomicU32> = inflow.into_iter().map(AtomicU32::new).collect();
    let follow = |start: usize| {
        let (mut at, mut carried) = (start, counts[start].load(Ordering::Relaxed) + 1);
        loop {
            counts[at].store(carried, Ordering::Relaxed);
            let Some(to) = drained_to(at, codes[at], &strides) else { return };
            if awaited[to].load(Ordering::Acquire) == 2 {
                carried += counts[to].load(Ordering::Relaxed) + 1;
            } else {
                counts[to].fetch_add(carried, Ordering::Relaxed);
                // Whoever tells last goes on.
                if awaited[to].fetch_sub(1, Ordering::AcqRel) != 2 {
                    return;
                }
                carried = counts[to].load(Ordering::Relaxed) + 1;
            }
            at = to;
        }
    };
    (0..codes.len()).into_par_iter().with_min_len(1 << 14).for_each(|index| {
        if codes[index] != NO_DIRECTION && awaited[index].load(Ordering::Relaxed) == 0 {
            follow(index);
        }
    });
    counts.into_iter().map(AtomicU32::into_inner).collect()
}

impl Drainage {
    /// The post that a post drains to; `None` where it drains off the land or has no data.
    #[inline]
    pub fn to(&self, index: usize) -> Option<usize> {
        drained_to(index, self.codes[index], &self.strides)
    }

    /// Whether a post has data.
    pub fn has_data(&self, index: usize) -> bool {
        self.codes[index] != NO_DIRECTION
    }

    /// The number of neighbors that drain to each post.
    pub fn entering(&self) -> Vec<u8> {
        entering(&self.codes, self.columns)
    }

    /// The number of posts that drain through each, itself among them; 0 without data.
    pub fn accumulation(&self) -> Vec<u32> {
        accumulated(&self.codes, self.columns, vec![0; self.codes.len()])
    }

    /// The posts with data, each before the one that it drains to.
    pub fn downstream(&self) -> Vec<u32> {
        let mut awaited = self.entering();
        let mut order = Vec::with_capacity(awaited.len());
        let sources: Vec<u32> = (0..awaited.len() as u32)
            .filter(|&index| self.has_data(index as usize) && awaited[index as usize] == 0)
            .collect();
        for source in sources {
            let mut at = source as usize;
            loop {
                order.push(at as u32);
                let Some(to) = self.to(at) else { break };
                awaited[to] -= 1;
                if awaited[to] > 0 {
                    break;
                }
                at = to;
            }
        }
        order
    }

    /// Gives posts the value of the one that they drain to, from the edge of the land up: those for whose number and value
    /// `takes` holds. `downstream` is what [`Drainage::downstream`] gives.
    pub fn pass_up<T: Copy>(&self, downstream: &[u32], values: &mut [T], takes: impl Fn(usize, T) -> bool) {
        for &index in downstream.iter().rev() {
            let index = index as usize;
            if takes(index, values[index])
                && let Some(to) = self.to(index)
            {
                values[index] = values[to];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::{bare, noise, on_pool};
    use glam::DVec2;

    fn drained(columns: u32, count: usize, seed: u32, steps: u32) -> Drainage {
        let heights = noise(count, seed, steps, true);
        let land = bare((DVec2::ZERO, DVec2::new(10.0, 14.0)), columns, heights);
        drain(&land.ground, land.ground.heights(), &StopFlag::default()).expect("drained")
    }

    #[test]
    fn each_post_comes_before_the_one_that_it_drains_to() {
        for steps in [2, 16, 60_000] {
            let drainage = drained(30, 900, 7, steps);
            let order = drainage.downstream();
            let mut rank = vec![0; 900];
            order.iter().enumerate().for_each(|(at, &index)| rank[index as usize] = at);
            let with_data = (0..900).filter(|&index| drainage.has_data(index)).count();
            assert_eq!(order.len(), with_data, "{steps} steps: a loop, or a post that is told twice");
            for &index in &order {
                let to = drainage.to(index as usize);
                assert!(to.is_none_or(|to| rank[to] > rank[index as usize]));
                assert!(to.is_none_or(|to| drainage.filled_m[to] <= drainage.filled_m[index as usize]));
            }
        }
    }

    #[test]
    fn every_post_is_counted_on_its_whole_way() {
        let drainage = drained(40, 1600, 5, 9);
        let mut wanted = vec![0; 1600];
        for start in (0..1600).filter(|&index| drainage.has_data(index)) {
            let mut at = Some(start);
            while let Some(index) = at {
                wanted[index] += 1;
                at = drainage.to(index);
            }
        }
        assert_eq!(drainage.accumulation(), wanted);
        assert_eq!(on_pool(1, || drainage.accumulation()), on_pool(3, || drainage.accumulation()));
    }
}

//! Depressions filled, and where each post drains to: Priority-Flood (Barnes, Lehman and Mulla 2014).
//!
//! The flood enters at the border of the land and beside holes, lowest post first. A post that it reaches is filled up to the
//! post from which it was reached. A post drains to its steepest lower neighbor of the filled ground (O'Callaghan and Mark
//! 1984); where it has none, on level ground and in filled depressions, to the post from which the flood came. So every post
//! drains to the border, and each drains to one that was flooded before it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::error::AnalysisError;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::{STEPS, neighbors};
use sandtable_terrain::stop_flag::StopFlag;

/// A post that drains off the land, or has no data.
pub(crate) const NO_POST: u32 = u32::MAX;

/// The flood checks whether it may end early once in so many posts.
const STOP_STRIDE: usize = 1 << 16;

/// The drained ground.
pub(crate) struct Drainage {
    /// The heights with depressions filled, meters; NaN without data.
    pub filled_m: Vec<f32>,
    /// The post that each drains to; [`NO_POST`] where it drains off the land.
    pub to: Vec<u32>,
    /// The posts with data in the order of the flood: each drains to one before it.
    pub order: Vec<u32>,
}

/// A height as a number that sorts alike.
fn sortable(height_m: f32) -> u32 {
    let bits = (height_m + 0.0).to_bits();
    if bits >> 31 == 0 { bits | 0x8000_0000 } else { !bits }
}

/// Fills the ground and finds where it drains to.
///
/// # Errors
/// [`AnalysisError::Stopped`].
pub(crate) fn drain(ground: &Lattice, stop: &StopFlag) -> Result<Drainage, AnalysisError> {
    let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
    let heights = ground.heights();
    let mut filled_m = vec![f32::NAN; heights.len()];
    let mut from = vec![NO_POST; heights.len()];
    let mut order = Vec::with_capacity(heights.len());
    let mut is_reached = vec![false; heights.len()];
    let mut flood = BinaryHeap::new();
    // Posts of the depression that is being filled: all at its level, so they need no heap.
    let mut pit = std::collections::VecDeque::new();
    for (index, &height) in heights.iter().enumerate().filter(|(_, height)| !height.is_nan()) {
        let beside = neighbors(index, columns, rows);
        let (mut count, mut is_beside_hole) = (0, false);
        for (_, other) in beside {
            count += 1;
            is_beside_hole |= heights[other].is_nan();
        }
        if count < STEPS.len() || is_beside_hole {
            is_reached[index] = true;
            filled_m[index] = height;
            flood.push(Reverse((sortable(height), index as u32)));
        }
    }
    while let Some(index) = pit.pop_front().or_else(|| flood.pop().map(|Reverse((_, index))| index)) {
        order.push(index);
        if order.len() % STOP_STRIDE == 0 && stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        let level = filled_m[index as usize];
        for (_, other) in neighbors(index as usize, columns, rows) {
            if is_reached[other] || heights[other].is_nan() {
                continue;
            }
            is_reached[other] = true;
            from[other] = index;
            if heights[other] <= level {
                filled_m[other] = level;
                pit.push_back(other as u32);
            } else {
                filled_m[other] = heights[other];
                flood.push(Reverse((sortable(heights[other]), other as u32)));
            }
        }
    }
    let cell = ground.cell();
    let run_m = STEPS.map(|(east, north)| (cell * glam::DVec2::new(east as f64, north as f64)).length());
    let to = (0..heights.len()).map(|index| {
        let own = f64::from(filled_m[index]);
        let mut steepest = (0.0, from[index]);
        for (step, other) in neighbors(index, columns, rows) {
            let fall = (own - f64::from(filled_m[other])) / run_m[step];
            if fall > steepest.0 {
                steepest = (fall, other as u32);
            }
        }
        steepest.1
    });
    let to = to.collect();
    Ok(Drainage { filled_m, to, order })
}

impl Drainage {
    /// The number of posts that drain through each, itself among them; 0 without data.
    pub fn accumulation(&self) -> Vec<u32> {
        let mut counts = vec![0_u32; self.to.len()];
        for &index in self.order.iter().rev() {
            counts[index as usize] += 1;
            let to = self.to[index as usize];
            if to != NO_POST {
                counts[to as usize] += counts[index as usize];
            }
        }
        counts
    }
}

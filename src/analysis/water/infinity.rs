//! Flow in any direction (D-infinity, Tarboton 1997): down the steepest of the eight triangles around a post.
//!
//! Water that flows between two neighbors goes to both, in proportion to how near the direction is to each. On flats, which
//! have no such direction, it goes where the eight directions have it.

use std::f64::consts::{FRAC_PI_4, TAU};

use rayon::prelude::*;

use super::drainage::Drainage;
use super::fill::check_posts;
use crate::error::AnalysisError;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::neighbors;
use sandtable_terrain::stop_flag::StopFlag;

/// The step of a post whose water goes nowhere.
const NO_STEP: u8 = u8::MAX;

/// Where the water of a post goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FlowSplit {
    /// The direction in degrees counter-clockwise from the east, from 0 to below 360.
    pub degrees: f32,
    /// The step of the first neighbor that gets water; the other is the next counter-clockwise.
    pub step: u8,
    /// The share of the second, from 0 to 1.
    pub second: f32,
}

/// Flow in any direction on drained ground.
pub(crate) struct InfiniteFlow<'a> {
    drainage: &'a Drainage,
    columns: usize,
    rows: usize,
    cell: glam::DVec2,
}

impl<'a> InfiniteFlow<'a> {
    /// The flow of drained ground.
    pub fn new(ground: &Lattice, drainage: &'a Drainage) -> Self {
        let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
        Self { drainage, columns, rows, cell: ground.cell() }
    }

    /// Where the water of a post goes; `None` where it leaves the land or there is no data.
    pub fn split(&self, index: usize) -> Option<FlowSplit> {
        let heights = &self.drainage.filled_m;
        let own = f64::from(heights[index]);
        let mut around = [f64::NAN; 8];
        for (step, other) in neighbors(index, self.columns, self.rows) {
            around[step] = f64::from(heights[other]);
        }
        // The steepest triangle between a step and the next: its fall, its step, and the direction seen from its side.
        let mut steepest = (0.0, 0, (1.0, 0.0));
        for step in 0..8 {
            let next = (step + 1) % 8;
            let (side, diagonal) = if step % 2 == 0 { (step, next) } else { (next, step) };
            // East and west are sides along the columns.
            let (run, across) =
                if side % 4 == 0 { (self.cell.x, self.cell.y) } else { (self.cell.y, self.cell.x) };
            let (along, beside) = ((own - around[side]) / run, (around[side] - around[diagonal]) / across);
            // Beyond its sides a triangle drains along the nearer one; without a diagonal, along the other.
            let (fall, slant) = match () {
                _ if beside <= 0.0 || beside.is_nan() => (along, (1.0, 0.0)),
                _ if along <= 0.0 || beside * run >= along * across => {
                    ((own - around[diagonal]) / run.hypot(across), (run, across))
                }
                _ => ((along * along + beside * beside).sqrt(), (along, beside)),
            };
            if fall > steepest.0 {
                steepest = (fall, step, slant);
            }
        }
        let (fall, step, (along, beside)) = steepest;
        if fall > 0.0 {
            let is_north = step % 4 == 1 || step % 4 == 2;
            let widest = if is_north {
                libm::atan2(self.cell.x, self.cell.y)
            } else {
                libm::atan2(self.cell.y, self.cell.x)
            };
            let share = (libm::atan2(beside, along) / widest).clamp(0.0, 1.0);
            let second = if step % 2 == 0 { share } else { 1.0 - share };
            let degrees = self.degrees(step, second);
            let (step, second) = if second >= 1.0 { ((step + 1) % 8, 0.0) } else { (step, second) };
            return Some(FlowSplit { degrees, step: step as u8, second: second as f32 });
        }
        self.drainage.to(index)?;
        let step = self.drainage.codes[index] - 1;
        Some(FlowSplit { degrees: self.degrees(usize::from(step), 0.0), step, second: 0.0 })
    }

    /// The direction from one step a share of the way to the next, degrees.
    fn degrees(&self, step: usize, share: f64) -> f32 {
        let diagonal = libm::atan2(self.cell.y, self.cell.x);
        let angle = |step: usize| {
            let (quarter, is_diagonal) = ((step / 2) as f64 * 2.0 * FRAC_PI_4, step % 2 == 1);
            // Diagonals of the second and fourth quarter lean the other way.
            let lean = if (step / 2).is_multiple_of(2) { diagonal } else { 2.0 * FRAC_PI_4 - diagonal };
            if is_diagonal { quarter + lean } else { quarter }
        };
        let (from, to) = (angle(step), if step == 7 { TAU } else { angle(step + 1) });
        let degrees = (from + (to - from) * share).to_degrees() as f32;
        if degrees >= 360.0 { 0.0 } else { degrees }
    }

    /// The posts that get water of a post, with their shares.
    fn receivers(&self, index: usize, (step, second): (u8, f32)) -> [Option<(usize, f64)>; 2] {
        if step == NO_STEP {
            return [None, None];
        }
        let to = |step: u8| {
            let wanted = usize::from(step % 8);
            neighbors(index, self.columns, self.rows)
                .find(|&(step, _)| step == wanted)
                .map(|(_, other)| other)
        };
        let second = f64::from(second);
        let share = |to: Option<usize>, share: f64| to.filter(|_| share > 0.0).map(|to| (to, share));
        [share(to(step), 1.0 - second), share(to(step + 1), second)]
    }

    /// The number of posts that drain through each, itself among them and parts of others; 0 without data.
    ///
    /// # Errors
    /// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
    pub fn accumulation(&self, stop: &StopFlag) -> Result<Vec<f64>, AnalysisError> {
        let posts = self.drainage.codes.len();
        check_posts(posts, 21)?;
        let step =
            |index: usize| self.split(index).map_or((NO_STEP, 0.0), |split| (split.step, split.second));
        let splits: Vec<(u8, f32)> = (0..posts).into_par_iter().with_min_len(1 << 12).map(step).collect();
        let receivers = |index: usize| self.receivers(index, splits[index]).into_iter().flatten();
        let mut awaited = vec![0_u8; posts];
        for index in 0..posts {
            for (to, _) in receivers(index) {
                awaited[to] += 1;
            }
        }
        // 1 for itself; those that nothing enters begin, others go on when the last has told.
        let mut amounts: Vec<f64> =
            (0..posts).map(|index| if self.drainage.has_data(index) { 1.0 } else { 0.0 }).collect();
        let sources: Vec<u32> = (0..posts as u32)
            .filter(|&index| awaited[index as usize] == 0 && self.drainage.has_data(index as usize))
            .collect();
        let mut ready = Vec::new();
        for (told, source) in sources.into_iter().enumerate() {
            if told.is_multiple_of(4096) && stop.is_stopped() {
                return Err(AnalysisError::Stopped);
            }
            ready.push(source);
            while let Some(index) = ready.pop() {
                for (to, share) in receivers(index as usize) {
                    amounts[to] += amounts[index as usize] * share;
                    awaited[to] -= 1;
                    if awaited[to] == 0 {
                        ready.push(to as u32);
                    }
                }
            }
        }
        Ok(amounts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::{bare, noise, shaped};
    use crate::water::drainage::drain;
    use glam::DVec2;

    fn drained(land: &crate::land::Land) -> Drainage {
        drain(&land.ground, land.ground.heights(), &StopFlag::default()).expect("drained")
    }

    #[test]
    fn a_plane_drains_down_its_aspect_whatever_that_is() {
        for (east, north) in [(1.0, 0.3), (-0.2, 1.0), (-1.0, -0.9), (0.4, -0.7), (0.0, -1.0), (1.0, 1.0)] {
            for cell in [DVec2::splat(10.0), DVec2::new(10.0, 16.0)] {
                let heights = (0..49)
                    .map(|index| {
                        let at = DVec2::new(f64::from(index % 7), f64::from(index / 7)) * cell;
                        (1000.0 - east * at.x - north * at.y) as f32
                    })
                    .collect();
                let land = bare((DVec2::ZERO, cell), 7, heights);
                let drainage = drained(&land);
                let split = InfiniteFlow::new(&land.ground, &drainage).split(24).expect("a direction");
                let wanted = libm::atan2(north, east).to_degrees().rem_euclid(360.0);
                // Tarboton's angle within a triangle is that of its plane; a share of it gives the neighbors.
                assert!((f64::from(split.degrees) - wanted).abs() < 0.01, "{split:?}, {wanted}");
            }
        }
    }

    #[test]
    fn water_between_two_neighbors_goes_to_both() {
        // A plane that falls to 22.5° north of east: half of the way to the diagonal.
        let (east, north) = (libm::cos(22.5_f64.to_radians()), libm::sin(22.5_f64.to_radians()));
        let land = shaped(5, 5, 10.0, |column, row| {
            (500.0 - 10.0 * (east * f64::from(column) + north * f64::from(row))) as f32
        });
        let drainage = drained(&land);
        let split = InfiniteFlow::new(&land.ground, &drainage).split(12).expect("a direction");
        assert_eq!(split.step, 0);
        assert!((split.second - 0.5).abs() < 1e-4, "{split:?}");
    }

    #[test]
    fn all_water_of_noisy_ground_leaves_it() {
        let land = bare((DVec2::ZERO, DVec2::splat(10.0)), 40, noise(1200, 3, 30, true));
        let drainage = drained(&land);
        let flow = InfiniteFlow::new(&land.ground, &drainage);
        let amounts = flow.accumulation(&StopFlag::default()).expect("accumulated");
        let off: f64 =
            (0..1200).filter(|&index| flow.split(index).is_none()).map(|index| amounts[index]).sum();
        let posts = land.ground.heights().iter().filter(|height| !height.is_nan()).count();
        assert!((off - posts as f64).abs() < 1e-6 * posts as f64, "{off} of {posts}");
    }
}

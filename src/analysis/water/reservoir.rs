//! The water behind a dam, and on which side of it that is.
//!
//! The flow directions of a level lake, or a lower post on either side, do not tell upstream from downstream. So the pool that a
//! dam would hold is flooded on both sides, up to the level, with the dam's line and its straight extensions as walls:
//!
//! ```text
//!        ╱ ground ╲                        a pool that touches the border of the land, or a hole
//!      ╱  enclosed  ╲                      in the data, is not held: its water leaves
//!  ═══╪══════ dam ═══╪═══ extension
//!     │     open     │                     the reservoir is enclosed, the valley below is open
//!     ▼              ▼                     and begins no higher
//! ```
//!
//! Where both sides or neither hold water, no rule tells them apart; then the caller states a point in the reservoir.

use glam::DVec2;

use super::carve::banks;
use super::flood::{FloodRule, spread, volume_m3};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::line_posts::along_line;
use crate::place::post_under;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::neighbors;
use sandtable_terrain::stop_flag::StopFlag;

/// The water behind a dam.
#[derive(Debug)]
pub(super) struct Reservoir {
    pub is_wet: Vec<bool>,
    /// The lowest post below the dam, near it.
    pub foot: usize,
    pub volume_m3: f64,
    /// The water's height above the foot, meters.
    pub height_m: f64,
    pub notes: Vec<String>,
}

/// A dam on the land, which parts it in two.
struct DamLine<'a> {
    ground: &'a Lattice,
    heights: &'a [f32],
    level_m: f32,
    is_wall: Vec<bool>,
    /// The posts on the extensions of the line beyond its ends.
    is_beyond: Vec<bool>,
}

/// The water that one side of a dam would hold.
struct SidePool {
    /// The lowest post beside the dam.
    bank: usize,
    is_pool: Vec<bool>,
    /// Whether dam and ground hold it: it touches neither the border nor a hole.
    is_enclosed: bool,
}

impl Reservoir {
    /// The water behind the dam of the arguments.
    ///
    /// # Errors
    /// [`AnalysisError::Argument`] where there is no ground beside the dam, no water behind it, or nothing tells which side it is
    /// on; [`AnalysisError::Stopped`].
    pub fn behind(
        ground: &Lattice,
        heights: &[f32],
        arguments: &AnalysisArguments,
        stop: &StopFlag,
    ) -> Result<Self, AnalysisError> {
        let (line, level_m) = (arguments.points("dam"), arguments.number("level_m") as f32);
        let no_ground = || AnalysisError::argument("dam", "has no ground on both of its sides");
        let length_m: f64 = line.windows(2).map(|leg| leg[0].distance(leg[1])).sum();
        let dam = DamLine::new(ground, heights, line, level_m);
        // A post under the dam's line is a bank of neither side.
        let beside = |(index, &height): (usize, &f32)| if dam.is_dam(index) { f32::NAN } else { height };
        let beside: Vec<f32> = heights.iter().enumerate().map(beside).collect();
        // A dam is the thicker the longer it is, as a rule.
        let more_m = (length_m / 4.0).min(200.0);
        let banks = banks(ground, &beside, line, (0.0, more_m)).ok_or_else(no_ground)?;
        let pools = [dam.pool(banks[0], stop)?, dam.pool(banks[1], stop)?];
        let behind = match arguments.points("reservoir") {
            [] => dam.enclosed_side(&pools)?,
            points => dam.stated_side(points, banks, stop)?,
        };
        let [left, right] = pools;
        let (pool, below) = if behind == 0 { (left, right) } else { (right, left) };
        let foot = below.bank;
        let is_open = |index: usize| heights[index] < level_m;
        let is_wet: Vec<bool> =
            (0..heights.len()).map(|index| pool.is_pool[index] && is_open(index)).collect();
        let held_m3 = || {
            let depth = |index: usize| if is_wet[index] { level_m - heights[index] } else { 0.0 };
            volume_m3(ground, &(0..heights.len()).map(depth).collect::<Vec<f32>>())
        };
        let volume_m3 = arguments.number_if("volume_m3").unwrap_or_else(held_m3);
        let height_m = arguments.number_if("height_m").unwrap_or(f64::from(level_m - heights[foot]));
        if volume_m3 <= 0.0 || height_m <= 0.0 {
            let problem = format!(
                "{level_m} is not above the ground on both sides of the dam; state a higher one, or `volume_m3` and \
                 `height_m` where the elevations show the water's surface"
            );
            return Err(AnalysisError::argument("level_m", problem));
        }
        let notes = dam.notes(&is_wet);
        Ok(Self { is_wet, foot, volume_m3, height_m, notes })
    }
}

impl<'a> DamLine<'a> {
    fn new(ground: &'a Lattice, heights: &'a [f32], line: &[DVec2], level_m: f32) -> Self {
        let mut is_wall = vec![false; heights.len()];
        along_line(ground, line, 0.0, |index| is_wall[index] = true);
        let mut is_beyond = vec![false; heights.len()];
        for ray in rays(ground, line) {
            along_line(ground, &ray, 0.0, |index| is_beyond[index] = true);
        }
        Self { ground, heights, level_m, is_wall, is_beyond }
    }

    fn is_dam(&self, index: usize) -> bool {
        self.is_wall[index] || self.is_beyond[index]
    }

    /// The water on the side of a bank: what is joined to it below the level, or, where the bank itself is not, up to the bank, so
    /// that a lake whose surface the elevations show is a pool too.
    fn pool(&self, bank: usize, stop: &StopFlag) -> Result<SidePool, AnalysisError> {
        let heights = self.heights;
        let is_held = |index: usize| heights[index] < self.level_m || heights[index] <= heights[bank];
        let is_open = |index: usize| is_held(index) && !self.is_dam(index);
        let is_pool = spread(self.ground, vec![bank], FloodRule::Sides, is_open, stop)?;
        let is_enclosed = !self.leaves(&is_pool);
        Ok(SidePool { bank, is_pool, is_enclosed })
    }

    /// Whether some of these posts lie at the border of the land or beside a hole in the data.
    fn leaves(&self, is_pool: &[bool]) -> bool {
        let (columns, rows) = (self.ground.columns() as usize, self.ground.rows() as usize);
        let leaves = |index: usize| {
            let whole = neighbors(index, columns, rows).filter(|&(_, other)| !self.heights[other].is_nan());
            whole.count() < 8
        };
        (0..is_pool.len()).any(|index| is_pool[index] && leaves(index))
    }

    /// The side whose pool is enclosed while the other's is open and begins no higher.
    fn enclosed_side(&self, pools: &[SidePool; 2]) -> Result<usize, AnalysisError> {
        let refused = |why: String| Err(AnalysisError::argument("reservoir", why));
        let level_m = self.level_m;
        let state = "state a point in the reservoir";
        let behind = match [pools[0].is_enclosed, pools[1].is_enclosed] {
            [true, false] => 0,
            [false, true] => 1,
            [true, true] => {
                return refused(format!(
                    "is not stated, and up to {level_m} m the ground holds water on both sides of the dam; {state}"
                ));
            }
            [false, false] => {
                return refused(format!(
                    "is not stated, and up to {level_m} m the water leaves the land on both sides of the dam, elsewhere than \
                     through it; state a lower `level_m`, analyze more land, or {state}"
                ));
            }
        };
        let [held_m, below_m] = [behind, 1 - behind].map(|side| self.heights[pools[side].bank]);
        if held_m < below_m {
            return refused(format!(
                "is not stated, and the side of the dam that holds water up to {level_m} m begins at {held_m} m, below the \
                 other side, at {below_m} m; {state}"
            ));
        }
        Ok(behind)
    }

    /// The side on which points lie, as the dam and its extensions part the land.
    fn stated_side(
        &self,
        points: &[DVec2],
        banks: [usize; 2],
        stop: &StopFlag,
    ) -> Result<usize, AnalysisError> {
        let refused = |why: &str| Err(AnalysisError::argument("reservoir", why));
        let mut behind = None;
        for &at in points {
            let post = post_under(self.ground, "reservoir", at)?;
            let side = spread(self.ground, vec![post], FloodRule::Sides, |index| !self.is_dam(index), stop)?;
            let here = match banks.map(|bank| side[bank]) {
                [true, false] => 0,
                [false, true] => 1,
                _ => {
                    return refused(
                        "lies on neither side of the dam alone; state a point in the water behind it",
                    );
                }
            };
            if *behind.get_or_insert(here) != here {
                return refused("has points on both sides of the dam; state points on one side");
            }
        }
        behind.map_or_else(|| refused("has no points; state one in the water behind the dam"), Ok)
    }

    /// What the reader is told of the water behind the dam.
    fn notes(&self, is_wet: &[bool]) -> Vec<String> {
        let (columns, rows) = (self.ground.columns() as usize, self.ground.rows() as usize);
        let mut notes = Vec::new();
        if self.leaves(is_wet) {
            notes.push(
                "the water behind the dam reaches the border of the land or a hole; its volume is that on the land"
                    .into(),
            );
        }
        let goes_around = |index: usize| {
            let is_low = |other: usize| self.is_beyond[other] && self.heights[other] < self.level_m;
            neighbors(index, columns, rows).any(|(_, other)| is_low(other))
        };
        if (0..is_wet.len()).any(|index| is_wet[index] && goes_around(index)) {
            notes.push(
                "at this level water would go around the dam; it is held by the dam's line, which is extended straight"
                    .into(),
            );
        }
        notes
    }
}

/// The lines straight on from both ends of a dam, to beyond the land.
fn rays(ground: &Lattice, dam: &[DVec2]) -> Vec<[DVec2; 2]> {
    let extent = ground.cell() * ground.last_grid();
    let far_m = 2.0 * extent.length() + ground.cell().max_element();
    let ray = |end: DVec2, before: DVec2| {
        let along = (end - before).normalize_or_zero();
        (along != DVec2::ZERO).then(|| [end, end + along * far_m])
    };
    let ([first, second, ..], [.., before, last]) = (dam, dam) else { return Vec::new() };
    ray(*first, *second).into_iter().chain(ray(*last, *before)).collect()
}

//! A single line of sight, and its first obstacle.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::lattice::Lattice;
use crate::query::{Interpolation, ground_height};
use crate::sight::Curvature;
use crate::sight::crossings::{LineCrossing, LinePart, crossings};
use sandtable_raster::answer::Answer;

/// One end of a line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightEnd {
    /// Map coordinates in the lattice's system, meters.
    pub at: DVec2,
    /// Meters above the ground there.
    pub above_m: f64,
}

/// The result of a line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight {
    /// Nothing blocks it.
    Clear,
    /// The ground blocks it.
    Blocked(Blocker),
    /// An end has no ground under it; the ground's answer there.
    NoGround(Answer),
}

/// The first position, from the observer, where the ground is higher than the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocker {
    /// Map coordinates.
    pub at: DVec2,
    /// Meters from the observer, in plan.
    pub distance_m: f64,
    /// The height of the ground there in meters.
    pub height_m: f64,
}

/// Whether `target` can be seen from `observer`. Ground without data blocks nothing.
///
/// Costs three crossings a cell up to the first blocker;
/// [`SightGround::line_of_sight`](crate::sight::ground::SightGround::line_of_sight) gives the same answer for
/// less.
pub fn line_of_sight(lattice: &Lattice, observer: SightEnd, target: SightEnd, curvature: Curvature) -> Sight {
    let sight = match GroundedSight::new(lattice, observer, target, curvature) {
        Ok(sight) => sight,
        Err(missing) => return Sight::NoGround(missing),
    };
    sight.result(crossings(lattice, sight.grid.0, sight.grid.1, |crossing| sight.check(crossing)))
}

/// A line of sight between two ends that have ground under them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroundedSight {
    observer: DVec2,
    target: DVec2,
    /// Both as grid positions.
    pub(crate) grid: (DVec2, DVec2),
    length_m: f64,
    /// The line.
    pub(crate) line: SightLine,
}

impl GroundedSight {
    /// The line from one end to the other.
    ///
    /// # Errors
    /// The ground's answer at the first end, the observer's before the target's, without a height.
    pub(crate) fn new(
        lattice: &Lattice,
        observer: SightEnd,
        target: SightEnd,
        curvature: Curvature,
    ) -> Result<Self, Answer> {
        let height_m = |end: SightEnd| match ground_height(lattice, Interpolation::Planar, end.at) {
            Answer::Height(height_m) => Ok(height_m + end.above_m),
            missing => Err(missing),
        };
        let (from_m, to_m) = (height_m(observer)?, height_m(target)?);
        let length_m = observer.at.distance(target.at);
        Ok(Self {
            observer: observer.at,
            target: target.at,
            grid: (lattice.grid_from_map(observer.at), lattice.grid_from_map(target.at)),
            length_m,
            line: SightLine::new(from_m, to_m, length_m, curvature),
        })
    }

    /// Breaks where the ground at a crossing is higher than the line.
    #[inline]
    pub(crate) fn check(&self, crossing: LineCrossing) -> ControlFlow<LineCrossing> {
        if self.line.is_below(crossing.height_m, crossing.part) {
            return ControlFlow::Break(crossing);
        }
        ControlFlow::Continue(())
    }

    /// The result of a walk along the whole line, which breaks at the first blocker.
    pub(crate) fn result(&self, walk: ControlFlow<LineCrossing>) -> Sight {
        match walk {
            ControlFlow::Break(crossing) => Sight::Blocked(self.place(crossing)),
            ControlFlow::Continue(()) => Sight::Clear,
        }
    }

    /// A crossing as a position on the map.
    pub(crate) fn place(&self, crossing: LineCrossing) -> Blocker {
        Blocker {
            at: self.observer.lerp(self.target, crossing.part),
            distance_m: self.length_m * crossing.part,
            height_m: crossing.height_m,
        }
    }
}

/// A line of sight as a height at each part of it.
#[derive(Clone, Copy, Debug)]
pub struct SightLine {
    from_m: f64,
    rise_m: f64,
    sag_m: f64,
}

impl SightLine {
    /// The line between two heights over `length_m` meters in plan.
    pub fn new(from_m: f64, to_m: f64, length_m: f64, curvature: Curvature) -> Self {
        let sag_m = curvature.drop_per_square_m() * length_m * length_m;
        Self { from_m, rise_m: to_m - from_m, sag_m }
    }

    /// The height of ground that the line would just touch, at a part of it, 0..=1.
    ///
    /// With the ground lowered by `sag·part²` and the target by `sag`, the line over ground as it is lies at
    /// `from + rise·part − sag·part·(1 − part)`.
    pub fn height_m(&self, part: f64) -> f64 {
        self.from_m + (self.rise_m - self.sag_m * (1.0 - part)) * part
    }

    /// Whether ground of this height is higher than the line; ground without data (NaN) never is.
    pub fn is_below(&self, ground_m: f64, part: f64) -> bool {
        ground_m > self.height_m(part)
    }

    /// A lower bound, but for rounding, of the line's height in a part of it; too low by at most `sag/4` times the square
    /// of the part's length.
    ///
    /// The line is a parabola that opens upward (downward where refraction exceeds the curvature): it hangs below its
    /// chord by no more than that.
    #[inline]
    pub(crate) fn lowest_m(&self, (first, last): LinePart) -> f64 {
        let span = last - first;
        let hang = 0.25 * self.sag_m.max(0.0) * span * span;
        self.height_m(first).min(self.height_m(last)) - hang
    }

    /// An upper bound of the rounding error of the line's height, in meters.
    pub(crate) fn rounding_m(&self) -> f64 {
        // Four operations, each off by half an epsilon of a value no larger than the sum of all three.
        8.0 * f64::EPSILON * (self.from_m.abs() + self.rise_m.abs() + self.sag_m.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(height: impl Fn(u32, u32) -> f32) -> Lattice {
        let heights = (0..101 * 101).map(|index| height(index % 101, index / 101)).collect();
        Lattice::new(DVec2::new(5e5, 4e6), DVec2::splat(100.0), 101, heights).expect("sound")
    }

    fn end(x: f64, y: f64, above_m: f64) -> SightEnd {
        SightEnd { at: DVec2::new(5e5 + x, 4e6 + y), above_m }
    }

    #[test]
    fn a_wall_blocks_targets_below_the_line_over_it() {
        let walled = lattice(|column, _| if column == 50 { 10.0 } else { 0.0 });
        let look = |above| {
            line_of_sight(&walled, end(0.0, 5000.0, 5.0), end(10_000.0, 5000.0, above), Curvature::FLAT)
        };
        let Sight::Blocked(blocker) = look(14.9) else { panic!("seen") };
        assert_eq!((blocker.distance_m, blocker.height_m), (5000.0, 10.0));
        assert_eq!(look(15.0), Sight::Clear, "the line touches the wall's top");
    }

    #[test]
    fn over_level_ground_the_horizon_is_at_its_geometric_distance() {
        let sea = lattice(|_, _| 0.0);
        let eye = 2.0;
        let curvature = Curvature { radius_m: 6_371_000.0, refraction: 0.0 };
        // √(2Rh) = 5048 m to the horizon; a mark on the ground beyond it is hidden.
        let seen =
            |x: f64| line_of_sight(&sea, end(0.0, 0.0, eye), end(x, 0.0, 0.0), curvature) == Sight::Clear;
        assert!(seen(4900.0) && !seen(5300.0));
    }

    #[test]
    fn an_end_off_the_model_or_over_a_hole_has_no_ground() {
        let holed = lattice(|column, row| if column < 3 && row < 3 { f32::NAN } else { 1.0 });
        let look = |to| line_of_sight(&holed, end(5000.0, 5000.0, 2.0), to, Curvature::default());
        assert_eq!(look(end(50.0, 50.0, 2.0)), Sight::NoGround(Answer::NoData));
        assert_eq!(look(end(-50.0, 50.0, 2.0)), Sight::NoGround(Answer::Outside));
    }
}

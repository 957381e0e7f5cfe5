//! A single line of sight, and what blocks it first.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::dem::answer::Answer;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};
use crate::terrain::sight::Curvature;
use crate::terrain::sight::crossings::{LineCrossing, crossings};

/// One end of a line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightEnd {
    /// Map coordinates in the lattice's system, meters.
    pub at: DVec2,
    /// Meters above the ground there.
    pub above_m: f64,
}

/// What came of looking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight {
    /// Nothing stands between.
    Clear,
    /// The ground stands in the way.
    Blocked(Blocker),
    /// An end has no ground under it: what the ground answered there.
    NoGround(Answer),
}

/// The first place, from the observer, where the ground stands higher than the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocker {
    /// Map coordinates.
    pub at: DVec2,
    /// Meters from the observer, along the ground.
    pub distance_m: f64,
    /// The height of the ground there in meters.
    pub height_m: f64,
}

/// Whether `target` can be seen from `observer`. Ground without data blocks nothing.
///
/// Costs three crossings a cell of the way to the first blocker;
/// [`SightGround::line_of_sight`](crate::terrain::sight::ground::SightGround::line_of_sight) gives the same answer for
/// less.
pub fn line_of_sight(lattice: &Lattice, observer: SightEnd, target: SightEnd, curvature: Curvature) -> Sight {
    match GroundedSight::new(lattice, observer, target, curvature) {
        Ok(look) => {
            look.sight(crossings(lattice, look.grid.0, look.grid.1, |crossing| look.blocked(crossing)))
        }
        Err(missing) => Sight::NoGround(missing),
    }
}

/// A line of sight between two ends that have ground under them.
#[derive(Clone, Copy, Debug)]
pub(in crate::terrain) struct GroundedSight {
    observer: DVec2,
    target: DVec2,
    /// Both as grid positions.
    pub(in crate::terrain) grid: (DVec2, DVec2),
    length_m: f64,
    /// The line.
    pub(in crate::terrain) line: SightLine,
}

impl GroundedSight {
    /// The line from one end to the other.
    ///
    /// # Errors
    /// What the ground answers at the first end, the observer's before the target's, that has none.
    pub(in crate::terrain) fn new(
        lattice: &Lattice,
        observer: SightEnd,
        target: SightEnd,
        curvature: Curvature,
    ) -> Result<Self, Answer> {
        let ground = |end: SightEnd| match ground_height(lattice, Interpolation::Planar, end.at) {
            Answer::Height(height_m) => Ok(height_m + end.above_m),
            missing => Err(missing),
        };
        let (from, to) = (ground(observer)?, ground(target)?);
        let length_m = observer.at.distance(target.at);
        let grid = |at: DVec2| lattice.grid_at(at - lattice.origin());
        Ok(Self {
            observer: observer.at,
            target: target.at,
            grid: (grid(observer.at), grid(target.at)),
            length_m,
            line: SightLine::new(from, to, length_m, curvature),
        })
    }

    /// Breaks where the ground at a crossing stands higher than the line.
    #[inline]
    pub(in crate::terrain) fn blocked(&self, crossing: LineCrossing) -> ControlFlow<LineCrossing> {
        if self.line.is_below(crossing.height_m, crossing.part) {
            return ControlFlow::Break(crossing);
        }
        ControlFlow::Continue(())
    }

    /// What came of looking along the whole line.
    pub(in crate::terrain) fn sight(&self, looked: ControlFlow<LineCrossing>) -> Sight {
        match looked {
            ControlFlow::Break(crossing) => Sight::Blocked(self.place(crossing)),
            ControlFlow::Continue(()) => Sight::Clear,
        }
    }

    /// A crossing as a place on the map.
    pub(in crate::terrain) fn place(&self, crossing: LineCrossing) -> Blocker {
        Blocker {
            at: self.observer.lerp(self.target, crossing.part),
            distance_m: self.length_m * crossing.part,
            height_m: crossing.height_m,
        }
    }
}

/// A line of sight as heights over the way along it.
#[derive(Clone, Copy, Debug)]
pub struct SightLine {
    from: f64,
    rise: f64,
    sag: f64,
}

impl SightLine {
    /// The line from height `from` to height `to`, both in meters, over `length` meters of ground.
    pub fn new(from: f64, to: f64, length: f64, curvature: Curvature) -> Self {
        Self { from, rise: to - from, sag: curvature.drop_per_square_m() * length * length }
    }

    /// The height of ground that the line would just touch, `part` of the way along it, 0..=1.
    ///
    /// With the ground sunk by `sag·part²` and the target by `sag`, the line over unsunk ground is
    /// `from + rise·part − sag·part·(1 − part)`.
    pub fn height_m(&self, part: f64) -> f64 {
        self.from + (self.rise - self.sag * (1.0 - part)) * part
    }

    /// Whether ground of this height stands higher than the line; ground without data (NaN) never does.
    pub fn is_below(&self, ground_m: f64, part: f64) -> bool {
        ground_m > self.height_m(part)
    }

    /// A height that the line is nowhere below between two parts of it, but for rounding; at the best no more than
    /// `sag/4` times the square of their distance too low.
    ///
    /// The line is a parabola that opens upward (downward where light bends more than the Earth does): it hangs below
    /// its chord by no more than that.
    #[inline]
    pub fn lowest_m(&self, (first, last): (f64, f64)) -> f64 {
        let span = last - first;
        let hang = 0.25 * self.sag.max(0.0) * span * span;
        self.height_m(first).min(self.height_m(last)) - hang
    }

    /// How far rounding may mistake the line's height, in meters, and more than that.
    pub(in crate::terrain) fn rounding_m(&self) -> f64 {
        // Four operations, each off by half an epsilon of what is no larger than the sum of all three.
        8.0 * f64::EPSILON * (self.from.abs() + self.rise.abs() + self.sag.abs())
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
    fn a_wall_blocks_what_is_lower_than_the_line_over_it() {
        let walled = lattice(|column, _| if column == 50 { 10.0 } else { 0.0 });
        let look = |above| {
            line_of_sight(&walled, end(0.0, 5000.0, 5.0), end(10_000.0, 5000.0, above), Curvature::FLAT)
        };
        let Sight::Blocked(blocker) = look(14.9) else { panic!("seen") };
        assert_eq!((blocker.distance_m, blocker.height_m), (5000.0, 10.0));
        assert_eq!(look(15.0), Sight::Clear, "the line touches the wall's top");
    }

    #[test]
    fn over_level_ground_the_horizon_is_where_geometry_puts_it() {
        let sea = lattice(|_, _| 0.0);
        let eye = 2.0;
        let curvature = Curvature { radius_m: 6_371_000.0, refraction: 0.0 };
        // √(2Rh) = 5048 m to the horizon; a mark on the ground beyond it is hidden.
        let seen =
            |x: f64| line_of_sight(&sea, end(0.0, 0.0, eye), end(x, 0.0, 0.0), curvature) == Sight::Clear;
        assert!(seen(4900.0) && !seen(5300.0));
    }

    #[test]
    fn an_end_off_the_model_or_over_a_hole_is_told() {
        let holed = lattice(|column, row| if column < 3 && row < 3 { f32::NAN } else { 1.0 });
        let look = |to| line_of_sight(&holed, end(5000.0, 5000.0, 2.0), to, Curvature::default());
        assert_eq!(look(end(50.0, 50.0, 2.0)), Sight::NoGround(Answer::NoData));
        assert_eq!(look(end(-50.0, 50.0, 2.0)), Sight::NoGround(Answer::Outside));
    }
}

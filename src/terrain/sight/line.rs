//! A single line of sight, and what blocks it first.

use std::ops::ControlFlow;

use glam::DVec2;

use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Answer, Interpolation, ground_height};
use crate::terrain::sight::Curvature;
use crate::terrain::sight::crossings::crossings;

/// One end of a line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Map coordinates in the lattice's system, metres.
    pub at: DVec2,
    /// Metres above the ground there.
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
    /// Metres from the observer, along the ground.
    pub distance_m: f64,
    /// The height of the ground there in metres.
    pub height_m: f64,
}

/// Whether `target` can be seen from `observer`. Ground without data blocks nothing.
///
/// Costs three crossings a cell of the way to the first blocker.
pub fn line_of_sight(lattice: &Lattice, observer: End, target: End, curvature: Curvature) -> Sight {
    let ground = |end: End| ground_height(lattice, Interpolation::Planar, end.at);
    let (from, to) = match (ground(observer), ground(target)) {
        (Answer::Height(from), Answer::Height(to)) => (from + observer.above_m, to + target.above_m),
        (Answer::Height(_), missing) | (missing, _) => return Sight::NoGround(missing),
    };
    let length = observer.at.distance(target.at);
    let line = SightLine::new(from, to, length, curvature);
    let grid = |at: DVec2| lattice.grid_at(at - lattice.origin());
    let looked = crossings(lattice, grid(observer.at), grid(target.at), |crossing| {
        if line.is_below(crossing.height_m, crossing.part) {
            let at = observer.at.lerp(target.at, crossing.part);
            let distance_m = length * crossing.part;
            return ControlFlow::Break(Blocker { at, distance_m, height_m: crossing.height_m });
        }
        ControlFlow::Continue(())
    });
    match looked {
        ControlFlow::Break(blocker) => Sight::Blocked(blocker),
        ControlFlow::Continue(()) => Sight::Clear,
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
    /// The line from height `from` to height `to`, both in metres, over `length` metres of ground.
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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(height: impl Fn(u32, u32) -> f32) -> Lattice {
        let heights = (0..101 * 101).map(|index| height(index % 101, index / 101)).collect();
        Lattice::new(DVec2::new(5e5, 4e6), DVec2::splat(100.0), 101, heights).expect("sound")
    }

    fn end(x: f64, y: f64, above_m: f64) -> End {
        End { at: DVec2::new(5e5 + x, 4e6 + y), above_m }
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

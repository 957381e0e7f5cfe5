//! The rise of an end of a line of sight that makes it clear, and the crossing that decides it.
//!
//! With the line at height `h(p)` over the crossing at part `p`, whose ground has height `g`, the line clears it when
//!
//! | what rises by `q` | lifts the line there by | so that `q` must be at least |
//! |---|---|---|
//! | the target | `q·p` | `(g − h) / p` |
//! | the observer | `q·(1 − p)` | `(g − h) / (1 − p)` |
//! | both | `q` | `g − h` |
//!
//! The greatest of these over all crossings is the answer. A negative one is room to spare: the end may sink so far. That
//! of both, negated, is the line's clearance over the ground.

use std::convert::Infallible;
use std::ops::ControlFlow;

use crate::lattice::Lattice;
use crate::sight::Curvature;
use crate::sight::crossings::{LineCrossing, LinePart, crossings};
use crate::sight::descent::Probe;
use crate::sight::line::{Blocker, GroundedSight, SightEnd};
use sandtable_raster::answer::Answer;

/// The end of a line of sight that is raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Raised {
    /// The target.
    Target,
    /// The observer.
    Observer,
    /// Both by the same.
    Both,
}

/// A rise, and the crossing that requires it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise {
    /// Meters; negative for room to spare.
    pub rise_m: f64,
    /// Where the line, so raised, touches the ground: the first such position from the observer.
    pub grazing: Blocker,
}

impl Raised {
    /// The share of the end's rise by which the line rises at a part of it.
    #[inline]
    fn lift(self, part: f64) -> f64 {
        match self {
            Self::Target => part,
            Self::Observer => 1.0 - part,
            Self::Both => 1.0,
        }
    }
}

/// The rise of `raised` that lets the line from `observer` to `target` clear the ground between them; `None` where there
/// is nothing to clear, no edge of a triangle or no data between the ends.
///
/// It is above 0 exactly where [`line_of_sight`](crate::sight::line::line_of_sight) is blocked. Costs three
/// crossings a cell of the whole line.
///
/// # Errors
/// The ground's answer at the first end, the observer's before the target's, without a height.
pub fn required_rise(
    lattice: &Lattice,
    observer: SightEnd,
    target: SightEnd,
    curvature: Curvature,
    raised: Raised,
) -> Result<Option<Rise>, Answer> {
    let sight = GroundedSight::new(lattice, observer, target, curvature)?;
    let mut search = RiseSearch::new(sight, raised, 0.0);
    match crossings(lattice, sight.grid.0, sight.grid.1, |crossing| search.visit(crossing)) {
        ControlFlow::Continue(()) => Ok(search.rise()),
        ControlFlow::Break(never) => match never {},
    }
}

/// The search for the crossing that requires the greatest rise.
pub(crate) struct RiseSearch {
    sight: GroundedSight,
    raised: Raised,
    /// The error of the line and of the ground under it, in meters.
    margin_m: f64,
    most_m: f64,
    at: Option<LineCrossing>,
}

impl RiseSearch {
    pub(crate) fn new(sight: GroundedSight, raised: Raised, margin_m: f64) -> Self {
        Self { sight, raised, margin_m, most_m: f64::NEG_INFINITY, at: None }
    }

    /// The greatest rise so far.
    pub(crate) fn rise(&self) -> Option<Rise> {
        self.at.map(|crossing| Rise { rise_m: self.most_m, grazing: self.sight.place(crossing) })
    }
}

impl Probe for RiseSearch {
    type Found = Infallible;

    fn rules_out(&self, part: LinePart, highest_m: f64, _: impl FnOnce() -> f64) -> bool {
        let above_m = highest_m + self.margin_m - self.sight.line.lowest_m(part);
        // The bound is greatest where the line is lifted least, if the ground is above it, else where it is lifted most.
        let lifts = [self.raised.lift(part.0), self.raised.lift(part.1)];
        let lift = if above_m > 0.0 { lifts[0].min(lifts[1]) } else { lifts[0].max(lifts[1]) };
        // Of a few operations' rounding, relative to the rise.
        const ROUNDING: f64 = 1.0 + 1e-14;
        let most_m = above_m / lift;
        (if most_m > 0.0 { most_m * ROUNDING } else { most_m / ROUNDING }) < self.most_m
    }

    fn visit(&mut self, crossing: LineCrossing) -> ControlFlow<Infallible> {
        let above_m = crossing.height_m - self.sight.line.height_m(crossing.part);
        let rise_m = above_m / self.raised.lift(crossing.part);
        if rise_m > self.most_m {
            self.most_m = rise_m;
            self.at = Some(crossing);
        }
        ControlFlow::Continue(())
    }
}

//! By how much an end of a line of sight must rise to be seen, and the place that decides it.
//!
//! With the line at height `h(p)` over the crossing at part `p`, whose ground stands at `g`, the line clears it when
//!
//! | what rises by `q` | lifts the line there by | so that `q` must be at least |
//! |---|---|---|
//! | the target | `q·p` | `(g − h) / p` |
//! | the observer | `q·(1 − p)` | `(g − h) / (1 − p)` |
//! | both | `q` | `g − h` |
//!
//! The most that any crossing asks for is the answer. A negative one is room to spare: the end may sink so far. That of
//! both, turned round, is the line's clearance over the ground.

use std::convert::Infallible;
use std::ops::ControlFlow;

use crate::dem::answer::Answer;
use crate::terrain::lattice::Lattice;
use crate::terrain::sight::Curvature;
use crate::terrain::sight::crossings::{LineCrossing, LinePart, crossings};
use crate::terrain::sight::descent::Probe;
use crate::terrain::sight::line::{Blocker, GroundedSight, SightEnd};

/// Which end of a line of sight is raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Raised {
    /// What is looked at.
    Target,
    /// Who looks.
    Observer,
    /// Both by the same.
    Both,
}

/// A rise, and the place that asks for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rise {
    /// Meters; negative where so much is to spare.
    pub rise_m: f64,
    /// Where the line, risen so, touches the ground: the first such place from the observer.
    pub grazing: Blocker,
}

impl Raised {
    /// By what part of the end's rise the line rises, `part` of the way along it.
    #[inline]
    fn lift(self, part: f64) -> f64 {
        match self {
            Self::Target => part,
            Self::Observer => 1.0 - part,
            Self::Both => 1.0,
        }
    }
}

/// By how much `raised` must rise for the line from `observer` to `target` to clear the ground between them; `None`
/// where there is nothing to clear, no edge of a triangle or no data between the ends.
///
/// It is above 0 where [`line_of_sight`](crate::terrain::sight::line::line_of_sight) is blocked, and only there. Costs
/// three crossings a cell of the whole way.
///
/// # Errors
/// What the ground answers at the first end, the observer's before the target's, that has no height.
pub fn required_rise(
    lattice: &Lattice,
    observer: SightEnd,
    target: SightEnd,
    curvature: Curvature,
    raised: Raised,
) -> Result<Option<Rise>, Answer> {
    let look = GroundedSight::new(lattice, observer, target, curvature)?;
    let mut seeker = Seeker::new(look, raised, 0.0);
    match crossings(lattice, look.grid.0, look.grid.1, |crossing| seeker.see(crossing)) {
        ControlFlow::Continue(()) => Ok(seeker.found()),
        ControlFlow::Break(never) => match never {},
    }
}

/// The search for the crossing that asks for most.
pub(in crate::terrain) struct Seeker {
    look: GroundedSight,
    raised: Raised,
    /// How far the line and the ground under it may be mistaken, in meters.
    margin_m: f64,
    most_m: f64,
    at: Option<LineCrossing>,
}

impl Seeker {
    pub(in crate::terrain) fn new(look: GroundedSight, raised: Raised, margin_m: f64) -> Self {
        Self { look, raised, margin_m, most_m: f64::NEG_INFINITY, at: None }
    }

    pub(in crate::terrain) fn found(&self) -> Option<Rise> {
        self.at.map(|crossing| Rise { rise_m: self.most_m, grazing: self.look.place(crossing) })
    }
}

impl Probe for Seeker {
    type Found = Infallible;

    fn rules_out(&self, parts: LinePart, highest_m: f64, _: impl FnOnce() -> f64) -> bool {
        let above_m = highest_m + self.margin_m - self.look.line.lowest_m(parts);
        // What is asked for most where the ground stands above the line is where the line is lifted least.
        let lifts = [self.raised.lift(parts.0), self.raised.lift(parts.1)];
        let lift = if above_m > 0.0 { lifts[0].min(lifts[1]) } else { lifts[0].max(lifts[1]) };
        // Of a few operations' rounding, relative to the rise.
        const ROUNDING: f64 = 1.0 + 1e-14;
        let most_m = above_m / lift;
        (if most_m > 0.0 { most_m * ROUNDING } else { most_m / ROUNDING }) < self.most_m
    }

    fn see(&mut self, crossing: LineCrossing) -> ControlFlow<Infallible> {
        let above_m = crossing.height_m - self.look.line.height_m(crossing.part);
        let rise_m = above_m / self.raised.lift(crossing.part);
        if rise_m > self.most_m {
            self.most_m = rise_m;
            self.at = Some(crossing);
        }
        ControlFlow::Continue(())
    }
}

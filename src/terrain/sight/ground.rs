//! The ground prepared for lines of sight: a lattice with the pyramid of its heights.
//!
//! Answers equal those of the plain walk ([`line_of_sight`](crate::sight::line::line_of_sight) and
//! [`required_rise`](crate::sight::rise::required_rise)) to the last bit; ground without effect is skipped.
//!
//! **When a block is skipped.** A line skips a block when the block's highest post lies below the line's lowest point over
//! it by more than their errors: the line's from rounding (`SightLine::rounding_m`), a crossing's height from rounding and
//! from its position, which is known to `POSITION_ERROR` of a cell, and so to no more than that share of the relief.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::lattice::Lattice;
use crate::post_rect::PostRect;
use crate::pyramid::Pyramid;
use crate::sight::Curvature;
use crate::sight::crossings::{LineCrossing, LinePart, POSITION_ERROR};
use crate::sight::descent::{Probe, descend};
use crate::sight::line::{GroundedSight, Sight, SightEnd};
use crate::sight::rise::{Raised, Rise, RiseSearch};
use sandtable_raster::answer::Answer;

/// A lattice with the pyramid of its heights; cheap to clone.
#[derive(Clone, Debug)]
pub struct SightGround {
    lattice: Arc<Lattice>,
    pyramid: Arc<Pyramid>,
    /// How far a crossing's height may lie above the highest post of its block, in meters.
    slack_m: f64,
}

impl SightGround {
    /// Prepares `lattice`; one pass over its heights.
    pub fn new(lattice: Arc<Lattice>) -> Self {
        let pyramid = Pyramid::new(&lattice);
        Self::with_pyramid(lattice, pyramid)
    }

    fn with_pyramid(lattice: Arc<Lattice>, pyramid: Pyramid) -> Self {
        let (low_m, high_m) = pyramid.height_range();
        let (low_m, high_m) = (f64::from(low_m), f64::from(high_m));
        let largest_m = low_m.abs().max(high_m.abs());
        // Twice the position's error: that of the crossing, and that of the block's border.
        let slack_m = 2.0 * POSITION_ERROR * (high_m - low_m) + 8.0 * f64::EPSILON * largest_m;
        // Infinite for a part without any data, where no crossing has a height.
        let slack_m = if slack_m.is_finite() { slack_m } else { 0.0 };
        Self { lattice, pyramid: Arc::new(pyramid), slack_m }
    }

    /// Lets the ground go, so that it can be edited without a copy; [`SightGround::again`] takes it back.
    pub fn release(self) -> Arc<Pyramid> {
        self.pyramid
    }

    /// The ground that was released as `pyramid`, after an edit of the posts in `edited` alone, which made it `lattice`. A
    /// pyramid that others hold stays as it is for them.
    ///
    /// # Panics
    /// Where `lattice` is of another size, or `edited` leaves it.
    pub fn again(pyramid: Arc<Pyramid>, lattice: Arc<Lattice>, edited: &[PostRect]) -> Self {
        let mut pyramid = Arc::unwrap_or_clone(pyramid);
        edited.iter().for_each(|&posts| pyramid.update(&lattice, posts));
        Self::with_pyramid(lattice, pyramid)
    }

    /// The ground itself.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// Its pyramid.
    pub fn pyramid(&self) -> &Arc<Pyramid> {
        &self.pyramid
    }

    /// Whether `target` can be seen from `observer`: to the last bit
    /// [`line_of_sight`](crate::sight::line::line_of_sight).
    pub fn line_of_sight(&self, observer: SightEnd, target: SightEnd, curvature: Curvature) -> Sight {
        let sight = match GroundedSight::new(&self.lattice, observer, target, curvature) {
            Ok(sight) => sight,
            Err(missing) => return Sight::NoGround(missing),
        };
        let margin_m = self.slack_m + sight.line.rounding_m();
        let mut search = BlockerSearch { sight: &sight, margin_m };
        sight.result(descend(&self.lattice, &self.pyramid, sight.grid, &mut search))
    }

    /// The rise of `raised` that lets the line clear the ground, and where that is decided: to the last bit
    /// [`required_rise`](crate::sight::rise::required_rise).
    ///
    /// # Errors
    /// As for [`required_rise`](crate::sight::rise::required_rise).
    pub fn required_rise(
        &self,
        observer: SightEnd,
        target: SightEnd,
        curvature: Curvature,
        raised: Raised,
    ) -> Result<Option<Rise>, Answer> {
        let sight = GroundedSight::new(&self.lattice, observer, target, curvature)?;
        let mut search = RiseSearch::new(sight, raised, self.slack_m + sight.line.rounding_m());
        match descend(&self.lattice, &self.pyramid, sight.grid, &mut search) {
            ControlFlow::Continue(()) => Ok(search.rise()),
            ControlFlow::Break(never) => match never {},
        }
    }

    /// How far a crossing's height may lie outside its block's extremes, in meters.
    pub(crate) fn slack_m(&self) -> f64 {
        self.slack_m
    }
}

/// The search for the first blocker of a line.
struct BlockerSearch<'a> {
    sight: &'a GroundedSight,
    margin_m: f64,
}

impl Probe for BlockerSearch<'_> {
    type Found = LineCrossing;

    #[inline]
    fn rules_out(&self, part: LinePart, highest_m: f64, _: impl FnOnce() -> f64) -> bool {
        highest_m + self.margin_m < self.sight.line.lowest_m(part)
    }

    #[inline]
    fn visit(&mut self, crossing: LineCrossing) -> ControlFlow<LineCrossing> {
        self.sight.check(crossing)
    }
}

//! The ground made ready for looking over it: a lattice and the pyramid of its heights.
//!
//! The answers are those of the plain walk along the whole line ([`line_of_sight`](crate::terrain::sight::line::line_of_sight) and
//! [`required_rise`](crate::terrain::sight::rise::required_rise)), to the last bit; what is saved is looking where the ground cannot matter.
//!
//! **Why a block may be passed.** A line passes a block when the block's highest post lies below the line's lowest
//! place over it by more than the two can be mistaken: the line by rounding (`SightLine::rounding_m`), a crossing's
//! height by rounding and by where it lies, which is known to `POSITION_ERROR` of a cell, and so no more than that
//! share of the ground's relief.

use std::ops::ControlFlow;
use std::sync::Arc;

use rayon::prelude::*;

use crate::dem::answer::Answer;
use crate::terrain::lattice::Lattice;
use crate::terrain::post_rect::PostRect;
use crate::terrain::sight::Curvature;
use crate::terrain::sight::crossings::{LineCrossing, LinePart, POSITION_ERROR};
use crate::terrain::sight::descent::{Probe, descend};
use crate::terrain::sight::line::{GroundedSight, Sight, SightEnd};
use crate::terrain::sight::pyramid::Pyramid;
use crate::terrain::sight::rise::{Raised, Rise, Seeker};

/// Lines of sight per task of a batch: some hundred microseconds' work.
const CHUNK: usize = 512;

/// A lattice with the pyramid of its heights; cheap to clone.
#[derive(Clone, Debug)]
pub struct SightGround {
    lattice: Arc<Lattice>,
    pyramid: Arc<Pyramid>,
    /// How far a crossing's height may lie above the highest post of its block, in meters.
    slack_m: f64,
}

impl SightGround {
    /// Makes `lattice` ready; one pass over its heights.
    pub fn new(lattice: Arc<Lattice>) -> Self {
        let pyramid = Pyramid::new(&lattice);
        Self::with(lattice, pyramid)
    }

    fn with(lattice: Arc<Lattice>, pyramid: Pyramid) -> Self {
        let (low_m, high_m) = pyramid.height_range();
        let (low_m, high_m) = (f64::from(low_m), f64::from(high_m));
        let largest_m = low_m.abs().max(high_m.abs());
        // Twice the position's error: that of the crossing, and that of the block's border.
        let slack_m = 2.0 * POSITION_ERROR * (high_m - low_m) + 8.0 * f64::EPSILON * largest_m;
        // A part of a larger lattice may hold no data at all, and no crossing then has a height.
        let slack_m = if slack_m.is_finite() { slack_m } else { 0.0 };
        Self { lattice, pyramid: Arc::new(pyramid), slack_m }
    }

    /// The same ground after an edit of the posts in `edited` alone, which made it `lattice`: the pyramid is copied and
    /// mended there, and whoever still looks over the old ground is not disturbed.
    ///
    /// # Panics
    /// Where `lattice` is of another size, or `edited` leaves it.
    pub fn edited(&self, lattice: Arc<Lattice>, edited: PostRect) -> Self {
        let mut pyramid = Pyramid::clone(&self.pyramid);
        pyramid.mend(&lattice, edited);
        Self::with(lattice, pyramid)
    }

    /// The ground itself.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// Its pyramid.
    pub fn pyramid(&self) -> &Arc<Pyramid> {
        &self.pyramid
    }

    /// Whether `target` can be seen from `observer`: what
    /// [`line_of_sight`](crate::terrain::sight::line::line_of_sight) says of it, to the last bit.
    pub fn line_of_sight(&self, observer: SightEnd, target: SightEnd, curvature: Curvature) -> Sight {
        match GroundedSight::new(&self.lattice, observer, target, curvature) {
            Ok(look) => {
                let margin_m = self.slack_m + look.line.rounding_m();
                let mut blocking = Blocking { look: &look, margin_m };
                look.sight(descend(&self.lattice, &self.pyramid, look.grid, &mut blocking))
            }
            Err(missing) => Sight::NoGround(missing),
        }
    }

    /// [`SightGround::line_of_sight`] for many pairs of observer and target, in order, on all threads.
    ///
    /// # Panics
    /// Where `out` is not as long as `pairs`.
    pub fn lines_of_sight(&self, pairs: &[(SightEnd, SightEnd)], curvature: Curvature, out: &mut [Sight]) {
        assert_eq!(pairs.len(), out.len(), "one answer per pair");
        pairs.par_chunks(CHUNK).zip(out.par_chunks_mut(CHUNK)).for_each(|(pairs, out)| {
            for (&(observer, target), out) in pairs.iter().zip(out) {
                *out = self.line_of_sight(observer, target, curvature);
            }
        });
    }

    /// By how much `raised` must rise for the line to clear the ground, and where that is decided: what
    /// [`required_rise`](crate::terrain::sight::rise::required_rise) says of it, to the last bit.
    ///
    /// # Errors
    /// As for [`required_rise`](crate::terrain::sight::rise::required_rise).
    pub fn required_rise(
        &self,
        observer: SightEnd,
        target: SightEnd,
        curvature: Curvature,
        raised: Raised,
    ) -> Result<Option<Rise>, Answer> {
        let look = GroundedSight::new(&self.lattice, observer, target, curvature)?;
        let mut seeker = Seeker::new(look, raised, self.slack_m + look.line.rounding_m());
        match descend(&self.lattice, &self.pyramid, look.grid, &mut seeker) {
            ControlFlow::Continue(()) => Ok(seeker.found()),
            ControlFlow::Break(never) => match never {},
        }
    }

    /// How far a crossing's height may lie outside its block's extremes, in meters.
    pub(in crate::terrain) fn slack_m(&self) -> f64 {
        self.slack_m
    }
}

/// The search for what blocks a line first.
struct Blocking<'a> {
    look: &'a GroundedSight,
    margin_m: f64,
}

impl Probe for Blocking<'_> {
    type Found = LineCrossing;

    #[inline]
    fn rules_out(&self, parts: LinePart, highest_m: f64, _: impl FnOnce() -> f64) -> bool {
        highest_m + self.margin_m < self.look.line.lowest_m(parts)
    }

    #[inline]
    fn see(&mut self, crossing: LineCrossing) -> ControlFlow<LineCrossing> {
        self.look.blocked(crossing)
    }
}

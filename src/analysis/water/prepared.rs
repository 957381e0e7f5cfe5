//! The ground as water meets it: cut through below bridges and culverts and, if so asked, with depressions breached.

use std::borrow::Cow;

use super::breach::{BreachLimits, breach};
use super::carve::carved;
use super::drainage::{Drainage, drain};
use super::fill::filled;
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The share of the work that breaching takes, where it is done.
pub(super) const BREACHED: f64 = 0.5;

/// The ground as water meets it.
pub(crate) struct WaterGround<'a> {
    /// The posts.
    pub ground: &'a Lattice,
    /// Their heights, meters; NaN without data.
    pub heights: Cow<'a, [f32]>,
    /// What was done to the ground, a sentence each.
    pub notes: Vec<String>,
    /// Whether its depressions were breached.
    is_breached: bool,
}

impl<'a> WaterGround<'a> {
    /// The ground of a land. Where its kind has `depressions`, and they are to be breached, they are.
    ///
    /// # Errors
    /// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
    pub fn of(land: &'a Land, arguments: &AnalysisArguments, stop: &StopFlag) -> Result<Self, AnalysisError> {
        let (mut heights, cuts) = carved(land);
        let mut notes = cuts.note();
        let is_breached = arguments.word("depressions") == "breach";
        if is_breached {
            let limits = BreachLimits {
                depth_m: arguments.number("breach_depth_m"),
                length_m: arguments.number("breach_length_m"),
            };
            let tally = breach(&land.ground, heights.to_mut(), limits, stop)?;
            notes.push(format!(
                "{} pits are breached; {} have no way out within the limits and are filled",
                tally.breached, tally.left
            ));
        }
        Ok(Self { ground: &land.ground, heights, notes, is_breached })
    }

    /// The heights with the depressions filled that are left.
    ///
    /// # Errors
    /// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
    pub fn filled(&self, stop: &StopFlag) -> Result<Vec<f32>, AnalysisError> {
        filled(&self.heights, self.ground.columns() as usize, stop)
    }

    /// Where the ground drains to.
    ///
    /// # Errors
    /// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
    pub fn drained(&self, stop: &StopFlag) -> Result<Drainage, AnalysisError> {
        // Filled, down slopes, across flats; what follows takes as long as each.
        stop.stretch(if self.is_breached { BREACHED } else { 0.0 }..0.8, 3);
        let drainage = drain(self.ground, &self.heights, stop)?;
        stop.stretch(0.8..1.0, 1);
        Ok(drainage)
    }
}

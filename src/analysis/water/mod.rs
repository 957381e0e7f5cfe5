//! Water on the land.

mod carve;
mod directions;
mod drainage;
mod fill;
mod kinds;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] =
    &[("fill", kinds::fill), ("flow", kinds::flow), ("streams", kinds::streams)];

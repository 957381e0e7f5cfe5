//! Water on the land.

mod breach;
mod carve;
mod directions;
mod drainage;
mod fill;
mod infinity;
mod kinds;
mod prepared;
mod streams;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] =
    &[("fill", kinds::fill), ("flow", kinds::flow), ("streams", streams::streams)];

//! The form of the ground.

pub mod slope;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[("slope", slope::slope)];

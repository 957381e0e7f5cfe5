//! Earth that is moved.

pub mod berms;
pub mod cut_fill;
mod haul;
mod transport;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] =
    &[("cut-fill", cut_fill::cut_fill), ("haul", haul::haul), ("berms", berms::berms)];

//! Landing and sites on the land.

pub(crate) mod disk;
pub mod zones;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[("landing-zones", zones::landing_zones)];

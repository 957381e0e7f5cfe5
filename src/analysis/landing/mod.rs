//! Landing and sites on the land.

pub(crate) mod disk;
mod mask;
mod sites;
pub mod zones;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] =
    &[("landing-zones", zones::landing_zones), ("sites", sites::sites)];

//! Landing and sites on the land.

pub(crate) mod disk;
mod drop;
mod mask;
#[cfg(test)]
mod oracle_tests;
mod rectangle;
mod sites;
mod suitability;
mod zone_sites;
pub mod zones;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] =
    &[("landing-zones", zones::landing_zones), ("sites", sites::sites), ("drop-zones", drop::drop_zones)];

//! Water on the land.

mod band_fill;
mod band_flats;
mod band_flow;
#[cfg(test)]
mod band_tests;
pub mod banded;
pub mod bands;
mod basins;
mod breach;
mod carve;
mod dam_break;
mod directions;
mod drainage;
mod drainage_height;
#[cfg(test)]
mod extreme_tests;
mod fill;
mod flood;
mod infinity;
mod kinds;
#[cfg(test)]
mod network_oracle_tests;
mod normal_depth;
#[cfg(test)]
mod oracle_tests;
mod outlines;
mod prepared;
mod reservoir;
#[cfg(test)]
mod reservoir_tests;
mod streams;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[
    ("fill", kinds::fill),
    ("flow", kinds::flow),
    ("streams", streams::streams),
    ("basins", basins::basins),
    ("drainage-height", drainage_height::drainage_height),
    ("flood", flood::flood),
    ("dam-break", dam_break::dam_break),
];

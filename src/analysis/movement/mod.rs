//! Movement across the land: what ground a vehicle can cross, how fast, and on which ways.

mod burn;
mod going;
mod grade;
mod isochrones;
mod obstacles;
mod queue;
mod route;
#[cfg(test)]
mod testing;
mod travel;
pub mod vehicle;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[
    ("obstacles", obstacles::obstacles),
    ("speed", obstacles::speed),
    ("time", isochrones::time),
    ("route", route::route),
];

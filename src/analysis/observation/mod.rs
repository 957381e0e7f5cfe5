//! Observation and fire over the land.
//!
//! All kinds ask one definition of sight, `sandtable_terrain::sight`: the line between two points over the triangles of the
//! ground, with the Earth's curvature and refraction.

mod exposure;
mod intervisibility;
mod lookout;
#[cfg(test)]
mod test_land;
mod viewsheds;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[
    ("viewsheds", viewsheds::viewsheds),
    ("intervisibility", intervisibility::intervisibility),
    ("exposure", exposure::exposure),
];

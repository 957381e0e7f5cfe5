//! Observation and fire over the land.
//!
//! All kinds ask one definition of sight, `sandtable_terrain::sight`: the line between two points over the triangles of the
//! ground, with the Earth's curvature and refraction.

mod best_posts;
mod exposure;
mod fields_of_fire;
mod intervisibility;
mod lookout;
mod masking;
#[cfg(test)]
mod test_land;
mod viewsheds;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[
    ("viewsheds", viewsheds::viewsheds),
    ("intervisibility", intervisibility::intervisibility),
    ("best-posts", best_posts::best_posts),
    ("fields-of-fire", fields_of_fire::fields_of_fire),
    ("masking", masking::masking),
    ("exposure", exposure::exposure),
];

//! The form of the ground.

pub mod aspect;
pub mod curvature;
pub mod hillshade;
pub mod slope;
mod window;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[
    ("slope", slope::slope),
    ("aspect", aspect::aspect),
    ("hillshade", hillshade::hillshade),
    ("curvature", curvature::curvature),
];

//! The form of the ground.

pub mod aspect;
pub mod contours;
pub mod curvature;
mod divide_tree;
pub mod form_lines;
#[cfg(test)]
mod gdaldem_tables;
pub mod geomorphons;
pub mod hillshade;
pub mod peaks;
pub mod ruggedness;
pub mod slope;
mod window;

use crate::run::KindFunction;

/// The functions of the family's kinds.
pub(crate) const FUNCTIONS: &[(&str, KindFunction)] = &[
    ("slope", slope::slope),
    ("aspect", aspect::aspect),
    ("hillshade", hillshade::hillshade),
    ("curvature", curvature::curvature),
    ("ruggedness", ruggedness::ruggedness),
    ("geomorphons", geomorphons::geomorphons),
    ("contours", contours::contours),
    ("elevation-bands", contours::elevation_bands),
    ("peaks", peaks::peaks),
    ("passes", peaks::passes),
    ("form-lines", form_lines::form_lines),
];

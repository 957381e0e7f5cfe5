//! Rings of positions: areas of parameters.

use glam::DVec2;

use sandtable_geom::polygon::contains;

/// Whether a position lies in the area of a parameter; anywhere does where none is stated.
pub(crate) fn is_in_area(area: &[DVec2], at: DVec2) -> bool {
    area.is_empty() || contains([area], at)
}

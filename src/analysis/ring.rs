//! Rings of positions: areas of parameters.

use glam::DVec2;

use sandtable_geom::polygon::{contains, doubled_area};

/// Whether a position lies in the area of a parameter; anywhere does where none is stated.
pub(crate) fn is_in_area(area: &[DVec2], at: DVec2) -> bool {
    area.is_empty() || contains([area], at)
}

/// The ring in the order that areas of an outcome have.
pub(crate) fn counter_clockwise(ring: &[DVec2]) -> Vec<DVec2> {
    let mut ring = ring.to_vec();
    if doubled_area(&ring) < 0.0 {
        ring.reverse();
    }
    ring
}

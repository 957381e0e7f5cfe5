//! Rings of positions: areas of parameters.

use glam::DVec2;

use sandtable_geom::polygon::doubled_area;

/// The ring in the order that areas of an outcome have.
pub(crate) fn counter_clockwise(ring: &[DVec2]) -> Vec<DVec2> {
    let mut ring = ring.to_vec();
    if doubled_area(&ring) < 0.0 {
        ring.reverse();
    }
    ring
}

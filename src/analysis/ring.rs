//! Rings of positions: areas of parameters.

use glam::DVec2;

/// Whether a ring holds a position, by the even-odd rule.
pub(crate) fn holds(ring: &[DVec2], at: DVec2) -> bool {
    let mut before = ring.last().copied().unwrap_or(at);
    let mut is_inside = false;
    for &corner in ring {
        if (corner.y > at.y) != (before.y > at.y)
            && at.x < before.x + (corner.x - before.x) * (at.y - before.y) / (corner.y - before.y)
        {
            is_inside = !is_inside;
        }
        before = corner;
    }
    is_inside
}

/// The ring in the order that areas of an outcome have.
pub(crate) fn counter_clockwise(ring: &[DVec2]) -> Vec<DVec2> {
    let mut ring = ring.to_vec();
    let twice_area: f64 =
        (0..ring.len()).map(|index| ring[index].perp_dot(ring[(index + 1) % ring.len()])).sum();
    if twice_area < 0.0 {
        ring.reverse();
    }
    ring
}

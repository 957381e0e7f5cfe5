//! The axis of a polygon: a line through the middle of its width, along its greater extent.

use glam::DVec2;

use crate::polygon::edges;

/// Sections across the polygon from which the axis is made.
const SECTIONS: usize = 48;

/// The middles of the widest parts of sections across a ring, in order along its greater extent; fewer than two where
/// the ring encloses nothing or is not finite. Where the ring is as wide as long, the axis runs along X.
pub fn axis(ring: &[DVec2]) -> Vec<DVec2> {
    if ring.len() < 3 || !ring.iter().all(|at| at.is_finite()) {
        return Vec::new();
    }
    let along = greater_extent(ring);
    let across = DVec2::new(-along.y, along.x);
    let stations = ring.iter().map(|at| at.dot(along));
    let (low, high) = stations.fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at), high.max(at)));
    let step = (high - low) / SECTIONS as f64;
    if step.is_nan() || step <= 0.0 {
        return Vec::new();
    }
    let station = |section: usize| low + (section as f64 + 0.5) * step;
    (0..SECTIONS)
        .filter_map(|section| {
            let at = station(section);
            let mut crossings: Vec<f64> =
                edges(ring).filter_map(|(from, to)| crossing(from, to, along, across, at)).collect();
            crossings.sort_by(f64::total_cmp);
            let widest = crossings.chunks_exact(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
            Some(along * at + across * (0.5 * (widest[0] + widest[1])))
        })
        .collect()
}

/// The direction in which the vertices, weighed by the edges beside them, are spread most.
fn greater_extent(ring: &[DVec2]) -> DVec2 {
    let (mut length, mut center) = (0.0, DVec2::ZERO);
    for (from, to) in edges(ring) {
        let weight = from.distance(to);
        length += weight;
        center += from.midpoint(to) * weight;
    }
    if length.is_nan() || length <= 0.0 {
        return DVec2::X;
    }
    center /= length;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (from, to) in edges(ring) {
        let (weight, off) = (from.distance(to), from.midpoint(to) - center);
        xx += weight * off.x * off.x;
        xy += weight * off.x * off.y;
        yy += weight * off.y * off.y;
    }
    if (xx - yy).abs() + xy.abs() < 0.1 * (xx + yy) {
        return DVec2::X;
    }
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    DVec2::new(libm::cos(angle), libm::sin(angle))
}

/// Where an edge crosses the section at a station, as a coordinate along `across`.
fn crossing(from: DVec2, to: DVec2, along: DVec2, across: DVec2, at: f64) -> Option<f64> {
    let (before, after) = (from.dot(along) - at, to.dot(along) - at);
    ((before < 0.0) != (after < 0.0)).then(|| from.lerp(to, before / (before - after)).dot(across))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_of_a_bent_strip_follows_the_bend() {
        let arc =
            |radius: f64| (0..=40).map(move |n| DVec2::from_angle(f64::from(n) / 40.0 * 2.0 + 0.57) * radius);
        let mut ring: Vec<DVec2> = arc(90.0).collect();
        let inner: Vec<DVec2> = arc(110.0).collect();
        ring.extend(inner.into_iter().rev());
        let axis = axis(&ring);
        assert!(axis.len() > 40);
        let middle = axis.iter().filter(|at| at.x.abs() < 60.0);
        let off = middle.map(|at| (at.length() - 100.0).abs()).fold(0.0, f64::max);
        assert!(off < 4.0, "{off}");
    }

    #[test]
    fn the_axis_of_a_rectangle_is_its_middle_line_whatever_its_direction() {
        for turn in 0..12 {
            let along = DVec2::from_angle(f64::from(turn) * 0.5);
            let across = DVec2::new(-along.y, along.x);
            let ring = [
                along * 50.0 + across * 8.0,
                along * -50.0 + across * 8.0,
                along * -50.0 - across * 8.0,
                along * 50.0 - across * 8.0,
            ];
            let axis = axis(&ring);
            assert!(axis.iter().all(|at| at.dot(across).abs() < 1e-6), "{turn}");
            assert!(axis[0].distance(axis[axis.len() - 1]) > 90.0, "{turn}");
        }
    }

    #[test]
    fn nothing_has_no_axis() {
        assert!(axis(&[]).is_empty());
        assert!(axis(&[DVec2::ONE; 5]).is_empty());
        assert!(axis(&[DVec2::NAN, DVec2::ONE, DVec2::ZERO]).is_empty());
    }
}

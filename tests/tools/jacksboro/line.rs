//! Lines and rings in the metric frame: smoothing, corner cutting, simplification.

use glam::DVec2;

/// Twice-averaged line: every inner vertex moves to (before + 2·itself + after) / 4, `passes` times, but
/// never farther than `leash_m` from where it began. The ends stay.
pub fn smooth(points: &[DVec2], passes: usize, leash_m: f64) -> Vec<DVec2> {
    let mut line = points.to_vec();
    for _ in 0..passes {
        let before = line.clone();
        for at in 1..line.len().saturating_sub(1) {
            let mean = (before[at - 1] + 2.0 * before[at] + before[at + 1]) / 4.0;
            line[at] = points[at] + (mean - points[at]).clamp_length_max(leash_m);
        }
    }
    line
}

/// Chaikin's corner cutting (1974), once: every corner becomes two vertices at the quarters of its sides.
pub fn cut_corners(points: &[DVec2]) -> Vec<DVec2> {
    let Some((first, last)) = points.first().zip(points.last()) else { return Vec::new() };
    let mut line = vec![*first];
    for (at, pair) in points.windows(2).enumerate() {
        if at > 0 {
            line.push(pair[0].lerp(pair[1], 0.25));
        }
        if at + 2 < points.len() {
            line.push(pair[0].lerp(pair[1], 0.75));
        }
    }
    line.push(*last);
    line
}

/// Chaikin's corner cutting of a ring.
pub fn cut_corners_ring(ring: &[DVec2]) -> Vec<DVec2> {
    let sides = (0..ring.len()).map(|at| (ring[at], ring[(at + 1) % ring.len()]));
    sides.flat_map(|(from, to)| [from.lerp(to, 0.25), from.lerp(to, 0.75)]).collect()
}

/// Douglas & Peucker's simplification (1973): drops vertices that lie within `tolerance_m` of what remains.
pub fn simplify(points: &[DVec2], tolerance_m: f64) -> Vec<DVec2> {
    let mut keep = vec![false; points.len()];
    let mut open = vec![(0, points.len().saturating_sub(1))];
    while let Some((from, to)) = open.pop() {
        keep[from] = true;
        keep[to] = true;
        let off = |at: usize| distance_to_segment(points[at], points[from], points[to]);
        let farthest = (from + 1..to).max_by(|&a, &b| off(a).total_cmp(&off(b)));
        if let Some(at) = farthest.filter(|&at| off(at) > tolerance_m) {
            open.extend([(from, at), (at, to)]);
        }
    }
    points.iter().zip(keep).filter_map(|(point, keep)| keep.then_some(*point)).collect()
}

/// Simplifies a ring in two halves, split at the vertex farthest from the first.
pub fn simplify_ring(ring: &[DVec2], tolerance_m: f64) -> Vec<DVec2> {
    let far = |at: usize| ring[at].distance_squared(ring[0]);
    let split = (0..ring.len()).max_by(|&a, &b| far(a).total_cmp(&far(b))).unwrap_or(0);
    let mut simple = simplify(&ring[..=split], tolerance_m);
    simple.pop();
    let back: Vec<DVec2> = ring[split..].iter().chain([&ring[0]]).copied().collect();
    simple.extend(simplify(&back, tolerance_m));
    simple.pop();
    simple
}

/// Vertices every `spacing_m` along the line, as evenly as its length allows, ends kept.
pub fn resample(points: &[DVec2], spacing_m: f64) -> Vec<DVec2> {
    let total = length(points);
    let pieces = (total / spacing_m).round().max(1.0) as usize;
    let mut line = Vec::with_capacity(pieces + 1);
    let (mut side, mut walked) = (0, 0.0);
    for piece in 0..pieces {
        let station = total * piece as f64 / pieces as f64;
        let mut long = points[side].distance(points[side + 1]);
        while walked + long < station && side + 2 < points.len() {
            walked += long;
            side += 1;
            long = points[side].distance(points[side + 1]);
        }
        let part = if long > 0.0 { ((station - walked) / long).min(1.0) } else { 0.0 };
        line.push(points[side].lerp(points[side + 1], part));
    }
    line.extend(points.last());
    line
}

/// The line's length.
pub fn length(points: &[DVec2]) -> f64 {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// The ring's area, positive where it runs counter-clockwise.
pub fn signed_area(ring: &[DVec2]) -> f64 {
    let sides = (0..ring.len()).map(|at| (ring[at] - ring[0], ring[(at + 1) % ring.len()] - ring[0]));
    sides.map(|(from, to)| from.perp_dot(to)).sum::<f64>() / 2.0
}

/// Distance from a point to a segment.
pub fn distance_to_segment(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let side = to - from;
    let square = side.length_squared();
    let part = if square > 0.0 { ((point - from).dot(side) / square).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(from + side * part)
}

/// Where two segments cross, ends included.
pub fn crossing(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> Option<DVec2> {
    let (along, across) = (a.1 - a.0, b.1 - b.0);
    let turn = along.perp_dot(across);
    if turn == 0.0 {
        return None;
    }
    let part_a = (b.0 - a.0).perp_dot(across) / turn;
    let part_b = (b.0 - a.0).perp_dot(along) / turn;
    let inside = (0.0..=1.0).contains(&part_a) && (0.0..=1.0).contains(&part_b);
    inside.then(|| a.0 + along * part_a)
}

//! Smooth curves through the vertices of a line.

use glam::DVec2;

/// The greatest turn at a vertex that is rounded, as its cosine: 75°. A sharper one is a corner and stays one.
const CORNER_COS: f64 = 0.258_819_045;

/// Points on the curve over leg `leg` of a line at `count − 1` places that divide it evenly, without its ends.
///
/// The curve is the centripetal one of Catmull and Rom, which has neither loops nor cusps (Yuksel, Schaefer and Keyser
/// 2011): it passes through every vertex, leaves a straight line straight, and depends on the leg and its neighbors alone.
/// No two neighbors of `points` may be the same.
pub fn along_leg(points: &[DVec2], leg: usize, count: u32) -> impl Iterator<Item = DVec2> + '_ {
    let (from, to) = (points[leg], points[leg + 1]);
    let chord = to - from;
    let before = leg.checked_sub(1).map(|index| from - points[index]);
    let after = points.get(leg + 2).map(|next| *next - to);
    let [start, end] = [before, after].map(|beside| {
        let beside = beside.filter(|beside| is_bend(*beside, chord));
        beside.map_or(chord, |beside| tangent(beside, chord))
    });
    (1..count).map(move |step| {
        let t = f64::from(step) / f64::from(count);
        let (squared, cubed) = (t * t, t * t * t);
        from + (cubed - 2.0 * squared + t) * start
            + (3.0 * squared - 2.0 * cubed) * chord
            + (cubed - squared) * end
    })
}

/// The derivative of the curve, over the leg `chord`, at the vertex between it and the leg `beside`.
fn tangent(beside: DVec2, chord: DVec2) -> DVec2 {
    let (own, other) = (chord.length().sqrt(), beside.length().sqrt());
    own * (beside / other - (beside + chord) / (other + own) + chord / own)
}

fn is_bend(beside: DVec2, chord: DVec2) -> bool {
    beside.dot(chord) > CORNER_COS * beside.length() * chord.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64)]) -> Vec<DVec2> {
        let points: Vec<DVec2> = points.iter().map(|&point| DVec2::from(point)).collect();
        let legs = 0..points.len() - 1;
        legs.flat_map(|leg| {
            std::iter::once(points[leg]).chain(along_leg(&points, leg, 8)).collect::<Vec<_>>()
        })
        .collect()
    }

    fn sharpest_turn(points: &[DVec2]) -> f64 {
        let turn = |around: &[DVec2]| (around[1] - around[0]).angle_to(around[2] - around[1]).abs();
        points.windows(3).map(turn).fold(0.0, f64::max)
    }

    #[test]
    fn bends_become_curves_and_straight_lines_stay_straight() {
        let round = curve(&[(0.0, 0.0), (10.0, 0.0), (18.0, 6.0), (20.0, 16.0)]);
        assert!(sharpest_turn(&round) < 0.25, "{}", sharpest_turn(&round));
        let straight = curve(&[(0.0, 0.0), (10.0, 5.0), (11.0, 5.5), (30.0, 15.0)]);
        assert!(straight.iter().all(|at| (at.y - at.x / 2.0).abs() < 1e-9));
        let corner = curve(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)]);
        assert!((sharpest_turn(&corner) - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    }

    #[test]
    fn the_curve_stays_near_its_line() {
        let points = [(0.0, 0.0), (10.0, 0.0), (18.0, 6.0), (20.0, 16.0), (20.5, 17.0), (40.0, 30.0)];
        for (index, at) in curve(&points).into_iter().enumerate() {
            let [from, to] = [index / 8, index / 8 + 1].map(|vertex| DVec2::from(points[vertex]));
            let off = crate::segment::distance_squared((from, to), at).sqrt();
            assert!(off < 0.15 * from.distance(to), "{off} at {at}");
        }
    }
}

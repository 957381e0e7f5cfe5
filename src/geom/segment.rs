//! Straight segments of the plane, as pairs of end points.

use glam::DVec2;

/// The position along the segment, 0..=1, of its point nearest to `at`; NaN for a segment without length.
pub fn nearest_part((from, to): (DVec2, DVec2), at: DVec2) -> f64 {
    let along = to - from;
    ((at - from).dot(along) / along.length_squared()).clamp(0.0, 1.0)
}

/// The square of the distance from `at` to the segment; NaN for a segment without length.
pub fn distance_squared((from, to): (DVec2, DVec2), at: DVec2) -> f64 {
    at.distance_squared(from + (to - from) * nearest_part((from, to), at))
}

/// The positions along two segments, 0..=1, at which they cross or touch; `None` where they do not, or are parallel.
pub fn crossing((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> Option<[f64; 2]> {
    // Of segments on one line apart, rounding may leave an area, and positions that mean nothing.
    if a.max(b).cmplt(c.min(d)).any() || c.max(d).cmplt(a.min(b)).any() {
        return None;
    }
    let (one, other) = (b - a, d - c);
    let area = one.perp_dot(other);
    let parts = [(c - a).perp_dot(other) / area, (c - a).perp_dot(one) / area];
    (area != 0.0 && parts.iter().all(|part| (0.0..=1.0).contains(part))).then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_lies_on_the_segment() {
        for quarter in 0..4 {
            let turned = |x: f64, y: f64| (0..quarter).fold(DVec2::new(x, y), |at, _| at.perp());
            let segment = (turned(0.0, 0.0), turned(10.0, 0.0));
            assert_eq!(nearest_part(segment, turned(2.5, 7.0)), 0.25);
            assert_eq!(distance_squared(segment, turned(2.5, 7.0)), 49.0);
            assert_eq!(distance_squared(segment, turned(13.0, 4.0)), 25.0);
        }
    }

    #[test]
    fn segments_on_one_line_apart_do_not_cross_however_they_are_rounded() {
        let one = (
            DVec2::new(9.623076923076903, 3.2769230769230973),
            DVec2::new(9.276923076923097, 3.623076923076903),
        );
        let other = (
            DVec2::new(11.56841825324288, 1.3315817467571198),
            DVec2::new(10.331581746757122, 2.5684182532428785),
        );
        assert_ne!((one.1 - one.0).perp_dot(other.1 - other.0), 0.0, "by rounding");
        assert_eq!(crossing(one, other), None);
        assert_eq!(crossing(other, one), None);
    }

    #[test]
    fn segments_cross_where_they_meet_and_parallel_ones_nowhere() {
        let segment = |from: (f64, f64), to: (f64, f64)| (DVec2::from(from), DVec2::from(to));
        let east = segment((0.0, 0.0), (8.0, 0.0));
        assert_eq!(crossing(east, segment((2.0, -1.0), (2.0, 3.0))), Some([0.25, 0.25]));
        assert_eq!(crossing(east, segment((8.0, 0.0), (9.0, 5.0))), Some([1.0, 0.0]), "they touch");
        assert_eq!(crossing(east, segment((9.0, -1.0), (9.0, 1.0))), None);
        assert_eq!(crossing(east, segment((0.0, 1.0), (8.0, 1.0))), None);
    }
}

//! The points that a line or a profile needs (Douglas and Peucker 1973).

/// The indices of those of `count` points, at least one, both ends among them, between which straight lines pass all others
/// by at most `slack`: `off` is how far the line from the first to the second index passes the point of the third. Where
/// that is no number, as between equal ends, the point is kept.
pub fn simplified(count: usize, slack: f64, off: impl Fn(usize, usize, usize) -> f64) -> Vec<usize> {
    let (mut kept, mut open) = (vec![0], Vec::from_iter((count > 1).then_some(count - 1)));
    while let (Some(&from), Some(&to)) = (kept.last(), open.last()) {
        let passed = (from + 1..to).map(|index| (off(from, to, index), index));
        let farthest = passed.max_by(|a, b| a.0.total_cmp(&b.0));
        match farthest.filter(|(off, _)| *off > slack || off.is_nan()) {
            Some((_, index)) => open.push(index),
            None => kept.extend(open.pop()),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_near_a_straight_line_are_left_out() {
        let heights = [0.0, 1.1, 2.0, 5.0, 2.9, 1.0, 0.0f64];
        let off = |from: usize, to: usize, index: usize| {
            let part = (index - from) as f64 / (to - from) as f64;
            (heights[index] - (heights[from] + (heights[to] - heights[from]) * part)).abs()
        };
        assert_eq!(simplified(heights.len(), 2.0, off), [0, 3, 6]);
        assert_eq!(simplified(heights.len(), 0.5, off), [0, 2, 3, 5, 6]);
        assert_eq!(simplified(heights.len(), 9.0, off), [0, 6]);
        assert_eq!(simplified(1, 9.0, off), [0]);
    }

    #[test]
    fn a_point_between_equal_ends_is_kept() {
        assert_eq!(simplified(3, 1.0, |_, _, _| f64::NAN), [0, 1, 2]);
    }
}

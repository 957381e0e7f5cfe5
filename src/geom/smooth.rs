//! Smoothing of lines: their vertices are drawn toward the middle of what is around them.

use glam::DVec2;

use crate::polyline::Polyline;

/// Passes of the moving mean: two together weigh the surroundings by a triangle, whose result has no corner.
const PASSES: usize = 2;

/// `line` with a vertex every `step`, each the mean of the line within `reach` of it. Ends stay where they are. Bends
/// narrower than `reach` disappear; at most `most` vertices are made, farther apart where more would be needed.
pub fn smoothed(line: &Polyline, step: f64, reach: f64, most: usize) -> Polyline {
    let length = line.length();
    let legs = ((length / step).ceil() as usize).clamp(1, most.max(2) - 1);
    let step = length / legs as f64;
    let mut points: Vec<DVec2> = (0..=legs).map(|leg| line.at(leg as f64 * step)).collect();
    let around = (reach / step).round() as usize;
    for _ in 0..PASSES {
        points = means(&points, around);
    }
    Polyline::new(points, 0.0).unwrap_or_else(|| line.clone())
}

/// For every point the mean of those up to `around` before and after it, fewer near the ends and as many on both sides.
fn means(points: &[DVec2], around: usize) -> Vec<DVec2> {
    let mut sums = vec![DVec2::ZERO; points.len() + 1];
    for (index, point) in points.iter().enumerate() {
        sums[index + 1] = sums[index] + *point;
    }
    let last = points.len() - 1;
    let mean = |index: usize| {
        let reach = around.min(index).min(last - index);
        (sums[index + reach + 1] - sums[index - reach]) / (2 * reach + 1) as f64
    };
    (0..points.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zigzag() -> Polyline {
        let points = (0..101).map(|n| DVec2::new(f64::from(n) * 10.0, if n % 2 == 0 { 0.0 } else { 6.0 }));
        Polyline::new(points, 0.0).expect("a line")
    }

    #[test]
    fn a_zigzag_becomes_straight_and_its_ends_stay() {
        let smooth = smoothed(&zigzag(), 2.0, 60.0, 10_000);
        assert_eq!(smooth.ends(), zigzag().ends());
        let inner = smooth.points().iter().filter(|at| (200.0..800.0).contains(&at.x));
        let off = inner.map(|at| (at.y - 3.0).abs()).fold(0.0, f64::max);
        assert!(off < 0.3, "{off}");
    }

    #[test]
    fn a_straight_line_stays_and_never_has_more_vertices_than_allowed() {
        let line = Polyline::new([DVec2::ZERO, DVec2::new(1e6, 5e5)], 0.0).expect("a line");
        let smooth = smoothed(&line, 0.5, 20.0, 300);
        assert!(smooth.points().len() <= 300);
        assert!((smooth.length() - line.length()).abs() < 1e-3);
    }
}

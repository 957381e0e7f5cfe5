//! The sides of a line with a width at a vertex: the miter, its limits, and the arc of a round join.

use glam::DVec2;

use crate::polyline::Polyline;

/// The neighboring vertices beyond the ends of a line, on the lines that continue it there. Two lines of one width that
/// know of each other end on one edge, as if they were one line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Continuations {
    /// The vertex before its first; `None` where no line continues it there.
    pub before: Option<DVec2>,
    /// After its last.
    pub after: Option<DVec2>,
}

impl Continuations {
    /// The continuations of a closed line: the line itself.
    pub fn around(line: &Polyline) -> Self {
        let points = line.points();
        Self { before: Some(points[points.len() - 2]), after: Some(points[1]) }
    }
}

/// The vector from a line to the left end of an edge square to a leg, `half` away.
pub fn square([from, to]: [DVec2; 2], half: f64) -> DVec2 {
    (to - from).normalize_or_zero().perp() * half
}

/// A vertex of a line with its neighbors, and the width about it.
#[derive(Clone, Copy, Debug)]
pub struct LineBend {
    /// The vertex before, the vertex, and the one after; no two in a row in one place.
    pub points: [DVec2; 3],
    /// Half of the width at the vertex.
    pub half: f64,
}

impl LineBend {
    /// The bend at a vertex of a line; `None` at an end that no line continues.
    pub fn at(points: &[DVec2], vertex: usize, beyond: Continuations, half: f64) -> Option<Self> {
        let before = vertex.checked_sub(1).map(|before| points[before]).or(beyond.before)?;
        let after = points.get(vertex + 1).copied().or(beyond.after)?;
        Some(Self { points: [before, points[vertex], after], half })
    }

    /// The directions of the legs before and after the vertex, of length 1.
    pub fn directions(&self) -> [DVec2; 2] {
        let [before, at, after] = self.points;
        [(at - before).normalize_or_zero(), (after - at).normalize_or_zero()]
    }

    /// The directions to the left of both legs, added: along the line that halves the angle between them.
    pub fn bisector(&self) -> DVec2 {
        let [before, after] = self.directions();
        before.perp() + after.perp()
    }

    /// The vector to the left end of the miter in half widths; `None` where the line turns back on itself.
    pub fn miter(&self) -> Option<DVec2> {
        let sum = self.bisector();
        let square = sum.length_squared();
        (square > 1e-12).then(|| sum * (2.0 / square))
    }

    /// The miter's left end as seen from the vertex; `None` where it would be longer than `limit` half widths, or would not
    /// [fit](Self::fitting_miter).
    pub fn mitered(&self, limit: f64) -> Option<DVec2> {
        self.miter()
            .filter(|miter| miter.length() <= limit && self.fits(*miter))
            .map(|miter| miter * self.half)
    }

    /// The miter's left end, whatever its length; `None` where its inner corner would reach past the middle of either leg,
    /// where the next vertex's may.
    pub fn fitting_miter(&self) -> Option<DVec2> {
        self.miter().filter(|miter| self.fits(*miter)).map(|miter| miter * self.half)
    }

    /// The left and the right end of an edge that is never split, for solids: mitered, with an outer end of at most `limit`
    /// half widths and an inner end that reaches along the shorter leg by at most `inner` of it. `None` where the line turns
    /// back on itself.
    pub fn limited(&self, limit: f64, inner: f64) -> Option<[DVec2; 2]> {
        let miter = self.miter()?;
        let outer_end = miter * self.half * (limit / miter.length()).min(1.0);
        let inner_end = miter * self.half * (inner * self.shorter_leg() / self.reach(miter)).min(1.0);
        let [before, after] = self.directions();
        Some(if before.perp_dot(after) > 0.0 { [inner_end, -outer_end] } else { [outer_end, -inner_end] })
    }

    /// The angle by which the line turns, counter-clockwise, in −π..=π.
    pub fn turn_rad(&self) -> f64 {
        let [before, after] = self.directions();
        libm::atan2(before.perp_dot(after), before.dot(after))
    }

    /// The corners of an arc about the vertex, as seen from it, from the left side of the leg before to that of the leg after
    /// and without these two, at most `step_rad` apart.
    pub fn arc(&self, step_rad: f64) -> Vec<DVec2> {
        let turn = self.turn_rad();
        let steps = (turn.abs() / step_rad).ceil().max(1.0);
        let from = self.directions()[0].perp() * self.half;
        let corner = |step: u32| {
            let angle = turn * f64::from(step) / steps;
            DVec2::new(libm::cos(angle), libm::sin(angle)).rotate(from)
        };
        (1..steps as u32).map(corner).collect()
    }

    fn fits(&self, miter: DVec2) -> bool {
        2.0 * self.reach(miter) <= self.shorter_leg()
    }

    /// How far along the legs a miter's inner corner reaches.
    fn reach(&self, miter: DVec2) -> f64 {
        (miter.length_squared() - 1.0).max(0.0).sqrt() * self.half
    }

    fn shorter_leg(&self) -> f64 {
        let [before, at, after] = self.points;
        at.distance(before).min(at.distance(after))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bend(points: [(f64, f64); 3], quarter: u32) -> LineBend {
        let turned = |at: (f64, f64)| (0..quarter).fold(DVec2::from(at), |at, _| at.perp());
        LineBend { points: points.map(turned), half: 1.0 }
    }

    #[test]
    fn a_square_turn_has_a_miter_of_the_square_root_of_two() {
        for quarter in 0..4 {
            let corner = bend([(-9.0, 0.0), (0.0, 0.0), (0.0, 9.0)], quarter);
            assert!((corner.turn_rad() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
            assert!(
                (corner.mitered(2.0).expect("it fits").length() - std::f64::consts::SQRT_2).abs() < 1e-12
            );
            assert_eq!(corner.mitered(1.4), None);
            assert_eq!(corner.arc(0.6).len(), 2);
            let [inner, outer] = corner.limited(1.2, 0.05).expect("it turns");
            assert!((outer.length() - 1.2).abs() < 1e-12 && inner.length() < 0.7, "{inner} {outer}");
        }
    }

    #[test]
    fn a_miter_fits_up_to_the_middle_of_the_shorter_leg() {
        assert!(bend([(-9.0, 0.0), (0.0, 0.0), (0.0, 2.1)], 0).fitting_miter().is_some());
        assert!(bend([(-9.0, 0.0), (0.0, 0.0), (0.0, 1.9)], 0).fitting_miter().is_none());
        assert!(bend([(-9.0, 0.0), (0.0, 0.0), (-9.0, 0.0)], 0).miter().is_none(), "it turns back");
    }
}

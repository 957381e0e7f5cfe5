//! How two segments of a ribbon meet.
//!
//! Both end on the miter, the line that halves the angle between them, and share an edge. Where the join is not a miter,
//! or the miter would be longer than its limit, they share the inner corner only, and a fan from there fills the outer
//! side: with nothing more than the bevel's triangle, or round the vertex in an arc. Where even the inner corner would
//! reach past a short segment's middle, both segments end square and the fan starts at the vertex:
//!
//! ```text
//!   miter  ───────╲           bevel  ──────┬╲          square  ──────┬─╲
//!          ─────╲  ╲                 ─────╲│ ╲                 ──────●  ╲
//!                ╲  ╲                      ╲  ╲                ──────┼╲  ╲
//!                 ╲  ╲                      ╲  ╲                     ╲ ╲  ╲
//! ```

use glam::DVec2;

use crate::description::words::Join;

/// The largest angle between two corners of an arc: at 15 degrees its chords lie within 1 % of a half width of it, which
/// no picture shows.
const ARC_STEP_RAD: f64 = std::f64::consts::PI / 12.0;

/// A vertex of a centerline with its neighbors and the ribbon about it.
#[derive(Clone, Copy, Debug)]
pub(in crate::ribbon) struct RibbonBend {
    /// The vertex before, the vertex, and the one after; no two in a row at one place.
    pub points: [DVec2; 3],
    /// Half of the ribbon's width at the vertex in meters.
    pub half_m: f64,
}

/// What two segments end on, as ways from the vertex between them.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::ribbon) enum RibbonJoint {
    /// One edge, whose left end lies there and whose right end opposite.
    Shared(DVec2),
    /// An edge each, and a fan between.
    Split {
        /// The left and the right end of the edge before.
        closing: [DVec2; 2],
        /// Of the edge after.
        opening: [DVec2; 2],
        /// What fills the outer side between the two.
        fan: JointFan,
    },
}

/// Triangles from one corner to a rim, as ways from the vertex.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::ribbon) struct JointFan {
    /// The inner corner of the bend, or its vertex.
    pub center: DVec2,
    /// The outer side, counter-clockwise.
    pub rim: Vec<DVec2>,
    outer: RibbonSide,
}

/// A side of a ribbon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RibbonSide {
    Left,
    Right,
}

impl JointFan {
    /// How far across the ribbon its rim lies: 0 at the left edge, 1 at the right.
    pub fn rim_u(&self) -> f32 {
        match self.outer {
            RibbonSide::Left => 0.0,
            RibbonSide::Right => 1.0,
        }
    }

    /// How far across its center lies.
    pub fn center_u(&self) -> f32 {
        if self.center == DVec2::ZERO { 0.5 } else { 1.0 - self.rim_u() }
    }
}

impl RibbonBend {
    /// The miter's left end, as a way from the vertex; `None` where it would be longer than `limit` half widths, or its
    /// inner corner would reach past the middle of either segment, where the next joint's may.
    pub fn mitered(&self, limit: f64) -> Option<DVec2> {
        self.shared().filter(|to_left| to_left.length() <= limit * self.half_m)
    }

    /// What the segments end on.
    pub fn joint(&self, join: Join, limit: f64) -> RibbonJoint {
        let mitered = if join == Join::Miter { self.mitered(limit) } else { None };
        if let Some(to_left) = mitered.or_else(|| self.straight()) {
            return RibbonJoint::Shared(to_left);
        }
        let [before, after] = self.directions().map(|along| along.perp() * self.half_m);
        let (outer, sign) =
            if self.turn_rad() >= 0.0 { (RibbonSide::Right, -1.0) } else { (RibbonSide::Left, 1.0) };
        let inner = self.shared().map(|to_left| to_left * -sign);
        let edge = |to_left: DVec2| match (outer, inner) {
            (RibbonSide::Right, Some(inner)) => [inner, -to_left],
            (RibbonSide::Left, Some(inner)) => [to_left, inner],
            (_, None) => [to_left, -to_left],
        };
        let mut rim = vec![before * sign];
        rim.extend(self.corners(join, limit).into_iter().map(|corner| corner * sign));
        rim.push(after * sign);
        if outer == RibbonSide::Left {
            rim.reverse();
        }
        let fan = JointFan { center: inner.unwrap_or_default(), rim, outer };
        RibbonJoint::Split { closing: edge(before), opening: edge(after), fan }
    }

    /// The shared edge's left end, whatever its length, where the inner corner fits.
    fn shared(&self) -> Option<DVec2> {
        let miter = self.miter()?;
        let reach = (miter.length_squared() - 1.0).max(0.0).sqrt() * self.half_m;
        let [before, at, after] = self.points;
        let shortest = at.distance(before).min(at.distance(after));
        (2.0 * reach <= shortest).then_some(miter * self.half_m)
    }

    /// The edge of a turn too slight to have an outer side.
    fn straight(&self) -> Option<DVec2> {
        if self.turn_rad().abs() < 1e-3 { self.shared() } else { None }
    }

    /// The way to the left end of the miter in half widths; `None` where the line turns back on itself.
    fn miter(&self) -> Option<DVec2> {
        let [before, after] = self.directions();
        let sum = before.perp() + after.perp();
        let square = sum.length_squared();
        (square > 1e-12).then(|| sum * (2.0 / square))
    }

    /// What lies on the outer side between the ends of both segments, as ways to the left of the line.
    fn corners(&self, join: Join, limit: f64) -> Vec<DVec2> {
        match join {
            Join::Bevel => Vec::new(),
            Join::Miter => self
                .miter()
                .filter(|miter| miter.length() <= limit)
                .map(|it| it * self.half_m)
                .into_iter()
                .collect(),
            Join::Round => {
                let turn = self.turn_rad();
                let steps = (turn.abs() / ARC_STEP_RAD).ceil().max(1.0);
                let from = self.directions()[0].perp() * self.half_m;
                let corner = |step: u32| turned(from, turn * f64::from(step) / steps);
                (1..steps as u32).map(corner).collect()
            }
        }
    }

    /// How far the line turns, counter-clockwise, in −π..=π.
    fn turn_rad(&self) -> f64 {
        let [before, after] = self.directions();
        libm::atan2(before.perp_dot(after), before.dot(after))
    }

    fn directions(&self) -> [DVec2; 2] {
        let [before, at, after] = self.points;
        [(at - before).normalize_or_zero(), (after - at).normalize_or_zero()]
    }
}

fn turned(way: DVec2, angle_rad: f64) -> DVec2 {
    DVec2::new(libm::cos(angle_rad), libm::sin(angle_rad)).rotate(way)
}

//! The joint of two segments of a ribbon.
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

use sandtable_description::words::Join;
use sandtable_geom::offset::LineBend;

/// The largest angle between two corners of an arc: chords lie within 1 % of a half width of it.
const ARC_STEP_RAD: f64 = std::f64::consts::PI / 12.0;

/// What two segments end on, as ways from the vertex between them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum RibbonJoint {
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
pub(crate) struct JointFan {
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
    /// The position of its rim across the ribbon: 0 at the left edge, 1 at the right.
    pub fn rim_u(&self) -> f32 {
        match self.outer {
            RibbonSide::Left => 0.0,
            RibbonSide::Right => 1.0,
        }
    }

    /// The position of its center across the ribbon.
    pub fn center_u(&self) -> f32 {
        if self.center == DVec2::ZERO { 0.5 } else { 1.0 - self.rim_u() }
    }
}

impl RibbonJoint {
    /// What the legs at a bend end on; miters are at most `limit` half widths long.
    pub fn new(bend: &LineBend, join: Join, limit: f64) -> Self {
        let turn = bend.turn_rad();
        let mitered = if join == Join::Miter { bend.mitered(limit) } else { None };
        // A turn too slight has no outer side.
        let straight = || if turn.abs() < 1e-3 { bend.fitting_miter() } else { None };
        if let Some(to_left) = mitered.or_else(straight) {
            return Self::Shared(to_left);
        }
        let [before, after] = bend.directions().map(|along| along.perp() * bend.half);
        let (outer, sign) = if turn >= 0.0 { (RibbonSide::Right, -1.0) } else { (RibbonSide::Left, 1.0) };
        let inner = bend.fitting_miter().map(|to_left| to_left * -sign);
        let edge = |to_left: DVec2| match (outer, inner) {
            (RibbonSide::Right, Some(inner)) => [inner, -to_left],
            (RibbonSide::Left, Some(inner)) => [to_left, inner],
            (_, None) => [to_left, -to_left],
        };
        let corners = match join {
            Join::Bevel => Vec::new(),
            Join::Miter => {
                let miter = bend.miter().filter(|miter| miter.length() <= limit);
                miter.map(|miter| miter * bend.half).into_iter().collect()
            }
            Join::Round => bend.arc(ARC_STEP_RAD),
        };
        let corners = std::iter::once(before).chain(corners).chain([after]);
        let mut rim: Vec<DVec2> = corners.map(|corner| corner * sign).collect();
        if outer == RibbonSide::Left {
            rim.reverse();
        }
        let fan = JointFan { center: inner.unwrap_or_default(), rim, outer };
        Self::Split { closing: edge(before), opening: edge(after), fan }
    }
}

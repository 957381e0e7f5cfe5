//! A line with a width in plan: what a wall, a hedge or the rail of a fence is built along.
//!
//! At every vertex the track's two sides meet on the miter, so that what is built along it turns without a gap:
//!
//! ```text
//!  left ───────╮            ● joint: a point of the line and the way to the track's left side
//!      ────●   │
//!  right ─╮│   │
//! ```
//!
//! Where the line turns back so sharply that the miter would become a spike, the track ends square and begins anew.

use glam::DVec2;

use crate::geom::offset::LineBend;

/// How long a miter may be in half widths: turns of up to 120 degrees keep theirs.
const MITER_LIMIT: f64 = 2.0;

/// Where two segments meet, or one ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackJoint {
    /// World X and Y, meters.
    pub at: DVec2,
    /// From there to the track's left side; to its right side it is as far the other way.
    pub to_left: DVec2,
}

impl TrackJoint {
    /// The point across the track: −1 is its right side, 0 its middle, 1 its left side.
    pub fn across(&self, share: f64) -> DVec2 {
        self.at + self.to_left * share
    }
}

/// Whether a stretch of track has ends or runs round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// It has two.
    Two,
    /// It ends where it begins.
    None,
}

/// A stretch of track without a break.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackStretch {
    /// At least two.
    pub joints: Vec<TrackJoint>,
    /// Whether it runs round.
    pub ends: Ends,
}

/// A line with a width.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// In the order of the line.
    pub stretches: Vec<TrackStretch>,
}

impl Track {
    /// The track along `points`, no two neighbors the same, `half_width_m` to either side. It runs round where the last
    /// point is the first.
    pub fn new(points: &[DVec2], half_width_m: f64) -> Self {
        let last = points.len().saturating_sub(1);
        let round = last >= 3 && points[0] == points[last];
        let miter = |points: [DVec2; 3]| LineBend { points, half: half_width_m }.mitered(MITER_LIMIT);
        let around = round.then(|| miter([points[last - 1], points[0], points[1]])).flatten();
        let square = |from: DVec2, to: DVec2| (to - from).normalize_or_zero().perp() * half_width_m;
        let mut stretches = Vec::new();
        let mut joints = Vec::new();
        for index in 0..points.len() {
            let at = points[index];
            let end = |to_left: DVec2| TrackJoint { at, to_left };
            if index == 0 && last > 0 {
                joints.push(end(around.unwrap_or_else(|| square(at, points[1]))));
            } else if index == last && last > 0 {
                joints.push(end(around.unwrap_or_else(|| square(points[last - 1], at))));
            } else if let Some(to_left) = miter([points[index - 1], at, points[index + 1]]) {
                joints.push(end(to_left));
            } else {
                joints.push(end(square(points[index - 1], at)));
                stretches.push(TrackStretch { joints: std::mem::take(&mut joints), ends: Ends::Two });
                joints.push(end(square(at, points[index + 1])));
            }
        }
        let ends = if around.is_some() && stretches.is_empty() { Ends::None } else { Ends::Two };
        stretches.extend((joints.len() > 1).then_some(TrackStretch { joints, ends }));
        Self { stretches }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(points: &[(f64, f64)], quarter: u32) -> Vec<DVec2> {
        let turn = |&(x, y): &(f64, f64)| (0..quarter).fold(DVec2::new(x, y), |at, _| at.perp());
        points.iter().map(turn).collect()
    }

    #[test]
    fn both_sides_keep_their_distance_round_a_corner() {
        for quarter in 0..4 {
            let points = turned(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)], quarter);
            let track = Track::new(&points, 1.0);
            assert_eq!(track.stretches.len(), 1);
            let joint = track.stretches[0].joints[1];
            let inner = turned(&[(9.0, 1.0)], quarter)[0];
            assert!(joint.across(1.0).distance(inner) < 1e-12, "{joint:?}");
        }
    }

    #[test]
    fn a_line_that_turns_back_ends_square_and_begins_anew() {
        let track = Track::new(&turned(&[(0.0, 0.0), (10.0, 0.0), (0.0, 1.0)], 0), 1.0);
        assert_eq!(track.stretches.len(), 2);
        let lengths =
            track.stretches.iter().flat_map(|stretch| &stretch.joints).map(|joint| joint.to_left.length());
        assert!(
            lengths.clone().all(|length| (length - 1.0).abs() < 1e-12),
            "{:?}",
            lengths.collect::<Vec<_>>()
        );
    }

    #[test]
    fn a_ring_has_no_ends() {
        let ring = turned(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)], 0);
        let track = Track::new(&ring, 1.0);
        assert_eq!((track.stretches.len(), track.stretches[0].ends), (1, Ends::None));
        let joints = &track.stretches[0].joints;
        assert_eq!(joints[0], joints[4]);
        assert_eq!(joints[0].across(1.0), DVec2::ONE);
    }
}

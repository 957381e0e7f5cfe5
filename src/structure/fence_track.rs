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

use sandtable_earthworks::alignment::Alignment;
use sandtable_geom::offset::{self, Continuations, LineBend};

/// How long a miter may be in half widths: turns of up to 120 degrees keep theirs.
const MITER_LIMIT: f64 = 2.0;

/// The joint of two segments, or the end of one.
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

/// The ends of a stretch of track, if it does not run round.
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

/// The stretches of the track along an alignment of one width, in order. It runs round where the line is closed.
pub fn stretches(alignment: &Alignment) -> Vec<TrackStretch> {
    let (line, half_m) = (&alignment.line, alignment.width.widest_m() / 2.0);
    let points = line.points();
    let beyond = if line.is_closed() { Continuations::around(line) } else { Continuations::default() };
    let (mut stretches, mut joints, mut ends) = (Vec::new(), Vec::new(), Ends::Two);
    for (index, &at) in points.iter().enumerate() {
        let joint = |to_left: DVec2| TrackJoint { at, to_left };
        let square = |leg: usize| joint(offset::square([points[leg], points[leg + 1]], half_m));
        let bend = LineBend::at(points, index, beyond, half_m);
        if let Some(to_left) = bend.and_then(|bend| bend.mitered(MITER_LIMIT)) {
            if index == 0 {
                ends = Ends::None;
            }
            joints.push(joint(to_left));
            continue;
        }
        joints.push(square(index.saturating_sub(1)));
        if index > 0 && index + 1 < points.len() {
            stretches.push(TrackStretch { joints: std::mem::take(&mut joints), ends: Ends::Two });
            joints.push(square(index));
        }
    }
    let ends = if stretches.is_empty() { ends } else { Ends::Two };
    stretches.push(TrackStretch { joints, ends });
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_geom::polyline::Polyline;

    fn track(points: &[DVec2]) -> Vec<TrackStretch> {
        let line = Polyline::new(points.iter().copied(), 0.0).expect("a line");
        stretches(&Alignment::on_ground(line, 2.0))
    }

    fn turned(points: &[(f64, f64)], quarter: u32) -> Vec<DVec2> {
        let turn = |&(x, y): &(f64, f64)| (0..quarter).fold(DVec2::new(x, y), |at, _| at.perp());
        points.iter().map(turn).collect()
    }

    #[test]
    fn both_sides_keep_their_distance_round_a_corner() {
        for quarter in 0..4 {
            let points = turned(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)], quarter);
            let track = track(&points);
            assert_eq!(track.len(), 1);
            let joint = track[0].joints[1];
            let inner = turned(&[(9.0, 1.0)], quarter)[0];
            assert!(joint.across(1.0).distance(inner) < 1e-12, "{joint:?}");
        }
    }

    #[test]
    fn a_line_that_turns_back_ends_square_and_begins_anew() {
        let track = track(&turned(&[(0.0, 0.0), (10.0, 0.0), (0.0, 1.0)], 0));
        assert_eq!(track.len(), 2);
        let lengths = track.iter().flat_map(|stretch| &stretch.joints).map(|joint| joint.to_left.length());
        assert!(
            lengths.clone().all(|length| (length - 1.0).abs() < 1e-12),
            "{:?}",
            lengths.collect::<Vec<_>>()
        );
    }

    #[test]
    fn a_ring_has_no_ends() {
        let ring = turned(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)], 0);
        let track = track(&ring);
        assert_eq!((track.len(), track[0].ends), (1, Ends::None));
        let joints = &track[0].joints;
        assert_eq!(joints[0], joints[4]);
        assert_eq!(joints[0].across(1.0), DVec2::ONE);
    }
}

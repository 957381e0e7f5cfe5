//! Lines with a width in meters on the ground: corridors, arrows and racetracks, as rings of longitudes and latitudes.
//!
//! ```text
//!   left 0 ───────── left 1 ──┐        head of an arrow, twice as wide as its shaft:
//!   start ─ ─ ─ ─ ─ ─ ─ ─ ─ end       ─────╲
//!   right 0 ──────── right 1 ─┘        ─ ─ ─ ─ ▷ tip
//!                                      ─────╱
//! ```
//!
//! Corners are mitered; where a line turns back so sharply that the miter would be longer than twice the width, the outer
//! corner is cut off.

use glam::DVec2;

use crate::geodesic::Geodesic;
use crate::ground_shape::{GroundShapeError, beside, check_reach, reached};

/// The longest miter in half widths.
const MOST_MITER: f64 = 4.0;
/// Vertices of the half circles at the ends of a racetrack.
const END_VERTICES: u32 = 32;

/// The side of the line between its two points on which a racetrack lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TrackSide {
    /// The line is its middle.
    #[default]
    Center,
    /// Left of the line.
    Left,
    /// Right of the line.
    Right,
}

/// The ring around a line that is `width_m` meters wide, with square ends.
///
/// # Errors
/// [`GroundShapeError`]
pub fn corridor(line: &[DVec2], width_m: f64) -> Result<Vec<DVec2>, GroundShapeError> {
    let line = distinct(line, width_m)?;
    let (mut left, right) = sides(&line, width_m / 2.0);
    left.extend(right.into_iter().rev());
    Ok(left)
}

/// The ring of an arrow along a line to its last vertex: a shaft `width_m` meters wide, and a head twice as wide that is as
/// long as the shaft is wide, or as the last leg where that is shorter.
///
/// # Errors
/// [`GroundShapeError`]
pub fn arrow(line: &[DVec2], width_m: f64) -> Result<Vec<DVec2>, GroundShapeError> {
    let mut line = distinct(line, 2.0 * width_m)?;
    let tip = line.pop().ok_or(GroundShapeError::Short)?;
    let from = *line.last().ok_or(GroundShapeError::Short)?;
    let back = Geodesic::between(tip, from);
    let base = reached(tip, back.bearing_deg(), back.length_m().min(width_m));
    let mut shaft = line;
    // A last leg no longer than the head has no shaft of its own.
    if back.length_m() > width_m {
        shaft.push(base);
    }
    let forward_deg = back.bearing_deg() + 180.0;
    let head = [reached(base, forward_deg - 90.0, width_m), tip, reached(base, forward_deg + 90.0, width_m)];
    if shaft.len() < 2 {
        return Ok(head.to_vec());
    }
    let (mut ring, right) = sides(&shaft, width_m / 2.0);
    ring.extend(head);
    ring.extend(right.into_iter().rev());
    Ok(ring)
}

/// The ring of a racetrack between two points: two straight legs `width_m` meters apart and half circles around the ends.
///
/// # Errors
/// [`GroundShapeError`]
pub fn racetrack(ends: [DVec2; 2], width_m: f64, side: TrackSide) -> Result<Vec<DVec2>, GroundShapeError> {
    let line = distinct(&ends, 2.0 * width_m)?;
    let half_m = width_m / 2.0;
    let [start, end] = line[..] else { return Err(GroundShapeError::Short) };
    let ahead_deg = Geodesic::between(start, end).bearing_deg();
    let behind_deg = Geodesic::between(end, start).bearing_deg();
    let moved = |at: DVec2, forward_deg: f64| match side {
        TrackSide::Center => at,
        TrackSide::Left => reached(at, forward_deg - 90.0, half_m),
        TrackSide::Right => reached(at, forward_deg + 90.0, half_m),
    };
    let (start, end) = (moved(start, ahead_deg), moved(end, behind_deg + 180.0));
    let half_circle = |at: DVec2, outward_deg: f64| {
        (0..=END_VERTICES).map(move |step| {
            let turn = 180.0 * f64::from(step) / f64::from(END_VERTICES) - 90.0;
            reached(at, outward_deg + turn, half_m)
        })
    };
    Ok(half_circle(end, behind_deg + 180.0).chain(half_circle(start, ahead_deg + 180.0)).collect())
}

/// The vertices of a line that differ from those before them, longitudes running on, after checks.
fn distinct(line: &[DVec2], width_m: f64) -> Result<Vec<DVec2>, GroundShapeError> {
    let mut kept: Vec<DVec2> = Vec::with_capacity(line.len());
    for &at in line {
        check_reach(at, width_m * MOST_MITER)?;
        let at = kept.last().map_or(at, |before| DVec2::new(beside(at.x, before.x), at.y));
        if kept.last() != Some(&at) {
            kept.push(at);
        }
    }
    if kept.len() < 2 { Err(GroundShapeError::Short) } else { Ok(kept) }
}

/// The left and the right side of a line of two or more vertices, both from its start to its end.
fn sides(line: &[DVec2], half_m: f64) -> (Vec<DVec2>, Vec<DVec2>) {
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for (index, &at) in line.iter().enumerate() {
        let arriving =
            index.checked_sub(1).map(|before| Geodesic::between(at, line[before]).bearing_deg() + 180.0);
        let leaving = line.get(index + 1).map(|&next| Geodesic::between(at, next).bearing_deg());
        let (arriving, leaving) = match (arriving, leaving) {
            (Some(arriving), Some(leaving)) => (arriving, leaving),
            (Some(only), None) | (None, Some(only)) => (only, only),
            (None, None) => continue,
        };
        let turn_deg = (leaving - arriving + 180.0).rem_euclid(360.0) - 180.0;
        let miter = 1.0 / libm::cos((turn_deg / 2.0).to_radians());
        for (side, sign) in [(&mut left, -90.0), (&mut right, 90.0)] {
            if miter.abs() <= MOST_MITER {
                side.push(reached(at, arriving + turn_deg / 2.0 + sign, half_m * miter));
            } else {
                side.push(reached(at, arriving + sign, half_m));
                side.push(reached(at, leaving + sign, half_m));
            }
        }
    }
    (left, right)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: [DVec2; 3] = [DVec2::new(15.5, 60.1), DVec2::new(16.0, 60.0), DVec2::new(16.0, 60.2)];

    fn length_m(one: DVec2, other: DVec2) -> f64 {
        Geodesic::between(one, other).length_m()
    }

    #[test]
    fn a_corridor_has_its_width_at_its_ends_and_a_miter_at_its_corner() {
        let ring = corridor(&LINE, 5000.0).expect("it fits");
        assert_eq!(ring.len(), 6);
        assert!((length_m(ring[0], ring[5]) - 5000.0).abs() < 1.0);
        assert!((length_m(ring[2], ring[3]) - 5000.0).abs() < 1.0);
        assert!(length_m(ring[1], ring[4]) > 5000.0, "the miter is longer");
        let middle = (ring[1] + ring[4]) / 2.0;
        assert!(length_m(middle, LINE[1]) < 20.0, "{middle}");
    }

    #[test]
    fn a_line_that_turns_back_is_cut_off_at_its_corner() {
        let back = [LINE[0], LINE[1], DVec2::new(15.5, 60.1001)];
        let ring = corridor(&back, 1000.0).expect("it fits");
        assert_eq!(ring.len(), 8);
        assert!(ring.iter().all(|&at| back.iter().any(|&vertex| length_m(at, vertex) < 501.0)), "{ring:?}");
    }

    #[test]
    fn an_arrow_ends_at_its_tip_with_a_head_twice_as_wide() {
        let line = [DVec2::new(15.8, 60.1), DVec2::new(16.4, 60.0), DVec2::new(16.8, 60.0)];
        let ring = arrow(&line, 5000.0).expect("it fits");
        assert_eq!(ring.len(), 9);
        assert_eq!(ring[4], line[2]);
        assert!((length_m(ring[3], ring[5]) - 10_000.0).abs() < 1.0);
        assert!((length_m(ring[2], ring[6]) - 5000.0).abs() < 1.0);
        let short = arrow(&[line[2], DVec2::new(16.801, 60.0)], 5000.0).expect("it fits");
        assert_eq!(short.len(), 3, "a head alone");
    }

    #[test]
    fn a_racetrack_lies_on_its_side() {
        let ends = [DVec2::new(15.0, 60.0), DVec2::new(15.0, 60.5)];
        let middle = |side| {
            let ring = racetrack(ends, 2000.0, side).expect("it fits");
            assert_eq!(ring.len(), 66);
            ring.iter().map(|at| at.x).sum::<f64>() / 66.0
        };
        assert!((middle(TrackSide::Center) - 15.0).abs() < 1e-3);
        assert!(middle(TrackSide::Left) < 14.99 && middle(TrackSide::Right) > 15.01);
    }

    #[test]
    fn bands_run_on_over_the_date_line() {
        let ring = corridor(&[DVec2::new(179.9, 10.0), DVec2::new(-179.9, 10.0)], 1000.0).expect("it fits");
        assert!(ring.iter().all(|at| (179.8..180.2).contains(&at.x)), "{ring:?}");
    }

    #[test]
    fn what_has_no_band_is_refused() {
        assert_eq!(corridor(&LINE[..1], 10.0), Err(GroundShapeError::Short));
        assert_eq!(corridor(&[LINE[0]; 3], 10.0), Err(GroundShapeError::Short));
        assert!(matches!(corridor(&LINE, 0.0), Err(GroundShapeError::Distance(_))));
        assert!(matches!(arrow(&LINE, f64::NAN), Err(GroundShapeError::Distance(_))));
        assert!(matches!(arrow(&[DVec2::NAN, LINE[0]], 10.0), Err(GroundShapeError::Place(..))));
    }
}

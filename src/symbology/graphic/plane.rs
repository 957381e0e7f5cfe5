//! Figures that draw rules have in common: arcs, arrowheads, offsets, gaps.

use std::f64::consts::TAU;

use glam::DVec2;

use sandtable_geom::offset::{Continuations, LineBend, square};
use sandtable_geom::polyline::Polyline;

/// The longest step of an arc in radians: a sagitta of 0.4 % of the radius.
const ARC_STEP_RAD: f64 = TAU / 72.0;

/// The most marks along a line.
const MOST_MARKS: f64 = 2000.0;

/// The longest miter of an offset, in offsets.
const MITER_LIMIT: f64 = 4.0;

/// The direction from one point to another; zero where they are one.
pub fn direction(from: DVec2, to: DVec2) -> DVec2 {
    (to - from).normalize_or_zero()
}

/// A vector turned counter-clockwise.
pub fn turned(vector: DVec2, angle_rad: f64) -> DVec2 {
    DVec2::new(libm::cos(angle_rad), libm::sin(angle_rad)).rotate(vector)
}

/// The points of an arc from `center + radius` on, counter-clockwise by `sweep_rad`.
pub fn arc(center: DVec2, radius: DVec2, sweep_rad: f64) -> Vec<DVec2> {
    let steps = (sweep_rad.abs() / ARC_STEP_RAD).ceil().max(1.0);
    (0..=steps as u32).map(|step| center + turned(radius, sweep_rad * f64::from(step) / steps)).collect()
}

/// A circle, without repeating the first point.
pub fn circle(center: DVec2, radius_m: f64) -> Vec<DVec2> {
    let mut points = arc(center, DVec2::X * radius_m, TAU);
    points.pop();
    points
}

/// The arc of a circle over a chord, bulging to its left by `sagitta` chords (to its right where negative).
pub fn bulge(from: DVec2, to: DVec2, sagitta: f64) -> Vec<DVec2> {
    let half_rad = 2.0 * libm::atan(2.0 * sagitta);
    let chord = to - from;
    let center = from.midpoint(to) - chord.perp() * (0.5 / libm::tan(half_rad));
    arc(center, from - center, -2.0 * half_rad)
}

/// An open arrowhead at `tip`: both barbs, `length` long along the shaft, each `half` off it.
pub fn arrowhead(tip: DVec2, toward: DVec2, length: f64, half: f64) -> [DVec2; 3] {
    let base = tip - toward * length;
    [base + toward.perp() * half, tip, base - toward.perp() * half]
}

/// A line `half` to the left of another, mitered; right where `half` is negative.
pub fn offset(points: &[DVec2], half: f64) -> Vec<DVec2> {
    let last = points.len() - 1;
    let at = |index: usize| {
        let bend = LineBend::at(points, index, Continuations::default(), half);
        let leg = index.clamp(1, last);
        let aside = square([points[leg - 1], points[leg]], half);
        let miter = bend.and_then(|bend| bend.miter()).map(|miter| {
            let length = miter.length();
            miter * (MITER_LIMIT / length).min(1.0) * half
        });
        points[index] + miter.unwrap_or(aside)
    };
    (0..=last).map(at).collect()
}

/// The pieces of a line between gaps, each a station of its middle and half of its length, in any order.
pub fn gapped(line: &Polyline, gaps: &[(f64, f64)]) -> Vec<Vec<DVec2>> {
    let mut gaps: Vec<[f64; 2]> = gaps.iter().map(|&(at, half)| [at - half, at + half]).collect();
    gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut pieces, mut from) = (Vec::new(), 0.0);
    for [start, end] in gaps.into_iter().chain([[line.length(); 2]]) {
        if start > from {
            pieces.push(line.between(from, start.min(line.length())));
        }
        from = end.max(from);
    }
    pieces
}

/// From mark to mark in meters, for marks `pitch_m` apart along each leg of a line: farther on a line that would have more than
/// [`MOST_MARKS`].
pub fn leg_pitch_m(points: &[DVec2], pitch_m: f64) -> f64 {
    let length_m: f64 = points.windows(2).map(|leg| leg[0].distance(leg[1])).sum();
    pitch_m.max(length_m / MOST_MARKS)
}

/// The ring through `points` as a line that ends where it begins; `None` for less than two distinct points.
pub fn closed(points: &[DVec2]) -> Option<Polyline> {
    Polyline::new(points.iter().chain(points.first()).copied(), 0.0)
}

/// The length of a line of text in meters, about: placement on the picture measures it.
pub fn text_m(text: &str, em_m: f64) -> f64 {
    /// The mean width of a capital in text heights.
    const CAPITAL: f64 = 0.62;
    text.lines().map(|line| line.chars().count()).max().unwrap_or(0) as f64 * CAPITAL * em_m
}

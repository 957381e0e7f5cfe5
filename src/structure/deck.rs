//! The course of a deck: lines across it, from which everything along a bridge is drawn out.
//!
//! At every vertex of the centerline stands a section, on the miter as a ribbon's is; between vertices more stand where
//! the deck's height bends. A deck is a closed solid, so a turn never splits it: where a miter would reach too far, it
//! is shortened on the outer side, and where its inner corner would pass the next one's, on the inner side.
//!
//! ```text
//!            left
//!      ┬──────┬──────┬╲
//!      │      │      │  ╲      a section: its place on the centerline,
//!      ┼──────┼──────┼    ╲    the ways from there to both edges, and
//!      │      │      │╲     ╲  the elevations of both edges
//!      ┴──────┴──────┴  ╲    ╱
//!            right        ╲╱
//! ```

use glam::{DVec2, Vec3};

use crate::bridge::{PARAPET_THICK_M, magnified};
use sandtable_earthworks::alignment::Alignment;
use sandtable_geom::offset::{self, Continuations, LineBend};

/// How far along a leg the inner corner of a miter may reach, as a part of it: two of them do not meet.
const LONGEST_INNER: f64 = 0.45;

/// The least distance of added sections, in widths: nearer ones would be one after rounding to f32.
const LEAST_APART: f64 = 0.02;

/// The most sections that are added between the vertices of one centerline.
const MOST_BREAKS: usize = 4096;

/// A line across a deck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeckSection {
    /// Where it stands along the centerline, in meters.
    pub station_m: f64,
    /// Its place on the centerline, in the world.
    pub at: DVec2,
    /// The ways from there to the left and to the right edge of the carriageway.
    pub aside: [DVec2; 2],
    /// The elevations of the left and the right edge, in meters.
    pub edges_m: [f64; 2],
    /// Whether a parapet stands on the left and on the right edge.
    pub parapets: [bool; 2],
}

/// The sections of a deck at every vertex of its line and, where they do not come in the way of a miter, at the stations
/// `breaks_m`, stations rising. A miter is at most `miter_limit` half widths long, at least 1.
pub fn sections(
    alignment: &Alignment,
    beyond: Continuations,
    miter_limit: f64,
    breaks_m: &[f64],
) -> Vec<DeckSection> {
    let mut breaks: Vec<f64> = breaks_m.iter().copied().take(MOST_BREAKS).collect();
    breaks.sort_by(f64::total_cmp);
    let (points, stations) = (alignment.line.points(), alignment.line.stations());
    let width_m = alignment.width.widest_m();
    let aside = |index| aside(points, index, beyond, width_m / 2.0, miter_limit);
    let asides: Vec<[DVec2; 2]> = (0..points.len()).map(aside).collect();
    let section = |station_m: f64, at: DVec2, aside: [DVec2; 2]| DeckSection {
        station_m,
        at,
        aside,
        edges_m: [alignment.level_m(station_m); 2],
        parapets: [true; 2],
    };
    let mut sections = Vec::with_capacity(points.len() + breaks.len());
    for (index, &at) in points.iter().enumerate() {
        sections.push(section(stations[index], at, asides[index]));
        let (Some(&next), Some(&end_m)) = (points.get(index + 1), stations.get(index + 1)) else {
            continue;
        };
        let along = (next - at).normalize_or_zero();
        // Parapets stand beside the carriageway, and on a bend their inner corners reach further along it.
        let outermost = 1.0 + 2.0 * PARAPET_THICK_M * magnified(width_m) / width_m;
        let reach = |index: usize| {
            let of_aside = asides[index].iter().map(|aside| aside.dot(along).abs()).fold(0.0, f64::max);
            of_aside * outermost + width_m * LEAST_APART
        };
        let (from_m, to_m) = (stations[index] + reach(index), end_m - reach(index + 1));
        let square = along.perp() * (width_m / 2.0);
        let first = breaks.partition_point(|&station| station <= from_m);
        let mut last_m = from_m;
        for &station in breaks[first..].iter().take_while(|&&station| station < to_m) {
            if station - last_m > width_m * LEAST_APART {
                let at = at + along * (station - stations[index]);
                sections.push(section(station, at, [square, -square]));
                last_m = station;
            }
        }
    }
    sections
}

/// The vectors from a vertex to both edges.
fn aside(points: &[DVec2], index: usize, beyond: Continuations, half: f64, miter_limit: f64) -> [DVec2; 2] {
    let leg = index.saturating_sub(1);
    let to_left = offset::square([points[leg], points[leg + 1]], half);
    let square = [to_left, -to_left];
    let Some(bend) = LineBend::at(points, index, beyond, half) else { return square };
    if let Some(miter) = bend.mitered(miter_limit) {
        return [miter, -miter];
    }
    // What continues beyond an end does so with an edge of its own; see `ribbon::stroke`.
    let is_end = index == 0 || index + 1 == points.len();
    bend.limited(miter_limit, LONGEST_INNER).filter(|_| !is_end).unwrap_or(square)
}

impl DeckSection {
    /// The point at `part` of the way to the left (0) or right (1) edge and `above_m` over that edge. A part
    /// above 1 lies beyond the carriageway.
    pub fn point(&self, side: usize, part: f64, above_m: f64) -> Vec3 {
        let plan = self.at + self.aside[side] * part;
        let middle_m = self.middle_m();
        plan.as_vec2().extend((middle_m + (self.edges_m[side] - middle_m) * part + above_m) as f32)
    }

    /// The elevation half-way between both edges, in meters.
    pub fn middle_m(&self) -> f64 {
        (self.edges_m[0] + self.edges_m[1]) / 2.0
    }

    /// The carriageway's left and right edge in the world.
    pub fn edges(&self) -> [Vec3; 2] {
        [0, 1].map(|side| (self.at + self.aside[side]).as_vec2().extend(self.edges_m[side] as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sandtable_geom::polyline::Polyline;

    fn turned(points: &[(f64, f64)], quarter: u32) -> Polyline {
        let turn = |&(x, y): &(f64, f64)| (0..quarter).fold(DVec2::new(x, y), |at, _| at.perp());
        Polyline::new(points.iter().map(turn), 0.01).expect("a line")
    }

    /// Twice the signed areas of both triangles of each quad between sections.
    fn doubled_areas(sections: &[DeckSection]) -> Vec<f64> {
        let quads = sections.windows(2).flat_map(|pair| {
            let [a, b] = [pair[0], pair[1]].map(|section| section.aside.map(|aside| section.at + aside));
            let quad = [a[0], a[1], b[1], b[0]];
            let triangles = crate::bridge::quad_corners(quad).map(|corners| corners.map(|at| quad[at]));
            triangles.map(|[p, q, r]| (q - p).perp_dot(r - p))
        });
        quads.collect()
    }

    #[test]
    fn a_gentle_course_covers_width_times_length_however_it_is_turned() {
        for quarter in 0..4 {
            let line = turned(&[(0.0, 0.0), (80.0, 0.0), (150.0, 30.0), (190.0, 90.0)], quarter);
            let alignment = Alignment::on_ground(line, 8.0);
            let breaks: Vec<f64> = (0..40).map(|index| f64::from(index) * 7.0).collect();
            let sections = sections(&alignment, Continuations::default(), 2.0, &breaks);
            assert!(sections.len() > 25);
            let area: f64 = doubled_areas(&sections).iter().sum::<f64>() / 2.0;
            assert!((area - 8.0 * alignment.line.length()).abs() < 1e-9, "{area}");
        }
    }

    #[test]
    fn an_end_is_mitered_with_what_goes_on_there() {
        let line = turned(&[(0.0, 0.0), (50.0, 0.0)], 0);
        let beyond = Continuations { before: Some(DVec2::new(-30.0, 30.0)), after: None };
        let sections = sections(&Alignment::on_ground(line, 6.0), beyond, 2.0, &[]);
        let [left, right] = sections[0].aside;
        assert_eq!(left, -right);
        assert!((left.y - 3.0).abs() < 1e-12 && left.x > 1.0 || left.x < -1.0, "{left}");
        assert_eq!(sections[1].aside[0], DVec2::new(0.0, 3.0));
    }

    proptest! {
        #[test]
        fn no_course_folds_over_itself(
            turns in prop::collection::vec((2.0..60.0f64, -1.9..1.9f64), 2..30),
            width_m in 3.0..30.0f64,
            quarter in 0u32..4,
        ) {
            let mut points = vec![(0.0, 0.0)];
            let (mut heading, mut at) = (0.0, DVec2::ZERO);
            for (length, turn) in turns {
                heading += turn;
                at += DVec2::new(libm::cos(heading), libm::sin(heading)) * length;
                points.push((at.x, at.y));
            }
            let alignment = Alignment::on_ground(turned(&points, quarter), width_m);
            let breaks: Vec<f64> = (0..200).map(|index| f64::from(index) * 3.0).collect();
            let sections = sections(&alignment, Continuations::default(), 2.0, &breaks);
            for pair in sections.windows(2) {
                prop_assert!(pair[0].station_m < pair[1].station_m);
            }
            for (index, area) in doubled_areas(&sections).into_iter().enumerate() {
                prop_assert!(area > 0.0, "triangle {}: {}", index, area);
            }
        }
    }
}

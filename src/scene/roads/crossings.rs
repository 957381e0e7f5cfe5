//! What passes below bridges: where other ways' centerlines cross theirs.
//!
//! Lines are cut into pieces of a few segments with a box round each, the pieces below sorted by their western edge; a
//! piece of a bridge is compared only with those whose boxes it may meet, so that the work grows with what is near each
//! other, not with all pairs of segments.

use std::ops::Range;

use glam::DVec2;

use crate::geom::polyline::Polyline;
use crate::geom::rect::Rect;
use crate::geom::segment;

/// Segments in a piece: enough to make boxes cheap, few enough to keep them small.
const SEGMENTS: usize = 8;

/// A crossing at a smaller angle than this sine counts as this one: its room would have no end.
const LEAST_SINE: f64 = 0.25;

/// A way that others may pass over.
#[derive(Clone, Copy, Debug)]
pub struct PassedLine<'a> {
    /// Its centerline in world coordinates.
    pub line: &'a Polyline,
    /// Its width in meters.
    pub width_m: f64,
    /// What passes over what.
    pub level: i32,
}

/// Where a way passes over another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overpass {
    /// Which of the upper ways.
    pub upper: usize,
    /// Which of the lower ways.
    pub lower: usize,
    /// The place.
    pub at: DVec2,
    /// The station on the upper way, in meters.
    pub upper_m: f64,
    /// The station on the lower way, in meters.
    pub lower_m: f64,
    /// Half of the length of the upper way that lies over the lower one's width, in meters.
    pub half_m: f64,
}

/// A run of a line's segments.
struct LineRun {
    way: usize,
    segments: Range<usize>,
    rect: Rect,
}

/// Every place where one of `upper` crosses one of `lower` whose level is lower, by upper way and station. Lines that
/// only touch end to end do not cross.
pub fn find(upper: &[PassedLine<'_>], lower: &[PassedLine<'_>]) -> Vec<Overpass> {
    let mut below = pieces(lower);
    below.sort_by(|a, b| a.rect.min.x.total_cmp(&b.rect.min.x));
    let widest = below.iter().map(|piece| piece.rect.size().x).fold(0.0, f64::max);
    let mut found = Vec::new();
    for piece in pieces(upper) {
        let first = below.partition_point(|other| other.rect.min.x < piece.rect.min.x - widest);
        let near = below[first..].iter().take_while(|other| other.rect.min.x <= piece.rect.max.x);
        for other in near.filter(|other| other.rect.meets(&piece.rect)) {
            if lower[other.way].level < upper[piece.way].level {
                cross((&piece, &upper[piece.way]), (other, &lower[other.way]), &mut found);
            }
        }
    }
    found.sort_by(|a, b| {
        a.upper.cmp(&b.upper).then(a.upper_m.total_cmp(&b.upper_m)).then(a.lower.cmp(&b.lower))
    });
    found.dedup_by(|next, kept| {
        (next.upper, next.lower) == (kept.upper, kept.lower) && next.upper_m - kept.upper_m < 1e-6
    });
    found
}

fn pieces(ways: &[PassedLine<'_>]) -> Vec<LineRun> {
    let cut = |(way, line): (usize, &Polyline)| {
        let count = line.points().len() - 1;
        let piece = move |from: usize, points: &[DVec2]| {
            let segments = from..(from + SEGMENTS).min(count);
            let rect = Rect::around(points[segments.start..=segments.end].iter().copied());
            LineRun { way, segments, rect }
        };
        (0..count).step_by(SEGMENTS).map(|from| piece(from, line.points())).collect::<Vec<_>>()
    };
    ways.iter().enumerate().flat_map(|(index, way)| cut((index, way.line))).collect()
}

fn cross(
    (piece, over): (&LineRun, &PassedLine<'_>),
    (other, under): (&LineRun, &PassedLine<'_>),
    found: &mut Vec<Overpass>,
) {
    for above in piece.segments.clone() {
        for below in other.segments.clone() {
            let ends = |line: &Polyline, segment: usize| (line.points()[segment], line.points()[segment + 1]);
            let Some(parts) = segment::crossing(ends(over.line, above), ends(under.line, below)) else {
                continue;
            };
            let station = |line: &Polyline, segment: usize, part: f64| {
                let stations = line.stations();
                stations[segment] + (stations[segment + 1] - stations[segment]) * part
            };
            let (upper_m, lower_m) =
                (station(over.line, above, parts[0]), station(under.line, below, parts[1]));
            if is_end(over.line, upper_m) && is_end(under.line, lower_m) {
                continue;
            }
            let direction = |line, segment| {
                let (from, to) = ends(line, segment);
                (to - from).normalize_or_zero()
            };
            let sine = direction(over.line, above).perp_dot(direction(under.line, below)).abs();
            found.push(Overpass {
                upper: piece.way,
                lower: other.way,
                at: over.line.at(upper_m),
                upper_m,
                lower_m,
                half_m: under.width_m / 2.0 / sine.max(LEAST_SINE),
            });
        }
    }
}

fn is_end(line: &Polyline, station_m: f64) -> bool {
    station_m < 0.01 || station_m > line.length() - 0.01
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line")
    }

    fn way(line: &Polyline, level: i32) -> PassedLine<'_> {
        PassedLine { line, width_m: 6.0, level }
    }

    #[test]
    fn a_bridge_crosses_the_road_below_and_not_the_one_it_leads_on_to() {
        let bridge = line(&[(0.0, 0.0), (40.0, 0.0)]);
        let below = line(&[(10.0, -50.0), (10.0, 50.0)]);
        let onward = line(&[(40.0, 0.0), (90.0, 5.0)]);
        let above = line(&[(20.0, -50.0), (20.0, 50.0)]);
        let lower = [way(&below, 0), way(&onward, 0), way(&above, 2)];
        let found = find(&[way(&bridge, 1)], &lower);
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].lower, found[0].upper_m, found[0].lower_m, found[0].half_m),
            (0, 10.0, 50.0, 3.0)
        );
    }

    proptest! {
        #[test]
        fn pieces_find_what_all_pairs_of_segments_do(
            over in prop::collection::vec((0.0..100.0f64, 0.0..100.0f64), 2..40),
            under in prop::collection::vec((0.0..100.0f64, 0.0..100.0f64), 2..40),
        ) {
            let (over, under) = (line(&over), line(&under));
            let segments = |line: &Polyline| -> Vec<(DVec2, DVec2)> {
                line.points().windows(2).map(|pair| (pair[0], pair[1])).collect()
            };
            let pairs = segments(&over).into_iter()
                .flat_map(|one| segments(&under).into_iter().map(move |other| (one, other)))
                .filter(|&(one, other)| segment::crossing(one, other).is_some())
                .count();
            prop_assert_eq!(find(&[way(&over, 1)], &[way(&under, 0)]).len(), pairs);
        }
    }
}

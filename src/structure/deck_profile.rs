//! How high a deck lies along its way: stated, or as a rope pulled taut over what it has to clear.
//!
//! The ends lie where the road comes from the ground. Between them the deck runs straight where it can; where the
//! ground, a road or water below needs room, it is lifted over it as little as it can be: the upper hull of all that it
//! must clear. What passes below asks for more room than there may be way to climb, so what it asks for is cut off where
//! it could only be reached too steeply from either end. Then the hull's corners are rounded by parabolas, as vertical
//! curves of roads are.
//!
//! ```text
//!              ╭─────────────╮            hull, rounded
//!          ╱    · · ·│           ╲
//!   end ●╱           │ 5 m          ╲● end
//!   ▓▓▓▓▓╲          ═╪═ road       ╱▓▓▓
//!   ▓▓▓▓▓▓▓╲______________________╱▓▓▓▓
//! ```

use glam::DVec2;

use crate::geom::convex;

/// How far rounding may take a deck down below the corner it rounds, in meters: what is lifted over the ground has this
/// much to spare.
const ROUNDED_OFF_M: f64 = 0.2;

/// How far from a corner its vertical curve may begin, in meters: longer ones would look no smoother.
const LONGEST_CURVE_M: f64 = 40.0;

/// Into how many parts a vertical curve is cut.
const CURVE_PARTS: u32 = 6;

/// How high a deck lies over the ground where nothing asks for more, in meters: the ground must not show through.
const OVER_GROUND_M: f64 = 0.3;

/// How fast it may rise to that from its ends: [`OVER_GROUND_M`] within ten meters.
const TO_OVER_GROUND: f64 = 0.03;

/// What a deck has to clear at a station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearancePoint {
    /// Where, in meters along the deck.
    pub station_m: f64,
    /// The elevation it must not lie below, in meters.
    pub level_m: f64,
}

/// The elevations along a deck: straight between stations.
#[derive(Clone, Debug, PartialEq)]
pub struct DeckProfile {
    /// Stations rising, at least two.
    points: Vec<ClearancePoint>,
}

impl DeckProfile {
    /// A profile through stated levels; `None` where there are fewer than two, or stations do not rise.
    pub fn stated(points: Vec<ClearancePoint>) -> Option<Self> {
        let rises = points.windows(2).all(|pair| pair[0].station_m < pair[1].station_m);
        let finite = points.iter().all(|point| point.station_m.is_finite() && point.level_m.is_finite());
        (points.len() >= 2 && rises && finite).then_some(Self { points })
    }

    /// The straight line over `length_m` between the levels of both ends.
    pub fn straight(length_m: f64, ends_m: [f64; 2]) -> Self {
        let [from, to] = ends_m;
        let end = |station_m, level_m| ClearancePoint { station_m, level_m };
        Self { points: vec![end(0.0, from), end(length_m, to)] }
    }

    /// The lowest profile over `length_m` that keeps its ends, clears the `ground` and, as far as it can be climbed at
    /// the grade `steepest` (rise over run), what passes below.
    pub fn clearing(
        (length_m, ends_m): (f64, [f64; 2]),
        ground: &[ClearancePoint],
        passages: &[ClearancePoint],
        steepest: f64,
    ) -> Self {
        let line = Self::straight(length_m, ends_m);
        let from_end = |station: f64| station.min(length_m - station);
        let over_ground = ground.iter().map(|floor| {
            let lift = OVER_GROUND_M.min(TO_OVER_GROUND * from_end(floor.station_m));
            ClearancePoint { level_m: floor.level_m + lift, ..*floor }
        });
        let over_passages = passages.iter().map(|floor| {
            let climbed = (ends_m[0] + steepest * floor.station_m)
                .min(ends_m[1] + steepest * (length_m - floor.station_m));
            let wanted = floor.level_m + ROUNDED_OFF_M;
            ClearancePoint { level_m: wanted.min(climbed).max(line.level_m(floor.station_m)), ..*floor }
        });
        let mut points: Vec<ClearancePoint> = over_ground.chain(over_passages).collect();
        points.retain(|point| {
            let inside = point.station_m > 0.0 && point.station_m < length_m;
            inside && point.level_m.is_finite()
        });
        points.extend(line.points);
        points.sort_by(|a, b| a.station_m.total_cmp(&b.station_m).then(a.level_m.total_cmp(&b.level_m)));
        Self { points: rounded(&upper_hull(&points)) }
    }

    /// The elevation at a station in meters, that of the nearer end beyond the ends.
    pub fn level_m(&self, station_m: f64) -> f64 {
        let last = self.points.len() - 1;
        let after = self.points.partition_point(|point| point.station_m < station_m).clamp(1, last);
        let (from, to) = (self.points[after - 1], self.points[after]);
        let part = ((station_m - from.station_m) / (to.station_m - from.station_m)).clamp(0.0, 1.0);
        from.level_m * (1.0 - part) + to.level_m * part
    }

    /// Where it bends.
    pub fn stations(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().map(|point| point.station_m)
    }

    /// The part from one station to another, its own stations from 0; backwards where the second is the lower.
    pub fn part(&self, from_m: f64, to_m: f64) -> Self {
        let (low, high) = (from_m.min(to_m), from_m.max(to_m).max(from_m.min(to_m) + 1e-6));
        let within = self.stations().filter(|&station| station > low + 1e-6 && station < high - 1e-6);
        let stations: Vec<f64> = std::iter::once(low).chain(within).chain([high]).collect();
        let point = |&at: &f64| ClearancePoint { station_m: (at - from_m).abs(), level_m: self.level_m(at) };
        let mut points: Vec<ClearancePoint> = stations.iter().map(point).collect();
        points.sort_by(|a, b| a.station_m.total_cmp(&b.station_m));
        points.dedup_by(|next, kept| next.station_m <= kept.station_m);
        Self { points }
    }

    /// The steepest rise or fall, meters a meter.
    pub fn steepest(&self) -> f64 {
        self.points.windows(2).map(|pair| grade(pair[0], pair[1]).abs()).fold(0.0, f64::max)
    }
}

fn grade(from: ClearancePoint, to: ClearancePoint) -> f64 {
    (to.level_m - from.level_m) / (to.station_m - from.station_m)
}

/// The upper hull of points sorted by station and level.
fn upper_hull(points: &[ClearancePoint]) -> Vec<ClearancePoint> {
    let backward = points.iter().rev().map(|point| DVec2::new(point.station_m, point.level_m));
    let hull = convex::left_turns(backward).into_iter().rev();
    hull.map(|at| ClearancePoint { station_m: at.x, level_m: at.y }).collect()
}

/// A polyline with its corners rounded by parabolas that touch both sides at equal distances from the corner.
fn rounded(corners: &[ClearancePoint]) -> Vec<ClearancePoint> {
    let length_m = corners[corners.len() - 1].station_m;
    let mut points = vec![corners[0]];
    for around in corners.windows(3) {
        let [before, corner, after] = [around[0], around[1], around[2]];
        let (rise, fall) = (grade(before, corner), grade(corner, after));
        let bend = (rise - fall).abs();
        let room = (corner.station_m - before.station_m).min(after.station_m - corner.station_m) / 2.0;
        // A parabola over ±w passes below the corner by bend · w / 4.
        let from_end = (corner.station_m - corners[0].station_m).min(length_m - corner.station_m);
        let spare = ROUNDED_OFF_M.min(TO_OVER_GROUND / 2.0 * from_end);
        let half = room.min(LONGEST_CURVE_M).min(4.0 * spare / bend.max(1e-9));
        for part in 0..=CURVE_PARTS {
            let along = f64::from(part) / f64::from(CURVE_PARTS);
            let (from, to) = (corner.level_m - rise * half, corner.level_m + fall * half);
            let curve = |a: f64, b: f64, c: f64| {
                a * (1.0 - along).powi(2) + 2.0 * b * along * (1.0 - along) + c * along.powi(2)
            };
            let station_m = corner.station_m + half * (2.0 * along - 1.0);
            points.push(ClearancePoint { station_m, level_m: curve(from, corner.level_m, to) });
        }
    }
    points.push(corners[corners.len() - 1]);
    points.dedup_by(|next, kept| next.station_m - kept.station_m < 1e-6);
    // The last point is the end itself.
    if let Some(last) = points.last_mut() {
        *last = corners[corners.len() - 1];
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn floor((station_m, level_m): (f64, f64)) -> ClearancePoint {
        ClearancePoint { station_m, level_m }
    }

    #[test]
    fn over_a_valley_a_deck_runs_straight() {
        let ground: Vec<ClearancePoint> =
            (1..100).map(|at| floor((f64::from(at), 50.0 - f64::from(at.min(100 - at))))).collect();
        let profile = DeckProfile::clearing((100.0, [50.0, 53.0]), &ground, &[], 0.1);
        for station in 0..=100 {
            let station = f64::from(station);
            assert!((profile.level_m(station) - (50.0 + 0.03 * station)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_road_below_gets_its_room_where_there_is_way_to_climb() {
        let passages = [floor((200.0, 6.0))];
        let long = DeckProfile::clearing((400.0, [0.0, 0.0]), &[], &passages, 0.1);
        assert!(long.level_m(200.0) >= 6.0 && long.level_m(200.0) < 6.3, "{}", long.level_m(200.0));
        assert!(long.steepest() < 0.1);
        let short = DeckProfile::clearing((40.0, [0.0, 0.0]), &[], &[floor((20.0, 6.0))], 0.1);
        assert!(short.level_m(20.0) > 1.6 && short.level_m(20.0) <= 2.0, "{}", short.level_m(20.0));
        assert!(short.steepest() <= 0.1 + 1e-9);
    }

    proptest! {
        #[test]
        fn a_deck_keeps_its_ends_and_lies_below_no_ground(
            heights in prop::collection::vec(0.0..60.0f64, 3..60),
            ends in (0.0..60.0f64, 0.0..60.0f64),
        ) {
            let length = heights.len() as f64 * 10.0;
            let ground: Vec<ClearancePoint> =
                heights.iter().enumerate().map(|(at, &height)| floor((at as f64 * 10.0 + 5.0, height))).collect();
            let profile = DeckProfile::clearing((length, [ends.0, ends.1]), &ground, &[], 0.1);
            prop_assert!(profile.stations().zip(profile.stations().skip(1)).all(|(a, b)| a < b));
            prop_assert_eq!(profile.level_m(0.0), ends.0);
            prop_assert_eq!(profile.level_m(length), ends.1);
            for floor in ground {
                let over = profile.level_m(floor.station_m) - floor.level_m;
                prop_assert!(over > -1e-6, "{} m over the ground at {}", over, floor.station_m);
            }
        }
    }
}

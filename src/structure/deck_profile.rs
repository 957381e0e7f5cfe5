//! The profile of a deck: a rope pulled taut over what it has to clear.
//!
//! The ends lie where the road leaves the ground. Between them the deck is the upper hull of what it must clear: ground,
//! roads, water. Clearance that could only be reached too steeply from either end is reduced. The hull's corners are
//! rounded by parabolas, as vertical curves of roads are.
//!
//! ```text
//!              ╭─────────────╮            hull, rounded
//!          ╱    · · ·│           ╲
//!   end ●╱           │ 5 m          ╲● end
//!   ▓▓▓▓▓╲          ═╪═ road       ╱▓▓▓
//!   ▓▓▓▓▓▓▓╲______________________╱▓▓▓▓
//! ```

use glam::DVec2;

use sandtable_geom::convex;
use sandtable_geom::profile::Profile;

/// How far rounding may lower a deck below the corner it rounds, in meters.
const ROUNDED_OFF_M: f64 = 0.2;

/// How far from a corner its vertical curve may begin, in meters: longer ones would look no smoother.
const LONGEST_CURVE_M: f64 = 40.0;

/// Into how many parts a vertical curve is cut.
const CURVE_PARTS: u32 = 6;

/// How high a deck lies over the ground where nothing asks for more, in meters: the ground must not show through.
const OVER_GROUND_M: f64 = 0.3;

/// How fast it may rise to that from its ends: [`OVER_GROUND_M`] within ten meters.
const TO_OVER_GROUND: f64 = 0.03;

/// A point that a deck has to clear at a station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearancePoint {
    /// Where, in meters along the deck.
    pub station_m: f64,
    /// The elevation it must not lie below, in meters.
    pub level_m: f64,
}

/// The lowest profile that keeps the ends of the straight one `line`, clears the `ground` and, as far as it can be climbed
/// at the grade `steepest` (rise over run), what passes below.
pub fn clearing(
    line: &Profile,
    ground: &[ClearancePoint],
    passages: &[ClearancePoint],
    steepest: f64,
) -> Profile {
    let ([.., length_m], &[from_m, to_m]) = (line.stations(), line.values()) else { return line.clone() };
    let over_ground = ground.iter().map(|floor| {
        let from_end = floor.station_m.min(length_m - floor.station_m);
        let lift = OVER_GROUND_M.min(TO_OVER_GROUND * from_end);
        ClearancePoint { level_m: floor.level_m + lift, ..*floor }
    });
    let over_passages = passages.iter().map(|floor| {
        let climbed =
            (from_m + steepest * floor.station_m).min(to_m + steepest * (length_m - floor.station_m));
        let wanted = floor.level_m + ROUNDED_OFF_M;
        ClearancePoint { level_m: wanted.min(climbed).max(line.at(floor.station_m)), ..*floor }
    });
    let mut points: Vec<ClearancePoint> = over_ground.chain(over_passages).collect();
    points.retain(|point| point.station_m > 0.0 && point.station_m < *length_m && point.level_m.is_finite());
    let ends = [(0.0, from_m), (*length_m, to_m)];
    points.extend(ends.map(|(station_m, level_m)| ClearancePoint { station_m, level_m }));
    points.sort_by(|a, b| a.station_m.total_cmp(&b.station_m).then(a.level_m.total_cmp(&b.level_m)));
    let (stations, levels) =
        rounded(&upper_hull(&points)).iter().map(|point| (point.station_m, point.level_m)).unzip();
    Profile::new(stations, levels).unwrap_or_else(|| line.clone())
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
        let profile = clearing(&Profile::straight(100.0, [50.0, 53.0]), &ground, &[], 0.1);
        for station in 0..=100 {
            let station = f64::from(station);
            assert!((profile.at(station) - (50.0 + 0.03 * station)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_road_below_gets_its_room_where_there_is_way_to_climb() {
        let passages = [floor((200.0, 6.0))];
        let long = clearing(&Profile::straight(400.0, [0.0, 0.0]), &[], &passages, 0.1);
        assert!(long.at(200.0) >= 6.0 && long.at(200.0) < 6.3, "{}", long.at(200.0));
        assert!(long.steepest(0.0) < 0.1);
        let short = clearing(&Profile::straight(40.0, [0.0, 0.0]), &[], &[floor((20.0, 6.0))], 0.1);
        assert!(short.at(20.0) > 1.6 && short.at(20.0) <= 2.0, "{}", short.at(20.0));
        assert!(short.steepest(0.0) <= 0.1 + 1e-9);
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
            let profile = clearing(&Profile::straight(length, [ends.0, ends.1]), &ground, &[], 0.1);
            prop_assert!(profile.stations().windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert_eq!(profile.at(0.0), ends.0);
            prop_assert_eq!(profile.at(length), ends.1);
            for floor in ground {
                let over = profile.at(floor.station_m) - floor.level_m;
                prop_assert!(over > -1e-6, "{} m over the ground at {}", over, floor.station_m);
            }
        }
    }
}

//! The bounds of elevation in longitude and latitude, also across the meridian of 180 degrees.

use glam::DVec2;

use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;

/// Points along each side of a rectangle that are brought to longitude and latitude.
const SIDE_POINTS: u32 = 64;

/// West, south, east and north of a rectangle in `crs` in degrees; `None` where it has no place. What crosses the meridian of
/// 180 degrees has its west east of its east, as in GeoJSON (RFC 7946, 5.2).
pub fn degree_bounds(crs: &Crs, rect: &Rect, degrees: &Crs) -> Option<[f64; 4]> {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let side = |from: usize| {
        let (from, to) = (corners[from], corners[(from + 1) % 4]);
        (0..SIDE_POINTS).map(move |step| from + (to - from) * (f64::from(step) / f64::from(SIDE_POINTS)))
    };
    let around = (0..4).flat_map(side).chain([DVec2::ZERO]);
    let placed: Option<Vec<DVec2>> =
        around.map(|at| crs.transform(degrees, rect.min + at * rect.size()).ok()).collect();
    let Rect { min, max } = Rect::around(continued(placed?, crs.is_geographic()));
    let (south, north) = (min.y.max(-90.0), max.y.min(90.0));
    let [west, east] = match max.x - min.x {
        // All the way round.
        width if width >= 360.0 => [-180.0, 180.0],
        _ if min.x >= -180.0 && max.x <= 180.0 => [min.x, max.x],
        _ => {
            let turned = |longitude: f64| longitude - 360.0 * ((longitude + 180.0) / 360.0).floor();
            let east = turned(max.x);
            [turned(min.x), if east == -180.0 { 180.0 } else { east }]
        }
    };
    (west != east && south < north).then_some([west, south, east, north])
}

/// The places with longitudes that go on across 180 degrees from each to the next; those of a system in degrees do already.
fn continued(mut places: Vec<DVec2>, is_continued: bool) -> Vec<DVec2> {
    if !is_continued {
        for at in 1..places.len() {
            let turns = ((places[at].x - places[at - 1].x) / 360.0).round();
            places[at].x -= 360.0 * turns;
        }
    }
    places
}

/// Bounds as descriptions of tiles state them: what crosses the meridian of 180 degrees has all longitudes, since viewers know
/// no others.
pub fn described_bounds([west, south, east, north]: [f64; 4]) -> [f64; 4] {
    if west > east { [-180.0, south, 180.0, north] } else { [west, south, east, north] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(crs: u32, min: (f64, f64), max: (f64, f64)) -> [f64; 4] {
        let rect = Rect { min: min.into(), max: max.into() };
        degree_bounds(&Crs::from_epsg(crs).expect("known"), &rect, &Crs::wgs84()).expect("a place")
    }

    #[test]
    fn degrees_are_taken_as_they_are_and_turned_where_they_go_on_past_180() {
        assert_eq!(bounds(4326, (7.1, 46.2), (7.9, 46.7)), [7.1, 46.2, 7.9, 46.7]);
        assert_eq!(bounds(4326, (176.5, -20.0), (182.0, -16.0)), [176.5, -20.0, -178.0, -16.0]);
        assert_eq!(bounds(4326, (-190.0, 50.0), (-180.0, 60.0)), [170.0, 50.0, 180.0, 60.0]);
        assert_eq!(bounds(4326, (180.0, 50.0), (190.0, 60.0)), [-180.0, 50.0, -170.0, 60.0]);
        assert_eq!(bounds(4326, (0.0, -60.0), (360.0, 60.0)), [-180.0, -60.0, 180.0, 60.0]);
    }

    #[test]
    fn a_system_in_meters_crosses_180_degrees_by_two_ranges() {
        // The Taveuni strait of Fiji in UTM zone 60 south, whose eastern border is that meridian.
        let [west, south, east, north] = bounds(32760, (780_000.0, 8_100_000.0), (900_000.0, 8_200_000.0));
        assert!((179.0..180.0).contains(&west) && (-180.0..-179.0).contains(&east), "{west} {east}");
        assert!(south < north && north < -16.0 && south > -18.0, "{south} {north}");
        let [west, _, east, _] = bounds(32632, (400_000.0, 5_100_000.0), (500_000.0, 5_200_000.0));
        assert!(west < east && (7.0..9.1).contains(&west) && (7.0..9.1).contains(&east));
    }
}

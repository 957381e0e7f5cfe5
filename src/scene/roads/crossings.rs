//! Overpasses: places where bridges pass over other lines.

use glam::DVec2;
use rayon::prelude::*;

use sandtable_geom::leg_tree::{LegTree, LineLeg};
use sandtable_geom::polyline::Polyline;
use sandtable_geom::segment;
use sandtable_ribbon::junction::Street;

/// A crossing at a smaller angle than this sine counts as this one: its clearance would have no end.
const LEAST_SINE: f64 = 0.25;

/// A place where a line passes over another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overpass {
    /// The index of the upper line.
    pub upper: usize,
    /// The index of the lower line.
    pub lower: usize,
    /// The point.
    pub at: DVec2,
    /// The station on the upper line, in meters.
    pub upper_m: f64,
    /// The station on the lower line, in meters.
    pub lower_m: f64,
    /// Half of the length of the upper line that lies over the lower one's width, in meters.
    pub half_m: f64,
}

/// Every point where one of `upper` crosses one of `lower` whose level is lower, by upper line and station. Lines that
/// only touch end to end do not cross.
pub fn find(upper: &[&Street], lower: &[&Street]) -> Vec<Overpass> {
    let legs = |lines: &[&Street]| -> Vec<LineLeg> {
        lines
            .iter()
            .enumerate()
            .flat_map(|(index, passed)| LineLeg::all(index, &passed.alignment.line))
            .collect()
    };
    let below = LegTree::new(legs(lower));
    let crossed = |above: &LineLeg| -> Vec<Overpass> {
        let over = upper[above.line];
        let near = below.near(above).into_iter().map(|index| &below.legs()[index]);
        let lower_legs = near.filter(|leg| lower[leg.line].level < over.level);
        lower_legs.filter_map(|leg| cross(over, above, lower[leg.line], leg)).collect()
    };
    let mut found: Vec<Overpass> = legs(upper).par_iter().flat_map_iter(crossed).collect();
    found.sort_by(|a, b| {
        a.upper.cmp(&b.upper).then(a.upper_m.total_cmp(&b.upper_m)).then(a.lower.cmp(&b.lower))
    });
    found.dedup_by(|next, kept| {
        (next.upper, next.lower) == (kept.upper, kept.lower) && next.upper_m - kept.upper_m < 1e-6
    });
    found
}

/// Where a leg of one line crosses a leg of another.
fn cross(over: &Street, above: &LineLeg, under: &Street, below: &LineLeg) -> Option<Overpass> {
    let parts = segment::crossing(above.ends.into(), below.ends.into())?;
    let station = |leg: &LineLeg, part: f64| leg.stations[0] + (leg.stations[1] - leg.stations[0]) * part;
    let (upper_m, lower_m) = (station(above, parts[0]), station(below, parts[1]));
    if is_end(&over.alignment.line, upper_m) && is_end(&under.alignment.line, lower_m) {
        return None;
    }
    let [a, b] = [above, below].map(|leg| (leg.ends[1] - leg.ends[0]).normalize_or_zero());
    let half_m = under.width_m / 2.0 / a.perp_dot(b).abs().max(LEAST_SINE);
    Some(Overpass {
        upper: above.line,
        lower: below.line,
        at: over.alignment.line.at(upper_m),
        upper_m,
        lower_m,
        half_m,
    })
}

fn is_end(line: &Polyline, station_m: f64) -> bool {
    station_m < 0.01 || station_m > line.length() - 0.01
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sandtable_earthworks::alignment::Alignment;
    use sandtable_ribbon::stroke::StrokeOptions;
    use sandtable_ribbon::texture::RibbonSurface;

    fn line(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&(x, y)| DVec2::new(x, y)), 0.0).expect("a line")
    }

    fn way(line: &Polyline, level: i32) -> Street {
        let alignment = Alignment::on_ground(line.clone(), 6.0);
        let options = StrokeOptions::default();
        Street { alignment, width_m: 6.0, options, level, surface: RibbonSurface::Asphalt }
    }

    #[test]
    fn a_bridge_crosses_the_road_below_and_not_the_one_it_leads_on_to() {
        let bridge = line(&[(0.0, 0.0), (40.0, 0.0)]);
        let below = line(&[(10.0, -50.0), (10.0, 50.0)]);
        let onward = line(&[(40.0, 0.0), (90.0, 5.0)]);
        let above = line(&[(20.0, -50.0), (20.0, 50.0)]);
        let lower = [way(&below, 0), way(&onward, 0), way(&above, 2)];
        let found = find(&[&way(&bridge, 1)], &lower.each_ref());
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].lower, found[0].upper_m, found[0].lower_m, found[0].half_m),
            (0, 10.0, 50.0, 3.0)
        );
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_all_pairs_of_segments_do(
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
            prop_assert_eq!(find(&[&way(&over, 1)], &[&way(&under, 0)]).len(), pairs);
        }
    }
}

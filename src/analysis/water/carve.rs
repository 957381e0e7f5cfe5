//! Water under bridges and through culverts: the ground of an embankment cut through, so that it dams nothing.
//!
//! Elevations have a road's embankment, not the opening in it. So a cut is made at each crossing, straight from the lowest
//! post on one side of the way to the lowest on the other, that falls evenly from the higher to the lower; posts below it
//! stay as they are.

use std::borrow::Cow;

use glam::DVec2;

use crate::land::{CrossingKind, Land};
use crate::line_posts::along_line;
use crate::place::nearest_post;
use sandtable_base::message::numbers::counted;
use sandtable_geom::segment::nearest_part;
use sandtable_terrain::lattice::Lattice;

/// How far from the edge of the way the lowest posts are sought, meters: an embankment 10 m high reaches some 20 m.
const REACH_M: f64 = 30.0;

/// The same in posts, where they lie far apart.
const REACH_POSTS: f64 = 2.0;

/// What the ground was cut through below, how many of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CutTally {
    /// Bridges.
    pub bridges: usize,
    /// Culverts that the data have.
    pub culverts: usize,
    /// Culverts inferred where roads cross streams.
    pub inferred: usize,
}

/// The heights of the ground with a cut below each bridge and along each culvert of the land, and the number of cuts.
pub(crate) fn carved(land: &Land) -> (Cow<'_, [f32]>, CutTally) {
    let ground = &*land.ground;
    let mut heights = Cow::Borrowed(ground.heights());
    let mut cuts = CutTally::default();
    for crossing in &land.crossings {
        let line = &crossing.line;
        let below = |width_m: f64| {
            let width_m = if width_m.is_finite() { width_m.max(0.0) } else { 0.0 };
            let banks = banks(ground, ground.heights(), line, (width_m, 0.0))?;
            Some(banks.map(|index| ground.map_position(ground.post_at(index))).to_vec())
        };
        let (way, count) = match crossing.kind {
            CrossingKind::Ford => continue,
            CrossingKind::Bridge => (below(crossing.width_m), &mut cuts.bridges),
            CrossingKind::InferredCulvert => (below(crossing.width_m), &mut cuts.inferred),
            CrossingKind::Culvert => (through(ground, line), &mut cuts.culverts),
        };
        *count += usize::from(way.is_some_and(|way| cut(ground, &mut heights, &way)));
    }
    (heights, cuts)
}

impl CutTally {
    /// What the reader is told of the cuts.
    pub fn note(self) -> Vec<String> {
        let Self { bridges, culverts, inferred } = self;
        let rows = [
            (bridges, counted(bridges, "bridge", "bridges")),
            (culverts, format!("{} of the scene", counted(culverts, "culvert", "culverts"))),
            (
                inferred,
                format!("{} inferred where roads cross streams", counted(inferred, "culvert", "culverts")),
            ),
        ];
        let parts: Vec<String> =
            rows.into_iter().filter(|(count, _)| *count > 0).map(|(_, part)| part).collect();
        let told = match &parts[..] {
            [] => return Vec::new(),
            [only] => only.clone(),
            [first @ .., last] => format!("{} and {last}", first.join(", ")),
        };
        vec![format!("the ground is cut through below {told}")]
    }
}

/// The water's way through a culvert: its line, from the lowest post before its start to the lowest post after its end; `None`
/// where one of them is not on the ground.
fn through(ground: &Lattice, line: &[DVec2]) -> Option<Vec<DVec2>> {
    let ([start, next, ..], [.., before, end]) = (line, line) else { return None };
    let upper = lowest_beyond(ground, *start, *start - *next)?;
    let lower = lowest_beyond(ground, *end, *end - *before)?;
    let ends = [upper, lower].map(|index| ground.map_position(ground.post_at(index)));
    Some([&ends[..1], line, &ends[1..]].concat())
}

/// The lowest post within 30 m, or two posts, of the end of a line, in the half of the plane that the line does not come from.
fn lowest_beyond(ground: &Lattice, end: DVec2, outward: DVec2) -> Option<usize> {
    let heights = ground.heights();
    let reach_m = REACH_M.max(REACH_POSTS * ground.cell().max_element());
    let aside = outward.normalize_or_zero().perp() * reach_m;
    let mut lowest: Option<(f32, usize)> = None;
    along_line(ground, &[end - aside, end + aside], 2.0 * reach_m, |index| {
        let off = ground.map_position(ground.post_at(index)) - end;
        let is_beyond = off.dot(outward) >= 0.0 && off.length() <= reach_m;
        if is_beyond && !heights[index].is_nan() && lowest.is_none_or(|known| (heights[index], index) < known)
        {
            lowest = Some((heights[index], index));
        }
    });
    lowest.map(|(_, index)| index)
}

/// The lowest posts on the left and on the right of a way of a width, no farther than 30 m, two posts or `more_m` beyond its
/// edge; `None` where a side has none.
pub(super) fn banks(
    ground: &Lattice,
    heights: &[f32],
    line: &[DVec2],
    (width_m, more_m): (f64, f64),
) -> Option<[usize; 2]> {
    let reach_m = width_m / 2.0 + REACH_M.max(REACH_POSTS * ground.cell().max_element()).max(more_m);
    let mut lowest: [Option<(f32, usize)>; 2] = [None; 2];
    for leg in line.windows(2) {
        let (from, along) = (leg[0], leg[1] - leg[0]);
        along_line(ground, leg, 2.0 * reach_m, |index| {
            let (at, height) = (ground.map_position(ground.post_at(index)) - from, heights[index]);
            let part = at.dot(along) / along.length_squared();
            let off_m = along.perp_dot(at) / along.length();
            if height.is_nan() || !(0.0..=1.0).contains(&part) || off_m.abs() <= width_m / 2.0 {
                return;
            }
            let lowest = &mut lowest[usize::from(off_m < 0.0)];
            if off_m != 0.0 && lowest.is_none_or(|known| (height, index) < known) {
                *lowest = Some((height, index));
            }
        });
    }
    match lowest {
        [Some((_, left)), Some((_, right))] => Some([left, right]),
        _ => None,
    }
}

/// Cuts the ground along a way between two posts, so that it falls evenly from the higher to the lower; `false` where nothing
/// stands in the way.
fn cut(ground: &Lattice, heights: &mut Cow<'_, [f32]>, way: &[DVec2]) -> bool {
    let [Some(start), Some(end)] = [way.first(), way.last()].map(|end| nearest_post(ground, *end?)) else {
        return false;
    };
    let levels = [heights[start], heights[end]].map(f64::from);
    let length_m: f64 = way.windows(2).map(|leg| leg[0].distance(leg[1])).sum();
    let (mut before_m, mut is_cut) = (0.0, false);
    for leg in way.windows(2).filter(|leg| leg[0] != leg[1]) {
        let leg_m = leg[0].distance(leg[1]);
        let mut posts = Vec::new();
        along_line(ground, leg, 0.0, |index| posts.push(index));
        for index in posts {
            let part = nearest_part((leg[0], leg[1]), ground.map_position(ground.post_at(index)));
            let share = before_m / length_m + part * (leg_m / length_m);
            let level = (levels[0] + (levels[1] - levels[0]) * share) as f32;
            if heights[index] > level {
                heights.to_mut()[index] = level;
                is_cut = true;
            }
        }
        before_m += leg_m;
    }
    is_cut
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::land::Crossing;
    use crate::test_land::shaped;
    use crate::water::fill::filled;
    use sandtable_terrain::stop_flag::StopFlag;

    /// A valley that falls to the south, with a dam of 12 m across its row 10.
    fn dammed() -> Land {
        shaped(21, 21, 10.0, |column, row| {
            let valley = row as f32 * 0.5 + (column as f32 - 10.0).abs() * 3.0;
            if row == 10 { valley.max(17.0) } else { valley }
        })
    }

    fn crossing(kind: CrossingKind, from: DVec2, to: DVec2) -> Crossing {
        Crossing { name: String::new(), kind, line: vec![from, to], width_m: 8.0, load_t: None }
    }

    fn depth(land: &Land) -> f32 {
        let (heights, _) = carved(land);
        let filled = filled(&heights, 21, &StopFlag::default()).expect("filled");
        filled.iter().zip(heights.iter()).map(|(filled, height)| filled - height).fold(0.0, f32::max)
    }

    #[test]
    fn a_culvert_lets_through_what_the_embankment_would_dam() {
        let mut land = dammed();
        // The border above, at 10 m, is the other outlet; the lowest post above the dam is at 5.5 m.
        assert_eq!(depth(&land), 4.5);
        let over = crossing(CrossingKind::InferredCulvert, DVec2::new(80.0, 100.0), DVec2::new(120.0, 100.0));
        land.crossings = vec![over.clone()];
        assert_eq!(depth(&land), 0.0);
        assert_eq!(carved(&land).1, CutTally { inferred: 1, ..CutTally::default() });
        // From 5.5 m in row 11 to 3.5 m in row 7, a quarter of the way.
        assert!((carved(&land).0[10 * 21 + 10] - 5.0).abs() < 1e-6);
        land.crossings = vec![Crossing { kind: CrossingKind::Bridge, ..over }];
        assert_eq!(depth(&land), 0.0);
    }

    #[test]
    fn fords_and_crossings_without_ground_on_both_sides_cut_nothing() {
        let mut land = dammed();
        let at = |x: f64, y: f64| DVec2::new(x, y);
        land.crossings = vec![
            crossing(CrossingKind::Ford, at(80.0, 100.0), at(120.0, 100.0)),
            crossing(CrossingKind::Bridge, at(80.0, 0.0), at(120.0, 0.0)),
            crossing(CrossingKind::Bridge, at(f64::NAN, 0.0), at(120.0, 100.0)),
            crossing(CrossingKind::Bridge, at(-9e9, 5e9), at(-8e9, 5e9)),
            crossing(CrossingKind::Culvert, at(-9e9, 5e9), at(-8e9, 5e9)),
            crossing(CrossingKind::Culvert, at(100.0, f64::NAN), at(100.0, 80.0)),
            crossing(CrossingKind::Culvert, at(100.0, 100.0), at(100.0, 9000.0)),
            Crossing {
                line: vec![at(1.0, 1.0)],
                ..crossing(CrossingKind::Culvert, at(0.0, 0.0), at(0.0, 0.0))
            },
            Crossing { line: Vec::new(), ..crossing(CrossingKind::Bridge, at(0.0, 0.0), at(0.0, 0.0)) },
        ];
        assert!(matches!(carved(&land), (Cow::Borrowed(_), cuts) if cuts == CutTally::default()));
    }

    #[test]
    fn a_culvert_of_the_data_leads_water_along_its_line_from_end_to_end() {
        // A bank of 16 posts, from row 4 to row 19, on which water stands; the pipe turns aside below it.
        let ground = |column: u32, row: u32| {
            let valley = row as f32 * 0.5 + (column as f32 - 10.0).abs() * 3.0;
            if (4..20).contains(&row) { valley.max(40.0) } else { valley }
        };
        let mut land = shaped(21, 40, 10.0, ground);
        let at = |column: f64, row: f64| DVec2::new(column, row) * 10.0;
        let line = vec![at(10.0, 19.5), at(14.0, 12.0), at(10.0, 3.5)];
        let pipe = Crossing { line, ..crossing(CrossingKind::Culvert, at(0.0, 0.0), at(0.0, 0.0)) };
        assert!(depth(&land) > 5.0);
        for is_reversed in [false, true] {
            let mut pipe = pipe.clone();
            if is_reversed {
                pipe.line.reverse();
            }
            land.crossings = vec![pipe];
            assert_eq!(depth(&land), 0.0);
            let (heights, cuts) = carved(&land);
            assert_eq!(cuts, CutTally { culverts: 1, ..CutTally::default() });
            // It goes by the bend of the pipe, not straight below the bank.
            assert!(heights[12 * 21 + 14] < 11.0 && heights[12 * 21 + 10] == 40.0);
            let low = land.ground.heights().iter().zip(&*heights).filter(|(before, after)| after < before);
            assert!((16..30).contains(&low.count()), "one chain of posts is cut");
        }
        let note = CutTally { bridges: 1, culverts: 1, inferred: 2 }.note();
        let wanted = "the ground is cut through below 1 bridge, 1 culvert of the scene and 2 culverts inferred where roads cross \
                      streams";
        assert_eq!(note, [wanted]);
        assert!(CutTally::default().note().is_empty());
    }
}

//! Water under bridges and through culverts: the ground of an embankment cut through, so that it dams nothing.
//!
//! Elevations have a road's embankment, not the opening in it. So a cut is made at each crossing, straight from the lowest
//! post on one side of the way to the lowest on the other, that falls evenly from the higher to the lower; posts below it
//! stay as they are.

use std::borrow::Cow;

use glam::DVec2;

use crate::land::{CrossingKind, Land};
use crate::line_posts::along_line;
use sandtable_geom::segment::nearest_part;
use sandtable_terrain::lattice::Lattice;

/// How far from the edge of the way the lowest posts are sought, meters: an embankment 10 m high reaches some 20 m.
const REACH_M: f64 = 30.0;

/// The same in posts, where they lie far apart.
const REACH_POSTS: f64 = 2.0;

/// The heights of the ground with a cut below each bridge and culvert of the land, and the number of cuts.
pub(crate) fn carved(land: &Land) -> (Cow<'_, [f32]>, usize) {
    let ground = &*land.ground;
    let mut heights = Cow::Borrowed(ground.heights());
    let mut cuts = 0;
    let wet = |kind| matches!(kind, CrossingKind::Bridge | CrossingKind::Culvert);
    for crossing in land.crossings.iter().filter(|crossing| wet(crossing.kind)) {
        let width_m = if crossing.width_m.is_finite() { crossing.width_m.max(0.0) } else { 0.0 };
        let banks = banks(ground, ground.heights(), &crossing.line, (width_m, 0.0));
        if let Some(ends) = banks {
            cuts += usize::from(cut(ground, &mut heights, ends));
        }
    }
    (heights, cuts)
}

/// What the reader is told of so many cuts.
pub(crate) fn cut_note(cuts: usize) -> Vec<String> {
    match cuts {
        0 => Vec::new(),
        1 => vec!["the ground is cut through below 1 bridge or culvert".into()],
        _ => vec![format!("the ground is cut through below {cuts} bridges and culverts")],
    }
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

/// Cuts the ground between two posts; `false` where nothing stands in the way.
fn cut(ground: &Lattice, heights: &mut Cow<'_, [f32]>, [from, to]: [usize; 2]) -> bool {
    let place = |index| ground.map_position(ground.post_at(index));
    let (start, end) = (place(from), place(to));
    let levels = [heights[from], heights[to]].map(f64::from);
    let mut way = Vec::new();
    along_line(ground, &[start, end], 0.0, |index| way.push(index));
    let mut is_cut = false;
    for index in way {
        let share = nearest_part((start, end), place(index));
        let level = (levels[0] + (levels[1] - levels[0]) * share) as f32;
        if heights[index] > level {
            heights.to_mut()[index] = level;
            is_cut = true;
        }
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
        let over = crossing(CrossingKind::Culvert, DVec2::new(80.0, 100.0), DVec2::new(120.0, 100.0));
        land.crossings = vec![over.clone()];
        assert_eq!(depth(&land), 0.0);
        assert_eq!(carved(&land).1, 1);
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
            Crossing { line: Vec::new(), ..crossing(CrossingKind::Bridge, at(0.0, 0.0), at(0.0, 0.0)) },
        ];
        assert!(matches!(carved(&land), (Cow::Borrowed(_), 0)));
    }
}

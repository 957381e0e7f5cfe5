//! Beds and shores of lakes: earthworks that keep water level, so that it neither floats nor drowns its banks.
//!
//! ```text
//!        islands stay, but none below the water
//!   ╲        ╱╲                      ╱
//!    ╲·     ·  ·          ·         ·     the first posts ashore are moved half as far as the posts
//!     ────────────────────────────       beside them, so that no cliff of one cell is left
//!     ▲ every corner of every cell that the water touches: level, and pinned so that it is always shown
//! ```
//!
//! All lakes are planned on the ground as it is, and only then is it moved: their order changes no height. A post under
//! two lakes takes the lower level. The bed reaches the diagonal of a cell ashore, which a lattice with posts
//! [`spacing_m`] apart keeps within [`reach_m`] of the shore; beside the bed no post farther away than that is moved.

use glam::DVec2;

use crate::leveling::posts_touched;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;
use sandtable_geom::segment;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::volumes::Volumes;

/// The move of the first posts ashore as a share of that under water: a step of one cell becomes two of half the
/// height.
const BLEND: f64 = 0.5;

/// How far from its shore a small lake may move ground, in meters. Less needs more posts, in number with the square:
/// this takes 4 times as many on a model of 30 m, and 64 times as many on one of 90 m.
const REACH_M: f64 = 30.0;

/// How far from its shore a lake may move ground, as a share of the side of a square of its area: beside a large lake
/// nobody sees what moves there, and posts would be put in all over the model for it.
const REACH_SHARE: f64 = 1.0 / 3.0;

/// Posts within the reach: the bed ends at the first or, aslant, before the second. More would make a softer shore of more
/// posts.
const POSTS_ASHORE: f64 = 2.0;

/// A lake's shore and the level of its water.
#[derive(Clone, Copy, Debug)]
pub struct LakeBasin<'a> {
    /// The outer shore in world coordinates.
    pub exterior: &'a [DVec2],
    /// Shores of islands.
    pub holes: &'a [Vec<DVec2>],
    /// Elevation of the water in meters.
    pub level_m: f32,
    /// How far from the shore ground beside the bed may be moved, in meters; see [`reach_m`].
    pub reach_m: f64,
}

impl LakeBasin<'_> {
    fn rings(&self) -> Vec<Vec<DVec2>> {
        std::iter::once(self.exterior.to_vec()).chain(self.holes.iter().cloned()).collect()
    }
}

/// The result of flooding a lake.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flooded {
    /// Earth moved for bed, islands and shore.
    pub volumes: Volumes,
    /// The level of a lower lake on some of the same posts, which have that level; `None` where there is none.
    pub lower_level_m: Option<f32>,
}

/// The distance from the shore within which a lake of this area may move ground, in meters.
pub fn reach_m(area_m2: f64) -> f64 {
    REACH_M.max(area_m2.max(0.0).sqrt() * REACH_SHARE)
}

/// The greatest distance between posts with which bed and shore lie within a reach, in meters.
pub fn spacing_m(reach_m: f64) -> f64 {
    reach_m / POSTS_ASHORE
}

/// The distance that the bed of a lake extends beyond the shore on a lattice, in meters: the diagonal of a cell.
pub fn bed_reach_m(lattice: &Lattice) -> f64 {
    lattice.cell().length()
}

/// Levels the ground within the shores to the levels, raises islands to them and moves the first posts ashore. Returns
/// what each lake took, in the order of `lakes`; the order changes no height.
pub fn flood(lattice: &mut Lattice, lakes: &[LakeBasin<'_>]) -> Vec<Flooded> {
    let plan = ShorePlan::new(lattice, lakes);
    let mut flooded: Vec<Flooded> = lakes.iter().map(|lake| plan.meets_lower(lattice, lake)).collect();
    let blends = plan.blends(lattice);
    for &place in &plan.claimed {
        let (post, lake) = (lattice.post_at(place), plan.claim_of(place).lake());
        let rise_m = plan.rise_m(lattice, place);
        flooded[lake].volumes += Volumes::from_rise(rise_m, lattice.cell_m2());
        lattice.pin(post, lakes[lake].level_m);
    }
    for ShoreBlend { post, lake, rise_m } in blends {
        flooded[lake].volumes += Volumes::from_rise(rise_m, lattice.cell_m2());
        // Not pinned: pinned posts are water, which rivers leave alone.
        let height_m = f64::from(lattice.height(post)) + rise_m;
        lattice.heights_mut(post, post.column)[0] = height_m as f32;
    }
    flooded
}

/// What moves a post: nothing, or the water or the island of a lake, by its position in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Claim(u32);

impl Claim {
    const NONE: Self = Self(0);

    fn water(lake: usize) -> Self {
        Self(2 * lake as u32 + 1)
    }

    fn island(lake: usize) -> Self {
        Self(2 * lake as u32 + 2)
    }

    /// The lake of a claim that is not none.
    fn lake(self) -> usize {
        (self.0 as usize - 1) / 2
    }

    fn is_water(self) -> bool {
        self.0 % 2 == 1
    }
}

/// A post beside the bed, the lake that it is moved for, and how far.
struct ShoreBlend {
    post: Post,
    lake: usize,
    rise_m: f64,
}

/// Which lake moves which post.
struct ShorePlan<'a> {
    lakes: &'a [LakeBasin<'a>],
    /// The number of a [`Claim`] for each post, in the order of [`Lattice::heights`]; none at all where there is no lake. Of a
    /// large lattice, memory is taken for no more than lies near lakes.
    claims: Vec<u32>,
    /// The places of the posts that are claimed, rising.
    claimed: Vec<usize>,
}

impl<'a> ShorePlan<'a> {
    fn new(lattice: &Lattice, lakes: &'a [LakeBasin<'a>]) -> Self {
        let count = if lakes.is_empty() { 0 } else { lattice.heights().len() };
        let mut plan = Self { lakes, claims: vec![Claim::NONE.0; count], claimed: Vec::new() };
        for (index, lake) in lakes.iter().enumerate() {
            for post in posts_touched(lattice, &lake.rings()) {
                plan.claim(lattice.index(post), Claim::water(index));
            }
        }
        for (index, lake) in lakes.iter().enumerate() {
            for post in lake.holes.iter().flat_map(|hole| posts_touched(lattice, std::slice::from_ref(hole)))
            {
                let place = lattice.index(post);
                if lattice.height(post) < lake.level_m && !plan.claim_of(place).is_water() {
                    plan.claim(place, Claim::island(index));
                }
            }
        }
        plan.claimed.sort_unstable();
        plan
    }

    fn claim_of(&self, place: usize) -> Claim {
        Claim(self.claims[place])
    }

    /// Gives a post to a lake, unless one at no higher level has it.
    fn claim(&mut self, place: usize, claim: Claim) {
        let (level_m, before) = (|claim: Claim| self.lakes[claim.lake()].level_m, self.claim_of(place));
        if before == Claim::NONE || level_m(claim).total_cmp(&level_m(before)).is_lt() {
            self.claims[place] = claim.0;
        }
        if before == Claim::NONE {
            self.claimed.push(place);
        }
    }

    /// The lowest of the lower lakes on a lake's posts, without volumes.
    fn meets_lower(&self, lattice: &Lattice, lake: &LakeBasin<'_>) -> Flooded {
        let posts = posts_touched(lattice, &lake.rings()).into_iter();
        let levels = posts.map(|post| self.lakes[self.claim_of(lattice.index(post)).lake()].level_m);
        let lower = levels.filter(|&level_m| level_m < lake.level_m).min_by(f32::total_cmp);
        Flooded { volumes: Volumes::default(), lower_level_m: lower }
    }

    /// How far a claimed post is moved; 0 where there is no ground.
    fn rise_m(&self, lattice: &Lattice, place: usize) -> f64 {
        let level_m = self.lakes[self.claim_of(place).lake()].level_m;
        let rise_m = f64::from(level_m) - f64::from(lattice.heights()[place]);
        if rise_m.is_nan() { 0.0 } else { rise_m }
    }

    /// Every post next to a bed: moved by half the mean move of its neighbors there, but not beyond their levels.
    fn blends(&self, lattice: &Lattice) -> Vec<ShoreBlend> {
        let water = self.claimed.iter().filter(|&&place| self.claim_of(place).is_water());
        let beside = water.flat_map(|&place| around(lattice, lattice.post_at(place)));
        let mut ashore: Vec<usize> = beside.filter(|&place| self.claim_of(place) == Claim::NONE).collect();
        ashore.sort_unstable();
        ashore.dedup();
        let mut shores: Vec<Option<Shoreline>> = self.lakes.iter().map(|_| None).collect();
        ashore
            .into_iter()
            .filter_map(|place| self.blend(lattice, &mut shores, lattice.post_at(place)))
            .collect()
    }

    fn blend(&self, lattice: &Lattice, shores: &mut [Option<Shoreline>], post: Post) -> Option<ShoreBlend> {
        let height_m = f64::from(lattice.height(post));
        if height_m.is_nan() {
            return None;
        }
        let beds = || around(lattice, post).filter(|&place| self.claim_of(place).is_water());
        let (sum_m, count) =
            beds().fold((0.0, 0), |(sum_m, count), place| (sum_m + self.rise_m(lattice, place), count + 1));
        let lakes = || beds().map(|place| self.claim_of(place).lake());
        let (low_m, high_m) = lakes()
            .map(|lake| f64::from(self.lakes[lake].level_m))
            .fold((height_m, height_m), |(low_m, high_m), level_m| (low_m.min(level_m), high_m.max(level_m)));
        let is_near = |&lake: &usize| {
            let basin = &self.lakes[lake];
            // What lies next to a bed is at most two diagonals away.
            2.0 * bed_reach_m(lattice) <= basin.reach_m
                || shores[lake]
                    .get_or_insert_with(|| Shoreline::new(basin))
                    .is_near(lattice.position(post).as_dvec2(), basin.reach_m)
        };
        let lake = lakes()
            .filter(is_near)
            .min_by(|&a, &b| self.lakes[a].level_m.total_cmp(&self.lakes[b].level_m))?;
        let rise_m = (height_m + sum_m / f64::from(count) * BLEND).clamp(low_m, high_m) - height_m;
        (rise_m != 0.0).then_some(ShoreBlend { post, lake, rise_m })
    }
}

/// The edges of a lake's shores, to be searched by place.
struct Shoreline {
    edges: Vec<(DVec2, DVec2)>,
    tree: RectTree,
}

impl Shoreline {
    fn new(lake: &LakeBasin<'_>) -> Self {
        let edges: Vec<(DVec2, DVec2)> =
            lake.rings().iter().flat_map(|ring| polygon::edges(ring).collect::<Vec<_>>()).collect();
        let bounds: Vec<Rect> = edges.iter().map(|&(from, to)| Rect::around([from, to])).collect();
        Self { edges, tree: RectTree::new(&bounds) }
    }

    /// Whether a point lies within a distance of the shore.
    fn is_near(&self, at: DVec2, distance_m: f64) -> bool {
        let mut near = self.tree.meeting(&Rect::around([at]).grown(distance_m));
        near.any(|index| segment::distance_squared(self.edges[index], at) <= distance_m * distance_m)
    }
}

/// The places of the posts around a post.
fn around(lattice: &Lattice, post: Post) -> impl Iterator<Item = usize> + use<'_> {
    let rect = PostRect { first: post, last: post }.grown((1, 1), lattice);
    rect.posts().filter(move |&other| other != post).map(|other| lattice.index(other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Ground that rises 2 m a post eastward, posts 10 m apart.
    fn slope() -> Lattice {
        let heights = (0..441).map(|index| (index % 21) as f32 * 2.0).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 21, heights).expect("sound")
    }

    fn square(low: f64, high: f64) -> Vec<DVec2> {
        vec![DVec2::new(low, low), DVec2::new(high, low), DVec2::new(high, high), DVec2::new(low, high)]
    }

    fn along(lattice: &Lattice, row: u32) -> Vec<f32> {
        (0..21).map(|column| lattice.height(Post { column, row })).collect()
    }

    fn lake<'a>(exterior: &'a [DVec2], holes: &'a [Vec<DVec2>], level_m: f32) -> LakeBasin<'a> {
        LakeBasin { exterior, holes, level_m, reach_m: REACH_M }
    }

    #[test]
    fn the_cliff_beside_the_water_is_halved() {
        let mut lattice = slope();
        flood(&mut lattice, &[lake(&square(52.0, 148.0), &[], 20.0)]);
        let heights = along(&lattice, 10);
        assert!(heights[5..=15].iter().all(|&height| height == 20.0), "{heights:?}");
        // The last post under water was cut by 10 m from 30 m, the next stood at 32 m.
        assert_eq!(heights[16..18], [27.0, 34.0]);
        // The first was filled by 10 m from 10 m, the one before stood at 8 m.
        assert_eq!(heights[3..5], [6.0, 13.0]);
    }

    #[test]
    fn an_island_keeps_its_ground_above_the_water() {
        let mut lattice = slope();
        flood(&mut lattice, &[lake(&square(12.0, 188.0), &[square(62.0, 138.0)], 20.0)]);
        let heights = along(&lattice, 10);
        assert!(heights[7..=10].iter().all(|&height| height == 20.0), "{heights:?}");
        assert!(heights[11] == 22.0 && heights[12] > 20.0, "{heights:?}");
    }

    #[test]
    fn of_two_lakes_in_one_cell_the_lower_holds_and_the_higher_reports_it() {
        let (low, high) = (square(32.0, 67.0), square(63.0, 98.0));
        let lakes = [lake(&low, &[], 9.0), lake(&high, &[], 12.0)];
        for (lakes, levels) in [(lakes, [None, Some(9.0)]), ([lakes[1], lakes[0]], [Some(9.0), None])] {
            let mut lattice = slope();
            let flooded = flood(&mut lattice, &lakes);
            assert_eq!([flooded[0].lower_level_m, flooded[1].lower_level_m], levels);
            assert_eq!(lattice.height(Post { column: 7, row: 7 }), 9.0);
        }
    }

    #[test]
    fn posts_ashore_stay_between_the_water_and_their_ground() {
        let before = slope();
        for level_m in [0.0, 7.0, 23.5, 60.0] {
            let mut lattice = slope();
            flood(&mut lattice, &[lake(&square(52.0, 148.0), &[], level_m)]);
            for post in lattice.posts() {
                let (was, is) = (before.height(post), lattice.height(post));
                assert!(is >= was.min(level_m) && is <= was.max(level_m), "{post:?}: {was} {is}");
            }
        }
    }

    #[test]
    fn no_post_beside_the_bed_is_moved_beyond_the_reach() {
        let shore = square(52.0, 148.0);
        for reach_m in [0.0, 5.0, 9.0, 15.0, 25.0] {
            let mut lattice = slope();
            flood(&mut lattice, &[LakeBasin { reach_m, ..lake(&shore, &[], 20.0) }]);
            for post in lattice.posts().filter(|&post| lattice.height(post) != slope().height(post)) {
                let at = lattice.position(post).as_dvec2();
                let away_m = (at - at.clamp(DVec2::splat(52.0), DVec2::splat(148.0))).length();
                let farthest_m = if lattice.is_pinned(post) { bed_reach_m(&lattice) } else { reach_m };
                assert!(away_m <= farthest_m, "{post:?} lies {away_m} m from the shore");
            }
        }
    }

    proptest! {
        #[test]
        fn the_order_of_lakes_changes_no_height(
            lakes in prop::collection::vec((0.0..150.0f64, 20.0..90.0f64, 0.0..40.0f32, any::<bool>()), 2..6),
            turn in 0usize..6,
        ) {
            let shapes: Vec<(Vec<DVec2>, Vec<Vec<DVec2>>, f32)> = lakes.iter().map(|&(low, size, level_m, has_island)| {
                let island = square(low + size * 0.3, low + size * 0.7);
                (square(low, low + size), has_island.then_some(island).into_iter().collect(), level_m)
            }).collect();
            let mut basins: Vec<LakeBasin<'_>> =
                shapes.iter().map(|(exterior, holes, level_m)| lake(exterior, holes, *level_m)).collect();
            let (mut plain, mut turned) = (slope(), slope());
            flood(&mut plain, &basins);
            basins.reverse();
            basins.rotate_left(turn % lakes.len());
            flood(&mut turned, &basins);
            let bits = |lattice: &Lattice| lattice.heights().iter().map(|height| height.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&plain), bits(&turned));
            prop_assert_eq!(plain.pinned(), turned.pinned());
        }
    }
}

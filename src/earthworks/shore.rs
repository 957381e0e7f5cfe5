//! A lake's bed and shore: earthworks that keep water level, so that it neither floats nor drowns its banks.
//!
//! ```text
//!        islands stay, but none below the water
//!   ╲        ╱╲                      ╱
//!    ╲·     ·  ·          ·         ·     the first posts ashore are moved half as far as the posts
//!     ────────────────────────────       beside them, so that no cliff of one cell is left
//!     ▲ every corner of every cell that the water touches: level, and pinned so that it is always shown
//! ```

use std::collections::BTreeMap;

use glam::DVec2;

use crate::earthworks::leveling::posts_touched;
use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::post_rect::PostRect;
use crate::terrain::volumes::Volumes;

/// The move of the first posts ashore as a share of that under water: a step of one cell becomes two of half the
/// height.
const BLEND: f64 = 0.5;

/// The result of flooding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flooded {
    /// Earth moved for bed, islands and shore.
    pub volumes: Volumes,
    /// The level of another lake on some of the same posts, which now have this one's; `None` where there is none.
    pub other_level_m: Option<f32>,
}

/// Levels the ground within a shore to `level_m`, raises islands to it and blends the first posts ashore. `exterior` and
/// `holes` are in world coordinates.
pub fn flood(lattice: &mut Lattice, exterior: &[DVec2], holes: &[Vec<DVec2>], level_m: f32) -> Flooded {
    let rings: Vec<Vec<DVec2>> = std::iter::once(exterior.to_vec()).chain(holes.iter().cloned()).collect();
    let water = posts_touched(lattice, &rings);
    let mut works = ShoreWorks { lattice, flooded: Flooded::default(), moves: BTreeMap::new() };
    for &post in &water {
        works.level(post, level_m);
    }
    for hole in holes {
        for post in posts_touched(works.lattice, std::slice::from_ref(hole)) {
            works.raise_island(post, level_m);
        }
    }
    works.blend(&water, level_m);
    works.flooded
}

/// Earthworks in progress.
struct ShoreWorks<'a> {
    lattice: &'a mut Lattice,
    flooded: Flooded,
    /// By row and column: how far each post of bed and islands was moved; 0 where there was no ground.
    moves: BTreeMap<(u32, u32), f64>,
}

impl ShoreWorks<'_> {
    /// Sets a post under water to the level.
    fn level(&mut self, post: Post, level_m: f32) {
        let before = self.lattice.height(post);
        if self.lattice.is_pinned(post) && before != level_m && self.flooded.other_level_m.is_none() {
            self.flooded.other_level_m = Some(before);
        }
        self.set(post, level_m);
    }

    /// Raises a post on an island that lies below the water.
    fn raise_island(&mut self, post: Post, level_m: f32) {
        let lies_below = self.lattice.height(post) < level_m;
        if lies_below && !self.moves.contains_key(&(post.row, post.column)) {
            self.set(post, level_m);
        }
    }

    fn set(&mut self, post: Post, height_m: f32) {
        let rise_m = f64::from(height_m) - f64::from(self.lattice.height(post));
        let rise_m = if rise_m.is_nan() { 0.0 } else { rise_m };
        self.moves.insert((post.row, post.column), rise_m);
        self.count(rise_m);
        self.lattice.pin(post, height_m);
    }

    fn count(&mut self, rise_m: f64) {
        self.flooded.volumes += Volumes::from_rise(rise_m, self.lattice.cell_m2());
    }

    /// Moves every post next to the bed by half the mean move of its neighbors there, but not beyond the level.
    fn blend(&mut self, water: &[Post], level_m: f32) {
        let mut ashore: BTreeMap<(u32, u32), (f64, u32)> = BTreeMap::new();
        for &post in water {
            let moved_m = self.moves[&(post.row, post.column)];
            let around = PostRect { first: post, last: post }.grown((1, 1), self.lattice);
            for place in around.posts().map(|neighbor| (neighbor.row, neighbor.column)) {
                if !self.moves.contains_key(&place) {
                    let (sum, count) = ashore.entry(place).or_default();
                    *sum += moved_m;
                    *count += 1;
                }
            }
        }
        for ((row, column), (sum, count)) in ashore {
            let post = Post { column, row };
            let (before, wanted_m) = (self.lattice.height(post), sum / f64::from(count) * BLEND);
            let to_level_m = f64::from(level_m) - f64::from(before);
            let rise_m = wanted_m.clamp(to_level_m.min(0.0), to_level_m.max(0.0));
            if rise_m != 0.0 && !before.is_nan() && !self.lattice.is_pinned(post) {
                self.count(rise_m);
                // Not pinned: pinned posts are water, which rivers leave alone.
                self.lattice.heights_mut(post, column)[0] = (f64::from(before) + rise_m) as f32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn the_cliff_beside_the_water_is_halved() {
        let mut lattice = slope();
        flood(&mut lattice, &square(52.0, 148.0), &[], 20.0);
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
        flood(&mut lattice, &square(12.0, 188.0), &[square(62.0, 138.0)], 20.0);
        let heights = along(&lattice, 10);
        assert!(heights[7..=10].iter().all(|&height| height == 20.0), "{heights:?}");
        assert!(heights[11] == 22.0 && heights[12] > 20.0, "{heights:?}");
    }

    #[test]
    fn of_two_lakes_in_one_cell_the_later_holds_and_reports_the_other() {
        let mut lattice = slope();
        assert_eq!(flood(&mut lattice, &square(32.0, 67.0), &[], 9.0).other_level_m, None);
        assert_eq!(flood(&mut lattice, &square(63.0, 98.0), &[], 12.0).other_level_m, Some(9.0));
        assert_eq!(lattice.height(Post { column: 7, row: 7 }), 12.0);
    }

    #[test]
    fn posts_ashore_stay_between_the_water_and_their_ground() {
        let before = slope();
        for level_m in [0.0, 7.0, 23.5, 60.0] {
            let mut lattice = slope();
            flood(&mut lattice, &square(52.0, 148.0), &[], level_m);
            for post in lattice.posts() {
                let (was, is) = (before.height(post), lattice.height(post));
                assert!(is >= was.min(level_m) && is <= was.max(level_m), "{post:?}: {was} {is}");
            }
        }
    }
}

//! A lake's bed and shore: earthwork that makes water level and neither floats it nor drowns its banks.
//!
//! ```text
//!        islands stay, but none below the water
//!   ╲        ╱╲                      ╱
//!    ╲·     ·  ·          ·         ·     the first posts ashore go half of the way with the posts they
//!     ────────────────────────────       stand beside, so that no cliff of one cell is left
//!     ▲ every corner of every cell that the water touches: level, and pinned so that it is always shown
//! ```

use std::collections::BTreeMap;

use glam::DVec2;

use crate::earthworks::leveling::posts_touched;
use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::volumes::Volumes;

/// The share of the move of the posts under water that the first posts ashore go along with: with half of it, a cut or
/// dam of one cell becomes two steps of half the height.
const BLEND: f64 = 0.5;

/// What flooding came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flooded {
    /// Earth moved for bed, islands and shore.
    pub volumes: Volumes,
    /// The level of another lake that had some of the same posts, which now have this one's; `None` where no other had.
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

/// Earthworks under way.
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
        let rise_m = self.rise_m(post, height_m);
        self.moves.insert((post.row, post.column), rise_m);
        self.count(rise_m);
        self.lattice.pin(post, height_m);
    }

    /// How far a post would rise; 0 where it has no ground.
    fn rise_m(&self, post: Post, height_m: f32) -> f64 {
        let before = self.lattice.height(post);
        if before.is_nan() { 0.0 } else { f64::from(height_m) - f64::from(before) }
    }

    fn count(&mut self, rise_m: f64) {
        let cell_m2 = self.lattice.cell().x * self.lattice.cell().y;
        self.flooded.volumes.fill_m3 += rise_m.max(0.0) * cell_m2;
        self.flooded.volumes.cut_m3 += (-rise_m).max(0.0) * cell_m2;
    }

    /// Moves every post next to the bed half as far as its neighbors there were moved on average, but not beyond the
    /// level.
    fn blend(&mut self, water: &[Post], level_m: f32) {
        let mut ashore: BTreeMap<(u32, u32), (f64, u32)> = BTreeMap::new();
        for &post in water {
            let moved_m = self.moves[&(post.row, post.column)];
            for place in neighbors(self.lattice, post) {
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
                // Not pinned: what is pinned is water, and rivers leave it alone.
                self.lattice.heights_mut(post, column)[0] = (f64::from(before) + rise_m) as f32;
            }
        }
    }
}

/// The row and column of each of a post's up to eight neighbors.
fn neighbors(lattice: &Lattice, post: Post) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (columns, rows) = (lattice.columns(), lattice.rows());
    let span = |at: u32, count: u32| at.saturating_sub(1)..=(at + 1).min(count - 1);
    span(post.row, rows)
        .flat_map(move |row| span(post.column, columns).map(move |column| (row, column)))
        .filter(move |&place| place != (post.row, post.column))
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
    fn an_island_keeps_its_ground_but_none_of_it_lies_below_the_water() {
        let mut lattice = slope();
        flood(&mut lattice, &square(12.0, 188.0), &[square(62.0, 138.0)], 20.0);
        let heights = along(&lattice, 10);
        assert!(heights[7..=10].iter().all(|&height| height == 20.0), "{heights:?}");
        assert!(heights[11] == 22.0 && heights[12] > 20.0, "{heights:?}");
    }

    #[test]
    fn of_two_lakes_in_one_cell_the_later_holds_and_says_so() {
        let mut lattice = slope();
        assert_eq!(flood(&mut lattice, &square(32.0, 67.0), &[], 9.0).other_level_m, None);
        assert_eq!(flood(&mut lattice, &square(63.0, 98.0), &[], 12.0).other_level_m, Some(9.0));
        assert_eq!(lattice.height(Post { column: 7, row: 7 }), 12.0);
    }

    #[test]
    fn what_lies_ashore_never_sinks_below_the_water_nor_rises_above_its_ground() {
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
